"""One student's grade for one assignment: the common input of all grade files."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta

from exercises.authoring.assignments.assignment import Assignment
from service.grading.graded_file import GradedFile, state


@dataclass(frozen=True, kw_only=True)
class GradeRow:
    """One student's counted submission for one assignment: the one with the most points, the newest among
    equals.

    ``points`` equals ``score`` unless a grader overrode it, and is None while nothing is graded; the late
    ``penalty`` is not subtracted. ``lateness`` is the time after the student's own deadline. ``weight`` is
    the assignment's in the course. ``released`` says whether the student may see the scores.
    ``max_points`` is the assignment's maximum, the same for every student. ``counted`` are the points of the
    counted checks in the report; they are fewer if the submission left out exercises. ``attempts`` is the
    number of the student's submissions. ``status`` is the submission's, or "none" without one. ``checks``
    holds each check's measured state, ``worth`` its points, ``earned`` the points it earned before overrides,
    ``given`` its overridden points.
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
    points: float | None = None
    penalty: float = 0
    weight: float = 1.0
    released: bool = True
    lateness: timedelta | None = None
    counted: int | None = None
    overridden: bool = False
    grader: str = ""
    checks: Mapping[str, str] = field(default_factory=dict)
    worth: Mapping[str, int] = field(default_factory=dict)
    earned: Mapping[str, int] = field(default_factory=dict)
    given: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the full name, or the student's user name if it is unknown."""
        return self.full_name or self.student

    @property
    def final(self) -> float | None:
        """Return the points after the late penalty, None without points."""
        return after_penalty(self.points, self.penalty)

    @property
    def percent(self) -> float | None:
        """Return the percentage of the assignment's points after the late penalty; optional functions can
        raise it above 100.
        """
        return (
            None
            if self.final is None or not self.max_points
            else round(100 * self.final / self.max_points, 2)
        )

    def state(self, check: str) -> str | None:
        """Return a check's state with its override applied, or None if the report lacks the check.

        An override that gives all points passes the check.
        """
        if check not in self.checks or check not in self.given:
            return self.checks.get(check)
        return "pass" if self.given[check] >= self.worth[check] else "fail"


def after_penalty(points: float | None, penalty: float) -> float | None:
    """Return what a late penalty leaves of ``points``, rounded to hundredths; whole numbers are an int."""
    return None if points is None else whole(round(points - penalty, 2))


def whole(number: float) -> float:
    """Return the number as an int if it is whole."""
    return int(number) if number == int(number) else number


def total_percent(rows: Iterable[GradeRow], *, graded: bool = False) -> float | None:
    """Return one student's weighted percentage of the course from the rows of the assignments; ungraded ones
    count 0, or are left out if ``graded``. None if no weight is left.
    """
    counted = [row for row in rows if row.max_points and not (graded and row.final is None)]
    weights = sum(row.weight for row in counted)
    return round(sum(row.weight * (row.percent or 0.0) for row in counted) / weights, 2) if weights else None


def moment(at: datetime | None) -> str | None:
    """Return the time as ISO 8601 in UTC, to the second; None for None."""
    return None if at is None else at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def rows(files: Sequence[GradedFile], assignment: Assignment) -> list[GradeRow]:
    """Return a row for each file. The student is the file's stem, or its path where several files share a
    stem.
    """
    stems = Counter(file.file.stem for file in files)
    return [
        row(file, assignment, "" if stems[file.file.stem] == 1 else file.file.with_suffix("").as_posix())
        for file in files
    ]


def row(file: GradedFile, assignment: Assignment, student: str = "") -> GradeRow:
    """Return the row of one file: 0 points for a refused file, None after a system fault."""
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
    if (report := file.report) is None:
        return about
    outcomes = report.outcomes()
    return replace(
        about,
        status="graded",
        counted=report.max_score,
        grader=(
            f"polhode {report.provenance.versions.get('polhode', '')}, assignment version {report.version}"
        ),
        checks={outcome.id: state(outcome, report.scene_ends) for outcome in outcomes},
        worth={outcome.id: outcome.points for outcome in outcomes},
        earned={outcome.id: outcome.earned for outcome in outcomes},
    )
