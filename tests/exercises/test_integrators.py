"""The assignment integrators: its truths against third sources, right answers of several forms, and its
chart.
"""

import functools
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from exercises.authoring.assignments.catalogue import find
from exercises.integrators import assignment as author
from polhode.kinds import play
from polhode.kinds import stepper as kit
from polhode.kinds.student_calls import expression
from service.grading.figures import rendering
from service.grading.grader import Grader
from service.grading.submission import Submission
from tests.support.toolbox import failed, judged

ALL = list(author.notebook.questions())
QUESTIONS = {question.function: question for question in reversed(ALL)}  # the first question of each function
STEPPERS = ("euler_step", "symplectic_step", "verlet_step", "rk4_step")
RIGHT_NAMES = {name: QUESTIONS[name].student[name] for name in ("growth", "final_error")}
RIGHT = "import numpy as np\n\n" + "\n\n".join(QUESTIONS[name].source for name in STEPPERS)


def rows(name, count=20, seed=7):
    drawn = QUESTIONS[name].draw(np.random.default_rng(seed), count)
    return [{key: value[k] for key, value in drawn.items()} for k in range(count)]


def kepler(x):
    return -x / (x @ x) ** 1.5


def run(step, x, v, h, n):
    """The places of n steps, from the truth of a question."""
    places = [x]
    for _ in range(n):
        x, v = step(kepler, x, v, h)
        places.append(x)
    return np.array(places)


@pytest.mark.parametrize("name", ["symplectic_step", "verlet_step"])
def test_the_symplectic_truths_obey_stormer_s_rule(name):
    """Both methods have x(t + h) - 2 x(t) + x(t - h) = h² a(x(t)); they differ in the velocity that they
    start with.
    """
    x, v, h = np.array([1.0, 0.1]), np.array([-0.1, 0.9]), 0.05
    places = run(QUESTIONS[name].truth, x, v, h, 40)
    second = places[2:] - 2 * places[1:-1] + places[:-2]
    assert second == pytest.approx(h**2 * np.array([kepler(place) for place in places[1:-1]]), abs=1e-14)
    wanted = x + h * v + h**2 * kepler(x) / (1 if name == "symplectic_step" else 2)
    assert places[1] == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize(
    ("name", "weights"), [("euler_step", [1, 1]), ("rk4_step", [1, 1, 1 / 2, 1 / 6, 1 / 24])]
)
def test_the_runge_kutta_truths_are_taylor_s_polynomial_on_the_oscillator(name, weights):
    x, v, h = np.array([0.3, -1.2]), np.array([0.7, 0.4]), 0.3
    A = h * np.array([[0, 1], [-1, 0]])
    wanted = sum(weight * np.linalg.matrix_power(A, k) for k, weight in enumerate(weights)) @ np.array([x, v])
    assert np.array(QUESTIONS[name].truth(lambda x: -x, x, v, h)) == pytest.approx(wanted, abs=1e-15)


def test_the_runge_kutta_truth_is_that_of_rational_arithmetic_for_another_force():
    """x'' = x² from rational numbers, by the rule of the notebook with fractions."""

    def f(y):
        return y[1], y[0] ** 2

    def at(y, factor, k):
        return tuple(a + factor * b for a, b in zip(y, k, strict=True))

    y, h = (Fraction(3, 7), Fraction(-2, 5)), Fraction(1, 10)
    k1 = f(y)
    k2 = f(at(y, h / 2, k1))
    k3 = f(at(y, h / 2, k2))
    k4 = f(at(y, h, k3))
    wanted = [
        float(a + h / 6 * (p + 2 * q + 2 * r + s)) for a, p, q, r, s in zip(y, k1, k2, k3, k4, strict=True)
    ]
    assert QUESTIONS["rk4_step"].truth(lambda x: x**2, 3 / 7, -2 / 5, 0.1) == pytest.approx(wanted, abs=1e-15)


def test_the_energy_is_that_of_sixty_digits():
    with mpmath.workdps(60):
        for row in rows("energy_error", 6):
            b, h = mpmath.mpf(float(row["b"])), mpmath.mpf(float(row["h"]))
            x, v, worst = mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0)
            for _ in range(row["n"]):
                x, v = x + h * (v - b * h * x), v - h * x
                worst = max(worst, abs(x**2 + v**2 - 1))
            assert QUESTIONS["energy_error"].truth(row["h"], row["n"], row["b"]) == pytest.approx(
                float(worst), rel=1e-12, abs=1e-13
            )


def matrix(row, h):
    """The matrix by which a step that is asked multiplies (x, v), by calling it."""
    family = QUESTIONS["growth"].inputs["step"]
    step = expression(family.text, family.over, {name: row[name] for name in family.given})
    return np.array([step(lambda x: -x, *start, h) for start in ((1.0, 0.0), (0.0, 1.0))]).T


def test_growth_and_limit_are_those_of_matrices():
    for row in rows("growth"):
        given = {name: row[name] for name in ("h", "b", "k")}
        assert QUESTIONS["growth"].truth(**given) == pytest.approx(
            np.abs(np.linalg.eigvals(matrix(row, row["h"]))).max(), rel=1e-8
        )
    limits = []
    for row in rows("stability_limit", 60):
        limits.append(QUESTIONS["stability_limit"].truth(row["b"], row["k"]))
        h = limits[-1] or 0.1
        assert np.abs(np.linalg.eigvals(matrix(row, h * (1 + 1e-6)))).max() > 1 + 1e-9, (
            "it grows above the limit"
        )
        if limits[-1]:
            below = [
                np.abs(np.linalg.eigvals(matrix(row, part * h))).max()
                for part in np.linspace(0.02, 1 - 1e-6, 20)
            ]
            assert max(below) < 1 + 1e-9


@pytest.mark.parametrize("seed", range(4))
def test_every_grading_has_limits_at_both_ends_and_in_the_middle_and_steps_that_grow_by_hardly_more_than_1e_9(
    seed,
):
    for count in QUESTIONS["stability_limit"].rows:
        given = rows("stability_limit", count, seed)
        limits = [QUESTIONS["stability_limit"].truth(row["b"], row["k"]) for row in given]
        for low, high in ((0.1, 0.15), (0.15, 3), (3.3, 4)):
            assert any(low < limit < high for limit in limits)
        growing = [row for row, limit in zip(given, limits, strict=True) if not limit]
        assert {row["b"] >= 1 for row in growing} == {False, True}
        assert any(1 + 1e-9 < np.abs(np.linalg.eigvals(matrix(row, 0.1))).max() < 1 + 1e-7 for row in growing)


def test_the_error_is_that_of_steps_in_sixty_digits():
    with mpmath.workdps(60):
        for row in rows("final_error", 6):
            n, c, k = int(row["n"]), int(row["c"]), mpmath.mpf(float(row["k"]))
            h, x, v = mpmath.mpf(5) / n, mpmath.mpf(1), mpmath.mpf(0)
            for _ in range(n):
                x, v = (
                    (x + h * (v - h / 2 * k * x), v - h * k * (x + h / 2 * v))
                    if c
                    else (x + h * v, v - h * k * x)
                )
            wanted = mpmath.hypot(x - mpmath.cos(5), v + mpmath.sin(5))
            assert author.distance_by_powers(n, c, row["k"]) == pytest.approx(float(wanted), rel=1e-10)


def test_the_calls_are_those_of_a_count():
    family, found = QUESTIONS["calls_needed"].inputs["step"], set()
    for row in rows("calls_needed", 12):
        step, n, error = expression(family.text, family.over, {"c": row["c"]}), 4, np.inf
        while error > row["tol"]:
            n, x, v, calls = 2 * n, 1.0, 0.0, 0
            for _ in range(n):
                calls += 3 if x < 0 else 2
                x, v = step(lambda x: -x, x, v, 5 / n)
            error = abs(complex(x, v) - np.exp(-5j))
        found.add(n)
        assert QUESTIONS["calls_needed"].truth(row["tol"], row["c"]) == calls
    assert min(found) == 8 and 1000 < max(found) <= 4096


@pytest.mark.parametrize(
    "error", ["np.hypot(a, b)", "np.sqrt(a**2 + b**2)", "abs(complex(a, b))", "np.linalg.norm([a[0], b[0]])"]
)
def test_an_error_that_equals_tol_does_so_in_every_form_of_the_distance(error):
    def calls_needed(step, tol):
        n, calls = 4, []
        while True:
            n, x, v = 2 * n, *((np.ones(1), np.zeros(1)) if "[0]" in error else (1, 0))
            calls.clear()
            for _ in range(n):
                x, v = step(lambda x: calls.append(x) or -x, x, v, 5 / n)
            if eval(error, {"np": np, "a": x - np.cos(5), "b": v + np.sin(5)}) <= tol:
                return len(calls)

    (question,) = [
        one for one in ALL if one.function == "calls_needed" and one is not QUESTIONS["calls_needed"]
    ]
    assert failed(judged(question, calls_needed)) == set()


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("euler_step", "y = np.array([x, v]) + h * np.array([v, acc(x)])\n    return y"),
        (
            "symplectic_step",
            (
                "new = [b + h * a for a, b in zip(acc(x), v)]\n"
                "    return [a + h * b for a, b in zip(x, new)], new"
            ),
        ),
        (
            "verlet_step",
            "a = acc(x)\n    y = x + v * h + 0.5 * a * h**2\n    return (y, v + 0.5 * h * (a + acc(y)))",
        ),
        (
            "rk4_step",
            """def f(y):
        return np.array([y[1], acc(y[0])])
    y = np.array([x, v])
    k = [f(y)]
    for part in (h / 2, h / 2, h):
        k.append(f(y + part * k[-1]))
    return tuple(y + h * np.tensordot([1 / 6, 1 / 3, 1 / 3, 1 / 6], k, axes=1))""",
        ),
        (
            "energy_error",
            """xs, vs = np.zeros(n + 1), np.zeros(n + 1)
    xs[0] = 1
    for k in range(n):
        xs[k + 1], vs[k + 1] = step(acc=lambda x: -x, x=xs[k], v=vs[k], h=h)
    E = (xs**2 + vs**2) / 2
    return np.max(np.abs(E / E[0] - 1))""",
        ),
        (
            "growth",
            """x, v = step(lambda x: -x, np.array([1.0, 0.0]), np.array([0.0, 1.0]), h)
    return float(max(abs(root) for root in np.roots([1, -x[0] - v[1], x[0] * v[1] - x[1] * v[0]])))""",
        ),
        (
            "final_error",
            (
                "y = (1, 0)\n    for k in range(n): y = step(acc, *y, 5 / n)\n"
                "    return abs(complex(*y) - np.exp(-5j))"
            ),
        ),
        (
            "calls_needed",
            """def acc(x):
        acc.calls += 1
        return -x
    for k in range(3, 60):
        x, v, acc.calls = 1, 0, 0
        for _ in range(2**k):
            x, v = step(acc, x, v, 5 / 2**k)
        if ((x - np.cos(5))**2 + (v + np.sin(5))**2)**0.5 <= tol:
            return float(acc.calls)""",
        ),
    ],
)
def test_right_answers_of_other_forms_pass(name, source):
    for question in [question for question in ALL if question.function == name]:
        outcomes = judged(question, f"def {name}({', '.join(QUESTIONS[name].inputs)}):\n    {source}\n")
        assert failed(outcomes) == set(), [outcome.line for outcome in outcomes.values()]


def test_the_limit_is_found_by_any_search():
    from scipy.optimize import brentq

    def by_brent(step):
        def excess(h):
            return RIGHT_NAMES["growth"](step, h) - 1 - 1e-9

        return 0 if excess(0.1) > 0 else brentq(excess, 0.1, 4, xtol=1e-7)

    def by_scan(step):
        found, h = 0.0, 0.1
        for digit in range(7):
            while h <= 4 and RIGHT_NAMES["growth"](step, h) <= 1 + 1e-9:
                found, h = h, h + 10.0**-digit
            if not found:
                return 0
            h = found + 10.0 ** -(digit + 1)
        return found

    for solution in (by_brent, by_scan):
        assert failed(judged(QUESTIONS["stability_limit"], solution)) == set()


KEPT = """kept = []
def verlet_step(acc, x, v, h):
    a = kept[1] if kept and np.array_equal(kept[0], x) else acc(x)
    new = x + h * v + h**2 / 2 * a
    kept[:] = new, acc(new)
    return new, v + h / 2 * (a + kept[1])
"""
COUNT = QUESTIONS["calls_needed"].source
LIMIT = QUESTIONS["stability_limit"].source


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("verlet_step", KEPT),
        (
            "rk4_step",
            (
                f"{RIGHT}\ngood = rk4_step\ndef rk4_step(acc, x, v, h): return (good if h < 0.2 else"
                " verlet_step)(acc, x, v, h)"
            ),
        ),
        ("calls_needed", COUNT.replace("n, calls = 8", "n, calls = 16")),
        ("calls_needed", COUNT.replace("n, calls = 8", "n, calls = 1")),
        ("calls_needed", COUNT.replace("> tol:", ">= tol:")),
        ("calls_needed", COUNT.replace("> tol:", "> 1.001 * tol:")),
        ("calls_needed", COUNT.replace("> tol:", "> tol and n < 1024:")),
        ("calls_needed", COUNT.replace("len(calls)", "n * (len(calls) // n)")),
        ("growth", QUESTIONS["growth"].source.replace(".max()", "[0]")),
        ("growth", QUESTIONS["growth"].source.replace(".max()", "[-1]")),
        ("stability_limit", LIMIT.replace("= 0.1, 4.0", "= 0.1, 2.6")),
        ("stability_limit", LIMIT.replace("= 0.1, 4.0", "= 0.1, 3.0")),
        ("stability_limit", LIMIT.replace("= 0.1, 4.0", "= 0.2, 4.0")),
        ("stability_limit", LIMIT.replace("> 1 + 1e-9", "> 1 + 1e-6")),
        ("final_error", QUESTIONS["final_error"].source.replace("step(acc,", "step(lambda x: -x,")),
    ],
)
def test_what_is_right_for_some_inputs_only_is_refused(name, source):
    names = {"np": np, **RIGHT_NAMES}
    exec(source, names)
    assert any(failed(judged(question, names[name])) for question in ALL if question.function == name)


def test_a_method_that_fails_at_the_published_limit_of_another_is_not_accepted():
    """Verlet's step passes neither as Runge–Kutta's nor as the symplectic one."""
    for name in ("rk4_step", "symplectic_step"):
        source = QUESTIONS["verlet_step"].source.replace("verlet_step", name)
        assert {outcome.rsplit("-", 1)[1] for outcome in failed(judged(QUESTIONS[name], source))} >= {
            "x",
            "v",
        }


@functools.cache
def exact_ends():
    return find("integrators").sweep.scene.truth({})


def charted(source):
    """The chart of a submission that runs here, without a sandbox."""
    wanted, names = author.notebook.assignment(find("integrators").folder).sweep, {}
    exec(source, names)
    seen = play(dict(wanted.scene.question), names, {})
    assert {name: array.shape for name, array in seen.items()} == {
        name: s.shape for name, s in wanted.scene.returns.items()
    }
    return wanted.read(seen, exact_ends())


def test_the_chart_shows_seconds_and_errors_of_the_student_s_steppers(monkeypatch):
    monkeypatch.setattr(kit, "CHARTED", (50, 200, 400))
    swept = charted(RIGHT)
    assert len(swept.points) == 12 and {point.method for point in swept.points} == set(STEPPERS)
    errors = {(point.method, round(20 / point.step)): point.error for point in swept.points}
    assert (
        errors["rk4_step", 400]
        < errors["verlet_step", 400]
        < errors["symplectic_step", 400]
        < errors["euler_step", 400]
    )
    assert errors["verlet_step", 200] / errors["verlet_step", 400] == pytest.approx(4, rel=0.2)
    assert {point.calls for point in swept.points if point.method == "rk4_step"} == {200, 800, 1600}
    assert "rk4_step 800 calls (it reaches" in swept.line and "euler_step more than 400 calls" in swept.line
    assert all(point.rtol is None and point.seconds > 0 for point in swept.points)
    chart = rendering.draw_sweep(swept).decode()
    assert (
        ">rk4_step<" in chart
        and "CPU time / ms" in chart
        and "error at the end of the run" in chart
        and "DOP853" not in chart
    )


def test_the_chart_leaves_out_a_stepper_that_is_not_written_or_fails(monkeypatch):
    monkeypatch.setattr(kit, "CHARTED", (50, 100))
    empty = "\n\ndef verlet_step(acc, x, v, h):\n    ...\n"
    diverges = "\n\ndef rk4_step(acc, x, v, h):\n    return x + 0 * acc(x), v * 1e20\n"
    swept = charted(QUESTIONS["euler_step"].source + empty + diverges)
    assert {point.method for point in swept.points} == {"euler_step", "rk4_step"}
    assert {point.method for point in swept.points if point.error is None} == {"rk4_step"}
    assert "symplectic_step" not in swept.line and "rk4_step more than" in swept.line


@pytest.mark.slow
def test_the_chart_is_drawn_from_the_sandbox(sandbox):
    swept = Grader(sandbox).sweep(Submission(RIGHT), find("integrators"))
    errors = {(point.method, point.calls): point.error for point in swept.points}
    assert swept.reference and "the solution: for an error of" in swept.line
    assert len(errors) == 28 and errors["rk4_step", 4 * 3200] < 1e-8 < errors["verlet_step", 2 * 3200] < 1e-3
