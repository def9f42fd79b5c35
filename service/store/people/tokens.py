"""Opaque tokens, stored as their SHA-256, and device logins (after RFC 8628)."""

import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from uuid import UUID

from service.store.database import Connection, Database, Row
from service.store.people.people import COURSE, add_person

PREFIX, SESSION = "polhode_", "session_"
SCOPES = ("submit", "read", "login")
NOTEBOOK, BROWSER = ("submit", "read"), ("read", "login")
SHOWN_CHARACTERS = len(PREFIX) + 4  # characters of a token that lists show
LETTERS = "BCDFGHJKLMNPQRSTVWXZ"  # no vowels, nothing that looks like a number: RFC 8628, 6.1
LOGIN_S, MOST_PENDING = 900.0, 5000
DAY_S = 86400.0
TERM_DAYS = 200.0  # for which a token is valid unless another time is given


@dataclass(frozen=True)
class TokenInfo:
    """A token with its person, their role in the course, and its scopes; ``over`` is the reason why it is not
    valid, or None.
    """

    id: UUID
    person: str
    role: str
    scopes: frozenset[str]
    over: str | None


class LoginOver(Exception):
    """The login was refused, already collected or not confirmed in time."""


async def create(
    connection: Connection,
    name: str,
    *,
    label: str,
    scopes: Sequence[str],
    seconds: float,
    prefix: str = PREFIX,
) -> str:
    """Return a new token of the person, who is added if unknown. Only its digest is stored."""
    await add_person(connection, name)
    ((_, token),) = await create_all(
        connection, [name], label=label, scopes=scopes, seconds=seconds, prefix=prefix
    )
    return token


async def create_all(
    connection: Connection,
    names: Sequence[str],
    *,
    label: str,
    scopes: Sequence[str],
    seconds: float,
    prefix: str = PREFIX,
) -> list[tuple[str, str]]:
    """Return (name, new token) for each of these people, who must exist.
    Only the tokens' digests are stored.
    """
    given = [(name, prefix + secrets.token_urlsafe(32)) for name in names]
    values = {
        "names": list(names),
        "digests": [_digest(token) for _, token in given],
        "prefixes": [t[:SHOWN_CHARACTERS] for _, t in given],
    }
    await connection.execute(_INSERT, values | {"label": label, "scopes": list(scopes), "seconds": seconds})
    return given


async def create_session(connection: Connection, name: str, *, label: str, seconds: float) -> str:
    """Return the secret of a new browser session of the person. The API does not accept it as a token."""
    return await create(connection, name, label=label, scopes=BROWSER, seconds=seconds, prefix=SESSION)


async def find(database: Database, token: str) -> TokenInfo | None:
    """Return the token's person, scopes and validity, or None if it does not exist.

    Record its use, to the hour.
    """
    row = await database.first(_FIND, {"digest": _digest(token), "course": COURSE})
    if row is None:
        return None
    if row.stale:
        async with database.begin() as connection:
            await connection.execute("UPDATE token SET used_at = now() WHERE id = %(id)s", {"id": row.id})
    over = f"was revoked on {row.revoked_at:%Y-%m-%d}" if row.revoked_at else None
    over = over or (f"expired on {row.expires_at:%Y-%m-%d}" if row.expired else None)
    return TokenInfo(row.id, row.name, row.role, frozenset(row.scopes), over)


async def revoke(connection: Connection, *, id: UUID | None = None, person: str | None = None) -> int:
    """Revoke one token, or all tokens and pending logins of a person; return the number of tokens."""
    await connection.execute(_DROP_LOGINS, {"person": person})
    return len(await connection.rows(_REVOKE, {"id": id, "person": person}))


async def revoke_own(connection: Connection, name: str, id: UUID) -> bool:
    """Revoke one token or session of the person. Return False if it is another person's or no longer
    valid.
    """
    return bool(await connection.rows(_REVOKE_OWN, {"id": id, "person": name}))


async def end_sessions(connection: Connection, name: str, *, but: UUID | None = None) -> int:
    """End the person's sessions except ``but``, and pending logins; return the number of sessions."""
    await connection.execute(_DROP_LOGINS, {"person": name})
    return len(await connection.rows(_END, {"person": name, "but": but}))


async def all_of(database: Database, person: str | None = None) -> Sequence[Row]:
    """Return tokens and sessions, of everyone or of one person, newest first."""
    return await database.rows(_LIST, {"person": person})


async def create_login(database: Database, label: str) -> tuple[str, str]:
    """Create a login to be confirmed; return the device's secret and the code to show to the person.

    Expired logins are deleted, and the oldest beyond MOST_PENDING that nobody has confirmed.
    """
    device, letters = secrets.token_urlsafe(32), [secrets.choice(LETTERS) for _ in range(8)]
    code = "".join(letters[:4]) + "-" + "".join(letters[4:])
    async with database.begin() as connection:
        await connection.execute(_DROP_OLD, {"most": MOST_PENDING - 1})
        values = {"digest": _digest(device), "code": code, "label": label, "seconds": LOGIN_S}
        await connection.execute(_BEGIN, values)
    return device, code


async def find_login(database: Database, code: str) -> str | None:
    """Return the label of the pending login with that code, or None."""
    row = await database.first(_OPEN, {"code": _tidy(code)})
    return None if row is None else str(row.label)


async def confirm_login(database: Database, code: str, name: str | None) -> bool:
    """Confirm a pending login for a person, or refuse it if ``name`` is None.

    Return False if no login with that code is pending.
    """
    async with database.begin() as connection:
        person = None if name is None else await add_person(connection, name)
        values = {"code": _tidy(code), "person": person, "refused": person is None}
        return bool(await connection.rows(_CONFIRM, values))


async def collect_login(database: Database, device: str, days: float) -> tuple[str, str] | None:
    """Return a new token and the person of a confirmed login, once; None while it is pending.

    The token is valid for ``days`` days. Raises LoginOver if the login was refused, collected or has expired.
    """
    async with database.begin() as connection:
        row = await connection.first(_COLLECT, {"digest": _digest(device)})
        if row is not None:
            return await create(
                connection, row.name, label=row.label, scopes=NOTEBOOK, seconds=days * DAY_S
            ), str(row.name)
    if not await database.rows(_PENDING, {"digest": _digest(device)}):
        raise LoginOver
    return None


def _digest(token: str) -> str:
    return sha256(token.encode()).hexdigest()


def _tidy(code: str) -> str:
    letters = [c for c in code.upper() if c in LETTERS][:8]
    return "".join(letters[:4]) + "-" + "".join(letters[4:])


_INSERT = """
INSERT INTO token (person_id, digest, prefix, label, scopes, expires_at)
SELECT p.id, new.digest, new.prefix, %(label)s, %(scopes)s, now() + make_interval(secs => %(seconds)s)
FROM unnest(CAST(%(names)s AS text[]), CAST(%(digests)s AS text[]), CAST(%(prefixes)s AS text[]))
    AS new (name, digest, prefix)
    JOIN person p USING (name)
"""
_FIND = """
SELECT t.id, p.name, coalesce(m.role, 'student') AS role, t.scopes, t.revoked_at, t.expires_at,
    t.expires_at < now() AS expired,
    coalesce(t.used_at < now() - interval '1 hour', true) AS stale
FROM token t JOIN person p ON p.id = t.person_id
    LEFT JOIN member m ON m.person_id = p.id AND m.course_id = (SELECT id FROM course WHERE slug = %(course)s)
WHERE t.digest = %(digest)s
"""
_REVOKE = """
UPDATE token t SET revoked_at = now() FROM person p
WHERE p.id = t.person_id AND t.revoked_at IS NULL AND (t.id = CAST(%(id)s AS uuid)
    OR p.name = CAST(%(person)s AS text)) RETURNING t.id
"""
_REVOKE_OWN = """
UPDATE token t SET revoked_at = now() FROM person p
WHERE p.id = t.person_id AND t.revoked_at IS NULL AND t.expires_at > now()
    AND t.id = %(id)s AND p.name = %(person)s RETURNING t.id
"""
_END = f"""
UPDATE token t SET revoked_at = now() FROM person p
WHERE p.id = t.person_id AND t.revoked_at IS NULL AND t.expires_at > now() AND p.name = %(person)s
    AND starts_with(t.prefix, '{SESSION}') AND t.id IS DISTINCT FROM CAST(%(but)s AS uuid) RETURNING t.id
"""
_DROP_LOGINS = (
    "DELETE FROM device_login l USING person p WHERE p.id = l.person_id AND p.name = CAST(%(person)s AS text)"
)
_LIST = """
SELECT t.id, p.name, t.prefix, t.label, t.scopes, t.created_at, t.expires_at, t.used_at, t.revoked_at,
    t.expires_at < now() AS expired
FROM token t JOIN person p ON p.id = t.person_id WHERE coalesce(p.name = CAST(%(person)s AS text), true)
    ORDER BY t.created_at DESC
"""
_BEGIN = """
INSERT INTO device_login (device_digest, user_code, label, expires_at)
VALUES (%(digest)s, %(code)s, %(label)s, now() + make_interval(secs => %(seconds)s))
"""
_DROP_OLD = """
DELETE FROM device_login WHERE expires_at < now() OR device_digest IN (
    SELECT device_digest FROM device_login WHERE person_id IS NULL ORDER BY created_at DESC OFFSET %(most)s
)
"""
_OPEN = (
    "SELECT label FROM device_login WHERE user_code = %(code)s AND expires_at > now() AND person_id IS NULL"
    " AND NOT refused"
)
_CONFIRM = """
UPDATE device_login SET person_id = %(person)s, refused = %(refused)s
WHERE user_code = %(code)s AND expires_at > now() AND person_id IS NULL AND NOT refused RETURNING user_code
"""
_COLLECT = """
DELETE FROM device_login l USING person p WHERE p.id = l.person_id AND l.device_digest = %(digest)s
    AND l.expires_at > now()
RETURNING p.name, l.label
"""
_PENDING = (
    "SELECT 1 FROM device_login WHERE device_digest = %(digest)s AND expires_at > now() AND NOT refused"
)
