"""Stopping what waits or is being graded: the grading gets a result that says by whom, which costs its person nothing."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import text
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store import runs
from service.store.course.people import record_audit
from service.store.database import Database
from service.store.queue import lock_person, send_next
from service.store.tables import result


class AlreadyFinished(Exception):
    """There is nothing to cancel: the grading has its result."""


async def cancel(database: Database, grading: UUID, who: str) -> UUID | None:
    """Cancel that grading; the id of its submission, or None where there is no such grading. Over if it has its result.

    A worker that has it notices at its next beat.
    """
    async with database.begin() as connection:
        found = (await connection.execute(_FOUND, {"grading": grading})).first()
        if found is None:
            return None
        if not await _stop(connection, [grading], who):
            raise AlreadyFinished
        await lock_person(connection, found.submission)
        await connection.execute(_FORGET_JOBS, {"gradings": [str(grading)]})
        await send_next(connection, grading, found.submission)
        detail = {"person": found.person, "grading": found.number, "preview": found.preview}
        await record_audit(connection, who, "cancel", str(found.submission), detail)
        await runs.notify_in(connection, found.submission)
    submission: UUID = found.submission
    return submission


async def cancel_all_of(connection: AsyncConnection, regrade: UUID, who: str) -> int:
    """Cancel what of a regrade has no result yet, in this transaction; how many."""
    open = [row.id for row in (await connection.execute(_OPEN, {"regrade": regrade})).all()]
    stopped = await _stop(connection, open, who) if open else []
    await connection.execute(_FORGET_JOBS, {"gradings": [str(id) for id in stopped]})
    return len(stopped)


async def _stop(connection: AsyncConnection, gradings: Sequence[UUID], who: str) -> Sequence[UUID]:
    """Write results and end the runs; those of the gradings that had no result before."""
    told = f"cancelled by {who}"
    rows = [{"grading_id": grading, "fault": told, "cancelled_by": who} for grading in gradings]
    written = insert(result).values(rows).on_conflict_do_nothing().returning(result.c.grading_id)
    stopped = [row.grading_id for row in (await connection.execute(written)).all()]
    await connection.execute(_END_RUNS, {"gradings": stopped, "note": told})
    return stopped


# Locked as by who claims it, and before the person: so a run begun meanwhile is seen and ended, and nobody waits in a circle. Not
# more than that, as a result that is being written locks the grading's key.
_FOUND = text("""
SELECT a.number, a.preview, s.id AS submission, p.name AS person
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
WHERE a.id = :grading FOR NO KEY UPDATE OF a
""")

_OPEN = text("""
SELECT a.id FROM grading a WHERE a.regrade_id = :regrade
    AND NOT EXISTS (SELECT 1 FROM result r WHERE r.grading_id = a.id) ORDER BY a.id FOR NO KEY UPDATE OF a
""")

_END_RUNS = text("""
UPDATE run SET ended_at = now(), end_reason = 'cancelled', note = :note WHERE grading_id = ANY(:gradings) AND ended_at IS NULL
""")

_FORGET_JOBS = text("""
DELETE FROM procrastinate_jobs WHERE args->>'attempt' = ANY(:gradings) AND task_name = 'grade' AND status = 'todo'
""")
