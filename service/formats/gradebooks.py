"""Grades as CSV files for other gradebooks: Canvas and Moodle import them, scripts read nbgrader's columns.

Each function takes one row per student. Canvas and Moodle clear an existing grade where the cell is empty, so their files
leave out students without points.
"""

import re
from collections.abc import Sequence
from datetime import UTC, datetime

from service.formats.grade_row import GradeRow
from service.formats.spreadsheet_csv import Value, cell, table

CANVAS_HEADER = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
POSSIBLE = "Points Possible"
RESERVED = re.compile(r"(Current|Final|Override) (Score|Points|Grade|Status)")

MOODLE_HEADER = ("Username", "ID number", "Email address")
NO_USER = "(none)"

NBGRADER_COLUMNS = (
    "assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score", "late_submission_penalty",
    "score", "max_score",
)  # fmt: skip


def canvas_csv(rows: Sequence[GradeRow], title: str, max_points: int) -> str:
    """Return the CSV of one assignment for Canvas (Grades, Import).

    Canvas finds a student by the first of ID, SIS User ID, SIS Login ID and name that matches. A sixth column is an assignment
    of that title, which Canvas creates if it does not exist. The row "Points Possible" holds its maximum.
    """
    possible = [f"    {POSSIBLE}", None, None, None, None, max_points]
    graded = [row for row in rows if row.points is not None]
    names = [row.name.replace(POSSIBLE, "Points-Possible") for row in graded]  # else Canvas reads the row as the one above
    students = [[name, None, row.student_id, row.student, None, row.points] for name, row in zip(names, graded, strict=True)]
    return table([*CANVAS_HEADER, _canvas_title(title)], [possible, *students])


def _canvas_title(title: str) -> str:
    """Return the title, changed if Canvas would read it as one of its own columns or as an existing assignment's id."""
    if RESERVED.search(title) or title in (*CANVAS_HEADER, "LastName", "FirstName", "Integration ID", "Root Account"):
        title = RESERVED.sub(r"\1-\2", f"{title} (polhode)")
    return re.sub(r"\((\d+)\)$", r"[\1]", title)


def moodle_csv(rows: Sequence[GradeRow], title: str) -> str:
    """Return the CSV of one assignment for Moodle (Grades, Import, CSV file), in UTF-8 with commas and decimal points.

    The instructor chooses the column that identifies users when importing. One unknown user stops the import. Moodle assigns a
    row whose user cell is empty or 0 to the previous row's user, so such a cell becomes "(none)".
    """
    graded = [row for row in rows if row.points is not None]
    lines = [[*map(_moodle_user, (row.student, row.student_id, row.email)), row.points] for row in graded]
    return table([*MOODLE_HEADER, title], lines)


def _moodle_user(value: str) -> str:
    # PHP's CSV reader does not end the cell at a quote that follows a backslash.
    user = cell(re.sub(r'\\+(?="|$)', "", value))
    return NO_USER if user in ("", "0") else user


def nbgrader_csv(rows: Sequence[GradeRow]) -> str:
    """Return a CSV with the columns of ``nbgrader export`` (0.9), with line feeds and without a byte order mark.

    Students are sorted by last and first name, and each has a line: 0.0 points and no timestamp without a submission, empty
    scores while a submission is not graded. Times are UTC without a zone. polhode has no late penalty: ``raw_score`` and
    ``score`` are both the points, including overrides.
    """
    by_name = sorted(rows, key=lambda row: (*split_name(row.full_name), row.student))
    return table(NBGRADER_COLUMNS, [_nbgrader_line(row) for row in by_name], end="\n")


def split_name(full: str) -> tuple[str, str]:
    """Return the last and first name of a full name. The last name is the part before a comma, or else the last word."""
    if "," in full:
        last, _, first = full.partition(",")
    else:
        first, _, last = full.strip().rpartition(" ")
    return last.strip(), first.strip()


def _nbgrader_line(row: GradeRow) -> list[Value]:
    known = row.points is not None or row.submission is None
    score = float(row.points or 0) if known else None
    student: list[Value] = [row.student, *split_name(row.full_name), row.email]
    return [row.assignment, _naive(row.due_at), _naive(row.submitted_at), *student, score, 0.0, score, float(row.max_points)]


def _naive(at: datetime | None) -> str | None:
    return None if at is None else str(at.astimezone(UTC).replace(tzinfo=None))
