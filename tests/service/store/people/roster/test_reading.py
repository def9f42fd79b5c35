"""Rosters as tools and people write them: who is in them, and what is asked about."""

import re

import pytest

from service.store.people.roster.columns import BEFORE_AT
from service.store.people.roster.reading import Choices, Entry, read

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
ANN = Entry("ann@uni.example", "student", "Ann Lee", "ann@uni.example", "0042", "A", "Lee")


def sentences(found):
    return {question.sentence: [*question.details] for question in found.questions}


@pytest.mark.parametrize(
    ("content", "login", "entries", "unused"),
    [
        (
            GRADESCOPE,
            "Email",
            [ANN, Entry("bo@uni.example", "assistant", "Bo Ek", "bo@uni.example", "7", None, "Ek")],
            [],
        ),
        (
            CANVAS,
            "SIS Login ID",
            [
                Entry("alee", None, "Lee, Ann", None, "0042", "A"),
                Entry("bek", None, "Ek, Bo", None, "7", "A"),
            ],
            ["ID", "Problem set 1 (17)"],
        ),
        (MOODLE, "Username", [ANN._replace(name="alee", role=None)], []),
        (PRAIRIELEARN, "UID", [ANN._replace(email=None, section=None, surname=None)], []),
        ("Name;Full name\nann;Ann Lee\n", "Name", [Entry("ann", None, "Ann Lee")], []),
        ("name;;\nann;;\n", "name", [Entry("ann")], []),
        ("name,role\nann\n", "name", [Entry("ann")], []),
    ],
)
def test_rosters_of_other_tools_need_no_question(content, login, entries, unused):
    for encoded in (
        content.encode(),
        content.encode("utf-8-sig"),
        content.replace("\n", "\r\n").encode("utf-16"),
    ):
        found = read(encoded, "r.csv")
        assert (found.columns.headings["login"], [*found.entries]) == (login, entries)
        assert [heading for heading in found.columns.unused if not heading.startswith("(")] == unused
        assert (found.errors, found.questions) == ([], [])


def test_a_line_of_canvas_without_an_id_is_no_person():
    assert read(CANVAS.encode(), "r.csv").notes == ["line 2 is not a person: Points Possible"]


# Eight rosters with what goes wrong in them: name, content, the entries, and what is asked.
STUDIP = "Nachname;Vorname;E-Mail;Matrikelnummer;Rolle;Gruppe\n"
MESSY = {
    "an address twice, staff among the students": (
        f"\ufeff{STUDIP}Müller;Änne;am@u.de;0012;Student;A\n"
        "Hu;Ida;hu@u.de;;Dozent/in;\n"
        "To;Ti;ti@u.de;;Tutor/in;\nMüller;Änne;am@u.de;0012;Studierende;B\n".encode(),
        [
            Entry("am@u.de", "student", "Änne Müller", "am@u.de", "0012", "A, B", "Müller"),
            Entry("hu@u.de", "instructor", "Ida Hu", "hu@u.de", None, None, "Hu"),
            Entry("ti@u.de", "assistant", "Ti To", "ti@u.de", None, None, "To"),
        ],
        {"1 person is listed more than once; the lines are merged.": ["lines 2 and 5: am@u.de"]},
    ),
    "a teacher who is also a student": (
        f"{STUDIP}Hu;Ida;hu@u.de;;Dozentin;\nHu;Ida;HU@u.de;;Student;\nHu;Ida;hu@u.de;;Student;\n".encode(),
        [
            Entry("hu@u.de", "instructor", "Ida Hu", "hu@u.de", None, None, "Hu"),
            Entry("HU@u.de", "student", "Ida Hu", "HU@u.de", None, None, "Hu"),
        ],
        {
            "1 person is listed more than once; the lines are merged.": ["lines 2 and 4: hu@u.de"],
            "Several login names share an email address; each becomes a person of their own.": [
                "hu@u.de: hu@u.de, HU@u.de"
            ],
        },
    ),
    "a title above, another encoding, an unknown column": (
        "Mechanik II;;\nVorname;Nachname;Nutzername;Schuhgröße\nJosé;Größ;jgr;43\n".encode("cp1252"),
        [Entry("jgr", None, "José Größ", None, None, None, "Größ")],
        {
            "The file is not in UTF-8 and was read as Windows-1252: these words must look right.": [
                "Schuhgröße", "José", "Größ",
            ],
            "These lines above the headings are skipped.": ["Mechanik II"],
            "These columns are not understood and not imported.": ["Schuhgröße"],
        },
    ),
    "two logins of one address and of one student ID": (
        b"login,full_name,email,student_id\nann,Ann Lee,a@x.org,7\nalee,Ann Lee,A@x.org,\n"
        b"bo,Bo Ek,b@x.org,7\n",
        [
            Entry("ann", None, "Ann Lee", "a@x.org", "7"),
            Entry("alee", None, "Ann Lee", "A@x.org"),
            Entry("bo", None, "Bo Ek", "b@x.org", "7"),
        ],
        {
            "Several login names share an email address; each becomes a person of their own.": [
                "a@x.org: ann, alee"
            ],
            "Several login names share a student ID; each becomes a person of their own.": ["7: ann, bo"],
        },
    ),
    "lines without a login name": (
        b"Username,Name,Email\nann,Ann Lee,a@x.org\n,Bo Ek,b@x.org\n,,\n,Total,\n",
        [Entry("ann", None, "Ann Lee", "a@x.org")],
        {"2 lines have no login name and will be skipped.": ["line 3: Bo Ek, b@x.org", "line 5: Total"]},
    ),
    "roles that nobody knows": (
        b"name,role\nann,king\nbo,student\ncem,king\ndan,\n",
        [Entry("bo", "student"), Entry("dan")],
        {"The role \u201cking\u201d is not understood: 2 people are skipped.": ["lines 2 and 4"]},
    ),
    "letters read wrongly before, and a number that Excel rounded": (
        "name,full_name,student_id\nann,Ann MÃ¼ller,\nbo,Bo Gr\N{REPLACEMENT CHARACTER},\n"
        'cem,Cem,"1,23E+09"\n'.encode(),
        [
            Entry("ann", None, "Ann MÃ¼ller"),
            Entry("bo", None, "Bo Gr\N{REPLACEMENT CHARACTER}"),
            Entry("cem", None, "Cem", None, "1,23E+09"),
        ],
        {
            "Letters or numbers look damaged: save the file again as CSV UTF-8.": [
                "line 2: Ann MÃ¼ller", "line 3: Bo Gr\N{REPLACEMENT CHARACTER}", "line 4: 1,23E+09",
            ]
        },
    ),
    "headings twice, and none": (
        b"E-Mail;E-Mail;Nachname;;Vorname\na@u.de;b@u.de;Lee;?;Ann\n",
        [Entry("a@u.de", None, "Ann Lee", "a@u.de", None, None, "Lee")],
        {"These columns are not understood and not imported.": ["E-Mail (column 2)", "(column 4)"]},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MESSY)
def test_a_messy_roster_keeps_its_people_and_asks(name):
    content, entries, asked = MESSY[name]
    found = read(content, "r.csv")
    assert ([*found.entries], sentences(found), found.errors) == (entries, asked, [])


@pytest.mark.parametrize(
    ("content", "errors"),
    [
        (
            b"Student,Email\nLee, Ann,a@x.org\n",
            "line 2 has more cells than there are columns: put a value that contains the separator",
        ),
        (
            b"Vorname;Nachname;E-Mail\nAnn;Lee;x@u.de\nBo;Ek;x@u.de\n",
            r"lines 2 and 3: x@u.de has different values \(full name Ann Lee and Bo Ek\): keep one line",
        ),
        (b"name\n" + b"x" * 300 + b"\n", "line 2: a name must have 1 to 200"),
        (b"name,email\nann,a\x07b\n", "line 2: the email address must have at most 200 printable characters"),
        (b"name\n", "nobody would be imported: add a line for each person"),
        (b"shoe,size\n1,2\n", "no column holds login names: .* it has shoe, size: choose the column"),
    ],
)
def test_what_contradicts_itself_must_be_corrected(content, errors):
    (error,) = read(content, "r.csv").errors
    assert re.match(errors, error)


def test_all_errors_are_told_at_once():
    assert len(read(b"name,email\nann,a\x07\n\x07,b\nbo,c,d\n", "r.csv").errors) == 3


def test_columns_roles_and_encoding_can_be_chosen():
    chosen = Choices({"login": "SID"})
    assert read(GRADESCOPE.encode(), "r.csv", chosen).entries[0] == ANN._replace(name="0042")
    chosen = Choices({"login": BEFORE_AT, "section": ""})
    assert read(GRADESCOPE.encode(), "r.csv", chosen).entries[0] == ANN._replace(name="ann", section=None)
    found = read(
        b"name,role\nann,king\nbo,page\n", "r.csv", Choices(roles={"king": "instructor", "page": "skip"})
    )
    assert [*found.entries] == [Entry("ann", "instructor")]
    assert [*sentences(found)] == ["The role \u201cpage\u201d is not understood: 1 person is skipped."]
    found = read("name,full_name\nann,Łoś\n".encode("cp1250"), "r.csv", Choices(encoding="Windows-1250"))
    assert (found.entries[0].full_name, found.questions) == ("Łoś", [])


def test_ten_thousand_lines_are_read_within_seconds():
    content = STUDIP + "".join(f"N{k};V{k};p{k}@u.de;{k};Student;A\n" for k in range(10_000))
    found = read(content.encode(), "r.csv")
    assert len(found.entries) == 10_000 and not found.questions
