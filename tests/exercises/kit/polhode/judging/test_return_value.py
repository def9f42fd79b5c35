"""Which functions are empty: students have not written them yet."""

import pytest

from polhode.judging.return_value import is_empty

EMPTY = [
    "pass",
    "...",
    "return",
    "'''TODO'''",
    "'''TODO'''\n    return None\n    g(x)",
    "if False: g(x)",
    "pass; pass; ...",
    "return ...",
    "raise NotImplementedError",
    "raise NotImplementedError()",
    "raise NotImplementedError('Exercise 3: your code here')",
    "'''TODO'''\n    raise NotImplementedError('write me') from None\n    return x",
    "raise NotImplemented",
    "return NotImplemented",
]
WRITTEN = [
    "return 1",
    "x = 1",
    "g(x)",
    "return x",
    "raise ValueError",
    "raise ValueError('x')",
    "raise",
    "if x: raise NotImplementedError",
    "return 'text'",
    "return sin",
    "return NotImplementedError('text')",
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
