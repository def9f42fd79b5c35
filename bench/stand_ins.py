"""Workers that are polhode's, except that a grading is a wait that returns a recorded report.

So the queue and the store can be measured with more workers than the machine has cores.
"""

import pickle
import threading
import types
from collections.abc import Callable
from pathlib import Path

import numpy as np

from exercises.authoring.assignments.catalogue import assignments
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.grader import SweepFailed
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose
from service.sandbox.result import Cancelled
from service.sandbox.sandbox import Sandbox
from service.settings import Settings
from service.workers import pool
from service.workers.worker import Worker

LONGEST_S = 180.0  # more than any wait
SOURCE = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"


def record(file: Path) -> None:
    """Grade a submission and store its report and the size of its arrays in ``file``."""
    sandbox = Sandbox(choose("process", True))
    try:
        assignment = assignments()["rigid-body"]
        graded = grade(Submission(SOURCE), assignment, sandbox, 7, ["2"])
    finally:
        sandbox.close()
    file.write_bytes(pickle.dumps((graded.report, len(rendering.pack(graded)["arrays.npz"]))))


def be_workers(recorded: Path, seconds: Callable[[Submission, int], float]) -> None:
    """Run a pool of workers whose gradings wait and return what was recorded.

    ``seconds`` gives the time of a submission with its seed.
    """
    report, size = pickle.loads(recorded.read_bytes())
    cancelled = threading.Event()

    def grade_and_pack(
        submission: Submission, slug: str, seed: int, *_: object
    ) -> tuple[object, dict[str, bytes]]:
        if cancelled.wait(seconds(submission, seed)):
            raise Cancelled
        return report, {"arrays.npz": np.random.default_rng().bytes(size)}

    def sweep_and_draw(*_: object) -> tuple[str, bytes]:
        raise SweepFailed("a stand-in measures nothing")

    async def start(worker: Worker) -> bool:
        sandbox = types.SimpleNamespace(cancelled=cancelled, replaced=0, waited_s=0.0, close=lambda: None)
        worker._grader = types.SimpleNamespace(  # type: ignore[assignment]
            grade_and_pack=grade_and_pack,
            sweep_and_draw=sweep_and_draw,
            longest_s=lambda slug: LONGEST_S,
            sandbox=sandbox,
        )
        worker._isolation = "none"
        return True

    Worker._start_sandbox = start  # type: ignore[method-assign]
    pool.NICENESS = 0  # a wait takes no processor from anybody
    pool.WorkerPool(Settings()).run()
