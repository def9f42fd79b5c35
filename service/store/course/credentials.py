"""What a person logs in with besides tokens: a password's hash, and the account at an OpenID provider that is theirs."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Row, text
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store.course import people, tokens
from service.store.database import Database


class NameTaken(Exception):
    """The name belongs to somebody else, or to somebody who has not shown that they are the same; the message says which."""


async def about(database: Database, name: str) -> Row[Any] | None:
    """Full name, email, student id, whether there is a password, and the ``issuer`` they sign in with, if any."""
    rows = await database.rows(_ABOUT, {"name": name})
    return rows[0] if rows else None


async def password(database: Database, name: str) -> str | None:
    """The hash of the person's password; None if there is none, or no such person."""
    rows = await database.rows("SELECT password FROM person WHERE name = :name", {"name": name})
    return rows[0].password if rows else None


async def set_password(connection: AsyncConnection, name: str, kept: str, *, by: str, but: UUID | None = None) -> bool:
    """Set the hash, end the person's sessions (``but`` this one) and note who did it; False if there is no such person."""
    if not (await connection.execute(_SET, {"name": name, "kept": kept})).all():
        return False
    await tokens.end_sessions(connection, name, but=but)
    await people.record_audit(connection, by, "set password", name, {})
    return True


async def renew_hash(connection: AsyncConnection, name: str, before: str, kept: str) -> None:
    """Put another hash of the same password in the place of the one ``before``, unless that has been changed meanwhile."""
    await connection.execute(_RENEW, {"name": name, "before": before, "kept": kept})


async def signed_in(connection: AsyncConnection, account: tuple[str, str], name: str, present: str | None) -> str:
    """The name of the person whose account (issuer, subject) this is; at the first time the person called ``name``, a new one if
    need be. NameTaken where that name has another account, or has a password and is not who is logged in at ``present``."""
    issuer, subject = account
    row = (await connection.execute(_OF_SUBJECT, {"issuer": issuer, "subject": subject})).first()
    if row is not None:
        return str(row.name)
    person = await people.add_person(connection, name)
    has_password = (await connection.execute(_LOCK, {"person": person})).scalar_one()
    others: Sequence[Row[Any]] = (await connection.execute(_OF_PERSON, {"person": person})).all()
    if [tuple(other) for other in others] == [(issuer, subject)]:  # two first sign-ins at once
        return name
    if others:
        raise NameTaken(f"another account signs in as {name} here: tell your course")
    if has_password and present != name:
        raise NameTaken(f"{name} has a password here: log in with it once, then connect this account on the page of your account")
    await connection.execute(_LINK, {"issuer": issuer, "subject": subject, "person": person})
    await people.record_audit(connection, name, "connect sign-in", name, {"issuer": issuer, "subject": subject})
    return name


async def unlink(connection: AsyncConnection, name: str, *, by: str) -> bool:
    """Forget the person's account at the provider and end their sessions; False if there was none."""
    if not (await connection.execute(_UNLINK, {"name": name})).all():
        return False
    await tokens.end_sessions(connection, name)
    await people.record_audit(connection, by, "disconnect sign-in", name, {})
    return True


_ABOUT = """
SELECT p.full_name, p.email, p.student_id, p.password IS NOT NULL AS has_password, s.issuer
FROM person p LEFT JOIN oidc_account s ON s.person_id = p.id WHERE p.name = :name
"""
_SET = text("UPDATE person SET password = :kept WHERE name = :name RETURNING id")
_RENEW = text("UPDATE person SET password = :kept WHERE name = :name AND password = :before")
_OF_SUBJECT = text("""
SELECT p.name FROM oidc_account s JOIN person p ON p.id = s.person_id WHERE s.issuer = :issuer AND s.subject = :subject
""")
_LOCK = text("SELECT password IS NOT NULL FROM person WHERE id = :person FOR UPDATE")
_OF_PERSON = text("SELECT issuer, subject FROM oidc_account WHERE person_id = :person")
_LINK = text("INSERT INTO oidc_account (issuer, subject, person_id) VALUES (:issuer, :subject, :person)")
_UNLINK = text("DELETE FROM oidc_account s USING person p WHERE p.id = s.person_id AND p.name = :name RETURNING s.subject")
