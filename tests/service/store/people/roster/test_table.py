"""The separator, the headings and the lines of a roster."""

import pytest

from service.store.people.roster.problems import BadRoster
from service.store.people.roster.table import read_table
from service.store.people.roster.text import Text


def table(text):
    return read_table(Text(text, "UTF-8"), "r.csv")


@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_separator_and_line_ends_are_found(separator, end):
    rows = ["Vorname", "E-Mail"], ["Änne", "a, b; c"], [], ["Bo", ""]
    quoted = [separator.join(f'"{cell}"' for cell in row) for row in rows]
    found = table(end.join(quoted) + end)
    assert found.headings == ["Vorname", "E-Mail"]
    assert [(line.number, [*line.cells]) for line in found.lines] == [(2, rows[1]), (4, rows[3])]


def test_excel_may_name_the_separator():
    assert table("sep=;\nname;role\nann;student\n").headings == ["name", "role"]


def test_lines_above_the_headings_are_kept_apart():
    found = table("Course 7;;\nPrinted, on; Monday;\nNachname;Vorname;Login\nLee;Ann;alee\n")
    assert found.headings == ["Nachname", "Vorname", "Login"]
    assert [line.number for line in found.above] == [1, 2]
    assert [line.number for line in found.lines] == [4]


def test_missing_and_repeated_headings_get_a_number():
    assert table("Email,,Email,Name\na,b,c,d\n").headings == [
        "Email",
        "(column 2)",
        "Email (column 3)",
        "Name",
    ]


def test_without_a_known_heading_the_first_line_has_the_headings():
    assert table("shoe;size\nstudent;1\n").headings == ["shoe", "size"]


def test_empty_columns_at_the_end_are_none():
    assert table("name;;\nann;;\n").headings == ["name"]
    assert table("name;;\nann;1;\n").headings == ["name", "(column 2)"]


def test_a_file_of_very_many_columns_is_refused():
    with pytest.raises(BadRoster, match="more than 500 columns: leave those that are about people"):
        table(",".join(f"c{k}" for k in range(501)))


@pytest.mark.parametrize("text", ["", "\n\n"])
def test_an_empty_file_is_refused(text):
    with pytest.raises(BadRoster, match="is empty: choose the file with the roster"):
        table(text)
