"""Persons and their roles in the course; their names come from a roster, a proxy, the hub, or are "local"."""

import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Row, select, text, update
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store.database import Database
from service.store.tables import audit, course, member, person

COURSE = "local"
ROLES = ("student", "assistant", "instructor", "former")
LONGEST_NAME = 200


class NoName(ValueError):
    """Not a name of a person; the message says what one is."""


def tidy(name: str) -> str:
    """The name as it is kept: composed (NFC), without space around it; NoName for anything else than one printable line."""
    name = unicodedata.normalize("NFC", name).strip()
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise NoName(f"a name has 1 to {LONGEST_NAME} printable characters")
    return name


async def enter(connection: AsyncConnection, name: str) -> UUID:
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
    for name, *about in roster:
        assert name is not None
        role, full_name, email, student_id = [*about, None, None, None, None][:4]
        person_id = await enter(connection, name)
        if role is not None:
            await connection.execute(_ROLE, {"person": person_id, "role": role, "course": COURSE})
        told = {"full_name": full_name, "email": email, "student_id": student_id}
        if told := {column: value for column, value in told.items() if value is not None}:
            await connection.execute(update(person).where(person.c.id == person_id).values(told))


async def note(connection: AsyncConnection, who: str, action: str, subject: str, detail: Mapping[str, Any]) -> None:
    """Enter into the audit trail who did what to whom."""
    await connection.execute(insert(audit).values(who=who, action=action, subject=subject, detail=dict(detail)))


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


_ROLE = text("""
UPDATE member SET role = :role FROM course c WHERE c.id = course_id AND c.slug = :course AND person_id = :person
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
