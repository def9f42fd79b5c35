"""The CSV read as Canvas's importer reads it: header, the row of points, who is matched by what."""

import csv
import io
import re

import pytest

from service.formats import canvas
from tests.service.formats.test_grades_csv import golden
from tests.support.grade_rows import CLASS, TITLE, row

ROSTER = {
    "by_sis": {"00815": "Ada", "00816": "Ben"},
    "by_login": {"ada": "Ada", "ben": "Ben", "cho": "Cho", "-ann": "Ann"},
    "by_name": {"Ann Lee": "Ann"},
}


def imported(text):
    """Points possible by assignment, and each line's student (None: Canvas asks who it is) with the new score."""
    header, *lines = csv.reader(io.StringIO(text, newline=""))
    assert "Student" in header[0] and "ID" in header[1]
    assert re.search(r"SIS\s+User\s+ID", header[2]) and re.search(r"SIS\s+Login\s+ID", header[3]) and "Section" in header[4]
    possible, scores = {}, []
    for line in lines:
        assert len(line) == len(header)
        if "Points Possible" in line[0]:
            possible |= dict(zip(header[5:], line[5:], strict=True))
            continue
        found = ROSTER["by_sis"].get(line[2]) or ROSTER["by_login"].get(line[3]) or ROSTER["by_name"].get(line[0])
        assert re.fullmatch(r"-?[0-9.,]+%?", line[5])  # empty would take away the score that is there
        scores.append((found, float(line[5])))
    return possible, scores


def test_the_golden_file():
    golden("canvas.csv", canvas.text(CLASS, TITLE, 2))


def test_whoever_has_points_is_found_and_nobody_else_has_a_row():
    assert imported(canvas.text(CLASS, TITLE, 2)) == ({TITLE: "2"}, [("Ada", 2.0), ("Ben", 1.0), ("Cho", 1.0)])


def test_a_user_name_that_looks_like_a_formula_is_found_by_another_column():
    told = [row("-ann", 2, full_name="Ann Lee"), row("-ann", 2, full_name="A. Lee"), row("-ann", 2, student_id="00815")]
    assert [who for who, _ in imported(canvas.text(told, TITLE, 2))[1]] == ["Ann", None, "Ada"]


def test_nobody_is_taken_for_the_row_of_points():
    possible, scores = imported(canvas.text([row("x", 1, full_name="Points Possible"), row("Points Possible", 1)], TITLE, 2))
    assert possible == {TITLE: "2"} and len(scores) == 2


@pytest.mark.parametrize("title", ["Lab (12)", "Final Score", "Unposted Current Grade", "Section", "Override Score (Fall)", "=1"])
def test_a_title_is_taken_for_a_new_assignment(title):
    shown = next(csv.reader(io.StringIO(canvas.text([], title, 2), newline="")))[5]
    assert (
        not re.search(r"\(\d+\)$", shown) and not canvas.RESERVED.search(shown) and shown not in canvas.HEADER and shown[0] != "="
    )
