"""Grading files without a server: the same core, the same walls."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from ecp.document import document
from ecp.outcome import Swept
from ecp.report import Report
from exercises.assignment import Assignment
from service import charts
from service.grading import pictures
from service.grading.grade import Graded, grade, select
from service.grading.submission import BadSubmission, Submission
from service.grading.sweep import NotSwept, sweep
from service.sandbox.choose import choose
from service.sandbox.sandbox import Sandbox
from service.settings import Settings


def grade_files(
    files: Sequence[Path],
    assignment: Assignment,
    exercises: list[str] | None,
    seed: int,
    out: Path | None,
    *,
    swept: bool = False,
) -> Iterator[tuple[Path, Report | BadSubmission]]:
    """Each file's report in turn (``swept``: with speed against accuracy), or why it is no submission.

    Raises before grading anything if an exercise is unknown or a file cannot be read.
    """
    select(assignment, exercises)
    contents = [(file, file.read_bytes()) for file in files]
    folders = _folders(files)
    sandbox = Sandbox(choose(Settings().min_tier))
    try:
        sandbox.rehearse()
        for file, data in contents:
            try:
                submission = Submission.from_bytes(data, file.name)
            except BadSubmission as reason:
                yield file, reason
                continue
            graded = grade(submission, assignment, sandbox, seed, exercises)
            if swept:
                try:
                    graded.report.sweep = sweep(submission, assignment, sandbox)
                except NotSwept as reason:
                    graded.report.sweep = Swept(scene="", points=[], line=f"not swept: {reason}")
            if out is not None:
                _write(graded, assignment, out / folders[file])
            yield file, graded.report
    finally:
        sandbox.close()


def _folders(files: Sequence[Path]) -> dict[Path, str]:
    """A folder for each file: its stem, and where several share one its whole path."""
    stems = [file.stem for file in files]
    return {f: f.stem if stems.count(f.stem) == 1 else "_".join(p for p in f.parts if p not in ("/", "..")) for f in files}


def _write(graded: Graded, assignment: Assignment, folder: Path) -> None:
    """report.txt, report.json, every figure as SVG and every contact sheet as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.txt").write_text(graded.report.text())
    (folder / "report.json").write_text(json.dumps(document(graded.report), ensure_ascii=False, indent=1))
    for name, content in pictures.pack(graded).items():
        if name.endswith(".png"):
            (folder / Path(name).name).write_bytes(content)
    if graded.report.sweep and graded.report.sweep.points:
        points = graded.report.sweep.points
        chart = charts.draw_work_precision(charts.load_work_precision(), graded.report.sweep.scene, points)
        (folder / "sweep.svg").write_bytes(chart)
    for picture in graded.report.figures:
        figure = pictures.find(assignment, picture.name)
        assert figure is not None
        drawn = pictures.draw(assignment, figure, graded.arrays, graded.report.provenance.seed, "svg")
        (folder / f"{picture.name}.svg").write_bytes(drawn)
