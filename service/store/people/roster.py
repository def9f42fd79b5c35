"""Read rosters: polhode's own columns, and those of Gradescope, Canvas, Moodle and PrairieLearn."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from service.store.people.people import ROLES, ROSTER, normalize_name

LONGEST = 200
SEPARATORS = ",;\t"
BEFORE_AT = "email, the part before @"
"""A choice of the login name beside the file's columns."""

# Headings in lower case without spaces, hyphens and underscores, by what they mean; "name" is the login name
# only in polhode's own format, and the full name beside another login name.
MEANINGS = {
    "login": ("username", "loginname", "login", "loginid", "sisloginid", "uid"),
    "name": ("name",),
    "full_name": ("fullname", "student", "studentname"),
    "first": ("firstname", "givenname"),
    "last": ("lastname", "surname", "familyname"),
    "email": ("email", "emailaddress", "mail"),
    "student_id": ("studentid", "sid", "idnumber", "sisuserid", "uin", "studentnumber"),
    "role": ("role",),
}
KNOWN = {word for words in MEANINGS.values() for word in words}
OWN = {"name", "role", "fullname", "email", "studentid"}
# whose gradebook has rows without an ID that are not people, such as "Points Possible"
CANVAS = {
    "student",
    "id",
}
ROLE_WORDS = {
    "student": ("student", "learner"),
    "assistant": (
        "assistant",
        "ta",
        "teaching assistant",
        "grader",
        "reader",
        "tutor",
        "non-editing teacher",
    ),
    "instructor": ("instructor", "teacher", "professor"),
    "former": ("former",),
}


class BadRoster(ValueError):
    """The file is not a valid roster; the message names the line."""


class Entry(NamedTuple):
    """A person of a roster; fields that are None stay unchanged."""

    name: str
    role: str | None = None
    full_name: str | None = None
    email: str | None = None
    student_id: str | None = None
    section: str | None = None


@dataclass(frozen=True)
class Roster:
    """The entries of a file; ``login`` is the column of the login names, one of ``choices``; ``unused``
    headings mean nothing.
    """

    entries: Sequence[Entry]
    login: str
    choices: Sequence[str]
    unused: Sequence[str]


def read(content: bytes, file: str, login: str | None = None) -> Roster:
    """Read a roster, separated by commas, semicolons or tabs, with an entry per line.

    ``login`` is the column with the login names, or BEFORE_AT; by default the file's headings determine it.
    Raises BadRoster, with ``file`` in its message, if the roster is not valid.
    """
    try:
        decoded = text(content)
        rows = csv.reader(io.StringIO(decoded, newline=""), delimiter=_separator(decoded))
        heads = next(rows, [])
        lines = [(rows.line_num, row) for row in rows if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadRoster(f"{file} is not CSV text in UTF-8 ({error}): save it as CSV UTF-8") from None
    heads = [head.strip() for head in heads]
    places = _places(heads)
    named = [head for head in heads if head]
    choices = named + [BEFORE_AT] * ("email" in places)
    plain = {*map(_plain, named)}
    strange = (
        [head for head in named if _plain(head) not in KNOWN]
        if "name" in plain and plain & KNOWN <= OWN
        else []
    )
    login = login or _login(heads, places)
    if login not in choices or len(set(named)) < len(named) or strange:
        wrong = f", not {strange[0][:40]!r}" if strange else ""
        raise BadRoster(
            f"{file}: the first line must name the columns, each once, separated by commas, semicolons or"
            f" tabs: name and optionally {', '.join(ROSTER[1:])}, or the columns of Gradescope, Canvas,"
            f" Moodle or PrairieLearn{wrong}"
        )
    if login in heads and places.get("full_name") == heads.index(login):
        del places["full_name"]
    if plain >= CANVAS:
        place = [*map(_plain, heads)].index("id")
        lines = [(number, row) for number, row in lines if _cell(row, place)]
    entries: dict[str, Entry] = {}
    for number, row in lines:
        place = places["email"] if login == BEFORE_AT else heads.index(login)
        name = row[place] if place < len(row) else ""
        try:
            entry = _entry(
                name.partition("@")[0] if login == BEFORE_AT else name,
                {meaning: _cell(row, place) for meaning, place in places.items()},
            )
        except ValueError as error:
            raise BadRoster(f"{file}, line {number}: {error}") from None
        if entries.setdefault(entry.name, entry) != entry:
            raise BadRoster(
                f"{file}, line {number}: {entry.name} is listed twice with different values: keep one line"
            )
    if not entries:
        raise BadRoster(f"{file} has no entries: add a line for each person")
    used = {*places.values(), heads.index(login) if login in heads else -1}
    return Roster(
        [*entries.values()],
        login,
        choices,
        [head for place, head in enumerate(heads) if head and place not in used],
    )


def text(content: bytes) -> str:
    """Return the text of a file in UTF-8 or, as Excel saves "Unicode text", UTF-16. Raises
    UnicodeDecodeError.
    """
    return content.decode("utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")


def _separator(text: str) -> str:
    """Return the separator with which the first line has the most headings that are understood."""
    first = text.partition("\n")[0].strip("\r")
    return max(
        SEPARATORS,
        key=lambda mark: sum(_plain(head) in KNOWN for head in next(csv.reader([first], delimiter=mark), [])),
    )


def _plain(head: str) -> str:
    return re.sub(r"[\s_-]", "", head).casefold()


def _cell(row: Sequence[str], place: int) -> str:
    return " ".join(row[place].split()) if place < len(row) else ""


def _places(heads: Sequence[str]) -> dict[str, int]:
    """Return the place of the first column of each meaning."""
    plain = [_plain(head) for head in heads]
    found = {
        meaning: [plain.index(word) for word in words if word in plain] for meaning, words in MEANINGS.items()
    }
    places = {meaning: min(known) for meaning, known in found.items() if known}
    if "name" in places and "full_name" not in places:
        places["full_name"] = places["name"]
    return {meaning: place for meaning, place in places.items() if meaning != "name"}


def _login(heads: Sequence[str], places: dict[str, int]) -> str:
    """Return the heading of the login names: in polhode's own columns "name", else the first there is of a
    login name, an email address and a name.
    """
    plain = [_plain(head) for head in heads]
    if "name" in plain and set(plain) <= OWN:
        return heads[plain.index("name")]
    known = [places[meaning] for meaning in ("login", "email") if meaning in places]
    known += [plain.index("name")] if "name" in plain else []
    return heads[known[0]] if known else ""


def _entry(name: str, cells: dict[str, str]) -> Entry:
    role = cells.get("role", "").casefold()
    known = next((own for own, words in ROLE_WORDS.items() if role in words), None)
    if role and known is None:
        raise ValueError(f"a role must be one of {', '.join(ROLES)}, not {role[:40]}")
    about = {column: cells[column] for column in ROSTER[2:] if column in cells}
    if "full_name" not in about and cells.keys() & {"first", "last"}:
        about["full_name"] = f"{cells.get('first', '')} {cells.get('last', '')}".strip()
    for column, value in about.items():
        if len(value) > LONGEST or not value.isprintable():
            raise ValueError(f"{column} must have at most {LONGEST} printable characters")
    return Entry(normalize_name(name), known, **about)
