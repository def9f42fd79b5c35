"""Extensions: later deadlines for single people, with the reason."""

from collections.abc import Sequence
from datetime import datetime, timedelta

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


async def extend_many(
    database: Database,
    slugs: Sequence[str],
    names: Sequence[str],
    *,
    due_at: datetime | None,
    later: timedelta,
    reason: str,
    by: str,
) -> int:
    """Give these people until ``due_at``, or if that is None until ``later`` after the deadline of each
    assignment. Return the number of extensions.

    Assignments without a deadline are left out, and who has as late a deadline keeps it.
    """
    values = {
        "slugs": list(slugs),
        "names": list(names),
        "course": COURSE,
        "due": due_at,
        "later": later,
        "reason": reason,
        "by": by,
    }
    async with database.begin() as connection:
        return len(await connection.rows(_EXTEND_MANY, values))


async def remove_many(database: Database, slugs: Sequence[str], names: Sequence[str], by: str) -> int:
    """Remove the extensions of these assignments that these people have. Return their number."""
    values = {"slugs": list(slugs), "names": list(names), "course": COURSE, "by": by}
    async with database.begin() as connection:
        return len(await connection.rows(_REMOVE_MANY, values))


async def all_extensions(database: Database) -> Sequence[Row]:
    """Return the rows of ``extensions`` of all assignments, with their ``slug`` and ``section``, in the order
    of the class.
    """
    return await database.rows(_ALL, {"course": COURSE})


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

# The audit log gets an entry for each person and assignment, as for a single extension.
_RECORD_MANY = """
INSERT INTO audit (actor, action, subject, detail)
SELECT %(by)s, {action}, p.name,
    jsonb_build_object('assignment', x.slug, 'due', done.due_at, 'reason', done.reason)
FROM done JOIN person p ON p.id = done.person_id JOIN assignment x ON x.id = done.assignment_id
ORDER BY x.slug, p.name RETURNING id
"""

_EXTEND_MANY = f"""
WITH done AS (
    INSERT INTO extension (assignment_id, person_id, due_at, reason, given_by)
    SELECT x.id, p.id, until.due_at, %(reason)s, %(by)s
    FROM assignment x JOIN course c ON c.id = x.course_id JOIN member m ON m.course_id = c.id
        JOIN person p ON p.id = m.person_id
        JOIN LATERAL (
            SELECT coalesce(CAST(%(due)s AS timestamptz), x.due_at + CAST(%(later)s AS interval)) AS due_at
        ) until ON until.due_at > x.due_at
    WHERE x.slug = ANY(%(slugs)s) AND p.name = ANY(%(names)s) AND c.slug = %(course)s
    ON CONFLICT (assignment_id, person_id) DO UPDATE
        SET due_at = excluded.due_at, reason = excluded.reason, given_by = excluded.given_by, given_at = now()
        WHERE extension.due_at < excluded.due_at
    RETURNING assignment_id, person_id, due_at, reason
) {_RECORD_MANY.format(action="'extension'")}"""

_REMOVE_MANY = f"""
WITH done AS (
    DELETE FROM extension e USING assignment x, course c, person p
    WHERE x.id = e.assignment_id AND c.id = x.course_id AND p.id = e.person_id
        AND x.slug = ANY(%(slugs)s) AND p.name = ANY(%(names)s) AND c.slug = %(course)s
    RETURNING e.assignment_id, e.person_id, e.due_at, e.reason
) {_RECORD_MANY.format(action="'extension taken back'")}"""

_ALL = """
SELECT x.slug, p.name, p.full_name, p.section, e.due_at, e.reason, e.given_by, e.given_at
FROM extension e JOIN assignment x ON x.id = e.assignment_id JOIN course c ON c.id = x.course_id
    JOIN person p ON p.id = e.person_id
WHERE c.slug = %(course)s ORDER BY p.sort_key, p.name, x.due_at, x.slug
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
