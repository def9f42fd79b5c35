"""Previewed regrades: nothing shown changes until an instructor applies the regrade."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from service.store.course import audit, grades
from service.store.database import Database, Row
from service.store.queue import runs
from service.store.queue.cancelling import cancel_all_of
from service.store.queue.jobs import lock_persons, send_gradings
from service.store.submissions.accepting import MAX_RUNS
from service.store.submissions.records import LAST, LATE, SHOWN, points

BATCH = 50
BEST, EVERY = "all", "every"
"""What a regrade covers: everybody's counted submission, or every submission."""


class NothingToGrade(Exception):
    """No selected submission can be regraded: none has a result yet, or all are being graded."""


class RegradeClosed(Exception):
    """The regrade has already been applied or dropped; the message says by whom."""


class RegradeIncomplete(Exception):
    """The regrade cannot be applied yet; the message says how many gradings have no result."""


@dataclass(frozen=True)
class Regrade:
    """A regrade. ``decided`` is "applied", "dropped" or None.

    Of its ``total`` gradings, ``finished`` have a result and ``graded`` have a report.
    """

    id: UUID
    assignment: str
    description: str
    requested_by: str
    requested_at: datetime
    decided: str | None
    decided_by: str | None
    decided_at: datetime | None
    finished: int
    graded: int
    total: int


async def create(
    database: Database,
    slug: str,
    which: UUID | str,
    actor: str,
    *,
    check: str | None = None,
    description: str,
) -> UUID:
    """Queue preview gradings and return the id of the new regrade.

    ``which`` is the id of one submission, BEST or EVERY; with ``check``, only submissions that do not pass
    that check. Submissions that are being graded, also as a preview, are skipped. Pages show
    ``description``. Raises NothingToGrade if no submission is left.
    """
    if isinstance(which, UUID):
        query, values = _ONE, {"slug": slug, "one": which}
    else:
        query, values = _SELECTED[which], {"slug": slug, "person": None, "check": check}
    async with database.begin() as connection:
        id = (await connection.one(_BEGIN, {"slug": slug, "description": description, "actor": actor})).id
        selected = [row.id for row in await connection.rows(query, values)]
    count = 0  # in batches, each its own transaction, so that students who submit meanwhile wait little
    for start in range(0, len(selected), BATCH):
        count += await _add(database, id, selected[start : start + BATCH])
    async with database.begin() as connection:
        if count:
            await audit.record(
                connection,
                actor,
                "regrade begun",
                str(id),
                {"assignment": slug, "what": description, "submissions": count},
            )
            return UUID(str(id))
        await connection.execute("DELETE FROM regrade WHERE id = %(id)s", {"id": id})
    raise NothingToGrade


async def _add(database: Database, id: UUID, submissions: Sequence[UUID]) -> int:
    """Queue preview gradings and return their number, which is 0 if the regrade has been decided
    meanwhile.
    """
    async with database.begin() as connection:
        await lock_persons(connection, submissions)
        if await connection.first(_UNDECIDED, {"id": id}) is None:
            return 0
        values = {"regrade": id, "submissions": list(submissions), "max_runs": MAX_RUNS}
        added = [row.id for row in await connection.rows(_ADD, values)]
        await send_gradings(connection, added)
    return len(added)


async def find(database: Database, id: UUID) -> Regrade | None:
    """Return the regrade with that id, or None."""
    row = await database.first(_FIND, {"id": id, "slug": None})
    return None if row is None else Regrade(**row._asdict())


async def of_assignment(database: Database, slug: str) -> Sequence[Regrade]:
    """Return the latest hundred regrades of an assignment, newest first."""
    return [Regrade(**row._asdict()) for row in await database.rows(_FIND, {"id": None, "slug": slug})]


async def apply(database: Database, id: UUID, actor: str) -> int:
    """Make all reports of the regrade count, and return the number of submissions that changed.

    Gradings that ended in a system fault stay previews. Raises RegradeClosed if the regrade was decided
    before, and RegradeIncomplete while a result is missing.
    """
    async with database.begin() as connection:
        if not await connection.execute(_DECIDE, {"id": id, "how": "applied", "actor": actor}):
            raise RegradeClosed(await _decision(database, id))
        if open := (await connection.one(_OPEN, {"id": id}))[0]:
            raise RegradeIncomplete(f"{open} of its submissions have not been graded yet")
        changed = await connection.rows(_RELEASE, {"id": id})
        await audit.record(connection, actor, "regrade applied", str(id), {"submissions": len(changed)})
        for row in changed:
            await runs.notify_in(connection, row.submission_id)
    return len(changed)


async def drop(database: Database, id: UUID, actor: str) -> int:
    """Discard the regrade and return the number of gradings cancelled.

    Raises RegradeClosed if it was decided before.
    """
    async with database.begin() as connection:
        if not await connection.execute(_DECIDE, {"id": id, "how": "dropped", "actor": actor}):
            raise RegradeClosed(await _decision(database, id))
        cancelled = await cancel_all_of(connection, id, actor)
        await audit.record(connection, actor, "regrade dropped", str(id), {"cancelled": cancelled})
    return cancelled


async def _decision(database: Database, id: UUID) -> str:
    regrade = await find(database, id)
    if regrade is None or not regrade.decided:
        return "there is no such regrade"
    return f"{regrade.decided_by} has already {regrade.decided} this regrade: reload the page"


_BEGIN = """
INSERT INTO regrade (assignment_id, description, requested_by)
SELECT id, %(description)s, %(actor)s FROM assignment WHERE slug = %(slug)s RETURNING id
"""

_EVERY = f"""
SELECT s.id, s.person_id, shown.grading, shown.score
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN {SHOWN} WHERE x.slug = %(slug)s
"""

_ONE = """
SELECT s.id FROM submission s JOIN assignment x ON x.id = s.assignment_id
WHERE s.id = %(one)s AND x.slug = %(slug)s
"""

_SELECTED = {
    which: (
        f"""
SELECT id FROM ({query}) counted
WHERE score IS NOT NULL AND (CAST(%(check)s AS text) IS NULL OR EXISTS (
    SELECT 1 FROM outcome o WHERE o.grading_id = counted.grading AND o.check_id = %(check)s AND o.counted
    AND o.state <> 'pass'))
ORDER BY person_id
"""
    )
    for which, query in ((BEST, grades.BEST), (EVERY, _EVERY))
}

_UNDECIDED = "SELECT 1 FROM regrade WHERE id = %(id)s AND decided IS NULL FOR SHARE"

_ADD = f"""
INSERT INTO grading (id, submission_id, number, kind, seed, max_runs, requested_at, regrade_id, preview)
SELECT gen_random_uuid(), s.id, (SELECT max(number) + 1 FROM grading b
    WHERE b.submission_id = s.id), 'regrade', a.seed, %(max_runs)s,
    clock_timestamp(), %(regrade)s, true
FROM submission s JOIN {LAST}
WHERE s.id = ANY(%(submissions)s) AND NOT EXISTS (
    SELECT FROM grading b LEFT JOIN result q ON q.grading_id = b.id
    WHERE b.submission_id = s.id AND b.preview AND q.grading_id IS NULL)
RETURNING id
"""

_FIND = """
SELECT g.id, x.slug AS assignment, g.description, g.requested_by, g.requested_at, g.decided, g.decided_by,
    g.decided_at,
    count(r.grading_id) AS finished, count(r.score) AS graded, count(a.id) AS total
FROM regrade g JOIN assignment x ON x.id = g.assignment_id LEFT JOIN grading a ON a.regrade_id = g.id
    LEFT JOIN result r ON r.grading_id = a.id
WHERE g.id = CAST(%(id)s AS uuid) OR x.slug = CAST(%(slug)s AS text) GROUP BY g.id, x.slug
    ORDER BY g.requested_at DESC LIMIT 100
"""

_DECIDE = """
UPDATE regrade SET decided = %(how)s, decided_by = %(actor)s, decided_at = clock_timestamp()
WHERE id = %(id)s AND decided IS NULL
"""

_OPEN = """
SELECT count(*) FROM grading a WHERE regrade_id = %(id)s AND NOT EXISTS (SELECT 1 FROM result r
    WHERE r.grading_id = a.id)
"""

# A report of a later grading stays shown.
_OVERTAKEN = """EXISTS (
    SELECT 1 FROM grading b JOIN result q ON q.grading_id = b.id
    WHERE b.submission_id = a.submission_id AND b.number > a.number AND NOT b.preview
    AND q.report IS NOT NULL)
"""

_RELEASE = f"""
UPDATE grading a SET preview = false FROM result r
WHERE a.regrade_id = %(id)s AND r.grading_id = a.id AND r.report IS NOT NULL AND NOT {_OVERTAKEN}
RETURNING a.submission_id
"""


async def score_changes(database: Database, id: UUID) -> Sequence[Row]:
    """Return a row per submission with points without this regrade (``was_…``) and with it.

    Rows also have ``overridden`` and ``overtaken``, which says that a later grading is shown already.
    """
    return await database.rows(_PAIRS, {"id": id})


async def check_changes(database: Database, id: UUID) -> Sequence[Row]:
    """Return changed checks: rows of ``grading``, ``check_id``, states ``was`` and ``now`` and their points
    (or None).
    """
    return await database.rows(_FLIPS, {"id": id})


# The grading that counts without this regrade: the last earlier one with a report.
_BEFORE = """
LATERAL (
    SELECT b.id AS grading, q.score, q.max_score, q.version FROM grading b
    JOIN result q ON q.grading_id = b.id
    WHERE b.submission_id = a.submission_id AND b.number < a.number AND NOT b.preview AND q.report IS NOT NULL
    ORDER BY b.number DESC LIMIT 1
) was ON true
"""

_PAIRS = f"""
SELECT a.id AS grading, s.id AS submission, s.submitted_at, {LATE}, p.name AS person, p.full_name,
    r.grading_id IS NOT NULL AS finished, r.fault, r.cancelled_by, was.score AS was_score,
    was.max_score AS was_max,
    was.version AS was_version, r.score, r.max_score, r.version,
    before.points AS was_points, given.points, given.overridden, {_OVERTAKEN} AS overtaken
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
    JOIN assignment x ON x.id = s.assignment_id LEFT JOIN result r ON r.grading_id = a.id LEFT JOIN {_BEFORE}
    LEFT JOIN {points("before", "was.grading", "was.score")} LEFT JOIN {points("given", "a.id", "r.score")}
WHERE a.regrade_id = %(id)s ORDER BY p.sort_key, p.name, s.submitted_at
"""

_FLIPS = f"""
SELECT grading, check_id, max(state) FILTER (WHERE old) AS was, max(state) FILTER (WHERE NOT old) AS now,
    max(earned) FILTER (WHERE old) AS was_points, max(earned) FILTER (WHERE NOT old) AS now_points
FROM (
    SELECT a.id AS grading, o.check_id, o.state, o.earned, side.old
    FROM grading a JOIN result r ON r.grading_id = a.id AND r.report IS NOT NULL JOIN {_BEFORE},
        LATERAL (VALUES (was.grading, true), (a.id, false)) AS side (grading, old), outcome o
    WHERE a.regrade_id = %(id)s AND o.grading_id = side.grading
) both_sides
GROUP BY grading, check_id HAVING count(*) = 1 OR min(state) <> max(state) OR min(earned) <> max(earned)
ORDER BY check_id
"""
