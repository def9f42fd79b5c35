"""Right-hand sides: points, the motion they drive, conserved quantities, and speed against accuracy."""

import numpy as np
import pytest

from exercises.authoring.assignments.speed_vs_accuracy import compared
from exercises.authoring.draws import between
from exercises.authoring.kinds.ode import ode
from exercises.authoring.questions.question_errors import question_errors
from polhode.judging.author_errors import AuthorError
from polhode.judging.outcome import Tolerance
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.grader import Grader
from service.grading.submission import Submission
from tests.support.solutions import solution
from tests.support.toolbox import failed, judged, mistaken, question_of, right

NEAR = Tolerance(limit=1e-9, reason="integration")
HALVED = "def oscillator(t, y, w, g):\n    return [y[1], -w**2 * y[0] / 2 - 2 * g * y[1]]\n"


@pytest.mark.parametrize(
    "source",
    [
        "return (y[1], -w**2 * y[0] - 2 * g * y[1])",
        "x, v = y\n    return np.array([[v], [-2 * g * v - w * w * x]]).ravel()",
        (
            "d = y.copy()\n    d[0], d[1] = y[1], 0\n    d[1] -= w**2 * y[0]\n    d[1] -= 2 * g * y[1]\n"
            "    return d"
        ),
        "return np.array([[0, 1], [-w**2, -2 * g]]) @ y",
    ],
)
def test_right_variants_pass(toolbox, source):
    assert (
        failed(judged(question_of(toolbox, "oscillator"), f"def oscillator(t, y, w, g):\n    {source}\n"))
        == set()
    )


def test_a_function_that_reuses_its_array_passes(toolbox):
    reused = np.zeros(2)

    def oscillator(t, y, w, g):
        reused[:] = y[1], -(w**2) * y[0] - 2 * g * y[1]
        return reused

    assert failed(judged(question_of(toolbox, "oscillator"), oscillator)) == set()


@pytest.mark.parametrize(
    ("function", "number", "checks"),
    [
        ("oscillator", 0, {"4-value", "4-motion", "4-new-value"}),
        ("oscillator", 1, {"4-value", "4-motion", "4-new-value"}),
        ("oscillator", 2, {"4-value", "4-motion", "4-new-value"}),
        ("pendulum", 0, {"5-value", "5-motion", "5-energy", "5-new-value"}),
        ("pendulum", 1, {"5-value", "5-motion", "5-energy", "5-new-value"}),
    ],
)
def test_a_mistake_fails_its_checks(toolbox, function, number, checks):
    assert failed(judged(question_of(toolbox, function), mistaken(toolbox, function, number))) == checks


def test_a_scalar_state_with_a_partial_closed_form_and_a_conserved_quantity():
    def decay(y, k):
        return -k * y

    question = ode(
        solution(decay),
        inputs={"y": between(1, 2), "k": between(0.1, 1)},
        agree=Tolerance(limit=1e-13, reason="rounding"),
        motion=lambda t, y, k: y * np.exp(-k * t),
        until=3.0,
        follow=NEAR,
        conserved={"y exp(kt)": ("y * exp(k * t)", NEAR)},
    )
    assert failed(judged(question, decay)) == set()
    assert failed(judged(question, lambda y, k: -1.001 * k * y)) == {
        "-value",
        "-motion",
        "-y exp(kt)",
        "-new-value",
    }


def test_a_closed_form_of_the_wrong_shape_is_the_authors_error():
    def decay(y, k):
        return -k * y

    tolerance = Tolerance(limit=1e-9, reason="integration")
    question = ode(
        solution(decay),
        {"y": between(1, 2), "k": between(0, 1)},
        tolerance,
        motion=lambda y, k: y,
        until=3.0,
        follow=tolerance,
    )
    with pytest.raises(
        AuthorError,
        match=r"assignment.py line \d+: .* closed form returned shape \(1, 1\), not \(k, 201\) with k ≤ 1",
    ):
        judged(question, decay)


def test_a_motion_that_stalls_or_is_not_finite_does_not_hide_the_points(toolbox, sandbox):
    stalls = (
        "def pendulum(t, y, g):\n"
        "    return np.array([y[1], -g * np.sin(y[0]) + 1e9 * (y[0] - int(1e9 * y[0]) / 1e9)])\n"
    )
    ends = "def oscillator(t, y, w, g):\n    return [y[1], y[0] ** 2 * 9]\n"
    report = grade(Submission(stalls + ends), toolbox.assignment, sandbox, 1).report
    lines = {outcome.id: outcome.line for outcome in report.outcomes()}
    assert all(lines[id].startswith("✗") for id in ("4-value", "4-new-value", "5-value", "5-new-value")), (
        report.text()
    )
    assert "of the integration" in lines["4-motion"] or "the integration stopped at" in lines["4-motion"]
    assert "after 20000 calls of pendulum" in lines["5-motion"] and lines["5-energy"].startswith("–")


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("return [y[1]]", "oscillator must return shape (2,); it returned shape (1,)"),
        ("return [y, -w**2 * y]", "oscillator must return shape (2,); it returned shape (2, 2)"),
        ("return [y[1], np.nan]", "oscillator returned a value that is not finite"),
        ("y[1] = 0\n    return y", "oscillator changes its argument y"),
    ],
)
def test_a_wrong_answer_has_its_reason(toolbox, sandbox, source, sentence):
    report = grade(
        Submission(f"def oscillator(t, y, w, g):\n    {source}\n"), toolbox.assignment, sandbox, 1
    ).report
    assert all(sentence in outcome.line for outcome in report.outcomes()), report.text()


def test_speed_against_accuracy_follows_from_a_closed_form(toolbox, sandbox):
    swept = Grader(sandbox).sweep(Submission(right(toolbox)), toolbox.assignment)
    errors = {(p.method, p.rtol): p.error for p in swept.points}
    assert errors["DOP853", 1e-11] < 1e-9 < errors["DOP853", 1e-3] and "is enough" in swept.line
    assert len(swept.reference) == len(swept.points) and len(swept.per_call) == 2
    chart = rendering.draw_sweep(swept).decode()
    assert ">DOP853<" in chart and ">the solution<" in chart and "largest error over the run" in chart


def test_the_sweep_of_a_wrong_function_names_it(toolbox):
    wanted, names = toolbox.assignment.sweep, {}
    exec(HALVED, names)
    seen = question_of(toolbox, "oscillator").play(names["oscillator"], dict(wanted.scene.inputs), "sweep")
    swept = wanted.read(seen, wanted.scene.truth(dict(wanted.scene.inputs)))
    swept = compared(swept, None, wanted, "oscillator")
    assert min(p.error for p in swept.points) > 1e-2 and "check oscillator first" in swept.line


def test_speed_against_accuracy_follows_from_the_truth_too_where_there_is_no_closed_form(toolbox, sandbox):
    swept = Grader(sandbox).sweep(Submission(right(toolbox)), toolbox.assignment, ["5"])
    errors = {(p.method, p.rtol): p.error for p in swept.points}
    assert (
        swept.scene.startswith("motion of pendulum to t = ")
        and errors["DOP853", 1e-11] < 1e-9 < errors["DOP853", 1e-3]
    )
    assert min(errors.values()) < 1e-12, "the exact motion is at least as accurate as the best run"


@pytest.mark.parametrize(
    ("changed", "error"),
    [
        ({"follow": None}, "a motion needs until= and follow=, its tolerance"),
        ({"until": None}, "a motion needs until= and follow=, its tolerance"),
        ({"motion": lambda t, y, q: y}, "the closed form takes q, which is neither asked nor drawn"),
        (
            {"conserved": {"E": ("y * q", NEAR)}},
            "E: 'y * q' uses q, which is neither a variable nor a parameter",
        ),
        (
            {"conserved": {"E": ("y", Tolerance(limit=1.0, reason=""))}},
            "decay: conserved: E[1]: the tolerance has no reason: say it with because=",
        ),
        ({"state": "x"}, "there is no input x, the state: name it with state="),
    ],
)
def test_an_error_of_the_declaration_is_reported(changed, error):
    def decay(y, k):
        return -k * y

    given = {
        "motion": lambda t, y, k: y * np.exp(-k * t),
        "until": 3.0,
        "follow": NEAR,
        "conserved": {"E": ("y", NEAR)},
    }
    question = ode(solution(decay), {"y": between(1, 2), "k": between(0.1, 1)}, NEAR, **given | changed)
    assert [found.split(": ", 1)[1] for found in question_errors(question)] == [error]
