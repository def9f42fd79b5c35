"""Our own CSV: an assignment with a column for each check, and the whole course."""

from collections.abc import Sequence

from service.formats.csv import BYTE_ORDER_MARK, Value, table
from service.formats.grade_row import GradeRow, moment

PERSON = ("student", "full_name", "email", "student_id")
GRADE = ("points", "max_points", "percent", "late", "submitted_at", "graded_at", "attempts", "overridden", "grader", "submission")
MORE = ("status", "score", "counted")


def assignment_csv(rows: Sequence[GradeRow], checks: Sequence[str]) -> str:
    """A line for each student of one assignment; a check's state is followed by "(override)" where somebody gave it."""
    return BYTE_ORDER_MARK + table([*PERSON, *GRADE, *MORE, *checks], [[*_grade(row), *_states(row, checks)] for row in rows])


def course_csv(rows: Sequence[GradeRow]) -> str:
    """A line for each student, with points and most points of every assignment, from the rows of all assignments."""
    slugs = list(dict.fromkeys(row.assignment for row in rows))
    header = [*PERSON, *(f"{slug} {what}" for slug in slugs for what in ("points", "max_points"))]
    by_student: dict[str, dict[str, GradeRow]] = {}
    for row in rows:
        by_student.setdefault(row.student, {})[row.assignment] = row
    lines = [[*_person(next(iter(of.values()))), *_pairs(of, slugs)] for of in by_student.values()]
    return BYTE_ORDER_MARK + table(header, lines)


def _person(row: GradeRow) -> list[Value]:
    return [row.student, row.full_name, row.email, row.student_id]


def _grade(row: GradeRow) -> list[Value]:
    points: list[Value] = [row.points, row.max_points, row.percent, row.late, moment(row.submitted_at), moment(row.graded_at)]
    overridden = row.overridden if row.submission else None
    return [*_person(row), *points, row.attempts, overridden, row.grader, row.submission, row.status, row.score, row.counted]


def _states(row: GradeRow, checks: Sequence[str]) -> list[Value]:
    shown = {check: row.state(check) for check in checks}
    return [f"{state} (override)" if state and check in row.given else state for check, state in shown.items()]


def _pairs(of: dict[str, GradeRow], slugs: Sequence[str]) -> list[Value]:
    return [value for slug in slugs for value in ((of[slug].points, of[slug].max_points) if slug in of else (None, None))]
