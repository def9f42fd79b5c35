"""What a regrade would change: points before and after by submission, and every check that comes out otherwise."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Row

from service.store.database import Database
from service.store.reading import LATE, points


async def pairs(database: Database, id: UUID) -> Sequence[Row[Any]]:
    """By submission, what counts without this regrade (``was``) and what with it, points given by an instructor included.

    Rows also have ``overridden``, and ``overtaken`` where a later attempt is shown already.
    """
    return await database.rows(_PAIRS, {"id": id})


async def flips(database: Database, id: UUID) -> Sequence[Row[Any]]:
    """Every check whose state is another than before: ``attempt``, ``check_id``, ``was`` and ``now``, None where there was none."""
    return await database.rows(_FLIPS, {"id": id})


# The attempt that counts without this regrade: the last before it with a report.
_BEFORE = """
LATERAL (
    SELECT b.id AS attempt, q.score, q.max_score, q.version FROM attempt b JOIN result q ON q.attempt_id = b.id
    WHERE b.submission_id = a.submission_id AND b.number < a.number AND NOT b.held AND q.report IS NOT NULL
    ORDER BY b.number DESC LIMIT 1
) was ON true
"""

_PAIRS = f"""
SELECT a.id AS attempt, s.id AS submission, s.submitted_at, {LATE}, p.name AS person, r.attempt_id IS NOT NULL AS finished, r.fault,
    r.cancelled_by, was.score AS was_score, was.max_score AS was_max, was.version AS was_version, r.score, r.max_score, r.version,
    before.points AS was_points, given.points, given.overridden, EXISTS (
        SELECT 1 FROM attempt b JOIN result q ON q.attempt_id = b.id
        WHERE b.submission_id = s.id AND b.number > a.number AND NOT b.held AND q.report IS NOT NULL) AS overtaken
FROM attempt a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
    JOIN assignment x ON x.id = s.assignment_id LEFT JOIN result r ON r.attempt_id = a.id LEFT JOIN {_BEFORE}
    LEFT JOIN {points("before", "was.attempt", "was.score")} LEFT JOIN {points("given", "a.id", "r.score")}
WHERE a.regrade_id = :id ORDER BY p.name, s.submitted_at
"""

_FLIPS = f"""
SELECT attempt, check_id, max(state) FILTER (WHERE old) AS was, max(state) FILTER (WHERE NOT old) AS now
FROM (
    SELECT a.id AS attempt, o.check_id, o.state, told.old
    FROM attempt a JOIN result r ON r.attempt_id = a.id AND r.report IS NOT NULL JOIN {_BEFORE},
        LATERAL (VALUES (was.attempt, true), (a.id, false)) AS told (attempt, old), outcome o
    WHERE a.regrade_id = :id AND o.attempt_id = told.attempt
) both_sides
GROUP BY attempt, check_id HAVING count(*) = 1 OR min(state) <> max(state) ORDER BY check_id
"""
