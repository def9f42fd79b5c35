"""Speed against accuracy of a submission, measured in the sandbox on request."""

from dataclasses import replace

import pytest

from ecp.document import document
from service.grading import grader, rendering
from service.grading.charts import draw_work_precision, load_work_precision
from service.grading.grader import Grader, SweepFailed
from service.grading.reproduction import LIMITS
from service.grading.submission import Submission
from service.sandbox.isolation import process_isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeLimits

RIGHT = "def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I\n"


@pytest.fixture(scope="module")
def swept(rigid_body, sandbox):
    return Grader(sandbox).sweep(Submission(RIGHT), rigid_body)


@pytest.mark.slow
def test_errors_and_calls_are_those_of_the_reference(swept):
    known = {
        (p["method"], p["setting"]): p for p in load_work_precision()["points"] if p["scene"] == swept.scene
    }
    assert len(swept.points) == 18
    for point in swept.points:
        other = known[point.method, point.rtol]
        assert 0.7 < point.calls / other["calls"] < 1.4
        error = max(other["error_w"], other["error_R"])
        assert (point.error is not None and 0.2 < point.error / error < 5) or max(point.error, error) < 1e-12
    assert (
        "DOP853 at rtol 1e-11 reaches" in swept.line and "reaches 1e-08 with the fewest calls" in swept.line
    )


def test_the_chart_shows_yours_over_the_others(swept):
    chart = draw_work_precision(load_work_precision(), swept.scene, swept.points).decode()
    assert (
        "yours, DOP853" in chart
        and "yours" not in draw_work_precision(load_work_precision(), swept.scene).decode()
    )


@pytest.mark.slow  # test_routes.py sweeps a submission too
def test_wrong_equations_reach_nothing(rigid_body, sandbox):
    wrong = Submission(RIGHT + "right = euler_eqs\ndef euler_eqs(t, w, I):\n    return -right(t, w, I)\n")
    assert "no solver reaches an error of 1e-08" in Grader(sandbox).sweep(wrong, rigid_body).line


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
TIMED = """import itertools, time
time.perf_counter = map(lambda n: n * NUMBER, itertools.count()).__next__
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
    """Seconds are compared with the host's clock too: 18 runs of 2 s in less than that."""
    with pytest.raises(
        SweepFailed,
        match=r"number of calls is not|time is not between|impossible numbers of calls or seconds",
    ):
        Grader(sandbox).sweep(Submission(source.replace("NUMBER", number)), rigid_body)


@pytest.mark.slow
def test_a_class_is_drawn_without_the_sweeps_whose_numbers_cannot_be(swept):
    wild = replace(swept, points=[replace(point, calls=10**400, seconds=-1.0) for point in swept.points])
    assert b"class, DOP853" in rendering.draw_class([document(wild), document(swept)])
    assert rendering.draw_class([document(wild)]).startswith(b"<?xml")


def test_a_sandbox_with_a_hole_is_not_ready():
    holed = Sandbox(process_isolation(["landlock", "limits"]))
    try:
        with pytest.raises(SystemFault, match=r"a submission could .*open a socket"):
            Grader(holed).ready()
    finally:
        holed.close()
