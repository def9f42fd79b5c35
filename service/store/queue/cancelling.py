"""Cancel gradings. The result names the staff member, and the submission does not use up the limit."""

from collections.abc import Sequence
from uuid import UUID

from service.store.course import audit
from service.store.database import Connection, Database
from service.store.queue import runs
from service.store.queue.jobs import delete_waiting, lock_persons, send_next


class AlreadyFinished(Exception):
    """The grading already has a result, so it cannot be cancelled."""


async def cancel(database: Database, grading: UUID, actor: str) -> UUID | None:
    """Cancel a grading and return the id of its submission, or None if the grading does not exist.

    A worker that is grading it stops at its next heartbeat. Raises AlreadyFinished if the grading has a
    result.
    """
    async with database.begin() as connection:
        found = await connection.first(_FOUND, {"grading": grading})
        if found is None:
            return None
        if not await _stop(connection, [grading], actor):
            raise AlreadyFinished
        await lock_persons(connection, [found.submission])
        await delete_waiting(connection, [grading])
        await send_next(connection, grading)
        detail = {"person": found.person, "grading": found.number, "preview": found.preview}
        await audit.record(connection, actor, "cancel", str(found.submission), detail)
        await runs.notify_in(connection, found.submission)
    submission: UUID = found.submission
    return submission


async def cancel_all_of(connection: Connection, regrade: UUID, actor: str) -> int:
    """Cancel the unfinished gradings of a regrade in this transaction and return their number."""
    open = [row.id for row in await connection.rows(_OPEN, {"regrade": regrade})]
    stopped = await _stop(connection, open, actor)
    await delete_waiting(connection, stopped)
    return len(stopped)


async def _stop(connection: Connection, gradings: Sequence[UUID], actor: str) -> Sequence[UUID]:
    """Record results, end runs and return the gradings that had no result before."""
    note = f"cancelled by {actor}"
    values = {"gradings": list(gradings), "note": note, "actor": actor}
    stopped = [row.grading_id for row in await connection.rows(_CANCEL, values)]
    await connection.execute(_END_RUNS, {"gradings": stopped, "note": note})
    return stopped


# Takes the lock of ``claim``, and takes it before the person's: so it sees and ends a run that starts
# meanwhile, without deadlock. A stronger lock would conflict with the key lock of a result that is being
# inserted.
_FOUND = """
SELECT a.number, a.preview, s.id AS submission, p.name AS person
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
WHERE a.id = %(grading)s FOR NO KEY UPDATE OF a
"""

_OPEN = """
SELECT a.id FROM grading a WHERE a.regrade_id = %(regrade)s
    AND NOT EXISTS (SELECT 1 FROM result r WHERE r.grading_id = a.id) ORDER BY a.id FOR NO KEY UPDATE OF a
"""

_CANCEL = """
INSERT INTO result (grading_id, fault, cancelled_by)
SELECT unnest(CAST(%(gradings)s AS uuid[])), %(note)s, %(actor)s
ON CONFLICT DO NOTHING RETURNING grading_id
"""

_END_RUNS = """
UPDATE run SET ended_at = now(), end_reason = 'cancelled', note = %(note)s
WHERE grading_id = ANY(%(gradings)s) AND ended_at IS NULL
"""
