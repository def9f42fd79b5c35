"""Registered workers, and recovery of gradings whose worker or job was lost."""

from uuid import UUID

from sqlalchemy import text
from sqlalchemy.ext.asyncio import AsyncConnection

from service.settings import LEASE_S
from service.store.database import Database
from service.store.queue import send_grading

JOBLESS_AFTER_S = 5.0  # an open grading older than this without a job gets one


async def register_worker(
    database: Database, worker: str, isolation: str | None, unavailable_reason: str | None, zygote_restarts: int = 0
) -> None:
    """Record that a worker is alive, with its isolation level or the reason why it cannot grade."""
    values = {"name": worker, "isolation": isolation, "reason": unavailable_reason, "zygote_restarts": zygote_restarts}
    async with database.begin() as connection:
        await connection.execute(_REGISTER, values)


async def unregister_worker(database: Database, worker: str) -> None:
    """Remove a worker that stops."""
    async with database.begin() as connection:
        await connection.execute(text("DELETE FROM worker WHERE name = :name"), {"name": worker})


_REGISTER = text("""
INSERT INTO worker (name, isolation, unavailable_reason, zygote_restarts) VALUES (:name, :isolation, :reason, :zygote_restarts)
ON CONFLICT (name) DO UPDATE
    SET isolation = :isolation, unavailable_reason = :reason, zygote_restarts = :zygote_restarts, seen_at = now()
""")


async def recover(database: Database, lease_s: float = LEASE_S) -> list[UUID]:
    """Queue gradings of lost runs again, drop jobs of finished gradings, and return the former.

    A run without a heartbeat for ``lease_s`` seconds is lost: its worker is dead, frozen or disconnected.
    """
    again = []
    async with database.begin() as connection:
        for job in (await connection.execute(_STALE, {"lease": lease_s})).all():
            if job.finished or job.task_name != "grade":
                continue
            again.append(UUID(job.grading))
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
        locked = (await connection.execute(_TRY_LOCK)).scalar()
        for row in (await connection.execute(_ORPHANS, {"lease": lease_s})).all() if locked else []:
            again.append(row.grading_id)
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
    return again


async def sweep(database: Database, lease_s: float = LEASE_S) -> list[UUID]:
    """Queue open gradings without a job, remove workers unseen for an hour, and return the gradings queued."""
    async with database.begin() as connection:
        if not (await connection.execute(_TRY_LOCK)).scalar():
            return []
        found = [row.id for row in (await connection.execute(_JOBLESS, {"after": JOBLESS_AFTER_S})).all()]
        for grading in found:
            await _lose_and_send(connection, grading, lease_s, begun=False)
        await connection.execute(_FORGET_WORKERS)
    return found


async def _lose_and_send(connection: AsyncConnection, grading: UUID, lease_s: float, *, begun: bool) -> None:
    await connection.execute(_LOSE, {"grading": grading, "lease": lease_s})
    await send_grading(connection, grading, begun=begun)


# Jobs taken by a worker whose run is silent or never began, or whose grading is finished. No heartbeat can
# arrive while the database is down, so a lease counts from the database's start at the earliest.
# Procrastinate's own worker heartbeat is ignored: a live worker may have lost track of a job. A sweep has
# no run, and gets 120 s.
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
UPDATE run SET ended_at = now(), end_reason = 'lost', note = 'the worker stopped sending heartbeats'
WHERE grading_id = :grading AND ended_at IS NULL AND heartbeat_at < now() - make_interval(secs => :lease)
""")

# Silent runs without a job.
_ORPHANS = text("""
SELECT DISTINCT grading_id FROM run LEFT JOIN result USING (grading_id)
WHERE run.ended_at IS NULL AND result.grading_id IS NULL
    AND greatest(heartbeat_at, pg_postmaster_start_time()) < now() - make_interval(secs => :lease)
    AND NOT EXISTS (SELECT 1 FROM procrastinate_jobs j WHERE j.task_name = 'grade' AND j.args->>'attempt' = run.grading_id::text)
""")

_TRY_LOCK = text("SELECT pg_try_advisory_xact_lock(2626)")

_JOBLESS = text("""
SELECT a.id FROM grading a LEFT JOIN result r ON r.grading_id = a.id
WHERE r.grading_id IS NULL AND a.requested_at < now() - make_interval(secs => :after) AND NOT EXISTS (
    SELECT 1 FROM procrastinate_jobs j
    WHERE j.status IN ('todo', 'doing') AND j.task_name = 'grade' AND j.args->>'attempt' = a.id::text)
ORDER BY a.requested_at
""")

_FORGET_WORKERS = text("DELETE FROM worker WHERE seen_at < now() - interval '1 hour'")
