"""The first instructor of a course, who is created with the link that the server prints.

The link works once: its secret is deleted with its use, and once the course has an instructor.
"""

import secrets

from service.store.course import audit
from service.store.database import Connection, Database
from service.store.people import credentials, people


class LinkOver(Exception):
    """The secret is not that of the link, or the course has an instructor."""


async def link_secret(database: Database) -> str | None:
    """Return the secret of the link, the same on all servers; None once the course has an instructor."""
    async with database.begin() as connection:
        if await people.has_instructor(connection):
            await connection.execute(_DELETE, {"secret": None})
            return None
        await connection.execute(_KEEP, {"secret": secrets.token_urlsafe(32)})
        return str((await connection.one(_READ)).value)


async def is_missing(database: Database) -> bool:
    """Return whether the course has no instructor."""
    return not await people.has_instructor(database)


async def is_link(database: Database, secret: str) -> bool:
    """Return whether the secret is that of the link, and the course has no instructor."""
    return await is_missing(database) and await database.first(_IS_LINK, {"secret": secret}) is not None


async def people_log_in(database: Database) -> bool:
    """Return whether an instructor was created with the link, after which a server without logins asks for
    them.
    """
    return bool((await database.one(_LOGINS, {"course": people.COURSE})).logins)


async def create(
    connection: Connection, secret: str, name: str, full_name: str | None, password: str | None
) -> None:
    """Make the person of that name the first instructor, and let people log in from now on.

    ``password`` is a hash; without one they log in as before. Raises LinkOver.
    """
    if await connection.first(_DELETE, {"secret": secret}) is None or await people.has_instructor(connection):
        raise LinkOver
    await people.enroll(connection, [(name, "instructor", full_name)])
    if password is not None:
        await credentials.set_password(connection, name, password, by=name)
    await connection.execute(_LET_LOG_IN, {"course": people.COURSE})
    await audit.record(connection, name, "first instructor", name, {})


_KEEP = "INSERT INTO secret VALUES ('first instructor', %(secret)s) ON CONFLICT DO NOTHING"
_IS_LINK = "SELECT 1 FROM secret WHERE name = 'first instructor' AND value = %(secret)s"
_READ = "SELECT value FROM secret WHERE name = 'first instructor'"
_DELETE = """
DELETE FROM secret WHERE name = 'first instructor' AND value = coalesce(%(secret)s, value) RETURNING name
"""
_LOGINS = "SELECT logins FROM course WHERE slug = %(course)s"
_LET_LOG_IN = "UPDATE course SET logins = true WHERE slug = %(course)s"
