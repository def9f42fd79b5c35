"""Grading files without a server: the same core and the same isolation, in processes with a warm guest each."""

import logging
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from ecp.outcome import SweepResult
from exercises import validation
from exercises.assignment import Assignment
from service.grading import charts, rendering
from service.grading.grade import Graded, grade, missing_packages, select
from service.grading.grader import SweepFailed, sweep
from service.grading.result import GradedFile
from service.grading.submission import MOST_BYTES, BadSubmission, Submission
from service.sandbox.guest.lockdown import die_with_parent
from service.sandbox.isolation import Isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import with_packages

log = logging.getLogger(__name__)
Tell = Callable[[int], None]


@dataclass(frozen=True)
class GradeRequest:
    """A file to grade, and the exercises of it; None: those it attempts."""

    file: Path
    exercises: tuple[str, ...] | None = None


@dataclass(frozen=True)
class GradeOptions:
    """What is wanted of every file: scenes drawn from ``seed``, figures in the ``forms`` (svg, png), whether it is swept too."""

    assignment: Assignment
    seed: int
    forms: Collection[str] = ()
    swept: bool = False


def grade_files(
    asks: Sequence[GradeRequest],
    wanted: GradeOptions,
    isolation: Isolation,
    jobs: int | None = None,
    tell: Tell = lambda done: None,
) -> Iterator[GradedFile]:
    """Each file in turn, graded by a process for each processor (at most ``jobs``); ``tell`` hears how many files are done.

    Raises before grading anything if an exercise is unknown or a file cannot be read, and Fault if the walls do not hold
    or a package that the assignment declares is not installed. What
    fails us with a single file is that file's fault, and the others are graded; a process that is lost takes along what was left.
    """
    for ask in asks:
        select(wanted.assignment, ask.exercises)
    if absent := missing_packages(wanted.assignment):
        raise SystemFault(absent)
    isolation = with_packages(isolation, wanted.assignment.packages)
    contents = [_read(ask.file) for ask in asks]
    processes = min(len(asks), jobs or len(os.sched_getaffinity(0)))
    if processes <= 1:
        yield from _here(asks, contents, wanted, isolation, tell)
        return
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(processes, multiprocessing.get_context("fork"), _begin, (wanted, isolation))
    try:
        asked = [pool.submit(_grade, ask, content) for ask, content in zip(asks, contents, strict=True)]
        yield from _in_turn(asks, asked, tell)
    finally:
        for child in set(multiprocessing.active_children()) - others:
            child.kill()  # it has nothing left to do, or nobody wants it done; its guest ends with it
        pool.shutdown(cancel_futures=True)


def _here(
    asks: Sequence[GradeRequest], contents: Sequence[bytes], wanted: GradeOptions, isolation: Isolation, tell: Tell
) -> Iterator[GradedFile]:
    hand = _FileGrader(wanted, isolation)
    try:
        for number, (ask, content) in enumerate(zip(asks, contents, strict=True), start=1):
            graded = hand.grade(ask, content)
            tell(number)
            yield graded
    finally:
        hand.sandbox.close()


def _in_turn(asks: Sequence[GradeRequest], asked: Sequence["Future[GradedFile]"], tell: Tell) -> Iterator[GradedFile]:
    done: list[object] = []

    def count(one: object) -> None:
        done.append(one)
        tell(len(done))

    for future in asked:
        future.add_done_callback(count)
    for ask, future in zip(asks, asked, strict=True):
        try:
            yield future.result()
        except BrokenProcessPool:
            yield GradedFile(file=ask.file, fault="a process that grades was lost (killed, or out of memory)")


class _FileGrader:
    """A process's own: one sandbox, and what is wanted of each file."""

    def __init__(self, wanted: GradeOptions, isolation: Isolation) -> None:
        self.wanted, self.sandbox = wanted, Sandbox(isolation)
        self.sandbox.start()

    def grade(self, ask: GradeRequest, content: bytes) -> GradedFile:
        """Raises Fault only where the walls do not hold: then no file can be graded."""
        if not self.sandbox.self_tested:
            self.sandbox.self_test()
        began = time.perf_counter()
        try:
            submission = Submission.from_bytes(content, ask.file.name)
        except BadSubmission as reason:
            return GradedFile(file=ask.file, refused=str(reason))
        source, wanted = submission.source, self.wanted
        try:
            graded = grade(submission, wanted.assignment, self.sandbox, wanted.seed, ask.exercises)
            if wanted.swept:
                graded.report.sweep = _sweep(submission, wanted.assignment, self.sandbox)
            drawn = _draw(graded, wanted)
        except SystemFault as fault:
            return GradedFile(file=ask.file, source=source, fault=str(fault))
        except (Exception, SystemExit) as error:  # the assignment's code or ours: not foreseen, and no other file's
            log.exception("grading failed")
            return GradedFile(file=ask.file, source=source, fault=validation.format_error(error, wanted.assignment.folder))
        seconds = time.perf_counter() - began
        return GradedFile(file=ask.file, source=source, report=graded.report, pictures=drawn, seconds=seconds)


_hand: _FileGrader | None = None


def _begin(wanted: GradeOptions, isolation: Isolation) -> None:
    global _hand  # noqa: PLW0603 -- a pool's initializer has no other place to leave it
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a key pressed is for who started us
    _hand = _FileGrader(wanted, isolation)


def _grade(ask: GradeRequest, content: bytes) -> GradedFile:
    assert _hand is not None
    return _hand.grade(ask, content)


def _read(file: Path) -> bytes:
    """The bytes, and of what is too large just enough to be seen as such."""
    with file.open("rb") as stream:
        return stream.read(MOST_BYTES + 1)


def _sweep(submission: Submission, assignment: Assignment, sandbox: Sandbox) -> SweepResult:
    try:
        return sweep(submission, assignment, sandbox)
    except SweepFailed as reason:
        return SweepResult(scene="", points=[], line=f"not swept: {reason}")


def _draw(graded: Graded, wanted: GradeOptions) -> dict[str, bytes]:
    """Figures, contact sheets and the chart of a sweep by file name, if any pictures are wanted."""
    if not wanted.forms:
        return {}
    drawn = {Path(name).name: sheet for name, sheet in rendering.pack(graded).items() if name.endswith(".png")}
    swept = graded.report.sweep
    if swept and swept.points:
        drawn["sweep.svg"] = charts.draw_work_precision(charts.load_work_precision(), swept.scene, swept.points)
    for picture in graded.report.figures:
        figure = rendering.find(wanted.assignment, picture.name)
        assert figure is not None
        for form in wanted.forms:
            seed = graded.report.provenance.seed
            drawn[f"{picture.name}.{form}"] = rendering.draw(wanted.assignment, figure, graded.arrays, seed, form)
    return drawn
