"""What the columns of a roster mean: a guess from their headings, which whoever imports it can change."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from service.store.people.roster.problems import BadRoster
from service.store.people.sort_keys import fold

FIELDS = {
    "login": "login name",
    "full_name": "full name",
    "first": "first name",
    "last": "surname",
    "email": "email address",
    "student_id": "student ID",
    "role": "role",
    "section": "section",
}
"""What a column can hold, with the words of pages and messages."""

BEFORE_AT = "email address, the part before @"
"""A choice of the login name beside the file's columns."""

# Headings as ``plain`` gives them, in English and in German, of Gradescope, Canvas, Moodle, PrairieLearn,
# Stud.IP, ILIAS, HISinOne and CAMPUSonline. A "name" is the login name in polhode's own format only.
MEANINGS = {
    "login": (
        "username", "loginname", "login", "loginid", "sisloginid", "uid", "benutzername", "anmeldename",
        "nutzername", "nutzerkennung", "benutzerkennung", "kennung", "userid", "rzkennung", "unikennung",
    ),
    "full_name": (
        "fullname", "student", "studentname", "namevorname", "nachnamevorname", "vornamenachname",
        "vollstandigername", "displayname", "anzeigename",
    ),
    "first": ("firstname", "givenname", "forename", "vorname", "vornamen", "rufname"),
    "last": ("lastname", "surname", "familyname", "nachname", "familienname", "zuname"),
    "email": ("email", "emailaddress", "mail", "emailadresse", "mailadresse", "unimail"),
    "student_id": (
        "studentid", "sid", "idnumber", "sisuserid", "uin", "studentnumber", "matrikelnummer", "matrikelnr",
        "matrnr", "mtknr", "matrikel", "idnummer", "matriculationnumber", "registrationnumber",
    ),
    "role": ("role", "roles", "rolle", "rollen"),
    "section": (
        "section", "sections", "group", "groups", "gruppe", "gruppen", "ubungsgruppe", "tutorium", "ubung",
    ),
}  # fmt: skip
OWN = {"name", "role", "fullname", "email", "studentid", "section"}
"""Headings of polhode's own format."""

CANVAS = {"student", "id", "section"}
# What tools export and polhode has no use for.
UNUSED = {
    "id", "rootaccount", "integrationid", "institution", "department", "abteilung", "anrede", "titel",
    "title", "titelnachgestellt", "studiengang", "studiengange", "fachsemester", "semester",
    "lastdownloadedfromthiscourse", "zuletztausdiesemkursgeladen", "letzterzugriff", "zuletztzugegriffen",
    "lastaccess", "anmeldedatum", "nr",
    "lfdnr", "position", "geschlecht", "land", "ort", "country", "city", "bemerkung", "telefon", "phone",
}  # fmt: skip


@dataclass(frozen=True)
class Columns:
    """The heading of each field's column; a field without a column is not in ``headings``.

    ``choices`` are the headings of the file, ``unused`` those that polhode knows and has no use for, and
    ``unknown`` those that it does not know.
    """

    headings: Mapping[str, str]
    choices: Sequence[str]
    unused: Sequence[str]
    unknown: Sequence[str]

    def place(self, field: str) -> int | None:
        """Return the number of the field's column, from 0, or None."""
        heading = self.headings.get(field)
        if heading == BEFORE_AT:
            heading = self.headings["email"]
        return None if heading is None else self.choices.index(heading)


def plain(heading: str) -> str:
    """Return a heading without case, accents, spaces and punctuation."""
    return re.sub(r"[\W_]", "", fold(heading))


def known(heading: str) -> bool:
    """Return whether a heading says what its column holds."""
    return plain(heading) == "name" or any(plain(heading) in words for words in MEANINGS.values())


def choose(headings: Sequence[str], chosen: Mapping[str, str]) -> Columns:
    """Return the columns of a file: those that are ``chosen`` by field, and for other fields a guess.

    An empty choice means that no column holds the field. Raises BadRoster if a choice is not a heading.
    """
    for field, heading in chosen.items():
        if field not in FIELDS:
            raise BadRoster(f"columns hold one of {', '.join(FIELDS)}, not {field[:40]}")
        if heading not in {"", *headings} and (field, heading) != ("login", BEFORE_AT):
            raise BadRoster(f"no column is called {heading[:40]}: the file has {', '.join(headings)}")
    found = {**_guess(headings), **chosen}
    if "login" not in chosen:
        found["login"] = found.get("login") or found.get("email") or _login_of_name(headings)
    found = {field: heading for field, heading in found.items() if heading}
    if found.get("login") == BEFORE_AT and "email" not in found:
        raise BadRoster("the part before @ needs a column of email addresses: choose one")
    if found.get("full_name") and found["full_name"] == found.get("login"):
        del found["full_name"]
    rest = [heading for heading in headings if heading not in found.values()]
    known_unused = _unused(headings)
    unused = [heading for heading in rest if heading in known_unused]
    return Columns(found, headings, unused, [heading for heading in rest if heading not in unused])


def _guess(headings: Sequence[str]) -> dict[str, str]:
    """Return the first heading of each field that is found."""
    words = [plain(heading) for heading in headings]
    found = {
        field: next(heading for heading, word in zip(headings, words, strict=True) if word in known)
        for field, known in MEANINGS.items()
        if set(known) & set(words)
    }
    if "name" in words:
        found.setdefault(_meaning_of_name(words, found), headings[words.index("name")])
    return found


def _meaning_of_name(words: Sequence[str], found: Mapping[str, str]) -> str:
    if OWN.issuperset(words):
        return "login"
    return "last" if "first" in found and "last" not in found else "full_name"


def _login_of_name(headings: Sequence[str]) -> str:
    return next((heading for heading in headings if plain(heading) == "name"), "")


def _unused(headings: Sequence[str]) -> set[str]:
    """Return the headings of columns that polhode has no use for."""
    words = [plain(heading) for heading in headings]
    found = {heading for heading, word in zip(headings, words, strict=True) if word in UNUSED}
    if CANVAS.issubset(words):
        found |= {*headings[words.index("section") + 1 :]}  # Canvas's assignments
    return found
