"""Extensions: later deadlines for single people, with the reason."""

from collections.abc import Sequence
from datetime import datetime

from service.store.course import audit
from service.store.database import Database, Row
from service.store.people.people import COURSE
from service.store.submissions.records import FAULTED, OWN_DEADLINE, SHOWN, STATUS


async def extend(database: Database, slug: str, name: str, due_at: datetime, *, reason: str, by: str) -> bool:
    """Set or replace a person's extension of an assignment.
    Return False if the person is not in the course.
    """
    values = {"slug": slug, "name": name, "course": COURSE, "due": due_at, "reason": reason, "by": by}
    async with database.begin() as connection:
        before = await connection.first(_OWN, values)
        if await connection.first(_EXTEND, values) is None:
            return False
        changed = audit.changes({"due": before and before.due_at}, {"due": due_at})
        detail = {"assignment": slug, **changed, "reason": reason}
        await audit.record(connection, by, "extension", name, detail)
    return True


async def remove_extension(database: Database, slug: str, name: str, by: str) -> bool:
    """Remove a person's extension. Return False if there is none."""
    async with database.begin() as connection:
        removed = await connection.first(_REMOVE, {"slug": slug, "name": name, "course": COURSE})
        if removed is not None:
            detail = {"assignment": slug, "due": removed.due_at.isoformat(), "reason": removed.reason}
            await audit.record(connection, by, "extension taken back", name, detail)
    return removed is not None


async def removed_extension(database: Database, slug: str, name: str) -> Row | None:
    """Return ``name``, ``full_name``, ``due_at`` and ``reason`` of a person's extension that was removed
    last, unless it is past or they have another one; None without one.
    """
    return await database.first(_REMOVED, {"slug": slug, "name": name, "course": COURSE})


async def extensions(database: Database, slug: str) -> Sequence[Row]:
    """Return the extensions of an assignment, latest deadline first."""
    return await database.rows(_LIST, {"slug": slug, "course": COURSE})


async def of_person(database: Database, name: str) -> Sequence[Row]:
    """Return the row of ``own`` for each assignment, with its ``slug``, ``weight``, the ``reason`` of the
    extension, if any, and the ``status`` of the last submission.
    """
    return await database.rows(_OWN, {"slug": None, "name": name, "course": COURSE})


async def own(database: Database, slug: str, name: str) -> Row:
    """Return a person's own rules: ``due_at`` with the extension, whether it is ``extended`` and, with
    ``grace_s``, ``over``, the ``submission_limit``, and how many submissions are ``used``.
    """
    return await database.one(_OWN, {"slug": slug, "name": name, "course": COURSE})


_OF = """
FROM assignment x JOIN course c ON c.id = x.course_id JOIN member m ON m.course_id = c.id
    JOIN person p ON p.id = m.person_id
WHERE x.slug = %(slug)s AND c.slug = %(course)s"""

_EXTEND = f"""
INSERT INTO extension (assignment_id, person_id, due_at, reason, given_by)
SELECT x.id, p.id, %(due)s, %(reason)s, %(by)s {_OF} AND p.name = %(name)s
ON CONFLICT (assignment_id, person_id) DO UPDATE
    SET due_at = %(due)s, reason = %(reason)s, given_by = %(by)s, given_at = now()
RETURNING person_id
"""

_REMOVE = f"""
DELETE FROM extension WHERE (assignment_id, person_id) IN (SELECT x.id, p.id {_OF} AND p.name = %(name)s)
    RETURNING due_at, reason
"""

_REMOVED = f"""
SELECT * FROM (
    SELECT p.name, p.full_name, CAST(a.detail->>'due' AS timestamptz) AS due_at, a.detail->>'reason' AS reason
    FROM audit a JOIN person p ON p.name = a.subject
    WHERE a.action = 'extension taken back' AND a.subject = %(name)s AND a.detail->>'assignment' = %(slug)s
    AND NOT EXISTS (
        SELECT FROM extension e WHERE e.person_id = p.id AND e.assignment_id IN (SELECT x.id {_OF}))
    ORDER BY a.id DESC LIMIT 1
) last WHERE due_at > now()
"""

_LIST = f"""
SELECT p.name, p.full_name, e.due_at, e.reason, e.given_by, e.given_at
FROM extension e JOIN person p ON p.id = e.person_id
WHERE (e.assignment_id, e.person_id) IN (SELECT x.id, p.id {_OF}) ORDER BY e.due_at DESC, p.sort_key, p.name
"""

_OWN = f"""
SELECT x.slug, x.weight, e.reason, until.due_at, coalesce(until.due_at > x.due_at, false) AS extended,
    x.grace_s, x.submission_limit,
    coalesce(now() > until.due_at + make_interval(secs => x.grace_s), false) AS over, last.status,
    (SELECT count(*) FROM submission s WHERE s.person_id = p.id AND s.assignment_id = x.id
    AND NOT {FAULTED}) AS used
FROM assignment x JOIN course c ON c.id = x.course_id LEFT JOIN person p ON p.name = %(name)s
    LEFT JOIN extension e ON e.assignment_id = x.id AND e.person_id = p.id
    JOIN LATERAL {OWN_DEADLINE}
    LEFT JOIN LATERAL (
        SELECT {STATUS} FROM submission s JOIN {SHOWN}
        WHERE s.assignment_id = x.id AND s.person_id = p.id ORDER BY s.submitted_at DESC LIMIT 1
    ) last ON true
WHERE coalesce(x.slug = CAST(%(slug)s AS text), true) AND c.slug = %(course)s ORDER BY x.due_at, x.slug
"""
