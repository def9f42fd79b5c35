"""Passwords, as hashes, and accounts at an OpenID provider."""

from collections.abc import Sequence
from uuid import UUID

from service.store.course import audit
from service.store.database import Connection, Database, Row
from service.store.people import people, tokens


class NameTaken(Exception):
    """The name belongs to another account, or needs its password; the message says which."""


async def about(database: Database, name: str) -> Row | None:
    """Return profile, ``has_password`` and ``issuer`` of the linked account as a row, or None."""
    return await database.first(_ABOUT, {"name": name})


async def password(database: Database, name: str) -> str | None:
    """Return the hash of the person's password; None without a password or for an unknown person."""
    row = await database.first("SELECT password FROM person WHERE name = %(name)s", {"name": name})
    return None if row is None else row.password


async def set_password(
    connection: Connection, name: str, new_hash: str, *, by: str, but: UUID | None = None
) -> bool:
    """Set the password's hash and end the person's sessions except ``but``.

    ``by`` is the actor in the audit log. Return False for an unknown person.
    """
    if not await connection.rows(_SET, {"name": name, "hash": new_hash}):
        return False
    await tokens.end_sessions(connection, name, but=but)
    await audit.record(connection, by, "set password", name, {})
    return True


async def renew_hash(connection: Connection, name: str, before: str, new_hash: str) -> None:
    """Replace the hash ``before`` by another one of the same password, unless it has changed."""
    await connection.execute(_RENEW, {"name": name, "before": before, "hash": new_hash})


async def signed_in(connection: Connection, account: tuple[str, str], name: str, present: str | None) -> str:
    """Return the name of the person linked to an account (issuer, subject).

    On the first sign-in, link the account to the person ``name``, who is added if unknown. Raises NameTaken
    if that person has another account, or has a password and is not ``present``, the name of the logged-in
    user.
    """
    issuer, subject = account
    row = await connection.first(_OF_SUBJECT, {"issuer": issuer, "subject": subject})
    if row is not None:
        return str(row.name)
    person = await people.add_person(connection, name)
    has_password = (await connection.one(_LOCK, {"person": person}))[0]
    others: Sequence[Row] = await connection.rows(_OF_PERSON, {"person": person})
    if [tuple(other) for other in others] == [(issuer, subject)]:  # a concurrent first sign-in has linked it
        return name
    if others:
        raise NameTaken(f"another account is linked to the name {name}: ask your course staff")
    if has_password and present != name:
        raise NameTaken(
            f"{name} has a password here: log in with it, then connect this sign-in on your account page"
        )
    await connection.execute(_LINK, {"issuer": issuer, "subject": subject, "person": person})
    await audit.record(connection, name, "connect sign-in", name, {"issuer": issuer, "subject": subject})
    return name


async def unlink(connection: Connection, name: str, *, by: str) -> bool:
    """Unlink the person's OpenID account and end their sessions. Return False if no account was linked."""
    if not await connection.rows(_UNLINK, {"name": name}):
        return False
    await tokens.end_sessions(connection, name)
    await audit.record(connection, by, "disconnect sign-in", name, {})
    return True


_ABOUT = """
SELECT p.full_name, p.email, p.student_id, p.password IS NOT NULL AS has_password, s.issuer
FROM person p LEFT JOIN oidc_account s ON s.person_id = p.id WHERE p.name = %(name)s
"""
_SET = "UPDATE person SET password = %(hash)s WHERE name = %(name)s RETURNING id"
_RENEW = "UPDATE person SET password = %(hash)s WHERE name = %(name)s AND password = %(before)s"
_OF_SUBJECT = """
SELECT p.name FROM oidc_account s JOIN person p ON p.id = s.person_id WHERE s.issuer = %(issuer)s
    AND s.subject = %(subject)s
"""
_LOCK = "SELECT password IS NOT NULL FROM person WHERE id = %(person)s FOR UPDATE"
_OF_PERSON = "SELECT issuer, subject FROM oidc_account WHERE person_id = %(person)s"
_LINK = "INSERT INTO oidc_account (issuer, subject, person_id) VALUES (%(issuer)s, %(subject)s, %(person)s)"
_UNLINK = (
    "DELETE FROM oidc_account s USING person p WHERE p.id = s.person_id AND p.name = %(name)s RETURNING"
    " s.subject"
)
