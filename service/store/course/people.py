"""Persons and their roles in the course; their names come from a roster, a proxy, the hub, or are "local"."""

import csv
import io
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple
from uuid import UUID

from sqlalchemy import Row, select, text
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store.database import Database
from service.store.tables import audit, course, member, person

COURSE = "local"
ROLES = ("student", "assistant", "instructor", "former")
ROSTER = ("name", "role", "full_name", "email", "student_id")
LONGEST_NAME = 200


class InvalidName(ValueError):
    """Not a name of a person; the message says what one is."""


def normalize_name(name: str) -> str:
    """The name as it is kept: composed (NFC), without space around it; NoName for anything else than one printable line."""
    name = unicodedata.normalize("NFC", name).strip()
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise InvalidName(f"a name has 1 to {LONGEST_NAME} printable characters")
    return name


async def add_person(connection: AsyncConnection, name: str) -> UUID:
    """The id of the person of that name, entered as a student when first seen."""
    await connection.execute(insert(person).values(name=name).on_conflict_do_nothing())
    id: UUID = (await connection.execute(select(person.c.id).where(person.c.name == name))).scalar_one()
    home = (await connection.execute(select(course.c.id).where(course.c.slug == COURSE))).scalar_one()
    await connection.execute(insert(member).values(course_id=home, person_id=id, role="student").on_conflict_do_nothing())
    return id


async def enroll(connection: AsyncConnection, roster: Iterable[Sequence[str | None]]) -> None:
    """Enter people, each as (name, role, full name, email, student id), of which all but the name may be missing.

    What is missing or None stays as it is: without a role, who is known keeps theirs and others are students.
    """
    told = sorted([*about, None, None, None, None][:5] for about in ([*entry] for entry in roster))
    columns = dict(zip(ROSTER, zip(*told, strict=True), strict=False))
    values = {name: list(column) for name, column in columns.items()} | {"course": COURSE}
    for statement in (_ENTER_ALL, _MEMBERS, _ROLES, _ABOUT) if told else ():
        await connection.execute(statement, values)


async def record_audit(connection: AsyncConnection, actor: str, action: str, subject: str, detail: Mapping[str, Any]) -> None:
    """Enter into the audit trail who did what to whom."""
    await connection.execute(insert(audit).values(actor=actor, action=action, subject=subject, detail=dict(detail)))


async def role(database: Database, name: str) -> str:
    """The role of that person; "student" for somebody unknown."""
    rows = await database.rows(_ROLE_OF, {"name": name, "course": COURSE})
    return str(rows[0].role) if rows else "student"


async def everybody(database: Database) -> Sequence[Row[Any]]:
    """The people of the course with role, number of submissions and when the last one came, staff first."""
    return await database.rows(_EVERYBODY, {"course": COURSE})


async def secret(database: Database, name: str) -> bytes:
    """What all servers on this database know and nobody else: to sign with."""
    return str((await database.rows("SELECT value FROM secret WHERE name = :name", {"name": name}))[0].value).encode()


_ENTER_ALL = text("INSERT INTO person (name) SELECT unnest(CAST(:name AS text[])) ON CONFLICT DO NOTHING")
_MEMBERS = text("""
INSERT INTO member (course_id, person_id, role) SELECT c.id, p.id, 'student' FROM course c, person p
WHERE c.slug = :course AND p.name = ANY(CAST(:name AS text[])) ON CONFLICT DO NOTHING
""")
_ROLES = text("""
UPDATE member m SET role = told.role
FROM unnest(CAST(:name AS text[]), CAST(:role AS text[])) AS told (name, role) JOIN person p USING (name), course c
WHERE m.person_id = p.id AND m.course_id = c.id AND c.slug = :course AND told.role IS NOT NULL
""")
_ABOUT = text("""
UPDATE person p SET full_name = coalesce(told.full_name, p.full_name), email = coalesce(told.email, p.email),
    student_id = coalesce(told.student_id, p.student_id)
FROM unnest(CAST(:name AS text[]), CAST(:full_name AS text[]), CAST(:email AS text[]), CAST(:student_id AS text[]))
    AS told (name, full_name, email, student_id)
WHERE p.name = told.name AND coalesce(told.full_name, told.email, told.student_id) IS NOT NULL
""")
_ROLE_OF = text("""
SELECT m.role FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE p.name = :name AND c.slug = :course
""")
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
    """The file is no roster; the message names the line."""


class Entry(NamedTuple):
    """A person of a roster; what is None is left as it is."""

    name: str
    role: str | None = None
    full_name: str | None = None
    email: str | None = None
    student_id: str | None = None


def read(content: bytes, file: str) -> list[Entry]:
    """An entry for every line; BadRoster for what is none. ``file`` is what the message calls it."""
    try:
        rows = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
        found = _read(rows, file)
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadRoster(f"{file} is no CSV text in UTF-8 ({error})") from None
    if not found:
        raise BadRoster(f"{file} names nobody")
    return found


def _read(rows: Any, file: str) -> list[Entry]:
    columns = [cell.strip().casefold().replace(" ", "_") for cell in next(rows, [])]
    if "name" not in columns or (unknown := set(columns) - set(COLUMNS)) or len(set(columns)) < len(columns):
        told = f", not {sorted(unknown)[0][:40]!r}" if "name" in columns and unknown else ""
        raise BadRoster(f"{file}: the first line names the columns, name and, if wanted, {', '.join(COLUMNS[1:])}{told}")
    found: dict[str, Entry] = {}
    for cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        try:
            entry = _entry(dict(zip(columns, cells, strict=False)))
        except ValueError as error:
            raise BadRoster(f"{file}, line {rows.line_num}: {error}") from None
        if found.setdefault(entry.name, entry) != entry:
            raise BadRoster(f"{file}, line {rows.line_num}: {entry.name} is told twice, and differently")
    return list(found.values())


def _entry(row: dict[str, str]) -> Entry:
    role = row.get("role", "").strip().casefold() or None
    if role not in (None, *ROLES):
        raise ValueError(f"a role is {', '.join(ROLES)}, not {role[:40]}")
    about = {name: " ".join(row[name].split()) for name in COLUMNS[2:] if name in row}
    for name, told in about.items():
        if len(told) > LONGEST or not told.isprintable():
            raise ValueError(f"{name} has at most {LONGEST} printable characters")
    return Entry(normalize_name(row.get("name", "")), role, **about)
