"""The first instructor of a course, who is created with the link that the server prints.

The link works once: its secret is deleted with its use, and once an instructor can log in. On a server
without logins everybody may do everything until it is used, even if a roster names instructors.
"""

import secrets

from service.store.course import audit
from service.store.database import Connection, Database, Queries
from service.store.people import credentials, people


class LinkOver(Exception):
    """The secret is not that of the link, or it is not needed any more."""


async def is_needed(queries: Queries, *, single_user: bool) -> bool:
    """Return whether no instructor can log in: on a ``single_user`` server nobody does until the link is
    used, and on others the course has none.
    """
    return not await (people_log_in(queries) if single_user else people.has_instructor(queries))


async def link_secret(database: Database, *, single_user: bool) -> str | None:
    """Return the secret of the link, the same on all servers; None if it is not needed any more."""
    async with database.begin() as connection:
        if not await is_needed(connection, single_user=single_user):
            await connection.execute(_DELETE, {"secret": None})
            return None
        await connection.execute(_KEEP, {"secret": secrets.token_urlsafe(32)})
        return str((await connection.one(_READ)).value)


async def is_link(database: Database, secret: str) -> bool:
    """Return whether the secret is that of the link."""
    return await database.first(_IS_LINK, {"secret": secret}) is not None


async def people_log_in(queries: Queries) -> bool:
    """Return whether an instructor was created with the link, after which a server without logins asks for
    them.
    """
    return bool((await queries.one(_LOGINS, {"course": people.COURSE})).logins)


async def create(
    connection: Connection,
    secret: str,
    name: str,
    full_name: str | None,
    password: str | None,
    *,
    single_user: bool,
) -> None:
    """Make the person of that name the first instructor, and let people log in from now on.

    ``password`` is a hash; without one they log in as before. Raises LinkOver.
    """
    if await connection.first(_DELETE, {"secret": secret}) is None:
        raise LinkOver
    if not await is_needed(connection, single_user=single_user):
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
