"""Integrators: four steps for x'' = acc(x), their energy error, stability limit, order and cost.

Each truth is another method than its solution; ``tests/exercises/test_integrators.py`` compares the truths
with a third source: 60-digit arithmetic, the two-step form of Verlet's method, and matrix powers.
"""

from math import log2, sqrt

import numpy as np

from exercises.authoring.kinds.stepper import euler, rk4, stepper
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author import (
    Notebook,
    Tolerance,
    choice,
    family,
    integers,
    mistake,
    uniform,
)

notebook = Notebook("Integrators", notebook="notebook.ipynb")
ROUNDING = Tolerance(limit=1e-12, reason="a hundred times what two forms of a step differ by")
SEARCHED = Tolerance(
    rtol=1e-3, atol=0, reason="the search takes a growth of a millionth in one step as rounding"
)
ORDER = Tolerance(atol=0.2, reason="four times what the slope bends at the largest steps")
OLD_V, OLD_A = "the position moves with the old velocity", "both accelerations are the old one"


def step_questions(solution, truth, order, limit, calls, mistakes):
    """Return two questions for one step: of the planet, with the chart of speed against accuracy of about
    three years; and of other forces, in turn at the same place and at the place of the step before.
    """
    ask = {"acc": family("-mu * x / (x @ x) ** 1.5", "x", mu=uniform(0.9, 1.1))}
    ask |= {
        "x": lambda rng: rng.uniform((0.9, -0.1), (1.1, 0.1)),
        "v": lambda rng: rng.uniform((-0.2, 0.9), (0.2, 1.1)),
    }
    ask["h"] = uniform(0.02, 0.1)
    least = Tolerance(limit=calls, reason="the method needs no more")
    measured = {
        "rates": lambda acc, x, v: (v, acc(x)),
        "order": (order, ORDER),
        "stability": limit,
        "chart": 20.0,
    }
    agree = {"x": ROUNDING, "v": ROUNDING}
    planet = stepper(solution, ask, agree, truth=truth, calls=least, **measured, mistakes=mistakes)
    name = solution.__name__

    def exact(acc, other, x, v, h):
        first = np.array(truth(acc, x, v, h))
        return [first, truth(other, *first, h), truth(other, x, v, h)]

    call = (
        f"[{name}(acc, x, v, h), {name}(other, *np.array({name}(acc, x, v, h)), h), {name}(other, x, v, h)]"
    )
    ask = {"acc": family("-sin(k * x)", "x", k=uniform(1, 3)), "other": family("cos(x) - x", "x")}
    ask |= {"x": uniform(-1, 1, 2), "v": uniform(-1, 1, 2), "h": uniform(0.1, 1.5)}
    label = f"{name} is right for large steps and other forces"
    return planet, values(solution, ask, ROUNDING, truth=exact, call=call, label=label, mistakes=mistakes)


def by_tableau(method):
    """Return the step of a Runge–Kutta method for y = (x, v)."""
    return lambda acc, x, v, h: tuple(
        method(lambda t, y: np.array([y[1], acc(y[0])]), 0.0, np.array([x, v]), h)
    )


def euler_step(acc, x, v, h):
    """Return x and v after a step h of Euler's method."""
    return x + h * v, v + h * acc(x)


def symplectic_step(acc, x, v, h):
    """Return x and v after a step h of the symplectic Euler method: first v, then x with the new v."""
    v = v + h * acc(x)
    return x + h * v, v


def by_places(acc, x, v, h):
    new = x + h * v + h**2 * acc(x)
    return new, (new - x) / h


NEVER = (
    0,
    Tolerance(rtol=0, atol=5e-3, reason="the search takes a growth of a millionth in one step as rounding"),
)
wrong = [
    mistake(
        "x + h * v,", "x + h * (v + h * acc(x)),", "wrong-variable", "the place moves with the new velocity"
    ),
    mistake("acc(x)", "acc(x + h * v)", "wrong-variable", "acc is that of the new place"),
    mistake("+ h * acc(x)", "- h * acc(x)", "sign-flipped", "the acceleration is subtracted"),
]
first = step_questions(euler_step, by_tableau(euler), 1, NEVER, 1, wrong)
wrong = [
    mistake(
        "    v = v + h * acc(x)\n    return x + h * v, v",
        "    return x + h * v, v + h * acc(x)",
        "wrong-variable",
        OLD_V,
    ),
    mistake(
        "x + h * v, v",
        "x + h * (v - h / 2 * acc(x)), v",
        "constant-factor",
        "the position moves with the mean velocity",
    ),
    mistake(
        "    v = v",
        "    x = x + h * v\n    v = v",
        "component-order",
        "the position moves before the velocity, and twice",
    ),
]
second = step_questions(symplectic_step, by_places, 1, (2, SEARCHED), 1, wrong)
notebook.exercise("1", "Euler's step, and a small change", *first, *second)


def verlet_step(acc, x, v, h):
    """Return x and v after a step h of the velocity Verlet method."""
    half = v + h / 2 * acc(x)
    x = x + h * half
    return x, half + h / 2 * acc(x)


def by_mean_acceleration(acc, x, v, h):
    new = x + h * v + h**2 / 2 * acc(x)
    return new, v + h * (acc(x) + acc(new)) / 2


wrong = [
    mistake("x = x + h * half", "x = x + h * v", "wrong-variable", OLD_V),
    mistake("x + h * half", "x + h * v + h**2 / 2 * acc(x)"),
    mistake("    x = x + h * half\n    return x,", "    return x + h * half,", "wrong-variable", OLD_A),
]
notebook.exercise(
    "2", "Velocity Verlet", *step_questions(verlet_step, by_mean_acceleration, 2, (2, SEARCHED), 2, wrong)
)


def rk4_step(acc, x, v, h):
    """Return x and v after a step h of the classical Runge–Kutta method for x' = v, v' = acc(x)."""
    v1, a1 = v, acc(x)
    v2, a2 = v + h / 2 * a1, acc(x + h / 2 * v1)
    v3, a3 = v + h / 2 * a2, acc(x + h / 2 * v2)
    v4, a4 = v + h * a3, acc(x + h * v3)
    return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


wrong = [
    mistake("v + h / 2 * a1", "v + h / 2 * acc(x)"),
    mistake(
        "h * a3, acc(x + h * v3)",
        "h / 2 * a3, acc(x + h / 2 * v3)",
        "constant-factor",
        "the last slopes are those of h/2",
    ),
    mistake(
        "+ 2 * v2 + 2 * v3",
        "+ v2 + v3",
        "missing-term",
        "the weights 2 of the middle slopes of x are missing",
    ),
]
notebook.exercise(
    "3", "Runge and Kutta", *step_questions(rk4_step, by_tableau(rk4), 4, (sqrt(8), SEARCHED), 4, wrong)
)

# b = 0 is Euler's step and b = 1 a symplectic one, of the oscillator x'' = -k² x with h in place of kh; e = 1
# exchanges x and v.
BLEND = "(x + k * h * (v + (1 - e) * b * k * h * acc(x)), v + k * h * acc(x + e * b * k * h * v))"


def energy_error(step, h, n):
    """Return the largest |E/E(0) - 1| in n steps h of the oscillator x'' = -x from x = 1, v = 0."""
    x, v, worst = 1.0, 0.0, 0.0
    for _ in range(n):
        x, v = step(lambda x: -x, x, v, h)
        worst = max(worst, abs(x**2 + v**2 - 1))
    return worst


def by_eigenvalues(h, n, b):
    """Raise the matrix by which a step multiplies (x, v) to all powers up to n; take the first column of
    each.
    """
    factors, modes = np.linalg.eig(np.array([[1 - b * h**2, h], [-h, 1]], dtype=complex))
    found = (modes * factors ** np.arange(n + 1)[:, None, None]) @ np.linalg.inv(modes)
    return np.abs(np.sum(found[:, :, 0].real ** 2, axis=1) - 1).max()


blend = family(BLEND, "acc", "x", "v", "h", b=lambda rng, row: (0.0, 0.5, 1.0, 1.2)[row % 4], k=1.0, e=0)
ask = {"step": blend, "h": uniform(0.05, 0.3), "n": integers(1, 300)}
wrong = [
    mistake(
        "max(worst, abs(x**2 + v**2 - 1))",
        "abs(x**2 + v**2 - 1)",
        "missing-term",
        "the error is that of the last step",
    ),
    mistake("abs(x**2 + v**2 - 1)", "x**2 + v**2 - 1", "wrong-function", "a loss of energy does not count"),
    mistake(
        "abs(x**2 + v**2 - 1)",
        "abs(x**2 + v**2 - 1) / 2",
        "constant-factor",
        "the error is not relative to E(0) = 1/2",
    ),
]
RELATIVE = Tolerance(rtol=1e-10, atol=1e-11, reason="a hundred times the rounding errors of 300 steps")
notebook.exercise(
    "4", "Energy", values(energy_error, ask, RELATIVE, truth=by_eigenvalues, rows=(5, 16), mistakes=wrong)
)


def growth(step, h):
    """Return the largest |λ| of the matrix by which a step h of the oscillator x'' = -x multiplies (x, v)."""
    columns = [step(lambda x: -x, x, v, h) for x, v in ((1.0, 0.0), (0.0, 1.0))]
    return np.abs(np.linalg.eigvals(np.array(columns).T)).max()


def by_trace(h, b, k):
    half, determinant = 1 - b * (k * h) ** 2 / 2, 1 + (1 - b) * (k * h) ** 2
    return sqrt(determinant) if half**2 < determinant else abs(half) + sqrt(half**2 - determinant)


def by_crossing(b, k):
    """Return where an eigenvalue is -1, or 0 if that is below 0.1 or the determinant is above 1."""
    limit = 2 / sqrt(2 * b - 1) / k if b >= 1 else 0.0
    return limit if limit > 0.1 else 0.0


def stability_limit(step):
    """Return the largest h between 0.1 and 4 with which the oscillator does not grow, to 1e-6, or 0 if it
    grows with h = 0.1.
    """
    stable, unstable = 0.1, 4.0
    if growth(step, stable) > 1 + 1e-9:
        return 0.0
    while unstable - stable > 1e-7:
        h = (stable + unstable) / 2
        stable, unstable = (stable, h) if growth(step, h) > 1 + 1e-9 else (h, unstable)
    return stable


REAL_PARTS = ("wrong-function", "the real parts of the eigenvalues stand for their absolute values")
ask = {
    "step": family(BLEND, "acc", "x", "v", "h", b=uniform(0, 2.5), k=uniform(0.5, 2), e=choice(0, 1)),
    "h": uniform(0.3, 3),
}
wrong = [
    mistake(
        "(1.0, 0.0), (0.0, 1.0)",
        "(1.0, 0.0), (1.0, 1.0)",
        "wrong-start",
        "the second column is the step from (1, 1)",
    ),
    mistake(
        "np.abs(np.linalg.eigvals(np.array(columns).T))",
        "np.linalg.eigvals(np.array(columns).T).real",
        *REAL_PARTS,
    ),
    mistake(
        "np.abs(np.linalg.eigvals(np.array(columns).T)).max()",
        "np.linalg.norm(columns, 2)",
        "wrong-quantity",
        "the norm",
    ),
]
NEAR = Tolerance(atol=1e-7, reason="the root of the rounding errors, where two eigenvalues meet")
grows = values(growth, ask, NEAR, truth=by_trace, rows=(6, 16), mistakes=wrong)
# In turn: growth with every h, of hardly more than 1e-9 in the sixth row; a limit below 0.1, near 0.1, in the
# middle, and near 4.
growing = {
    "b": lambda rng, row: [(0.5, 1 - 1e-6)[row // 5 % 2], 1.0, 1.0, rng.uniform(1.05, 2.5), 1.0][row % 5]
}
growing["k"] = lambda rng, row: (
    2 / rng.uniform(*[(1, 4), (0.05, 0.09), (0.105, 0.15), (1, 3), (3.3, 3.95)][row % 5])
)
growing["e"] = lambda rng, row: row % 2
ask = {"step": family(BLEND, "acc", "x", "v", "h", **growing)}
wrong = [
    mistake(
        "> 1 + 1e-9 else",
        "> 1.01 else",
        "wrong-constant",
        "a growth of a hundredth in each step counts as stable",
    ),
    mistake("return 0.0", "return stable", "missing-term", "a method that always grows has no limit of 0.1"),
    mistake("    if growth(step, stable) > 1 + 1e-9:\n        return 0.0\n", ""),
    mistake("> 1 + 1e-9", "> 1", "wrong-constant", "rounding errors count as growth"),
]
LIMIT = Tolerance(atol=2e-6, reason="twice the precision that is asked for")
limits = values(stability_limit, ask, LIMIT, truth=by_crossing, uses=[growth], rows=(10, 15), mistakes=wrong)
notebook.exercise("5", "Where a method fails", grows, limits)

# On x'' = -x from x = 1, v = 0 the number z = x + iv is exp(-it); a step of SCHEME multiplies it by 1 - ih -
# c h²/2.
SCHEME = (
    "(x + h * v, v + h * acc(x)) if c == 0 else (x + h * (v + h / 2 * acc(x)), v + h * acc(x + h / 2 * v))"
)
STEP = family(SCHEME, "acc", "x", "v", "h", c=lambda rng, row: row % 2)
ERROR = Tolerance(limit=1e-10, reason="a hundred times the rounding errors of 400 steps")
RATIO = Tolerance(atol=1e-7, reason="the rounding errors of 400 steps, relative to an error of 1e-5")
EXACT = Tolerance(atol=0, reason="integers are exact")


def final_error(step, acc, n):
    """Return the distance of (x, v) from (cos 5, -sin 5) after n steps to t = 5, from x = 1, v = 0."""
    x, v = 1.0, 0.0
    for _ in range(n):
        x, v = step(acc, x, v, 5 / n)
    return np.hypot(x - np.cos(5), v + np.sin(5))


def by_complex_powers(n, c, k=1.0):
    """Take the powers of the factor of x + iv/w, where acc(x) = -k x and w² = k."""
    w = sqrt(k)
    z = (1 - 1j * w * 5 / n - c * k * (5 / n) ** 2 / 2) ** n
    return abs(z.real + 1j * w * z.imag - np.exp(-5j))


def observed_order(step, n):
    """Return log₂ of the error of n steps over that of 2n steps, of the oscillator x'' = -x."""
    return np.log2(final_error(step, lambda x: -x, n) / final_error(step, lambda x: -x, 2 * n))


def calls_needed(step, tol):
    """Return how often acc is called in the first run of 8, 16, 32, … steps with an error of at most tol."""
    n, calls = 8, []

    def acc(x):
        calls.append(x)
        return -x

    while final_error(step, acc, n) > tol:
        n *= 2
        calls.clear()
    return len(calls)


def by_formula(tol, c):
    """Count two calls for each step, and a third where x < 0."""
    n = next(8 * 2**k for k in range(30) if by_complex_powers(8 * 2**k, c) <= tol)
    return 2 * n + int(np.sum(((1 - 5j / n - c * (5 / n) ** 2 / 2) ** np.arange(n)).real < 0))


wrong = [
    mistake(
        "np.hypot(x - np.cos(5), v + np.sin(5))",
        "abs(x - np.cos(5))",
        "missing-term",
        "the error of v is missing",
    )
]
ask = {"step": STEP, "acc": family("-k * x", "x", k=uniform(0.5, 2))}
ask["n"] = lambda rng, row: 1 if row % 3 == 0 else rng.integers(2, 401)
errors = values(final_error, ask, ERROR, truth=by_complex_powers, mistakes=wrong)
wrong = [mistake("np.log2", "np.log", "wrong-function", "the natural logarithm stands for that of base 2")]
ask = {"step": STEP, "n": integers(50, 200)}
exact = {"truth": lambda n, c: log2(by_complex_powers(n, c) / by_complex_powers(2 * n, c))}
orders = values(observed_order, ask, RATIO, **exact, uses=[final_error], mistakes=wrong)
wrong = [
    mistake("n, calls = 8", "n, calls = 16"),
    mistake("calls.clear()", "pass", "missing-term", "the calls of the coarser runs count too"),
    mistake("len(calls)", "n", "wrong-variable", "the number of steps is returned, not that of the calls"),
]
COSTLY = "(x + h * (v + c * h / 2 * acc(x)), v + h * acc(x + c * h / 2 * v) + (0 * acc(x) if x < 0 else 0))"
ask = {
    "step": family(COSTLY, "acc", "x", "v", "h", c=uniform(0.8, 1.2)),
    "tol": lambda rng, row: 10 ** (0.3 - 0.7 * (row % 5 + rng.uniform(0, 1))),
}
cost = values(calls_needed, ask, EXACT, truth=by_formula, uses=[final_error], rows=(5, 15), mistakes=wrong)
# A step to x = 2⁶⁰ h, beside which cos 5 is nothing: the error is 5 · 2⁶⁰/n exactly. In turn it is tol, above
# it, below it.
ask = {"step": family("(2.0**60 * h + 0 * x, 0 * acc(x))", "acc", "x", "v", "h")}
factors = (1, 1 - 2.0**-20, 1)
ask["tol"] = lambda rng, row: (
    factors[row % 3] * 5 * 2.0**60 / rng.choice([(8, 16), (64, 512), (1, 2)][row % 3])
)
given = {"truth": lambda tol: next(n for n in 8 * 2.0 ** np.arange(20) if 5 * 2.0**60 / n <= tol)}
given["label"] = "calls_needed takes an error that equals tol, and none above it"
equal = values(calls_needed, ask, EXACT, **given, uses=[final_error], rows=(3, 6))
notebook.exercise("6", "Speed against accuracy", errors, orders, cost, equal)
