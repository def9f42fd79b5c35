"""What runs in a worker process: one warm sandbox, grading and drawing. Everything here is called from the grader's pool."""

import atexit
import time

from exercises.assignment import assignments
from service import charts
from service.grading import pictures
from service.grading.grade import grade
from service.grading.submission import Submission
from service.grading.sweep import sweep
from service.sandbox.guest.lockdown import die_with_parent
from service.sandbox.sandbox import Sandbox
from service.sandbox.seen import Fault
from service.sandbox.walls import Walls

_sandbox: Sandbox | None = None


def start(walls: Walls | None) -> None:
    """Prepare this process: a sandbox behind those walls if there are any, and no life after the server's."""
    global _sandbox  # noqa: PLW0603 -- a pool's initializer has no other place to leave it
    die_with_parent()
    if walls is not None:
        _sandbox = Sandbox(walls)
        _sandbox.start()
        atexit.register(_sandbox.close)
    assignments()  # imported while the guest warms up


def ready() -> None:
    """Return once the probe has been played behind the walls and found no hole. Fault if it has not."""
    _own()


def grade_one(submission: Submission, slug: str, exercises: list[str] | None, seed: int) -> tuple[str, dict[str, bytes]]:
    """The report as JSON and the artefacts to keep."""
    began = time.perf_counter()
    graded = grade(submission, assignments()[slug], _own(), seed, exercises)
    judged = time.perf_counter()
    packed = pictures.pack(graded)
    graded.report.provenance.phases_ms = {"grade": 1e3 * (judged - began), "pack": 1e3 * (time.perf_counter() - judged)}
    return graded.report.model_dump_json(), packed


def sweep_one(submission: Submission, slug: str) -> tuple[str, bytes]:
    """Speed against accuracy of a submission, as JSON and as a chart over the reference methods. Raises NotSwept."""
    swept = sweep(submission, assignments()[slug], _own())
    return swept.model_dump_json(), charts.draw_work_precision(charts.load_work_precision(), swept.scene, swept.points)


def draw_one(slug: str, figure: str, packed: bytes, seed: int, form: str) -> bytes:
    """One figure of a graded submission."""
    assignment = assignments()[slug]
    declared = pictures.find(assignment, figure)
    if declared is None:
        raise KeyError(figure)
    return pictures.draw(assignment, declared, pictures.unpack(packed), seed, form)


def draw_chart(kind: str, number: int) -> bytes:
    """A chart by its number, of kind "work-precision" or "stability", from the measurement that comes with this version."""
    if kind == "stability":
        return charts.draw_stability(charts.load_stability(), number)
    document = charts.load_work_precision()
    return charts.draw_work_precision(document, charts.scenes(document)[number])


def _own() -> Sandbox:
    """This process's sandbox, probed before its first use."""
    if _sandbox is None:
        raise Fault("this worker was not started")
    if not _sandbox.rehearsed:
        _sandbox.rehearse()
    return _sandbox
