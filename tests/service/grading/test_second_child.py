"""The second child of a grading, which a worker's sandbox plays beside the first one: the reports are the
same.
"""

import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from ecp.document import document
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.result import Cancelled, SystemFault

RIGHT = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
LATER = """
calls = []
def euler_eqs(t, w, I):
    calls.append(t)
    if len(calls) == 500:  # the points are fewer, an integration takes more
        {}
    return -np.cross(w, I * w) / I
"""
SOURCES = {
    "right": RIGHT,
    "wrong": RIGHT.replace("-np", "np"),
    "uses SciPy": (
        "from scipy.linalg import solve\ndef euler_eqs(t, w, I):\n"
        "    return -solve(np.diag(I), np.cross(w, I * w))\n"
    ),
    "crashes later": LATER.format("import ctypes; ctypes.string_at(0)"),
    "exits later": LATER.format("import os; os._exit(3)"),
    "violates the protocol later": LATER.format("import os; os.write(4, b'no frame')"),
    "never returns later": LATER.format("\n        while True: pass"),
    "crashes at once": "import ctypes\ndef euler_eqs(t, w, I):\n    ctypes.string_at(0)\n",
    "is missing": "pass",
    "raises in the second child": "import os\nif int.from_bytes(os.urandom(1)) >= 0: 1 / 0\n" + RIGHT,
}


class Recording(ThreadPoolExecutor):
    """A thread that records the names of what it was given."""

    def __init__(self):
        super().__init__(1)
        self.submitted = []

    def submit(self, work, *values, **options):
        self.submitted.append(work.__name__)
        return super().submit(work, *values, **options)


@pytest.fixture
def beside(warm_sandbox, monkeypatch):
    with Recording() as recording:
        monkeypatch.setattr(warm_sandbox, "beside", recording)
        yield recording


def as_json(report):
    found = json.loads(json.dumps(document(report)))
    del found["provenance"]["phases_ms"]
    return found


@pytest.mark.parametrize(
    "source",
    [
        pytest.param(text, id=id, marks=[pytest.mark.slow] if "never" in id else [])
        for id, text in SOURCES.items()
    ],
)
def test_the_report_is_the_same(source, rigid_body, sandbox, warm_sandbox, beside):
    alone, both = (
        as_json(grade(Submission(source), rigid_body, each, 5, ["2"]).report)
        for each in (sandbox, warm_sandbox)
    )
    assert both == alone


def test_it_starts_while_the_first_child_plays(rigid_body, warm_sandbox, beside):
    passed = grade(Submission(RIGHT), rigid_body, warm_sandbox, 5, ["2"]).report.passed
    assert passed and beside.submitted == ["start_child", "_play"]


def test_it_does_not_play_before_the_first_child_has_answered(rigid_body, warm_sandbox, beside):
    grade(Submission(SOURCES["crashes at once"]), rigid_body, warm_sandbox, 5, ["2"])
    assert beside.submitted == ["start_child"]


def test_a_guest_that_is_slow_to_start_a_child_does_not_hold_up_the_first_child(
    rigid_body, warm_sandbox, beside, monkeypatch
):
    """The first child would block on a full pipe until its time is over."""
    start, waits = warm_sandbox.start_child, []

    def slow(*rest):
        if threading.current_thread() is not threading.main_thread():
            waits.append(time.sleep(1.0))
        start(*rest)

    monkeypatch.setattr(warm_sandbox, "start_child", slow)
    played = []
    grade(
        Submission(RIGHT),
        rigid_body,
        warm_sandbox,
        5,
        ["2"],
        on_progress=lambda *step: played.append((step[0], time.monotonic())),
    )
    (_, first), *_, (phase, judging) = played
    assert waits and phase == "judging" and judging - first < 0.9


def test_a_second_child_whose_start_fails_plays_all_the_same(rigid_body, warm_sandbox, beside, monkeypatch):
    start = warm_sandbox.start_child

    def failing(*rest):
        if threading.current_thread() is not threading.main_thread():
            raise SystemFault("the sandbox did not start")
        start(*rest)

    monkeypatch.setattr(warm_sandbox, "start_child", failing)
    assert grade(Submission(RIGHT), rigid_body, warm_sandbox, 5, ["2"]).report.passed


def test_it_ends_with_a_cancelled_grading(rigid_body, warm_sandbox, beside):
    def cancel(phase, scene, scenes):
        if scene == 2:
            warm_sandbox.cancelled.set()

    with pytest.raises(Cancelled):
        grade(Submission(RIGHT), rigid_body, warm_sandbox, 5, ["2"], on_progress=cancel)
    warm_sandbox.cancelled.clear()
    assert grade(Submission(RIGHT), rigid_body, warm_sandbox, 5, ["2"]).report.passed


def test_a_grading_waits_for_a_second_child_whose_answers_it_does_not_use(rigid_body, warm_sandbox, beside):
    """Else that child would hold a guest that the next submission needs."""
    source = (
        LATER.format("import os; os.write(4, b'no frame')").replace("calls = []", "import time\ncalls = []")
        + "right = euler_eqs\ndef euler_eqs(t, w, I):\n    if len(calls) == 100: time.sleep(1.0)\n    return"
        " right(t, w, I)\n"
    )
    grade(Submission(source), rigid_body, warm_sandbox, 5, ["2"])
    assert beside.submitted == ["start_child", "_play"] and not any(
        guest._turn.locked() for guest in warm_sandbox._guests
    )


def test_without_questions_to_repeat_there_is_none(rigid_body, warm_sandbox, beside):
    source = (
        "def box_moments(m, a, b, c):\n"
        "    return m / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])\n"
    )
    grade(Submission(source), rigid_body, warm_sandbox, 5, ["1"])
    assert not beside.submitted
