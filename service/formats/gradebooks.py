"""Grades as CSV files for other gradebooks: Canvas and Moodle import them, scripts read nbgrader's and
Gradescope's columns.

Each function takes one row per student. Canvas and Moodle clear an existing grade where the cell is empty, so
their files leave out students without points.
"""

import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from service.formats.grade_row import GradeRow
from service.formats.spreadsheet_csv import Value, cell, table

CANVAS_HEADER = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
POSSIBLE = "Points Possible"
RESERVED = re.compile(r"(Current|Final|Override) (Score|Points|Grade|Status)")

MOODLE_HEADER = ("Username", "ID number", "Email address")
NO_USER = "(none)"

NBGRADER_COLUMNS = (
    "assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score",
    "late_submission_penalty",
    "score", "max_score",
)  # fmt: skip

GRADESCOPE_COLUMNS = (
    "First Name", "Last Name", "SID", "Email", "Sections", "Total Score", "Max Points", "Status",
    "Submission ID",
    "Submission Time", "Lateness (H:M:S)", "View Count", "Submission Count",
)  # fmt: skip


def canvas_csv(rows: Sequence[GradeRow], title: str, max_points: int) -> str:
    """Return the CSV of one assignment for Canvas (Grades, Import).

    Canvas finds a student by the first of ID, SIS User ID, SIS Login ID and name that matches. A sixth column
    is an assignment of that title, which Canvas creates if it does not exist. The row "Points Possible" holds
    its maximum.
    """
    possible = [f"    {POSSIBLE}", None, None, None, None, max_points]
    graded = [row for row in rows if row.points is not None]
    names = [
        row.name.replace(POSSIBLE, "Points-Possible") for row in graded
    ]  # else Canvas reads the row as the one above
    students = [
        [name, None, row.student_id, row.student, None, row.final]
        for name, row in zip(names, graded, strict=True)
    ]
    return table([*CANVAS_HEADER, _canvas_title(title)], [possible, *students])


def _canvas_title(title: str) -> str:
    """Return the title, changed if Canvas would read it as one of its own columns or as an existing
    assignment's id.
    """
    if RESERVED.search(title) or title in (
        *CANVAS_HEADER,
        "LastName",
        "FirstName",
        "Integration ID",
        "Root Account",
    ):
        title = RESERVED.sub(r"\1-\2", f"{title} (polhode)")
    return re.sub(r"\((\d+)\)$", r"[\1]", title)


def moodle_csv(rows: Sequence[GradeRow], title: str) -> str:
    """Return the CSV of one assignment for Moodle (Grades, Import, CSV file), in UTF-8 with commas and
    decimal points.

    The instructor chooses the column that identifies users when importing. One unknown user stops the import.
    Moodle assigns a row whose user cell is empty or 0 to the previous row's user, so such a cell becomes
    "(none)".
    """
    graded = [row for row in rows if row.points is not None]
    lines = [[*map(_moodle_user, (row.student, row.student_id, row.email)), row.final] for row in graded]
    return table([*MOODLE_HEADER, title], lines)


def _moodle_user(value: str) -> str:
    # PHP's CSV reader does not end the cell at a quote that follows a backslash.
    user = cell(re.sub(r'\\+(?="|$)', "", value))
    return NO_USER if user in ("", "0") else user


def nbgrader_csv(rows: Sequence[GradeRow]) -> str:
    """Return a CSV with the columns of ``nbgrader export`` (0.9), with line feeds and without a byte order
    mark.

    Students are sorted by last and first name, and each has a line: 0.0 points and no timestamp without a
    submission, empty scores while a submission is not graded. Times are UTC without a zone. ``raw_score`` are
    the points, including overrides, and ``score`` is what the late penalty leaves of them.
    """
    by_name = sorted(rows, key=lambda row: (*split_name(row.full_name), row.student))
    return table(NBGRADER_COLUMNS, [_nbgrader_line(row) for row in by_name], end="\n")


def gradescope_csv(rows: Sequence[GradeRow]) -> str:
    """Return a CSV with the columns of Gradescope's grades of one assignment, for scripts that read them.

    Students without a submission are Missing; lateness is counted from the student's own deadline.
    """
    return table(GRADESCOPE_COLUMNS, [_gradescope_line(row) for row in rows])


def _gradescope_line(row: GradeRow) -> list[Value]:
    last, first = split_name(row.full_name)
    status = "Missing" if row.submission is None else "Ungraded" if row.points is None else "Graded"
    seconds = int((row.lateness or timedelta()).total_seconds())
    late = f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}" if row.submission else None
    at = f"{row.submitted_at.astimezone(UTC):%Y-%m-%d %H:%M:%S} +0000" if row.submitted_at else None
    score: list[Value] = [
        row.final,
        float(row.max_points),
        status,
        row.submission,
        at,
        late,
        None,
        row.attempts,
    ]
    return [first, last, row.student_id, row.email or row.student, None, *score]


def split_name(full: str) -> tuple[str, str]:
    """Return the last and first name of a full name. The last name is the part before a comma, or else the
    last word.
    """
    if "," in full:
        last, _, first = full.partition(",")
    else:
        first, _, last = full.strip().rpartition(" ")
    return last.strip(), first.strip()


def _nbgrader_line(row: GradeRow) -> list[Value]:
    known = row.points is not None or row.submission is None
    raw, score = (float(points or 0) if known else None for points in (row.points, row.final))
    about: list[Value] = [
        row.assignment,
        _naive(row.due_at),
        _naive(row.submitted_at),
        row.student,
        *split_name(row.full_name),
    ]
    return [*about, row.email, raw, float(row.penalty), score, float(row.max_points)]


def _naive(at: datetime | None) -> str | None:
    return None if at is None else str(at.astimezone(UTC).replace(tzinfo=None))
