"""Which sources are equal by the rules of arithmetic, and which merely look alike."""

import pytest

from exercises.authoring.mutants.equivalence import fingerprint

EQUAL = [
    ("def f(x, y): return 2*x + y", "def f(x, y): return y + x*2"),
    ("def f(A, B): return -A @ B", "def f(A, B): return -(A @ B)"),
    ("def f(x): return 2*x < 0", "def f(x): return -x > 0"),
    ("def f(x):\n for k in x:\n  s = s + k\n return s", "def f(x):\n for k in x:\n  s = k + s\n return s"),
]
DIFFERENT = [
    ("def f(A, B): return A @ B", "def f(A, B): return B @ A"),
    ("def f(r): return r.random() - r.random()", "def f(r): return 0*r"),
    (
        "def f(r):\n a = r.random()\n b = r.random()\n return a",
        "def f(r):\n a = r.random()\n b = r.random()\n return b",
    ),
    ("def f(x):\n if x: y = 1\n else: y = 2\n return y", "def f(x):\n if x: y = 3\n else: y = 2\n return y"),
    (
        "def f(x):\n try: y = 1\n except E: y = 2\n return y",
        "def f(x):\n try: y = 1\n except E: y = 3\n return y",
    ),
    ("def f(x):\n x[0] = 1\n return x", "def f(x):\n x[0] = 2\n return x"),
    ("class A:\n g = 1", "class A:\n g = 2"),
    ("f = lambda x: x", "f = lambda x: 2*x"),
    ("def f(x): return x < 0", "def f(x): return x <= 0"),
]


@pytest.mark.parametrize(
    ("one", "other", "equal"), [(*pair, True) for pair in EQUAL] + [(*pair, False) for pair in DIFFERENT]
)
def test_equal_sources_have_one_fingerprint(one, other, equal):
    assert (fingerprint(one) == fingerprint(other)) is equal
