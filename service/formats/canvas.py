"""CSV for Canvas: Grades, Import.

Its rules: the header begins with Student and ID, then SIS User ID, SIS Login ID and Section; a student is found by the first of
ID, SIS User ID, SIS Login ID and name that fits; a column beyond is an assignment of that title, made if there is none, and the
row "Points Possible" tells what it has. An empty cell takes away a score that is there, so who has no points has no row.
"""

import re
from collections.abc import Sequence

from service.formats.csv import table
from service.formats.grade_row import GradeRow

HEADER = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
POSSIBLE = "Points Possible"
RESERVED = re.compile(r"(Current|Final|Override) (Score|Points|Grade|Status)")


def text(rows: Sequence[GradeRow], title: str, max_points: int) -> str:
    """The CSV of one assignment."""
    possible = [f"    {POSSIBLE}", None, None, None, None, max_points]
    students = [[_name(row), None, row.student_id, row.student, None, row.points] for row in rows if row.points is not None]
    return table([*HEADER, column(title)], [possible, *students])


def column(title: str) -> str:
    """The title as a column that Canvas takes for an assignment, and not for the one with some number or a total of its own."""
    if RESERVED.search(title) or title in (*HEADER, "LastName", "FirstName", "Integration ID", "Root Account"):
        title = RESERVED.sub(r"\1-\2", f"{title} (polhode)")
    return re.sub(r"\((\d+)\)$", r"[\1]", title)


def _name(row: GradeRow) -> str:
    """Whoever is called like the row that tells what an assignment has would be taken for it."""
    return row.name.replace(POSSIBLE, "Points-Possible")
