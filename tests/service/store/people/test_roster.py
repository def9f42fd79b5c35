"""Rosters in polhode's own columns and in those of other tools."""

import pytest

from service.store.people.roster import BEFORE_AT, BadRoster, Entry, read

GRADESCOPE = (
    "First Name,Last Name,SID,Email,Role,Section\nAnn,Lee,0042,ann@uni.example,Student,A\n"
    "Bo,Ek,7,bo@uni.example,TA,\n"
)
CANVAS = (
    "Student,ID,SIS User ID,SIS Login ID,Section,Problem set 1 (17)\n    Points Possible,,,,,10\n"
    '"Lee, Ann",991,0042,alee,A,7\n"Ek, Bo",992,7,bek,A,\n'
)
MOODLE = "First name;Last name;ID number;Email address;Username;Groups\nAnn;Lee;0042;ann@uni.example;alee;A\n"
PRAIRIELEARN = "UID\tUIN\tName\tRole\nann@uni.example\t0042\tAnn Lee\tStudent\n"
OWN = "Name;Full name\nann;Ann Lee\n"


@pytest.mark.parametrize(
    ("content", "login", "entries", "unused"),
    [
        (
            GRADESCOPE,
            "Email",
            [
                Entry("ann@uni.example", "student", "Ann Lee", "ann@uni.example", "0042"),
                Entry("bo@uni.example", "assistant", "Bo Ek", "bo@uni.example", "7"),
            ],
            ["Section"],
        ),
        (
            CANVAS,
            "SIS Login ID",
            [Entry("alee", None, "Lee, Ann", None, "0042"), Entry("bek", None, "Ek, Bo", None, "7")],
            ["ID", "Section", "Problem set 1 (17)"],
        ),
        (MOODLE, "Username", [Entry("alee", None, "Ann Lee", "ann@uni.example", "0042")], ["Groups"]),
        (PRAIRIELEARN, "UID", [Entry("ann@uni.example", "student", "Ann Lee", None, "0042")], []),
        (OWN, "Name", [Entry("ann", None, "Ann Lee")], []),
        ("name;;\nann;;\n", "name", [Entry("ann")], []),
        ("Name,Email\nann,a@x.org\n", "Name", [Entry("ann", None, None, "a@x.org")], []),
        ("Name,SID,shoe\nAnn Lee,7,1\n", "Name", [Entry("Ann Lee", None, None, None, "7")], ["shoe"]),
    ],
)
def test_columns_and_separators_of_other_tools(content, login, entries, unused):
    for encoded in (
        content.encode(),
        content.encode("utf-8-sig"),
        content.replace("\n", "\r\n").encode("utf-16"),
    ):
        found = read(encoded, "r.csv")
        assert (found.login, list(found.entries), list(found.unused)) == (login, entries, unused)


def test_the_login_name_is_of_the_column_that_is_chosen():
    ann, _ = read(GRADESCOPE.encode(), "r.csv", "SID").entries
    assert ann == Entry("0042", "student", "Ann Lee", "ann@uni.example", "0042")
    found = read(GRADESCOPE.encode(), "r.csv", BEFORE_AT)
    assert (
        found.entries[0] == Entry("ann", "student", "Ann Lee", "ann@uni.example", "0042")
        and BEFORE_AT in found.choices
    )
    with pytest.raises(BadRoster, match="name the columns"):
        read(GRADESCOPE.encode(), "r.csv", "Shoe")
    assert BEFORE_AT not in read(b"name\nann\n", "r.csv").choices


@pytest.mark.parametrize("content", [b"", b"shoe\n1\n", b"name,name\nann,ann\n", b"\n\n"])
def test_a_file_without_a_login_name_is_refused(content):
    with pytest.raises(
        BadRoster, match="name the columns, each once, separated by commas, semicolons or tabs"
    ):
        read(content, "r.csv")
