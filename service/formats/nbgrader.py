"""CSV with the columns of ``nbgrader export`` (0.9), for scripts that read those.

Its rules: every student, by last and first name, has a line; who sent nothing has 0.0 and no timestamp; score is raw_score less
the penalty and never below 0; times are UTC without zone; what is not known is empty. We have no penalty for lateness, so that
both scores are the points, with what was given for them; of what is sent and not graded yet neither is known.
"""

from collections.abc import Sequence
from datetime import UTC, datetime

from service.formats.csv import Value, table
from service.formats.grade_row import GradeRow

COLUMNS = (
    "assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score", "late_submission_penalty",
    "score", "max_score",
)  # fmt: skip


def text(rows: Sequence[GradeRow]) -> str:
    """The CSV, with line feeds and without byte order mark, as nbgrader writes it."""
    return table(COLUMNS, [_line(row) for row in sorted(rows, key=lambda row: (*names(row.full_name), row.student))], end="\n")


def names(full: str) -> tuple[str, str]:
    """Last and first name of a full name: what stands before a comma, else its last word."""
    if "," in full:
        last, _, first = full.partition(",")
    else:
        first, _, last = full.strip().rpartition(" ")
    return last.strip(), first.strip()


def _line(row: GradeRow) -> list[Value]:
    known = row.points is not None or row.submission is None
    score = float(row.points or 0) if known else None
    who: list[Value] = [row.student, *names(row.full_name), row.email]
    return [row.assignment, _naive(row.due_at), _naive(row.submitted_at), *who, score, 0.0, score, float(row.max_points)]


def _naive(at: datetime | None) -> str | None:
    return None if at is None else str(at.astimezone(UTC).replace(tzinfo=None))
