"""Which functions are empty: students have not written them yet."""

import pytest

from ecp.return_value import is_empty

EMPTY = [
    "pass",
    "...",
    "return",
    "'''TODO'''",
    "'''TODO'''\n    return None\n    g(x)",
    "if False: g(x)",
    "pass; pass; ...",
]
WRITTEN = [
    "return 1",
    "x = 1",
    "g(x)",
    "return x",
    "raise ValueError",
    "'''TODO'''\n    return x.y",
    "for _ in x: pass",
]


def function(body):
    names = {}
    exec(f"def f(x):\n    {body}\n", names)
    return names["f"]


@pytest.mark.parametrize("body", EMPTY)
def test_a_function_without_code_that_runs_is_empty(body):
    assert is_empty(function(body))


@pytest.mark.parametrize("body", WRITTEN)
def test_a_function_that_does_something_is_not_empty(body):
    assert not is_empty(function(body))
