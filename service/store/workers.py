"""Which workers are there, and what they grade behind or why they cannot."""

from uuid import UUID

from sqlalchemy import text
from sqlalchemy.ext.asyncio import AsyncConnection

from service.settings import LEASE_S
from service.store.database import Database
from service.store.queue import send_grading


async def register_worker(
    database: Database, worker: str, isolation: str | None, unavailable_reason: str | None, zygote_restarts: int = 0
) -> None:
    """Tell that a worker is there and what it grades behind, or why it cannot grade."""
    values = {"name": worker, "isolation": isolation, "reason": unavailable_reason, "zygote_restarts": zygote_restarts}
    async with database.begin() as connection:
        await connection.execute(_ENROL, values)


async def unregister_worker(database: Database, worker: str) -> None:
    """Tell that a worker is not there any more."""
    async with database.begin() as connection:
        await connection.execute(text("DELETE FROM worker WHERE name = :name"), {"name": worker})


_ENROL = text("""
INSERT INTO worker (name, isolation, unavailable_reason, zygote_restarts) VALUES (:name, :isolation, :reason, :zygote_restarts)
ON CONFLICT (name) DO UPDATE
    SET isolation = :isolation, unavailable_reason = :reason, zygote_restarts = :zygote_restarts, seen_at = now()
""")


SWEPT_AFTER_S = 5.0  # an open grading older than this has a job, or gets one


async def recover(database: Database, lease_s: float = LEASE_S) -> list[UUID]:
    """Queue gradings again whose runs are lost, and forget jobs of gradings that have their result; return those queued again.

    A run that has given no sign of life for ``lease_s`` is lost: its worker is dead, frozen or cut off.
    """
    again = []
    async with database.begin() as connection:
        for job in (await connection.execute(_STALE, {"lease": lease_s})).all():
            if job.finished or job.task_name != "grade":
                continue
            again.append(UUID(job.grading))
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
        alone = (await connection.execute(_ALONE)).scalar()
        for row in (await connection.execute(_ORPHANS, {"lease": lease_s})).all() if alone else []:
            again.append(row.grading_id)
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
    return again


async def sweep(database: Database, lease_s: float = LEASE_S) -> list[UUID]:
    """Queue gradings without result that have no job at all, and forget workers long gone; the gradings queued again."""
    async with database.begin() as connection:
        if not (await connection.execute(_ALONE)).scalar():
            return []
        found = [row.id for row in (await connection.execute(_JOBLESS, {"after": SWEPT_AFTER_S})).all()]
        for grading in found:
            await _lose_and_send(connection, grading, lease_s, begun=False)
        await connection.execute(_FORGET_WORKERS)
    return found


async def _lose_and_send(connection: AsyncConnection, grading: UUID, lease_s: float, *, begun: bool) -> None:
    await connection.execute(_LOSE, {"grading": grading, "lease": lease_s})
    await send_grading(connection, grading, begun=begun)


# Jobs in the hands of a worker whose run says nothing any more, or that never began one, or whose grading is finished. Nobody can
# have said anything while the database was out, so a lease begins anew with it. The worker's own heartbeat is not asked:
# Procrastinate may leave a job with a live worker that has forgotten it. A sweep of a submission's function has no run and may
# take its time.
_STALE = text("""
DELETE FROM procrastinate_jobs WHERE id IN (
    SELECT j.id FROM procrastinate_jobs j
        JOIN LATERAL (SELECT max(at) AS at FROM procrastinate_events e WHERE e.job_id = j.id AND e.type = 'started') taken ON true
        LEFT JOIN LATERAL (
            SELECT max(greatest(heartbeat_at, ended_at)) FILTER (WHERE end_reason IS DISTINCT FROM 'lost') AS at
            FROM run WHERE run.grading_id = (j.args->>'attempt')::uuid
        ) beat ON true
    WHERE j.status = 'doing' AND greatest(taken.at, beat.at, pg_postmaster_start_time()) < now() - make_interval(
        secs => CASE WHEN j.task_name = 'grade' THEN CAST(:lease AS float) ELSE 120 END)
    FOR UPDATE OF j SKIP LOCKED
) RETURNING args->>'attempt' AS grading, task_name,
    EXISTS (SELECT 1 FROM result WHERE grading_id = (args->>'attempt')::uuid) AS finished
""")

_LOSE = text("""
UPDATE run SET ended_at = now(), end_reason = 'lost', note = 'the worker was not heard of any more'
WHERE grading_id = :grading AND ended_at IS NULL AND heartbeat_at < now() - make_interval(secs => :lease)
""")

# Runs that have fallen silent and whose job is gone.
_ORPHANS = text("""
SELECT DISTINCT grading_id FROM run LEFT JOIN result USING (grading_id)
WHERE run.ended_at IS NULL AND result.grading_id IS NULL
    AND greatest(heartbeat_at, pg_postmaster_start_time()) < now() - make_interval(secs => :lease)
    AND NOT EXISTS (SELECT 1 FROM procrastinate_jobs j WHERE j.task_name = 'grade' AND j.args->>'attempt' = run.grading_id::text)
""")

_ALONE = text("SELECT pg_try_advisory_xact_lock(2626)")

_JOBLESS = text("""
SELECT a.id FROM grading a LEFT JOIN result r ON r.grading_id = a.id
WHERE r.grading_id IS NULL AND a.requested_at < now() - make_interval(secs => :after) AND NOT EXISTS (
    SELECT 1 FROM procrastinate_jobs j
    WHERE j.status IN ('todo', 'doing') AND j.task_name = 'grade' AND j.args->>'attempt' = a.id::text)
ORDER BY a.requested_at
""")

_FORGET_WORKERS = text("DELETE FROM worker WHERE seen_at < now() - interval '1 hour'")
