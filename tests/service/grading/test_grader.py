"""Speed against accuracy of a submission, measured in the sandbox on request."""

import re
from dataclasses import replace

import pytest

from polhode.report.dataclass_json import document
from service.grading import grader
from service.grading.diagnosis.matching_variants import LIMITS
from service.grading.figures import rendering
from service.grading.grader import Grader, SweepFailed
from service.grading.submission import Submission
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeLimits

RIGHT = "def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I\n"


@pytest.fixture(scope="module")
def swept(rigid_body, sandbox):
    return Grader(sandbox).sweep(Submission(RIGHT), rigid_body)


def test_the_student_s_runs_stand_beside_those_of_the_solution(swept):
    assert len(swept.points) == len(swept.reference) == 16
    for mine, right in zip(swept.points, swept.reference, strict=True):
        assert (mine.method, mine.rtol) == (right.method, right.rtol)
        assert 0.7 < mine.calls / right.calls < 1.4 and not mine.stopped
        assert mine.error < 30 * right.error or mine.error < 1e-11
    assert swept.tolerance == 1.01e-8 and swept.sensitivity == pytest.approx(72.7, rel=0.01)
    assert 0 < swept.closed_form < min(p.seconds for p in swept.reference)
    mine, right = swept.per_call
    assert mine > 2 * right > 0, "np.cross is slower than three lines"


def test_the_text_says_what_is_enough_what_a_call_costs_and_where_the_time_goes(swept):
    enough, cost, spent = swept.line.split("; ")
    assert re.fullmatch(r"one call of euler_eqs takes \S+ µs, of the solution \S+ µs \(×\S+\)", cost)
    assert re.match(r"DOP853 at rtol 1e-11 makes \d+ calls in \S+ ms, \S+ ms of it in euler_eqs: ", spent)
    assert re.search(r"is enough: it has an error of \S+, and 1.01e-08 is allowed, in \S+ ms", enough)


def test_the_chart_shows_yours_and_the_solution(swept):
    chart = rendering.draw_sweep(swept).decode()
    for name in ("DOP853", "RK45", "LSODA", "the solution", "tolerance of the check", "closed form"):
        assert f">{name}<" in chart


SINGLE = """def euler_eqs(t, w, I):
    I1, I2, I3 = I.astype(np.float32)
    w1, w2, w3 = w.astype(np.float32)
    return np.array([(I2 - I3) * w2 * w3 / I1, (I3 - I1) * w3 * w1 / I2, (I1 - I2) * w1 * w2 / I3])
"""


@pytest.mark.slow
def test_single_precision_is_named_and_its_stopped_runs_are_no_divergence(rigid_body, sandbox):
    found = Grader(sandbox).sweep(Submission(SINGLE), rigid_body)
    stopped = [p for p in found.points if p.stopped]
    assert stopped and all(p.error is None and p.calls == 20_001 for p in stopped)
    assert "this is what single precision does" in found.line and "float64" in found.line
    assert f"{len(stopped)} of 16 runs were stopped at rounding noise" in found.line


@pytest.mark.slow  # test_routes.py sweeps a submission too
def test_wrong_equations_reach_nothing(rigid_body, sandbox):
    wrong = Submission(RIGHT + "right = euler_eqs\ndef euler_eqs(t, w, I):\n    return -right(t, w, I)\n")
    assert "and 1.01e-08 is allowed: check euler_eqs first" in Grader(sandbox).sweep(wrong, rigid_body).line


def test_an_assignment_with_a_long_budget_does_not_lengthen_the_deadline_of_others(rigid_body, monkeypatch):
    known = {"rigid-body": rigid_body, "long": replace(rigid_body, slug="long", cpu_s=1000.0)}
    monkeypatch.setattr(grader, "find_assignment", known.__getitem__)
    longest_s = Grader(Sandbox(process_isolation(), TimeLimits(60.0, 120.0))).longest_s
    assert longest_s("rigid-body") == 120.0 + LIMITS.wall_s
    assert longest_s("long") == 2000.0 + LIMITS.wall_s


@pytest.mark.parametrize(
    ("source", "why"),
    [("x = 1", "not defined"), ("def euler_eqs(t, w, I):\n    return 1 / 0", "ZeroDivisionError")],
)
def test_what_cannot_be_swept_says_why(source, why, rigid_body, sandbox):
    with pytest.raises(SweepFailed, match=why):
        Grader(sandbox).sweep(Submission(source), rigid_body)


COUNTED = """import sys
def euler_eqs(t, w, I):
    frame = sys._getframe(1)
    while frame and frame.f_code.co_name != "evaluate":
        frame = frame.f_back
    if frame:
        frame.f_locals["calls"][0] = NUMBER
    return np.cross(I * w, w) / I
"""
TIMED = """import itertools, polhode.judging.cpu_time
polhode.judging.cpu_time.thread_time = map(lambda n: n * NUMBER, itertools.count()).__next__
def euler_eqs(t, w, I):
    return np.cross(I * w, w) / I
"""


@pytest.mark.parametrize(
    ("source", "number"),
    [
        (COUNTED, "10**300"),
        (TIMED, "2.0"),
        pytest.param(COUNTED, "-1", marks=pytest.mark.slow),
        pytest.param(COUNTED, "float('nan')", marks=pytest.mark.slow),
        pytest.param(TIMED, "1e300", marks=pytest.mark.slow),
    ],
)
def test_impossible_calls_and_seconds_are_refused(source, number, rigid_body, sandbox):
    """Seconds are compared with the host's clock too: 16 runs of 2 s in less than that."""
    with pytest.raises(
        SweepFailed,
        match=r"number of calls is not|time is not between|impossible numbers of calls or seconds",
    ):
        Grader(sandbox).sweep(Submission(source.replace("NUMBER", number)), rigid_body)


@pytest.mark.slow
def test_a_class_is_drawn_without_the_sweeps_whose_numbers_cannot_be(swept):
    wild = replace(swept, points=[replace(point, calls=10**400, seconds=-1.0) for point in swept.points])
    assert b">DOP853<" in rendering.draw_class([document(wild), document(swept)])
    assert rendering.draw_class([document(wild)]).startswith(b"<svg")


def test_a_sandbox_with_a_hole_is_not_ready():
    holed = Sandbox(process_isolation(["landlock", "limits"]))
    try:
        with pytest.raises(SystemFault, match=r"a submission could .*open a socket"):
            Grader(holed).ready()
    finally:
        holed.close()
