"""Speed against accuracy of a submission's own function, when somebody asks: played behind the wall, judged by the exact motion."""

import atexit
import json
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from ecp.document import document, read
from ecp.outcome import SweepResult
from ecp.report import Report
from exercises.assignment import Assignment, InvalidAssignment, NoAssignment
from exercises.catalogue import assignments, find
from service.grading import charts, rendering
from service.grading.grade import Tell, grade, job_of, truth
from service.grading.submission import Submission
from service.sandbox.guest.lockdown import die_with_parent
from service.sandbox.isolation import Isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import with_packages


class SweepFailed(Exception):
    """The function could not be swept; the message says why, to the student."""


def sweep(submission: Submission, assignment: Assignment, sandbox: Sandbox) -> SweepResult:
    """Play the assignment's sweep with this submission. NotSwept where there is none, or the function does not see it through."""
    if assignment.sweep is None:
        raise SweepFailed(f"assignment {assignment.slug} has no sweep")
    scene = assignment.sweep.scene
    assert not callable(scene.inputs)
    seen = sandbox.play(job_of(submission, assignment, [scene], {scene.name: scene.inputs}))
    if not seen.finished(scene.name):
        scene_end = seen.scene_ends.get(scene.name)
        raise SweepFailed(scene_end.sentence if scene_end else "your code stopped before this was played")
    try:
        return assignment.sweep.read(seen.arrays[scene.name], truth(scene, scene.inputs))
    except (ArithmeticError, ValueError) as error:
        raise SweepFailed(f"the numbers that came back are beyond what can be judged ({error})") from error


_sandbox: Sandbox | None = None


def start(isolation: Isolation) -> None:
    """Prepare this process: a sandbox with ``isolation``, and an end together with the process that started it."""
    global _sandbox  # noqa: PLW0603 -- a pool's initializer has no other place to leave it
    die_with_parent()
    if _sandbox is None:
        atexit.register(_close)
    _close()
    _sandbox = Sandbox(with_packages(isolation, sorted({name for known in assignments().values() for name in known.packages})))
    _sandbox.start()


def ready() -> None:
    """Return once the probe has been played behind the walls and found no hole. Fault if it has not."""
    _own()


def zygotes() -> int:
    """Warm guests that had to be replaced so far."""
    return max(0, _sandbox.zygotes - 1) if _sandbox else 0


def stop_playing(stop: bool = True) -> None:
    """From another thread: end what is being played, and play nothing, until this is called with False."""
    if _sandbox is not None:
        (_sandbox.unwanted.set if stop else _sandbox.unwanted.clear)()


def grade_one(
    submission: Submission, slug: str, exercises: list[str] | None, seed: int, tell: Tell = lambda phase, scene, scenes: None
) -> tuple[Report, dict[str, bytes]]:
    """The report and the artefacts to keep. Stopped where ``stop_playing`` was called meanwhile."""
    began = time.perf_counter()
    graded = grade(submission, _assignment(slug), _own(), seed, exercises, tell=tell)
    judged = time.perf_counter()
    packed = rendering.pack(graded)
    graded.report.provenance.phases_ms = {"grade": 1e3 * (judged - began), "pack": 1e3 * (time.perf_counter() - judged)}
    return graded.report, packed


def sweep_one(submission: Submission, slug: str) -> tuple[str, bytes]:
    """Speed against accuracy of a submission, as JSON and as a chart over the reference methods. Raises NotSwept."""
    swept = sweep(submission, _assignment(slug), _own())
    return json.dumps(document(swept)), charts.draw_work_precision(charts.load_work_precision(), swept.scene, swept.points)


def draw_one(slug: str, figure: str, packed: bytes, seed: int, form: str) -> bytes:
    """One figure of a graded submission."""
    assignment = _assignment(slug)
    declared = rendering.find(assignment, figure)
    if declared is None:
        raise KeyError(figure)
    return rendering.draw(assignment, declared, rendering.unpack(packed), seed, form)


def draw_chart(kind: str, number: int) -> bytes:
    """A chart by its number, of kind "work-precision" or "stability", from the measurement that comes with this version."""
    if kind == "stability":
        return charts.draw_stability(charts.load_stability(), number)
    document = charts.load_work_precision()
    return charts.draw_work_precision(document, charts.scenes(document)[number])


def draw_class(documents: Sequence[dict[str, Any]]) -> bytes:
    """The sweeps of a class, as ``sweep_one`` told them, over the reference methods; those on the scene that most are on."""
    found = [read(SweepResult, told) for told in documents]
    scene = Counter(swept.scene for swept in found).most_common(1)[0][0]
    return charts.draw_class(charts.load_work_precision(), scene, [s.points for s in found if s.scene == scene])


def _assignment(slug: str) -> Assignment:
    """Fault where it is broken, or is not there any more."""
    try:
        return find(slug)
    except (InvalidAssignment, NoAssignment) as error:
        raise SystemFault(f"the assignment {slug} cannot be used") from error


def _close() -> None:
    if _sandbox is not None:
        _sandbox.close()


def _own() -> Sandbox:
    """This process's sandbox, probed before its first use."""
    if _sandbox is None:
        raise SystemFault("this worker was not started")
    if not _sandbox.self_tested:
        _sandbox.self_test()
    return _sandbox
