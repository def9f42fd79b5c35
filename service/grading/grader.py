"""The grader of a worker process: grading, speed against accuracy of a submission, figures and charts, with one sandbox."""

import atexit
import json
import math
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
from service.grading.author_errors import author_errors, play
from service.grading.grade import OnProgress, grade, job_of, truth
from service.grading.submission import Submission
from service.sandbox.guest.lockdown import die_with_parent
from service.sandbox.isolation import Isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import with_packages
from service.sandbox.time_budget import DEFAULT_LIMITS, TimeBudget, TimeLimits

MOST_CALLS, MOST_SECONDS = 10**9, 1e6  # of one solver in a sweep; assignments allow less


class SweepFailed(Exception):
    """Speed against accuracy could not be measured. The message is for the student."""


def sweep(submission: Submission, assignment: Assignment, sandbox: Sandbox) -> SweepResult:
    """Measure speed against accuracy of a submission's function. Raises SweepFailed if that is not possible."""
    if assignment.sweep is None:
        raise SweepFailed(f"assignment {assignment.slug} does not measure speed against accuracy")
    scene = assignment.sweep.scene
    assert not callable(scene.inputs)
    began = time.monotonic()
    job = job_of(submission, assignment, [scene], {scene.name: scene.inputs})
    result = play(job, assignment, sandbox, budget=TimeBudget(sandbox.limits.at_least(assignment.cpu_s)))
    elapsed = time.monotonic() - began
    if not result.finished(scene.name):
        scene_end = result.scene_ends.get(scene.name)
        raise SweepFailed(scene_end.sentence if scene_end else "your code stopped before the measurement")
    try:
        with author_errors(assignment):
            exact = truth(scene, scene.inputs)
        with author_errors(assignment, numbers=True):
            swept = assignment.sweep.read(result.arrays[scene.name], exact)
    except (ArithmeticError, ValueError) as error:
        raise SweepFailed(f"the results cannot be compared with the exact motion ({error})") from error
    if not plausible(swept) or sum(point.seconds for point in swept.points) > elapsed:
        raise SweepFailed("the measurement returned impossible numbers of calls or seconds: submit your functions alone")
    return swept


def plausible(swept: SweepResult) -> bool:
    """Return whether every number of a sweep is finite and in its range, so that it can be drawn."""
    return all(
        1 <= p.calls <= MOST_CALLS and 0 <= p.seconds <= MOST_SECONDS and (p.error is None or 0 <= p.error < math.inf)
        for p in swept.points
    )


_sandbox: Sandbox | None = None


def start(isolation: Isolation, limits: TimeLimits = DEFAULT_LIMITS) -> None:
    """Start this process's sandbox, and let the process end together with its parent. ``limits`` are those of one grading."""
    global _sandbox  # noqa: PLW0603 -- a pool's initializer can pass its result in no other way
    die_with_parent()
    if _sandbox is None:
        atexit.register(_close)
    _close()
    packages = sorted({name for known in assignments().values() for name in known.packages})
    _sandbox = Sandbox(with_packages(isolation, packages), limits)
    _sandbox.start()


def ready() -> None:
    """Return when the sandbox has passed its self-test. Raises SystemFault if it has not."""
    _tested_sandbox()


def zygotes() -> int:
    """Return how many warm guests have been replaced so far."""
    return max(0, _sandbox.zygotes - 1) if _sandbox else 0


def stop_playing(stop: bool = True) -> None:
    """End the current play, from another thread, and play nothing until this is called with ``stop=False``."""
    if _sandbox is not None:
        (_sandbox.cancelled.set if stop else _sandbox.cancelled.clear)()


def grade_one(
    submission: Submission,
    slug: str,
    exercises: list[str] | None,
    seed: int,
    on_progress: OnProgress = lambda phase, scene, scenes: None,
) -> tuple[Report, dict[str, bytes]]:
    """Grade a submission. Return the report and its artefacts by name. Raises Cancelled after ``stop_playing``, and SystemFault."""
    began = time.perf_counter()
    graded = grade(submission, _assignment(slug), _tested_sandbox(), seed, exercises, on_progress=on_progress)
    judged = time.perf_counter()
    packed = rendering.pack(graded)
    graded.report.provenance.phases_ms = {"grade": 1e3 * (judged - began), "pack": 1e3 * (time.perf_counter() - judged)}
    return graded.report, packed


def sweep_one(submission: Submission, slug: str) -> tuple[str, bytes]:
    """Measure speed against accuracy. Return JSON and an SVG chart with the reference methods. Raises SweepFailed."""
    swept = sweep(submission, _assignment(slug), _tested_sandbox())
    return json.dumps(document(swept)), charts.draw_work_precision(charts.load_work_precision(), swept.scene, swept.points)


def draw_one(slug: str, figure: str, packed: bytes, seed: int, form: str) -> bytes:
    """Draw one figure of a graded submission, from its ``packed`` arrays. Raises KeyError if there is no such figure."""
    assignment = _assignment(slug)
    declared = rendering.find(assignment, figure)
    if declared is None:
        raise KeyError(figure)
    return rendering.draw(assignment, declared, rendering.unpack(packed), seed, form)


def draw_chart(kind: str, number: int) -> bytes:
    """Draw chart ``number`` of the kind "work-precision" or "stability" from the measurement of this version, as SVG."""
    if kind == "stability":
        return charts.draw_stability(charts.load_stability(), number)
    document = charts.load_work_precision()
    return charts.draw_work_precision(document, charts.scenes(document)[number])


def draw_class(documents: Sequence[dict[str, Any]]) -> bytes:
    """Draw the sweeps of a class, as ``sweep_one`` returned them, with the reference methods. Uses the most frequent scene only."""
    found = [swept for swept in (read(SweepResult, one) for one in documents) if plausible(swept)]
    measured = charts.load_work_precision()
    scene = Counter([swept.scene for swept in found] or charts.scenes(measured)).most_common(1)[0][0]
    return charts.draw_class(measured, scene, [s.points for s in found if s.scene == scene])


def _assignment(slug: str) -> Assignment:
    """Return the assignment. Raises SystemFault if it is invalid or does not exist."""
    try:
        return find(slug)
    except (InvalidAssignment, NoAssignment) as error:
        raise SystemFault(f"assignment {slug} is invalid or missing; run polhode verify {slug}") from error


def _close() -> None:
    if _sandbox is not None:
        _sandbox.close()


def _tested_sandbox() -> Sandbox:
    """Return this process's sandbox, which runs its self-test before its first use."""
    if _sandbox is None:
        raise SystemFault("the sandbox of this process was not started")
    if not _sandbox.self_tested:
        _sandbox.self_test()
    return _sandbox
