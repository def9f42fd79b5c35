"""A student's grade for an assignment: the one thing that every form of export is made of."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from exercises.assignment import Assignment
from service.grading.result import GradedFile, state


@dataclass(frozen=True, kw_only=True)
class GradeRow:
    """One student and one assignment, with the best of their submissions: most points, of equals the newest.

    ``points`` are the ``score`` unless somebody gave others; None while nothing is graded. ``max_points`` is what the assignment
    has, the same for everybody; ``counted`` is how many checks count in that submission's report, fewer if it left exercises out.
    ``status`` is "none" for a student who sent nothing, else that of the submission. ``checks`` has states as measured and
    ``given`` the points (1 or 0) given for a check instead.
    """

    assignment: str
    title: str
    max_points: int
    student: str
    due_at: datetime | None = None
    full_name: str = ""
    email: str = ""
    student_id: str = ""
    status: str = "none"
    attempts: int = 0
    submission: str | None = None
    submitted_at: datetime | None = None
    late: bool | None = None
    graded_at: datetime | None = None
    score: int | None = None
    points: int | None = None
    counted: int | None = None
    overridden: bool = False
    grader: str = ""
    checks: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, int] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """What the student is called: the full name, or else the name they are known by here."""
        return self.full_name or self.student

    @property
    def percent(self) -> float | None:
        """Of the assignment's points; above 100 with checks of functions that could have been left out."""
        return None if self.points is None or not self.max_points else round(100 * self.points / self.max_points, 2)

    def state(self, check: str) -> str | None:
        """The state of a check, with what was given for it instead; None where it is not in the report."""
        if check not in self.checks or check not in self.given:
            return self.checks.get(check)
        return "pass" if self.given[check] else "fail"


def moment(at: datetime | None) -> str | None:
    """A moment as ISO 8601 in UTC, to the second."""
    return None if at is None else at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def rows(files: Sequence[GradedFile], assignment: Assignment) -> list[GradeRow]:
    """A row for each file; files of one name in several folders, such as ann/mine.py and ben/mine.py, go by their path."""
    stems = Counter(file.file.stem for file in files)
    return [row(file, assignment, "" if stems[file.file.stem] == 1 else file.file.with_suffix("").as_posix()) for file in files]


def row(file: GradedFile, assignment: Assignment, student: str = "") -> GradeRow:
    """The row of one file. What is no submission has no points; after a fault of ours, none are known."""
    about = GradeRow(
        assignment=assignment.slug,
        title=assignment.title,
        max_points=assignment.max_points(),
        student=student or file.file.stem,
        submission=file.file.as_posix(),
        attempts=1,
        score=file.points,
        points=file.points,
        status="faulted" if file.fault is not None else "refused",
    )
    return about if file.report is None else _graded(about, file)


def _graded(about: GradeRow, file: GradedFile) -> GradeRow:
    report = file.report
    assert report is not None
    grader = f"polhode {report.provenance.versions.get('polhode', '')}, assignment version {report.version}"
    checks = {outcome.id: state(outcome, report.scene_ends) for outcome in report.outcomes()}
    return replace(about, status="graded", counted=report.max_score, grader=grader, checks=checks)
