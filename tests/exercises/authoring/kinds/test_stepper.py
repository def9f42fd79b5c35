"""Steppers: values at points, the observed order, and the stability limit."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from exercises.authoring.draws import array_of, between, expression
from exercises.authoring.kinds.stepper import euler, heun, midpoint, rk4, stepper
from exercises.authoring.questions.question_errors import question_errors
from polhode import kinds
from polhode.judging.outcome import Tolerance
from polhode.kinds import stepper as kit
from polhode.report.figure_files import draw
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.solutions import solution
from tests.support.toolbox import failed, judged, mistaken, question_of


@pytest.mark.parametrize(
    "source",
    [
        """def rk4_step(f, t, y, h):
    k1 = h * f(t, y)
    k2 = h * f(t + 0.5 * h, y + k1 / 2)
    k3 = h * f(t + 0.5 * h, y + k2 / 2)
    k4 = h * f(t + h, y + k3)
    return tuple((y + k1 / 6 + k2 / 3 + k3 / 3 + k4 / 6).tolist())""",
        """def rk4_step(f, t, y, h):
    k, new = f(t, y), y.copy()
    for weight, at in ((1, 0.5), (2, 0.5), (2, 1)):
        new += weight * h / 6 * k
        k = f(t + at * h, y + at * h * k)
    new += h / 6 * k
    return new""",
    ],
)
def test_right_variants_pass(toolbox, source):
    assert failed(judged(question_of(toolbox, "rk4_step"), source)) == set()


@pytest.mark.parametrize(
    ("function", "number", "checks"),
    [
        ("rk4_step", 0, {"6-value", "6-order", "6-stability", "6-new-value"}),
        ("rk4_step", 1, {"6-value", "6-order", "6-stability", "6-new-value"}),
        ("rk4_step", 2, {"6-value", "6-order", "6-new-value"}),
        ("rk4_step", 3, {"6-calls", "6-new-calls"}),
        ("verlet", 0, {"7-v", "7-order", "7-stability", "7-new-v"}),
        ("verlet", 1, {"7-x", "7-v", "7-order", "7-stability", "7-new-x", "7-new-v"}),
    ],
)
def test_a_mistake_fails_its_checks(toolbox, function, number, checks):
    assert failed(judged(question_of(toolbox, function), mistaken(toolbox, function, number))) == checks


def backward_euler(f, t, y, h):
    return fsolve(lambda new: new - y - h * f(t + h, new), y)


def implicit_midpoint(f, t, y, h):
    """By fixed-point iteration to a loose tolerance."""
    new = y + h * f(t, y)
    for _ in range(200):
        old, new = new, y + h * f(t + h / 2, (y + new) / 2)
        if abs(new - old).max() < 1e-7:
            break
    return new


@pytest.mark.parametrize("h", [0.02, 0.1, 0.5])
@pytest.mark.parametrize(
    ("step", "order", "limit"),
    [
        (euler, 1, 2),
        (heun, 2, 2),
        (midpoint, 2, 2),
        (rk4, 4, 2.785),
        (backward_euler, 1, math.inf),
        (implicit_midpoint, 2, 2),  # its iteration converges for h < 2
    ],
)
def test_order_and_stability_limit_of_known_methods(step, order, limit, h):
    """They hold for small and for large steps, where rounding and the first steps spoil some runs."""
    question = stepper(
        solution(step),
        inputs={
            "f": expression("A @ y + cos(t) - y**3", of="t y", A=array_of((2, 2), between(-1, 1))),
            "t": 0.5,
            "y": array_of(2, between(-1, 1)),
            "h": h,
        },
        agree=Tolerance(limit=1e-6, reason="the iteration"),
        order=(order, Tolerance(atol=0.3, reason="first steps")),
        stable_to=(limit, Tolerance(rtol=1e-3, atol=0, reason="four digits")),
    )
    outcomes = judged(question, step)
    assert failed(outcomes) == set(), [outcome.line for outcome in outcomes.values()]


def test_a_scalar_state_beside_an_array_and_a_constant_step():
    """A rotor whose angle is a number and whose other state is an array."""

    def step(f, a, v, h):
        return a + h * v[0], v + h * f(a) * np.array([1.0, 0.5])

    rounding = Tolerance(limit=1e-13, reason="rounding")
    question = stepper(
        solution(step),
        inputs={
            "f": expression("-sin(a) - q", of="a", q=between(0, 1)),
            "a": between(0, 1),
            "v": array_of(2, between(1, 2)),
            "h": 0.1,
        },
        agree={"a": rounding, "v": rounding},
        rates=lambda f, a, v: (v[0], f(a) * np.array([1.0, 0.5])),
        order=(1, Tolerance(atol=0.2, reason="first steps")),
    )
    assert failed(judged(question, step)) == set()
    wrong = judged(question, lambda f, a, v, h: (a + h * v[0], v + h * f(a)))
    assert failed(wrong) == {"-v", "-order", "-new-v"} and wrong["-order"].measured < 0.1


NO_REASON = "step: order[1]: the tolerance has no reason: say it with because="


@pytest.mark.parametrize(
    ("changed", "error"),
    [
        ({"inputs": {"t": 0.0, "y": 1.0, "h": 0.1}}, "a step needs a function argument: expression(…)"),
        ({"state": "x"}, "it has no parameter x"),
        ({"test": "-z"}, "the test problem: '-z' uses z, which is neither a variable nor a parameter"),
        ({"order": (1, Tolerance(atol=0.1, reason=""))}, NO_REASON),
        ({"stable_to": (2, Tolerance(reason="none"))}, "step: stable_to[1]: the tolerance has no number"),
    ],
)
def test_an_error_of_the_declaration_is_reported(changed, error):
    def step(f, t, y, h):
        return y + h * f(t, y)

    near = Tolerance(limit=1e-13, reason="rounding")
    inputs = {"f": expression("-y", of="t y"), "t": 0.0, "y": between(0, 1), "h": 0.1}
    given = {"inputs": inputs, "agree": near, "truth": euler} | changed
    found = [one.split(": ", 1)[1] for one in question_errors(stepper(solution(step), **given))]
    assert error in found


def test_the_order_needs_three_runs_above_rounding():
    assert kit.observed_order(np.array([1e-3, 1e-5, 1e-14, 1e-15])) is None
    assert kit.observed_order(np.array([1e-2, 1e-4, 1e-6, 5e-14, 1e-15])) == pytest.approx(np.log2(100))


def test_runs_that_are_unstable_do_not_count_for_the_order():
    assert kit.observed_order(np.array([1e9, 1e20, 1e3, 8e-2, 4e-2, 2e-2, 1e-2])) == pytest.approx(1)
    assert kit.observed_order(np.array([5.0, 0.9, 0.8, 0.8, 0.8, 0.8, 0.8])) == pytest.approx(0, abs=1e-9)


def test_a_stepper_that_raises_in_a_long_run_keeps_its_points(toolbox, sandbox):
    source = (
        "def rk4_step(f, t, y, h):\n    if h < 0.05: raise RuntimeError('too small')\n"
        "    return y + h * f(t, y)\n"
    )
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    lines = {outcome.id: outcome.line for outcome in report.outcomes()}
    assert lines["6-order"].startswith("–") and "RuntimeError: too small" in lines["6-order"]
    assert lines["6-value"].startswith("✗") and lines["6-calls"].startswith("✓")


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        (
            "def rk4_step(f, t, y, h): return np.sum(y)",
            "rk4_step must return shape (3,); it returned a number",
        ),
        (
            "def rk4_step(f, t, y, h): return y[:, None] + h * f(t, y)",
            "must return shape (3,); it returned shape (3, 3)",
        ),
        ("def rk4_step(f, t, y, h):\n    y += h * f(t, y)\n    return y", "rk4_step changes its argument y"),
        ("def verlet(force, x, v, h): return x", "verlet (x) must return shape (2,); it returned a number"),
        (
            "def verlet(force, x, v, h): return x * np.nan, v * np.nan",
            "verlet (x) returned a value that is not finite",
        ),
    ],
)
def test_a_wrong_answer_has_its_reason(toolbox, sandbox, source, sentence):
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    assert all(sentence in outcome.line for outcome in report.outcomes()), report.text()


def test_a_step_may_pass_a_list_as_the_state(toolbox):
    def heun(f, t, y, h):
        k1 = f(t, list(y))
        k2 = f(t + h, [a + h * b for a, b in zip(y, k1, strict=True)])
        return [a + h / 2 * (b + c) for a, b, c in zip(y, k1, k2, strict=True)]

    found = judged(question_of(toolbox, "rk4_step"), heun)
    assert found["6-stability"].measured == pytest.approx(2.0, rel=1e-6) and found[
        "6-order"
    ].measured == pytest.approx(2.0, abs=0.1)


def test_an_exception_of_every_step_is_not_a_stability_limit(toolbox):
    def broken(f, t, y, h):
        raise ValueError("no step")

    question = question_of(toolbox, "rk4_step")
    with pytest.raises(ValueError, match="no step"):
        question.play(broken, question.draw(np.random.default_rng(0), 1), "stability")


@pytest.mark.parametrize(
    ("function", "texts"), [("rk4_step", ["rk4_step", "order 4"]), ("oscillator", ["y[0]", "y[1]", "exact"])]
)
def test_the_figure_of_a_part_shows_the_exact_beside_the_student_s(toolbox, function, texts):
    question = question_of(toolbox, function)
    (figure,) = kinds.exercise("1", "One", [question.document], True).figures
    (scene,) = [scene for scene in question.scenes() if (scene.name,) == figure.scenes]
    truth = scene.truth(scene.inputs)
    seen = question.play(question.student, scene.inputs, scene.question["part"]) | {
        name: truth[name] for name in scene.known
    }
    drawn = draw(figure, [seen], [truth], "svg").decode()
    assert all(f">{text}<" in drawn for text in texts)
