"""Grade one file without a server."""

import json
import logging
import re
import time
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path

from exercises.authoring.assignments import validation
from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import SweepResult
from polhode.notebook.strip_outputs import is_notebook
from service.grading.figures import rendering
from service.grading.grade import Graded, UnknownExercise, grade, select
from service.grading.graded_file import GradedFile
from service.grading.grader import Grader, SweepFailed
from service.grading.submission import DEFAULT_SIZES, BadSubmission, SizeLimits, Submission
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox

log = logging.getLogger(__name__)
LONG = 1000
_STRING = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"')  # a JSON string


@dataclass(frozen=True)
class GradeRequest:
    """A file to grade and the numbers of its exercises (None: the exercises that it requests or attempts)."""

    file: Path
    exercises: tuple[str, ...] | None = None


@dataclass(frozen=True)
class GradeOptions:
    """Options for all files: the ``seed`` of the scenes, the ``formats`` of figures (svg, png), whether to
    ``sweep``, and the size limits of each file.
    """

    assignment: Assignment
    seed: int
    formats: Collection[str] = ()
    sweep: bool = False
    sizes: SizeLimits = DEFAULT_SIZES


def start_grader(sandbox: Sandbox) -> Grader:
    """Return a grader whose guest starts while the first file is read."""
    sandbox.start()
    return Grader(sandbox)


def grade_file(grader: Grader, options: GradeOptions, request: GradeRequest) -> GradedFile:
    """Grade one file.

    Raises OSError if it cannot be read. Raises SystemFault only if the self-test of the sandbox fails, so
    that no file can be graded.
    """
    grader.ready()
    began = time.perf_counter()
    try:
        submission, source = _read(request, options)
    except BadSubmission as reason:
        return GradedFile(file=request.file, refused=str(reason))
    try:
        graded = grade(submission, options.assignment, grader.sandbox, options.seed)
        if options.sweep:
            graded.report.sweep = _sweep(grader, submission, options.assignment)
        drawn = _draw(graded, options)
    except SystemFault as fault:
        return GradedFile(file=request.file, source=source, fault=str(fault))
    except (
        Exception,
        SystemExit,
    ) as error:  # a defect of the assignment or of polhode, which affects this file only
        log.exception("grading failed")
        return GradedFile(
            file=request.file, source=source, fault=validation.format_error(error, options.assignment.folder)
        )
    seconds = time.perf_counter() - began
    return GradedFile(
        file=request.file,
        source=source,
        report=graded.report,
        pictures=drawn,
        seconds=seconds,
        cpu_s=graded.cpu_s,
    )


def _read(request: GradeRequest, options: GradeOptions) -> tuple[Submission, str]:
    """Return the submission, with the exercises of the request if it has some, and the text whose lines the
    report refers to, "" for a JSON document.

    Raises BadSubmission, OSError.
    """
    sizes = options.sizes
    with request.file.open("rb") as stream:
        content = stream.read(
            sizes.upload + 1
        )  # one more byte than accepted reveals a file that is too large
    if len(content) <= sizes.upload and _is_document(request.file.name, content):
        submission, source = Submission.from_json(content, sizes), ""
        try:
            select(options.assignment, submission.exercises)
        except UnknownExercise as error:
            raise BadSubmission(str(error)) from error
    else:
        submission = Submission.from_bytes(content, request.file.name, sizes)
        text = content.decode("utf-8-sig")
        source = submission.source if submission.source == text else _shortened(text)
    return replace(submission, exercises=request.exercises or submission.exercises), source


def _is_document(name: str, content: bytes) -> bool:
    """Return whether a file is a submission as JSON, rather than Python or a notebook."""
    return name.lower().endswith(".json") and not is_notebook(content.decode("utf-8-sig", "replace"), name)


def _shortened(notebook: str) -> str:
    """Return the notebook's text with its lines, but without long strings that are not code, such as
    pictures.
    """
    sources = [cell["source"] for cell in json.loads(notebook)["cells"] if cell["cell_type"] == "code"]
    code = {piece for source in sources for piece in ([source] if isinstance(source, str) else source)}
    return _STRING.sub(
        lambda found: found[0] if len(found[0]) < LONG or json.loads(found[0]) in code else '""', notebook
    )


def _sweep(grader: Grader, submission: Submission, assignment: Assignment) -> SweepResult:
    try:
        return grader.sweep(submission, assignment, submission.exercises or ())
    except SweepFailed as reason:
        return SweepResult(scene="", points=[], line=f"speed and accuracy were not measured: {reason}")


def _draw(graded: Graded, options: GradeOptions) -> dict[str, bytes]:
    """Return figures, contact sheets and the chart of a sweep by file name, if pictures are requested."""
    if not options.formats:
        return {}
    drawn = {
        Path(name).name: sheet for name, sheet in rendering.pack(graded).items() if name.endswith(".png")
    }
    swept = graded.report.sweep
    if swept and swept.points:
        drawn["sweep.svg"] = rendering.draw_sweep(swept)
    for picture in graded.report.figures:
        figure = rendering.find(options.assignment, picture.name)
        assert figure is not None
        for image_format in options.formats:
            seed = graded.report.provenance.seed
            drawn[f"{picture.name}.{image_format}"] = rendering.draw(
                options.assignment, figure, graded.arrays, seed, image_format
            )
    return drawn
