"""Rows of a gradebook for files graded without a server: a file's name, without its ending, is the student's."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from exercises.assignment import Assignment
from service.grades.row import Row
from service.grading.states import state
from service.tellings.files import GradedFile


def rows(files: Sequence[GradedFile], assignment: Assignment) -> list[Row]:
    """A row for each file; files of one name in several folders, such as ann/mine.py and ben/mine.py, go by their path."""
    stems = Counter(file.file.stem for file in files)
    return [row(file, assignment, "" if stems[file.file.stem] == 1 else file.file.with_suffix("").as_posix()) for file in files]


def row(file: GradedFile, assignment: Assignment, student: str = "") -> Row:
    """The row of one file. What is no submission has no points; after a fault of ours, none are known."""
    about = Row(
        assignment=assignment.slug,
        title=assignment.title,
        max_points=assignment.most_points(),
        student=student or file.file.stem,
        submission=file.file.as_posix(),
        attempts=1,
        score=file.points,
        points=file.points,
        status="faulted" if file.fault is not None else "refused",
    )
    return about if file.report is None else _graded(about, file)


def _graded(about: Row, file: GradedFile) -> Row:
    report = file.report
    assert report is not None
    grader = f"polhode {report.provenance.versions.get('polhode', '')}, assignment version {report.version}"
    checks = {outcome.id: state(outcome, report.endings) for outcome in report.outcomes()}
    return replace(about, status="graded", counted=report.max_score, grader=grader, checks=checks)
