"""Which functions have the same fingerprint: those that do the same, wherever they stand."""

import itertools
from types import CodeType

import pytest

from polhode.notebook.code_fingerprint import fingerprint


def printed(text):
    (code,) = (
        constant for constant in compile(text, "cell", "exec").co_consts if isinstance(constant, CodeType)
    )
    return fingerprint(code)


@pytest.mark.parametrize(
    "text",
    [
        "def f(x):\n    return x in {'a', 'b', 'c'} or np.sin(x)",
        "def f(x):\n    class A:\n        def g(self):\n            return x\n    return A",
        "def f(x, *y, z=1):\n    return [lambda: k for k in y if k]",
    ],
)
def test_the_place_and_the_imports_of_the_cell_do_not_matter(text):
    assert (
        printed(text) == printed(f"import numpy as np\n\n\n{text}") == printed(f"if True:\n\n  pass\n{text}")
    )


BODIES = [
    "1",
    "1.0",
    "True",
    "'1'",
    "0.0",
    "-0.0",
    "(1, 2)",
    "(1, 2.0)",
    "x in {1}",
    "x in {2}",
    "x + 1",
    "x - 1",
]
BODIES += ["a.b(x)", "a.c(x)", "g(a=x)", "g(b=x)", "lambda: 2", "lambda: 3"]
DIFFERENT = [
    *[f"def f(x): return {body}" for body in BODIES],
    *[
        f"def f({parameters}): return 5"
        for parameters in ("", "x", "y", "x, z", "x, *, z", "x, /", "*x", "**x")
    ],
    *[f"def f(x):\n if x:\n  x += 1\n{space}x *= 2\n return x" for space in (" ", "  ")],
    *[f"def f(x):\n class A:\n  def g(self): return {value}\n return A" for value in (1, 2)],
]


def test_other_values_parameters_or_steps_do():
    for one, other in itertools.combinations(DIFFERENT, 2):
        assert printed(one) != printed(other), (one, other)
