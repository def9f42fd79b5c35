"""At which isolation levels a test runs."""

import pytest

# What the host does is the same at both levels: one of them is for ``make test-all``.
BY_THE_HOST = pytest.mark.parametrize("either_sandbox", ["A", pytest.param("B", marks=pytest.mark.slow)], indirect=True)
