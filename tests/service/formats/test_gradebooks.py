"""The CSV files read as the importers of Canvas and Moodle read them, and by the rules of nbgrader."""

import csv
import io
import re
from datetime import datetime

import pytest

from service.formats import gradebooks
from tests.service.formats.test_grades import golden
from tests.support.grade_rows import CLASS, TITLE, row

ROSTER = {
    "by_sis": {"00815": "Ada", "00816": "Ben"},
    "by_login": {"ada": "Ada", "ben": "Ben", "cho": "Cho", "-ann": "Ann"},
    "by_name": {"Ann Lee": "Ann"},
}


def imported_by_canvas(text):
    """Points possible by assignment, and each line's student (None: Canvas asks who it is) with the new
    score.
    """
    header, *lines = csv.reader(io.StringIO(text, newline=""))
    assert "Student" in header[0] and "ID" in header[1]
    assert (
        re.search(r"SIS\s+User\s+ID", header[2])
        and re.search(r"SIS\s+Login\s+ID", header[3])
        and "Section" in header[4]
    )
    possible, scores = {}, []
    for line in lines:
        assert len(line) == len(header)
        if "Points Possible" in line[0]:
            possible |= dict(zip(header[5:], line[5:], strict=True))
            continue
        found = (
            ROSTER["by_sis"].get(line[2]) or ROSTER["by_login"].get(line[3]) or ROSTER["by_name"].get(line[0])
        )
        assert re.fullmatch(r"-?[0-9.,]+%?", line[5])  # empty would take away the score that is there
        scores.append((found, float(line[5])))
    return possible, scores


def test_the_golden_file_of_canvas():
    golden("canvas.csv", gradebooks.canvas_csv(CLASS, TITLE, 2))


def test_canvas_finds_whoever_has_points_and_nobody_else_has_a_row():
    assert imported_by_canvas(gradebooks.canvas_csv(CLASS, TITLE, 2)) == (
        {TITLE: "2"},
        [("Ada", 2.0), ("Ben", 1.0), ("Cho", 1.0)],
    )


def test_a_user_name_that_looks_like_a_formula_is_found_by_another_column():
    told = [
        row("-ann", 2, full_name="Ann Lee"),
        row("-ann", 2, full_name="A. Lee"),
        row("-ann", 2, student_id="00815"),
    ]
    assert [who for who, _ in imported_by_canvas(gradebooks.canvas_csv(told, TITLE, 2))[1]] == [
        "Ann",
        None,
        "Ada",
    ]


def test_nobody_is_taken_for_the_row_of_points():
    possible, scores = imported_by_canvas(
        gradebooks.canvas_csv([row("x", 1, full_name="Points Possible"), row("Points Possible", 1)], TITLE, 2)
    )
    assert possible == {TITLE: "2"} and len(scores) == 2


@pytest.mark.parametrize(
    "title", ["Lab (12)", "Final Score", "Unposted Current Grade", "Section", "Override Score (Fall)", "=1"]
)
def test_a_title_is_taken_for_a_new_assignment(title):
    shown = next(csv.reader(io.StringIO(gradebooks.canvas_csv([], title, 2), newline="")))[5]
    assert (
        not re.search(r"\(\d+\)$", shown)
        and not gradebooks.RESERVED.search(shown)
        and shown not in gradebooks.CANVAS_HEADER
        and shown[0] != "="
    )


USERS = {"Username": {"ada", "ben", "cho", "x"}, "Email address": {"ada@uni.example", "ben@uni.example"}}


class Stopped(Exception):
    """The importer takes nothing of the file."""


def imported_by_moodle(text, by):
    """The grades by user, where column ``by`` tells the user: as the importer goes through the rows."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    header, *lines = csv.reader(io.StringIO(text, newline=""), escapechar="\\", strict=True)
    user, grades = None, []
    for line in lines:
        if len(line) != len(header):
            raise Stopped("the number of columns")
        value = line[header.index(by)].strip()
        if value not in ("", "0"):
            if value not in USERS[by]:
                raise Stopped(value)
            user = value
        grades.append((user, float(line[header.index(TITLE)])))
    return grades


def test_the_golden_file_of_moodle():
    golden("moodle.csv", gradebooks.moodle_csv(CLASS, TITLE))


def test_whoever_has_points_gets_them():
    assert imported_by_moodle(gradebooks.moodle_csv(CLASS, TITLE), "Username") == [
        ("ada", 2.0),
        ("ben", 1.0),
        ("cho", 1.0),
    ]


@pytest.mark.parametrize("email", ["", " ", "0", "\x01"])
def test_nobody_gets_the_points_of_whom_nothing_is_known(email):
    text = gradebooks.moodle_csv([CLASS[0], row("x", 1, email=email)], TITLE)
    with pytest.raises(Stopped, match=r"\(none\)"):
        imported_by_moodle(text, "Email address")
    assert imported_by_moodle(text, "Username") == [("ada", 2.0), ("x", 1.0)]


def test_a_user_name_that_looks_like_a_formula_stops_the_import_and_is_named():
    with pytest.raises(Stopped, match="'-ann"):
        imported_by_moodle(gradebooks.moodle_csv([row("-ann", 1)], TITLE), "Username")


@pytest.mark.parametrize("email", ['a,"\\', 'a,\\",17\nben', "a,b\\\\"])
def test_no_cell_swallows_the_next(email):
    text = gradebooks.moodle_csv([row("x", 1, email=email), CLASS[1]], TITLE)
    assert imported_by_moodle(text, "Username") == [("x", 1.0), ("ben", 1.0)]


def test_the_golden_file_of_nbgrader():
    golden("nbgrader.csv", gradebooks.nbgrader_csv(CLASS))


def test_the_rules_of_nbgrader():
    lines = list(csv.DictReader(io.StringIO(gradebooks.nbgrader_csv(CLASS), newline="")))
    assert len(lines) == len(CLASS)
    for line in lines:
        if line["score"]:
            assert float(line["score"]) == max(
                0.0, float(line["raw_score"]) - float(line["late_submission_penalty"])
            )
        for name in ("duedate", "timestamp"):
            assert line[name] == "" or datetime.fromisoformat(line[name]).tzinfo is None
    by_student = {line["student_id"]: line for line in lines}
    assert by_student["dora"]["score"] == "0.0" and by_student["dora"]["timestamp"] == ""
    assert by_student["eve"]["score"] == "" and by_student["eve"]["timestamp"]  # a fault of ours is no zero
    keys = [(line["last_name"], line["first_name"]) for line in lines]
    assert keys == sorted(keys)


@pytest.mark.parametrize(
    ("full", "split"),
    [
        ("Ada Lovelace", ("Lovelace", "Ada")),
        ("van Dyk, Ben", ("van Dyk", "Ben")),
        ("Plato", ("Plato", "")),
        ("", ("", "")),
        ("A B C", ("C", "A B")),
    ],
)
def test_names(full, split):
    assert gradebooks.split_name(full) == split


def test_a_formula_split_off_a_name_is_none():
    assert "'=1+1,'=2" in gradebooks.nbgrader_csv([row("x", 1, full_name="=1+1, =2")])
