"""Settings of an assignment: whether it is published, from when and until when it is open, how often one may
submit, its weight, and when the students see scores and the details of hidden checks.

A setting is a column of the table ``assignment`` and a field of AssignmentSettings.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from typing import Any

from service.store.course import audit
from service.store.database import Connection, Database
from service.store.people.people import COURSE

RELEASES = ("immediately", "deadline", "manually")


@dataclass(frozen=True)
class AssignmentSettings:
    """What the course staff has set for an assignment.

    Students see nothing of a draft, which is not ``published`` and does not count in the course's total.
    Before ``available_from`` they see the title and that time. ``grace_s`` is the time in seconds after
    the deadline ``due_at`` in which submissions are accepted and marked late. Without a time or a
    ``submission_limit`` there is no limit. ``scores_release`` and ``details_release`` are one of RELEASES.
    """

    published: bool = False
    available_from: datetime | None = None
    due_at: datetime | None = None
    grace_s: float = 0.0
    submission_limit: int | None = None
    weight: float = 1.0
    scores_release: str = "immediately"
    details_release: str = "immediately"


NAMES = tuple(field.name for field in fields(AssignmentSettings))


async def change(
    database: Database, slug: str, changes: Mapping[str, Any], actor: str
) -> AssignmentSettings | None:
    """Change the settings named in ``changes``, and return all of them; the audit log gets those that differ.
    Return None if the assignment does not exist.
    """
    async with database.begin() as connection:
        return await change_in(connection, slug, changes, actor)


async def change_in(
    connection: Connection, slug: str, changes: Mapping[str, Any], actor: str
) -> AssignmentSettings | None:
    """Change settings as ``change`` does, in this transaction."""
    row = await connection.first(_READ, {"slug": slug, "course": COURSE})
    if row is None:
        return None
    settings = row._asdict() | changes
    if changed := audit.changes(row._asdict(), changes):
        await connection.execute(_SET, settings | {"slug": slug, "course": COURSE})
        await audit.record(connection, actor, "assignment settings", slug, changed)
    return AssignmentSettings(**settings)


async def unavailable(database: Database) -> dict[str, datetime | None]:
    """Return by slug the assignments that students cannot open: the time from which they can, None for a
    draft.
    """
    rows = await database.rows(_UNAVAILABLE, {"course": COURSE})
    return {row.slug: row.available_from for row in rows}


async def release(
    database: Database, slug: str, *, scores: bool | None, details: bool | None, actor: str
) -> None:
    """Release scores or details that are released manually (True), withdraw the release (False), or leave it
    as it is (None).
    """
    async with database.begin() as connection:
        await connection.execute(
            _RELEASE, {"slug": slug, "course": COURSE, "scores": scores, "details": details}
        )
        await audit.record(connection, actor, "release", slug, {"scores": scores, "details": details})


_OF = "slug = %(slug)s AND course_id = (SELECT id FROM course WHERE slug = %(course)s)"

_READ = f"SELECT {', '.join(NAMES)} FROM assignment WHERE {_OF} FOR NO KEY UPDATE"

_SET = f"UPDATE assignment SET {', '.join(f'{name} = %({name})s' for name in NAMES)} WHERE {_OF}"

_UNAVAILABLE = """
SELECT x.slug, CASE WHEN x.published THEN x.available_from END AS available_from
FROM assignment x JOIN course c ON c.id = x.course_id
WHERE c.slug = %(course)s AND (NOT x.published OR x.available_from > now())
"""

_RELEASE = f"""
UPDATE assignment SET
    scores_released_at = CASE CAST(%(scores)s AS boolean) WHEN true THEN now() WHEN false THEN NULL
    ELSE scores_released_at END,
    details_released_at = CASE CAST(%(details)s AS boolean) WHEN true THEN now() WHEN false THEN NULL
    ELSE details_released_at END
WHERE {_OF}
"""
