"""The wrong versions of right solutions: the sentence of each, that no two are equal, and the numbers they
return.
"""

import ast
import sys

import numpy as np
import pytest
import scipy.linalg

from exercises.authoring.diagnosis_codes import CODES
from exercises.authoring.mutants.mutation import pairs, variants

CHANGES = {
    "-w**2*x - 2*g*v": [
        ("sign-flipped", "the term `2*g*v` has the opposite sign", "-w**2*x + 2*g*v"),
        ("sign-flipped", "the term `w**2*x` has the opposite sign", "w**2*x - 2*g*v"),
        ("missing-term", "the term `2*g*v` is missing", "-w**2*x"),
        ("constant-factor", "the factor `2` in `2*g*v` is missing", "-w**2*x - g*v"),
        ("missing-term", "the factor `g` in `2*g*v` is missing", "-w**2*x - 2*v"),
        ("wrong-power", "the exponent `2` of `w**2` is missing", "-w*x - 2*g*v"),
    ],
    "(x[0], x[1]*2)": [
        ("wrong-index", "`x[0]` stands in place of `x[1]`", "(x[0], x[0]*2)"),
        ("component-order", "`x[0]` and `x[1]*2` are returned in the other order", "(x[1]*2, x[0])"),
    ],
    "x[1:-1] - x[:-2]": [
        ("wrong-index", "`x[2:-1]` stands in place of `x[1:-1]`", "x[2:-1] - x[:-2]"),
        ("wrong-index", "`x[:-1]` stands in place of `x[:-2]`", "x[1:-1] - x[:-1]"),
        ("sign-flipped", "`x[1:-1] - x[:-2]` has the opposite sign", "x[:-2] - x[1:-1]"),
    ],
    "x[:, 0]": [("wrong-index", "the indices of `x[:, 0]` are exchanged", "x[0, :]")],
    "x if x < w else -1": [
        ("wrong-comparison", "the comparison `x < w` is reversed", "x if x > w else -1"),
        ("wrong-comparison", "`<=` stands in place of `<` in `x < w`", "x if x <= w else -1"),
    ],
    "np.sin(x) + sqrt(v / w)": [
        ("wrong-function", "`cos` stands in place of `sin` in `np.sin(x)`", "np.cos(x) + sqrt(v / w)"),
        ("wrong-function", "`sqrt` is missing in `sqrt(v / w)`", "np.sin(x) + v / w"),
        ("wrong-divisor", "numerator and denominator of `v / w` are exchanged", "np.sin(x) + sqrt(w / v)"),
    ],
    "np.interp(x, v, w)": [
        ("swapped-arguments", "the arguments `x` and `v` of `interp` are exchanged", "np.interp(v, x, w)"),
        ("missing-argument", "the argument `w` of `interp` is missing", "np.interp(x, v)"),
    ],
    "np.sum(x.T @ v, axis=1, keepdims=True)": [
        ("transposed", "`.T` is missing after `x`", "np.sum(x @ v, axis=1, keepdims=True)"),
        (
            "wrong-operator",
            "`*` stands in place of `@` before `v` in `x.T @ v`",
            "np.sum(x.T * v, axis=1, keepdims=True)",
        ),
        ("wrong-index", "`axis=0` stands in place of `axis=1`", "np.sum(x.T @ v, axis=0, keepdims=True)"),
        ("missing-argument", "the argument `axis=1` of `sum` is missing", "np.sum(x.T @ v, keepdims=True)"),
        (
            "wrong-option",
            "`keepdims=False` stands in place of `keepdims=True`",
            "np.sum(x.T @ v, axis=1, keepdims=False)",
        ),
    ],
    "w / (2 * (x + v))": [
        ("missing-brackets", "the brackets around `2 * (x + v)` are missing", "w / 2 * (x + v)"),
        ("missing-brackets", "the brackets around `x + v` are missing", "w / (2 * x + v)"),
        (
            "wrong-operator",
            "`*` stands in place of `/` before `2 * (x + v)` in `w / (2 * (x + v))`",
            "w * (2 * (x + v))",
        ),
    ],
    "[x for _ in range(v)]": [
        ("off-by-one", "the bound `v` of `range(v)` is one less", "[x for _ in range(v - 1)]")
    ],
    "(x / 2, w * (x / 2 + v))": [
        (
            "constant-factor",
            "the division by `2` in `(x / 2, w * (x / 2 + v))` is missing",
            "(x, w * (x / 2 + v))",
        ),
        (
            "wrong-operator",
            "`*` stands in place of `/` before `2` in `x / 2 + v`",
            "(x / 2, w * (x * 2 + v))",
        ),
    ],
    "x + w": [
        ("wrong-variable", "`v` stands in place of `x` in `x + w`", "v + w"),
        ("constant-factor", "`w` is halved in `x + w`", "x + w / 2"),
    ],
}


def made(answer):
    return variants(f"def f(x, v, w, g):\n    return {answer}\n")


def returned(variant):
    return ast.dump(ast.parse(variant.source.split("return ")[1].strip()))


@pytest.mark.parametrize(
    ("right", "code", "sentence", "wrong"), [(r, *c) for r, changes in CHANGES.items() for c in changes]
)
def test_a_change_and_its_sentence(right, code, sentence, wrong):
    wrong = ast.dump(ast.parse(wrong))
    named = [
        (v.code, v.sentence.replace("the returned value", f"`{right}`"), returned(v)) for v in made(right)
    ]
    assert (code, sentence, wrong) in named


def test_no_sentence_about_a_factor_sign_or_term_contains_the_whole_solution():
    sentences = [v.sentence for v in made("x * w / (2 + v)")]
    assert (
        "the factor `w` in the returned value is missing" in sentences
        and "the returned value is halved" in sentences
    )
    assert not [s for s in sentences if "`x * w / (2 + v)`" in s and "in place of" not in s]


EQUAL = [
    ("x * 1", "x"),
    ("x * 1", "x / 1"),
    ("(x - w)**2", "(w - x)**2"),
    ("abs(x - w)", "abs(w - x)"),
    ("max(x, w)", "max(w, x)"),
    ("np.hypot(x, w)", "np.hypot(w, x)"),
    ("x if x - w > 0 else v", "x if (x - w) / 2 > 0 else v"),
]


@pytest.mark.parametrize(("right", "equal"), EQUAL)
def test_no_variant_is_equal_by_the_rules_of_arithmetic(right, equal):
    assert ast.dump(ast.parse(equal)) not in map(returned, made(right))


SOURCE = '''import numpy as np
from math import sin as sine

G = 9.81  # µ = 1


class Pendulum:
    """Two 2 + 2."""

    def __init__(self, l: float, g: float = 2.5):
        self.l, self.g = l, g  # ω² = g/l

    def period(self) -> float:
        print("period", 7)
        return 2 * np.pi * (
            self.l  # the length
            / self.g
        ) ** 0.5


def run(l, g):
    """Return 1 - 2."""
    return Pendulum(l, g).period() - G
'''


def test_only_one_place_changes_in_the_code():
    found = variants(SOURCE)
    lines = SOURCE.splitlines()
    changed = {
        n
        for v in found
        for n, (a, b) in enumerate(zip(lines, v.source.splitlines(), strict=False), 1)
        if a != b and len(v.source.splitlines()) == len(lines)
    }
    assert (
        min(changed) >= 4
        and not {8, 10, 14, 22} & changed
        and {4, 15, 17, 23} <= {v.line for v in found} | changed
    )
    assert any("self.l  # the length\n            / self.g" in v.source for v in found), "comments stay"


@pytest.mark.parametrize("bad", ["def f(:", "x = = 2"])
def test_a_source_that_is_not_python_raises(bad):
    with pytest.raises(SyntaxError):
        variants(bad)


RIGHT = {
    "rk4_step": """
def rk4_step(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h/2, y + h/2*k1)
    k3 = f(t + h/2, y + h/2*k2)
    k4 = f(t + h, y + h*k3)
    return y + h/6*(k1 + 2*k2 + 2*k3 + k4)
""",
    "oscillator": """
def oscillator(t, y, w, g):
    return [y[1], -w**2*y[0] - 2*g*y[1]]
""",
    "normal_modes": """
def normal_modes(M, K):
    w2, X = scipy.linalg.eigh(K, M)
    return np.sqrt(w2), X
""",
    "find_root": """
def find_root(f, a, b, tol):
    fa = f(a)
    while b - a > tol:
        m = (a + b)/2
        fm = f(m)
        if fa*fm <= 0:
            b = m
        else:
            a, fa = m, fm
    return (a + b)/2
""",
    "Pendulum": """
class Pendulum:
    def __init__(self, length, gravity=9.81):
        self.length = length
        self.gravity = gravity

    def period(self, amplitude):
        small = 2*np.pi*np.sqrt(self.length/self.gravity)
        return small*(1 + amplitude**2/16)
""",
    "power_spectrum": """
def power_spectrum(x, dt):
    n = len(x)
    X = np.fft.rfft(x - x.mean())
    power = np.abs(X)**2/n
    power[1:-1] *= 2
    return np.fft.rfftfreq(n, dt), power
""",
    "pi_and_error": """
def pi_and_error(n, rng):
    inside = 0
    for k in range(n):
        x, y = rng.random(2)
        if x**2 + y**2 < 1:
            inside += 1
    p = inside/n
    return 4*p, 4*np.sqrt(p*(1 - p)/n)
""",
    "line_fit": """
def line_fit(x, y, s):
    A = np.stack([np.ones_like(x), x], axis=1)/s[:, None]
    cov = np.linalg.inv(A.T @ A)
    return cov @ (A.T @ (y/s)), cov
""",
}


class TooLong(Exception):
    """A variant does not end."""


def oscillation(t, y):
    return np.array([y[1], -(1.3**2) * y[0] - 0.4 * t * y[1] + np.cos(t)])


def calls(name):
    """Calls of the function with three sets of inputs."""
    return [
        call(name, *np.random.default_rng(k).uniform(0.3, 1.9, 4), np.random.default_rng(k)) for k in range(3)
    ]


def call(name, a, b, c, d, rng):
    S, x, w = rng.normal(size=(3, 3)), np.sort(rng.uniform(0, 9, 12)), rng.uniform(0.5, 2, 12)
    return {
        "rk4_step": lambda f: f(oscillation, a, np.array([b, -c]), 0.1 + d / 9),
        "oscillator": lambda f: f(a, np.array([b, -c]), 2 * d, a / 3),
        "normal_modes": lambda f: f(np.diag([a, b, c]), S @ S.T + np.diag([0.2, 1, 2])),
        "find_root": lambda f: f(lambda E: E - 0.8 * np.sin(E) - a, 0.0, np.pi, 1e-12),
        "Pendulum": lambda f: (f(a, 10 * b).period(c), f(a).period(d)),
        "power_spectrum": lambda f: f(S.ravel()[:8] + 2, a),
        "pi_and_error": lambda f: f(200 + int(9 * a), np.random.default_rng(int(100 * b))),
        "line_fit": lambda f: f(x, 2 + 3 * x + w, w),
    }[name]


def numbers(source, name):
    """Return the shapes and numbers that a version of the function returns; None if it raises, loops or is
    not finite.
    """
    scope, steps = {"np": np, "scipy": scipy}, [0]

    def guard(frame, event, argument):
        if frame.f_code.co_filename != "<variant>":
            return None
        steps[0] += 1
        if steps[0] > 20_000:
            raise RuntimeError
        return guard

    before = sys.gettrace()
    try:
        with np.errstate(all="ignore"):
            exec(compile(source, "<variant>", "exec"), scope)
            sys.settrace(guard)
            answers = [ask(scope[name]) for ask in calls(name)]
            sys.settrace(before)
        parts = [np.asarray(part) for a in answers for part in (a if isinstance(a, tuple) else (a,))]
        found = np.concatenate([part.astype(float, casting="same_kind").ravel() for part in parts])
    except Exception:
        return None
    finally:
        sys.settrace(before)
    return ([part.shape for part in parts], found) if np.all(np.isfinite(found)) else None


def same(one, other):
    return one[0] == other[0] and np.allclose(one[1], other[1], rtol=1e-11, atol=1e-13)


def measured(name):
    """Return the variants, those of them with the right numbers, and groups of those with the same wrong
    numbers.
    """
    source = RIGHT[name].lstrip()
    right, found, equal, groups = numbers(source, name), variants(source), [], []
    for variant, answer in [(v, n) for v in found if (n := numbers(v.source, name)) is not None]:
        if same(answer, right):
            equal.append(variant)
        elif group := next((g for g in groups if same(g[0][1], answer)), None):
            group.append((variant, answer))
        else:
            groups.append([(variant, answer)])
    return found, equal, [[v for v, _ in g] for g in groups]


@pytest.mark.parametrize("name", RIGHT)
def test_each_variant_compiles_has_a_documented_code_and_no_other_has_its_meaning(name):
    source = RIGHT[name].lstrip()
    found = variants(source)
    assert len(found) >= 10 and {v.code for v in found} <= CODES
    meanings = {ast.dump(compile(v.source, name, "exec", ast.PyCF_ONLY_AST)) for v in found} | {
        ast.dump(ast.parse(source))
    }
    assert len(meanings) == len(found) + 1


@pytest.mark.slow
def test_nearly_all_variants_return_wrong_numbers_and_nine_in_ten_their_own():
    """Not those with an argument without effect, which often have the numbers of a missing term."""
    results = [measured(name) for name in RIGHT]
    equal, wrong = (
        sum(map(len, parts))
        for parts in ([e for _, e, _ in results], [g for _, _, groups in results for g in groups])
    )
    assert wrong >= 300 and equal <= 0.03 * wrong
    sizes = [
        sum("has no effect" not in variant.sentence for variant in group)
        for _, _, groups in results
        for group in groups
    ]
    assert sizes.count(1) >= 0.9 * sum(sizes)


STEP = "def step(x, v, h):\n    return x + h * v, v - h * x\n"


def sources_of(code):
    return [variant.source for variant in variants(STEP) if variant.code == code]


def test_a_value_that_is_replaced_before_the_other_is_computed_from_it():
    assert "def step(x, v, h):\n    x = x + h * v\n    v = v - h * x\n    return x, v\n" in sources_of(
        "wrong-variable"
    )
    assert "def step(x, v, h):\n    v = v - h * x\n    x = x + h * v\n    return x, v\n" in sources_of(
        "wrong-variable"
    )


def test_a_constant_in_place_of_an_argument():
    assert "def step(x, v, h):\n    h = 1\n    return x + h * v, v - h * x\n" in sources_of("wrong-constant")


def answer(source):
    names = {}
    exec(source, names)
    return names["step"](2.0, 3.0, 0.5)


def test_two_changes_are_none_of_the_single_ones():
    single, double = {v.source for v in variants(STEP)}, pairs(STEP)
    assert (2.0 - 0.5 * 3.0, 3.0 + 0.5 * 2.0) in [answer(v.source) for v in double]
    assert not single & {v.source for v in double} and all(len(v.both) == 2 for v in double)
