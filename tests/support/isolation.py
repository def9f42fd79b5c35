"""At which isolation levels a test runs."""

import pytest

LEVELS = ["namespaces", pytest.param("process", marks=pytest.mark.slow)]
# What the host does is the same at both levels: one of them is for ``make test-all``.
BY_THE_HOST = pytest.mark.parametrize("either_sandbox", LEVELS, indirect=True)
