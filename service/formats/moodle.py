"""CSV for Moodle: Grades, Import, CSV file.

Its rules: UTF-8, commas, a decimal point; whoever imports says which column tells the user by what, and which is the grade. One
user who is not found stops the import. A row in which the user's cell is empty, or 0, goes to the user of the row before: no cell
is. An empty grade takes away one that is there, or is a 0 in a new item, so who has no points has no row.
"""

import re
from collections.abc import Sequence

from service.formats.csv import Value, cell, table
from service.formats.grade_row import GradeRow

HEADER = ("Username", "ID number", "Email address")
NOBODY = "(none)"


def text(rows: Sequence[GradeRow], title: str) -> str:
    """The CSV of one assignment."""
    return table([*HEADER, title], [_line(row) for row in rows if row.points is not None])


def _line(row: GradeRow) -> list[Value]:
    return [*map(_key, (row.student, row.student_id, row.email)), row.points]


def _key(value: str) -> str:
    """PHP takes a quote after a backslash for one that does not end the cell."""
    shown = cell(re.sub(r'\\+(?="|$)', "", value))
    return NOBODY if shown in ("", "0") else shown
