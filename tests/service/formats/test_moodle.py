"""The CSV read as Moodle's importer reads it: PHP's quotes, one column that tells the user, and no row without one."""

import csv
import io

import pytest

from service.formats import moodle
from tests.service.formats.test_grades_csv import golden
from tests.support.grade_rows import CLASS, TITLE, row

USERS = {"Username": {"ada", "ben", "cho", "x"}, "Email address": {"ada@uni.example", "ben@uni.example"}}


class Stopped(Exception):
    """The importer takes nothing of the file."""


def imported(text, by):
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


def test_the_golden_file():
    golden("moodle.csv", moodle.text(CLASS, TITLE))


def test_whoever_has_points_gets_them():
    assert imported(moodle.text(CLASS, TITLE), "Username") == [("ada", 2.0), ("ben", 1.0), ("cho", 1.0)]


@pytest.mark.parametrize("email", ["", " ", "0", "\x01"])
def test_nobody_gets_the_points_of_whom_nothing_is_known(email):
    told = moodle.text([CLASS[0], row("x", 1, email=email)], TITLE)
    with pytest.raises(Stopped, match=r"\(none\)"):
        imported(told, "Email address")
    assert imported(told, "Username") == [("ada", 2.0), ("x", 1.0)]


def test_a_user_name_that_looks_like_a_formula_stops_the_import_and_is_named():
    with pytest.raises(Stopped, match="'-ann"):
        imported(moodle.text([row("-ann", 1)], TITLE), "Username")


@pytest.mark.parametrize("email", ['a,"\\', 'a,\\",17\nben', "a,b\\\\"])
def test_no_cell_swallows_the_next(email):
    told = moodle.text([row("x", 1, email=email), CLASS[1]], TITLE)
    assert imported(told, "Username") == [("x", 1.0), ("ben", 1.0)]
