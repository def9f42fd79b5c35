"""People and their roles in the course."""

import unicodedata
from collections.abc import Iterable, Sequence
from uuid import UUID

from service.store.database import Connection, Database, Queries, Row
from service.store.people.sort_keys import fold, sort_key

COURSE = "local"
ROLES = ("student", "assistant", "instructor", "former")
STAFF = ("assistant", "instructor")
ROSTER = ("name", "role", "full_name", "email", "student_id", "section")
LONGEST_NAME = 200
# Every database has the person "local", which has no submissions, and is not listed, where people log in.
# Its condition does not depend on ``p``, so PostgreSQL evaluates it once rather than per person.
IS_PERSON = """(p.name <> 'local' OR EXISTS (
    SELECT FROM submission o JOIN person l ON l.id = o.person_id WHERE l.name = 'local'))"""


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
        await connection.execute(statement, {"name": [name], "sort_key": [sort_key(name)], "course": COURSE})
    id: UUID = (await connection.one("SELECT id FROM person WHERE name = %(name)s", {"name": name}))[0]
    return id


async def is_member(connection: Connection, name: str) -> bool:
    """Return whether a person of that name is in the course."""
    return await connection.first(_ROLE_OF, {"name": name, "course": COURSE}) is not None


async def enroll(connection: Connection, roster: Iterable[Sequence[str | None]]) -> None:
    """Add or update people, each given as (name, role, full name, email, student id, section, surname).

    All but the name may be missing or None: known people keep these fields, and new people become students.
    The surname only decides where lists show the person; without it, it is taken from the full name.
    """
    columns = (*ROSTER, "surname")
    entries = sorted([*entry, *[None] * len(columns)][: len(columns)] for entry in roster)
    values = {column: [entry[k] for entry in entries] for k, column in enumerate(columns)}
    values["sort_key"] = [sort_key(entry[0] or "", entry[2], entry[6]) for entry in entries]
    for statement in (_ENTER_ALL, _MEMBERS, _ROLES, _ABOUT) if entries else ():
        await connection.execute(statement, values | {"course": COURSE})


async def lock_members(connection: Connection) -> None:
    """Let nobody else add or change people until the transaction ends."""
    await connection.execute(_LOCK, {"course": COURSE})


async def role(database: Database, name: str) -> str:
    """Return the person's role, which is "student" for an unknown person."""
    row = await database.first(_ROLE_OF, {"name": name, "course": COURSE})
    return "student" if row is None else str(row.role)


async def has_instructor(queries: Queries, besides: str = "local") -> bool:
    """Return whether somebody other than ``besides`` is an instructor of the course. The person "local" does
    not count.
    """
    return await queries.first(_INSTRUCTOR, {"course": COURSE, "besides": besides}) is not None


async def members(queries: Queries) -> Sequence[Row]:
    """Return the columns of ROSTER of all people of the course, in the order of lists."""
    return await queries.rows(_MEMBERS_ABOUT, {"course": COURSE})


async def everybody(database: Database) -> Sequence[Row]:
    """Return the people of the course, staff first, with role and number of submissions."""
    return await database.rows(_EVERYBODY, {"course": COURSE})


async def find(database: Database, name: str) -> Row | None:
    """Return the row of ``everybody`` of the person of that name, or None if they are not in the course."""
    return await database.first(_FIND, {"course": COURSE, "name": name})


async def neighbours(database: Database, name: str) -> Row | None:
    """Return the names of the student before and after ``name`` in the order of the class, None at its ends,
    as ``before`` and ``after``; None if the person is not a student.
    """
    return await database.first(_NEIGHBOURS, {"course": COURSE, "name": name})


async def search(database: Database, text: str, most: int) -> Sequence[Row]:
    """Return at most ``most`` people of the course whose name, full name, email address, student id or
    section contains ``text``, apart from case and accents.
    """
    wanted = fold(text)  # compared here, as the database of some locales knows no case but that of ASCII
    names = [row.name for row in await database.rows(_TEXTS, {"course": COURSE}) if wanted in fold(row.text)]
    return await database.rows(_SEARCH, {"course": COURSE, "names": names, "most": most})


async def secret(database: Database, name: str) -> bytes:
    """Return a signing key that all servers on this database share."""
    return str(
        (await database.rows("SELECT value FROM secret WHERE name = %(name)s", {"name": name}))[0].value
    ).encode()


_LOCK = "SELECT id FROM course WHERE slug = %(course)s FOR NO KEY UPDATE"
_ENTER_ALL = """
INSERT INTO person (name, sort_key)
SELECT * FROM unnest(CAST(%(name)s AS text[]), CAST(%(sort_key)s AS text[])) ON CONFLICT DO NOTHING
"""
_MEMBERS = """
INSERT INTO member (course_id, person_id, role) SELECT c.id, p.id, 'student' FROM course c, person p
WHERE c.slug = %(course)s AND p.name = ANY(CAST(%(name)s AS text[])) ON CONFLICT DO NOTHING
"""
_ROLES = """
UPDATE member m SET role = entry.role
FROM unnest(CAST(%(name)s AS text[]), CAST(%(role)s AS text[])) AS entry (name, role)
    JOIN person p USING (name), course c
WHERE m.person_id = p.id AND m.course_id = c.id AND c.slug = %(course)s AND entry.role IS NOT NULL
"""
_ABOUT = """
UPDATE person p SET full_name = coalesce(entry.full_name, p.full_name),
    email = coalesce(entry.email, p.email),
    student_id = coalesce(entry.student_id, p.student_id),
    section = coalesce(entry.section, p.section),
    sort_key = CASE WHEN entry.surname IS NOT NULL OR entry.full_name <> p.full_name THEN entry.sort_key
        ELSE p.sort_key END
FROM unnest(CAST(%(name)s AS text[]), CAST(%(full_name)s AS text[]), CAST(%(email)s AS text[]),
    CAST(%(student_id)s AS text[]), CAST(%(section)s AS text[]), CAST(%(surname)s AS text[]),
    CAST(%(sort_key)s AS text[]))
    AS entry (name, full_name, email, student_id, section, surname, sort_key)
WHERE p.name = entry.name
    AND coalesce(entry.full_name, entry.email, entry.student_id, entry.section) IS NOT NULL
"""
_ROLE_OF = """
SELECT m.role FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE p.name = %(name)s AND c.slug = %(course)s
"""
_PEOPLE = """
SELECT p.name, p.full_name, p.email, p.student_id, p.section, m.role,
    coalesce(sent.n, 0) AS submissions, sent.last,
    p.password IS NOT NULL AS password, coalesce(given.n, 0) AS tokens
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
    LEFT JOIN LATERAL (SELECT count(*) AS n, max(submitted_at) AS last FROM submission s
    WHERE s.person_id = p.id) sent ON true
    LEFT JOIN LATERAL (
        SELECT count(*) AS n FROM token t WHERE t.person_id = p.id AND revoked_at IS NULL
        AND expires_at > now()
    ) given ON true
WHERE c.slug = %(course)s
"""
_INSTRUCTOR = """
SELECT 1 FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE c.slug = %(course)s AND m.role = 'instructor' AND p.name NOT IN (%(besides)s, 'local') LIMIT 1
"""
_MEMBERS_ABOUT = f"""
SELECT {", ".join(f"{'m' if column == 'role' else 'p'}.{column}" for column in ROSTER)}
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE c.slug = %(course)s AND {IS_PERSON} ORDER BY p.sort_key, p.name
"""
_BY_ROLE = """ORDER BY array_position(ARRAY['instructor', 'assistant', 'student', 'former'], m.role),
    p.sort_key, p.name"""
_EVERYBODY = f"{_PEOPLE} AND {IS_PERSON} {_BY_ROLE}"
_FIND = f"{_PEOPLE} AND p.name = %(name)s"
_TEXTS = """
SELECT p.name, concat_ws(chr(10), p.name, p.full_name, p.email, p.student_id, p.section) AS text
FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
WHERE c.slug = %(course)s
"""
_SEARCH = f"""
{_PEOPLE} AND {IS_PERSON} AND p.name = ANY(%(names)s)
{_BY_ROLE} LIMIT %(most)s
"""
_NEIGHBOURS = f"""
WITH class AS (
    SELECT p.name, lag(p.name) OVER place AS before, lead(p.name) OVER place AS after
    FROM member m JOIN course c ON c.id = m.course_id JOIN person p ON p.id = m.person_id
    WHERE c.slug = %(course)s AND m.role = 'student' AND {IS_PERSON}
    WINDOW place AS (ORDER BY p.sort_key, p.name)
)
SELECT before, after FROM class WHERE name = %(name)s
"""
