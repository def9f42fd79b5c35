"""A play that nobody wants any more ends at once; the guest stays warm and plays the next."""

import threading
import time

import pytest

from exercises.authoring.assignments.catalogue import find
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.result import Cancelled

GOOD = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
LOOPS = {
    "while it is loaded": "while True:\n    pass\n" + GOOD,
    "in a scene": GOOD.replace(":\n", ":\n    calls.append(t)\n    while len(calls) > 200:\n        pass\n")
    + "calls = []\n",
    "printing": "while True:\n    print('x' * 10, flush=True)\n    import time\n    time.sleep(0.01)\n"
    + GOOD,
}


@pytest.mark.parametrize(
    "where", ["in a scene", *(pytest.param(w, marks=pytest.mark.slow) for w in LOOPS if w != "in a scene")]
)
def test_stopped_long_before_its_budgets_end_and_the_next_is_graded_by_the_same_guest(
    sandbox, rigid_body, where
):
    sandbox.close()  # a guest ends with the thread that started it, which may be that of another test
    sandbox.wait_ready()
    before, timer = sandbox.zygotes, threading.Timer(0.6, sandbox.cancelled.set)
    timer.start()
    began = time.monotonic()
    try:
        with pytest.raises(Cancelled):
            grade(Submission(LOOPS[where]), rigid_body, sandbox, 7, ["2"])
        assert 0.5 < time.monotonic() - began < 5.0  # each of its budgets is 10 s or more
        with pytest.raises(Cancelled):
            grade(Submission(GOOD), rigid_body, sandbox, 7, ["2"])
    finally:
        sandbox.cancelled.clear()
    assert grade(Submission(GOOD), find("rigid-body"), sandbox, 7, ["2"]).report.passed
    assert sandbox.zygotes == before
