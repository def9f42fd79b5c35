"""What columns mean: guessed from the headings of many tools, or chosen."""

import pytest

from service.store.people.roster.columns import BEFORE_AT, choose
from service.store.people.roster.problems import BadRoster

MOODLE = ["Vorname", "Nachname", "ID-Nummer", "Abteilung", "E-Mail-Adresse", "Gruppen", "Rollen"]
MOODLE_FIELDS = {
    "first": "Vorname",
    "last": "Nachname",
    "student_id": "ID-Nummer",
    "email": "E-Mail-Adresse",
    "section": "Gruppen",
    "role": "Rollen",
    "login": "E-Mail-Adresse",
}


@pytest.mark.parametrize(
    ("headings", "fields"),
    [
        (MOODLE, MOODLE_FIELDS),
        (
            ["Anrede", "Vorname", "Nachname", "Nutzername", "E-Mail", "Matrikelnummer", "Studiengänge"],
            {"first": "Vorname", "last": "Nachname", "login": "Nutzername", "email": "E-Mail",
             "student_id": "Matrikelnummer"},
        ),
        (["FAMILIENNAME", "VORNAME", "MATRIKEL_NR"], {"last": "FAMILIENNAME", "first": "VORNAME",
                                                     "student_id": "MATRIKEL_NR"}),
        (["Name", "Vorname", "Mail"], {"last": "Name", "first": "Vorname", "email": "Mail", "login": "Mail"}),
        (["Name, Vorname", "Kennung"], {"full_name": "Name, Vorname", "login": "Kennung"}),
        (["name", "role", "section"], {"login": "name", "role": "role", "section": "section"}),
        (["UID", "UIN", "Name"], {"login": "UID", "student_id": "UIN", "full_name": "Name"}),
        (["Name", "SID", "shoe"], {"login": "Name", "student_id": "SID"}),
    ],
)  # fmt: skip
def test_columns_are_guessed(headings, fields):
    assert choose(headings, {}).headings == fields


def test_what_is_not_imported_is_known_or_unknown():
    found = choose([*MOODLE, "Schuhgröße"], {})
    assert (found.unused, found.unknown) == (["Abteilung"], ["Schuhgröße"])
    canvas = choose(["Student", "ID", "SIS Login ID", "Section", "Problem set 1 (17)"], {})
    assert (canvas.unused, canvas.unknown) == (["ID", "Problem set 1 (17)"], [])


def test_a_choice_counts_before_the_guess():
    found = choose(MOODLE, {"login": BEFORE_AT, "section": "", "role": "Abteilung"})
    expected = {**MOODLE_FIELDS, "login": BEFORE_AT, "role": "Abteilung"}
    del expected["section"]
    assert found.headings == expected
    assert found.place("login") == found.place("email") == 4 and found.place("section") is None
    assert found.unknown == ["Gruppen", "Rollen"]


@pytest.mark.parametrize(
    ("chosen", "why"),
    [
        ({"shoe": "Vorname"}, "hold one of login, full_name, .* not shoe"),
        ({"login": "Shoe"}, "no column is called Shoe: the file has Vorname, Nachname"),
        ({"email": BEFORE_AT}, "no column is called"),
        ({"login": BEFORE_AT, "email": ""}, "needs a column of email addresses"),
    ],
)
def test_a_choice_must_be_a_column(chosen, why):
    with pytest.raises(BadRoster, match=why):
        choose(MOODLE, chosen)
