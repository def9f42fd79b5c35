"""People and their roles in the course, and the roster format."""

import csv
import io
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple
from uuid import UUID

from service.store.database import Connection, Database, Row

COURSE = "local"
ROLES = ("student", "assistant", "instructor", "former")
ROSTER = ("name", "role", "full_name", "email", "student_id")
LONGEST_NAME = 200


class InvalidName(ValueError):
    """The name is not valid; the message says what a valid name is."""


def normalize_name(name: str) -> str:
    """Return the name as it is stored: NFC, stripped.

    Raises InvalidName unless it is one printable line of 1 to 200 characters.
    """
    name = unicodedata.normalize("NFC", name).strip()
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise InvalidName(f"a name must have 1 to {LONGEST_NAME} printable characters")
    return name


async def add_person(connection: Connection, name: str) -> UUID:
    """Return the id of the person of that name; an unknown person is added as a student."""
    for statement in _ENTER_ALL, _MEMBERS:
        await connection.execute(statement, {"name": [name], "course": COURSE})
    id: UUID = (await connection.one("SELECT id FROM person WHERE name = :name", {"name": name}))[0]
    return id


async def is_member(connection: Connection, name: str) -> bool:
    """Return whether a person of that name is in the course."""
    return await connection.first(_ROLE_OF, {"name": name, "course": COURSE}) is not None


async def enroll(connection: Connection, roster: Iterable[Sequence[str | None]]) -> None:
    """Add or update people, each given as (name, role, full name, email, student id).

    All but the name may be missing or None: known people keep these fields, and new people become students.
    """
    entries = sorted([*about, None, None, None, None][:5] for about in ([*entry] for entry in roster))
    columns = dict(zip(ROSTER, zip(*entries, strict=True), strict=False))
    values = {name: list(column) for name, column in columns.items()} | {"course": COURSE}
    for statement in (_ENTER_ALL, _MEMBERS, _ROLES, _ABOUT) if entries else ():
        await connection.execute(statement, values)


async def role(database: Database, name: str) -> str:
    """Return the person's role, which is "student" for an unknown person."""
    row = await database.first(_ROLE_OF, {"name": name, "course": COURSE})
    return "student" if row is None else str(row.role)


async def everybody(database: Database) -> Sequence[Row]:
    """Return the people of the course, staff first, with role and number of submissions."""
    return await database.rows(_EVERYBODY, {"course": COURSE})


async def secret(database: Database, name: str) -> bytes:
    """Return a signing key that all servers on this database share."""
    return str((await database.rows("SELECT value FROM secret WHERE name = :name", {"name": name}))[0].value).encode()


_ENTER_ALL = "INSERT INTO person (name) SELECT unnest(CAST(:name AS text[])) ON CONFLICT DO NOTHING"
_MEMBERS = """
INSERT INTO member (course_id, person_id, role) SELECT c.id, p.id, 'student' FROM course c, person p
WHERE c.slug = :course AND p.name = ANY(CAST(:name AS text[])) ON CONFLICT DO NOTHING
"""
_ROLES = """
UPDATE member m SET role = entry.role
FROM unnest(CAST(:name AS text[]), CAST(:role AS text[])) AS entry (name, role) JOIN person p USING (name), course c
WHERE m.person_id = p.id AND m.course_id = c.id AND c.slug = :course AND entry.role IS NOT NULL
"""
_ABOUT = """
UPDATE person p SET full_name = coalesce(entry.full_name, p.full_name), email = coalesce(entry.email, p.email),
    student_id = coalesce(entry.student_id, p.student_id)
FROM unnest(CAST(:name AS text[]), CAST(:full_name AS text[]), CAST(:email AS text[]), CAST(:student_id AS text[]))
    AS entry (name, full_name, email, student_id)
WHERE p.name = entry.name AND coalesce(entry.full_name, entry.email, entry.student_id) IS NOT NULL
"""
_ROLE_OF = """
SELECT m.role FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE p.name = :name AND c.slug = :course
"""
_EVERYBODY = """
SELECT p.name, p.full_name, p.email, p.student_id, m.role, coalesce(sent.n, 0) AS submissions, sent.last,
    p.password IS NOT NULL AS password, coalesce(given.n, 0) AS tokens
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
    LEFT JOIN (SELECT person_id, count(*) AS n, max(submitted_at) AS last FROM submission GROUP BY 1) sent ON sent.person_id = p.id
    LEFT JOIN (SELECT person_id, count(*) AS n FROM token WHERE revoked_at IS NULL AND expires_at > now() GROUP BY 1) given
        ON given.person_id = p.id
WHERE c.slug = :course
ORDER BY array_position(ARRAY['instructor', 'assistant', 'student', 'former'], m.role),
    lower(coalesce(nullif(p.full_name, ''), p.name))
"""


COLUMNS = ROSTER
LONGEST = 200


class BadRoster(ValueError):
    """The file is not a valid roster; the message names the line."""


class Entry(NamedTuple):
    """A person of a roster; fields that are None stay unchanged."""

    name: str
    role: str | None = None
    full_name: str | None = None
    email: str | None = None
    student_id: str | None = None


def read(content: bytes, file: str) -> list[Entry]:
    """Read a roster in CSV and return an entry per line.

    Raises BadRoster, with ``file`` in its message, if it is not valid.
    """
    try:
        rows = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
        found = _read(rows, file)
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadRoster(f"{file} is not CSV text in UTF-8 ({error}): save it as CSV UTF-8") from None
    if not found:
        raise BadRoster(f"{file} has no entries: add a line for each person")
    return found


def _read(rows: Any, file: str) -> list[Entry]:
    columns = [cell.strip().casefold().replace(" ", "_") for cell in next(rows, [])]
    if "name" not in columns or (unknown := set(columns) - set(COLUMNS)) or len(set(columns)) < len(columns):
        wrong = f", not {sorted(unknown)[0][:40]!r}" if "name" in columns and unknown else ""
        raise BadRoster(f"{file}: the first line must name the columns: name and optionally {', '.join(COLUMNS[1:])}{wrong}")
    found: dict[str, Entry] = {}
    for cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        try:
            entry = _entry(dict(zip(columns, cells, strict=False)))
        except ValueError as error:
            raise BadRoster(f"{file}, line {rows.line_num}: {error}") from None
        if found.setdefault(entry.name, entry) != entry:
            problem = f"{entry.name} is listed twice with different values: keep one line"
            raise BadRoster(f"{file}, line {rows.line_num}: {problem}")
    return list(found.values())


def _entry(row: dict[str, str]) -> Entry:
    role = row.get("role", "").strip().casefold() or None
    if role not in (None, *ROLES):
        raise ValueError(f"a role must be one of {', '.join(ROLES)}, not {role[:40]}")
    about = {name: " ".join(row[name].split()) for name in COLUMNS[2:] if name in row}
    for name, value in about.items():
        if len(value) > LONGEST or not value.isprintable():
            raise ValueError(f"{name} must have at most {LONGEST} printable characters")
    return Entry(normalize_name(row.get("name", "")), role, **about)
