"""Grading files without a server: the same core, the same walls."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from exercises.assignment import Assignment
from service.grading import pictures
from service.grading.grade import Graded, grade, select
from service.grading.report import Report
from service.grading.submission import Submission
from service.sandbox.choose import choose
from service.sandbox.sandbox import Sandbox
from service.settings import Settings


def grade_files(
    files: Iterable[Path], assignment: Assignment, exercises: list[str] | None, seed: int, out: Path | None
) -> Iterator[tuple[Path, Report]]:
    """Each file's report in turn. Raises before grading anything if a file cannot be a submission or an exercise is unknown."""
    select(assignment, exercises)
    submissions = [(file, Submission.from_bytes(file.read_bytes(), file.name)) for file in files]
    sandbox = Sandbox(choose(Settings().walls))
    try:
        for file, submission in submissions:
            graded = grade(submission, assignment, sandbox, seed, exercises)
            if out is not None:
                _write(graded, assignment, out / file.stem)
            yield file, graded.report
    finally:
        sandbox.close()


def _write(graded: Graded, assignment: Assignment, folder: Path) -> None:
    """report.txt, report.json, every figure as SVG and every contact sheet as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.txt").write_text(graded.report.text())
    (folder / "report.json").write_text(graded.report.model_dump_json(indent=1))
    for name, content in pictures.pack(graded).items():
        if name.endswith(".png"):
            (folder / Path(name).name).write_bytes(content)
    for picture in graded.report.figures:
        figure = pictures.find(assignment, picture.name)
        assert figure is not None
        drawn = pictures.draw(assignment, figure, graded.arrays, graded.report.provenance.seed, "svg")
        (folder / f"{picture.name}.svg").write_bytes(drawn)
