"""The second child of a grading, which a worker's sandbox plays beside the first one: the reports are the same."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest

from ecp.document import document
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.result import Cancelled

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
    "uses SciPy": "from scipy.linalg import solve\ndef euler_eqs(t, w, I):\n    return -solve(np.diag(I), np.cross(w, I * w))\n",
    "crashes later": LATER.format("import ctypes; ctypes.string_at(0)"),
    "exits later": LATER.format("import os; os._exit(3)"),
    "violates the protocol later": LATER.format("import os; os.write(4, b'no frame')"),
    "never returns later": LATER.format("\n        while True: pass"),
    "crashes at once": "import ctypes\ndef euler_eqs(t, w, I):\n    ctypes.string_at(0)\n",
    "is missing": "pass",
    "raises in the second child": "import os\nif int.from_bytes(os.urandom(1)) >= 0: 1 / 0\n" + RIGHT,
}


class Counting(ThreadPoolExecutor):
    """A thread that counts what it was given."""

    submitted = 0

    def submit(self, *work, **options):
        self.submitted += 1
        return super().submit(*work, **options)


@pytest.fixture
def beside(warm_sandbox, monkeypatch):
    with Counting(1) as counting:
        monkeypatch.setattr(warm_sandbox, "beside", counting)
        yield counting


def as_json(report):
    found = json.loads(json.dumps(document(report)))
    del found["provenance"]["phases_ms"]
    return found


@pytest.mark.parametrize(
    "source", [pytest.param(text, id=id, marks=[pytest.mark.slow] if "never" in id else []) for id, text in SOURCES.items()]
)
def test_the_report_is_the_same(source, rigid_body, sandbox, warm_sandbox, beside):
    alone, both = (as_json(grade(Submission(source), rigid_body, each, 5, ["2"]).report) for each in (sandbox, warm_sandbox))
    assert both == alone


def test_it_starts_while_the_first_child_plays(rigid_body, warm_sandbox, beside):
    assert grade(Submission(RIGHT), rigid_body, warm_sandbox, 5, ["2"]).report.passed and beside.submitted == 1


def test_it_does_not_start_before_the_first_child_has_answered(rigid_body, warm_sandbox, beside):
    grade(Submission(SOURCES["crashes at once"]), rigid_body, warm_sandbox, 5, ["2"])
    assert beside.submitted == 0


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
    source = LATER.format("import os; os.write(4, b'no frame')").replace("calls = []", "import time\ncalls = []") + (
        "right = euler_eqs\ndef euler_eqs(t, w, I):\n    if len(calls) == 100: time.sleep(1.0)\n    return right(t, w, I)\n"
    )
    grade(Submission(source), rigid_body, warm_sandbox, 5, ["2"])
    assert beside.submitted == 1 and not any(guest._turn.locked() for guest in warm_sandbox._guests)


def test_without_questions_to_repeat_there_is_none(rigid_body, warm_sandbox, beside):
    source = "def box_moments(m, a, b, c):\n    return m / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])\n"
    grade(Submission(source), rigid_body, warm_sandbox, 5, ["1"])
    assert beside.submitted == 0
