"""Registered workers, and recovery of gradings whose worker or job was lost.

All times are those of the database's clock, which may jump. A time counts as recent if it is near the
present on either side: what was stored before the clock went back lies in the future.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from uuid import UUID

from service.settings import LEASE_S
from service.store.database import Connection, Database
from service.store.queue.jobs import send_gradings

log = logging.getLogger(__name__)
JOBLESS_AFTER_S = 5.0  # an open grading older than this without a job gets one


async def register_worker(
    database: Database,
    worker: str,
    isolation: str | None,
    unavailable_reason: str | None,
    zygote_restarts: int = 0,
) -> None:
    """Record that a worker is alive, with its isolation level or the reason why it cannot grade."""
    values = {
        "name": worker,
        "isolation": isolation,
        "reason": unavailable_reason,
        "zygote_restarts": zygote_restarts,
    }
    async with database.begin() as connection:
        await connection.execute(_REGISTER, values)


async def unregister_worker(database: Database, worker: str) -> None:
    """Remove a worker that stops."""
    async with database.begin() as connection:
        await connection.execute("DELETE FROM worker WHERE name = %(name)s", {"name": worker})


_REGISTER = """
INSERT INTO worker (name, isolation, unavailable_reason, zygote_restarts)
    VALUES (%(name)s, %(isolation)s, %(reason)s, %(zygote_restarts)s)
ON CONFLICT (name) DO UPDATE
    SET isolation = %(isolation)s, unavailable_reason = %(reason)s, zygote_restarts = %(zygote_restarts)s,
    seen_at = now()
"""


@dataclass
class ClockWatch:
    """Compares the database's clock with the monotonic clock of this process to notice jumps."""

    monotonic: Callable[[], float] = time.monotonic
    jumps: int = field(default=0, init=False)
    # lower and upper bound of the difference
    _offset: tuple[float, float] | None = field(default=None, init=False)
    _settled_at: float = field(default=float("-inf"), init=False)

    async def settled(self, connection: Connection, began: float, lease_s: float) -> bool:
        """Return False in the lease after a jump, in which living workers send heartbeats by the new time.

        ``began`` is the monotonic time before the transaction.
        """
        now = (await connection.one("SELECT extract(epoch FROM now())::float8"))[0]
        ended = self.monotonic()
        before, self._offset = self._offset, (now - ended, now - began)
        if before is not None:
            jump = max(self._offset[0] - before[1], before[0] - self._offset[1])
            if jump > lease_s / 2:  # less cannot make a living worker's last heartbeat too old
                log.warning(
                    "the database's clock jumped by at least %.1f s: no run counts as lost for %g s",
                    jump,
                    lease_s,
                )
                self._settled_at, self.jumps = ended + lease_s, self.jumps + 1
        return ended >= self._settled_at


async def recover(
    database: Database, lease_s: float = LEASE_S, clock: ClockWatch | None = None
) -> list[UUID]:
    """Queue gradings of lost runs again, drop jobs of finished gradings, and return the former.

    A run without a heartbeat for ``lease_s`` seconds is lost: its worker is dead, frozen or disconnected.
    After the database's clock has jumped, as ``clock`` notices between two calls, nothing is lost for a
    lease.
    """
    again = []
    began = clock.monotonic() if clock is not None else 0.0
    async with database.begin() as connection:
        if clock is not None and not await clock.settled(connection, began, lease_s):
            return []
        for job in await connection.rows(_STALE, {"lease": lease_s}):
            if job.finished or job.task_name != "grade":
                continue
            again.append(UUID(job.grading))
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
        locked = (await connection.one(_TRY_LOCK)).locked
        for row in await connection.rows(_ORPHANS, {"lease": lease_s}) if locked else []:
            again.append(row.grading_id)
            await _lose_and_send(connection, again[-1], lease_s, begun=True)
    return again


async def sweep(database: Database, lease_s: float = LEASE_S) -> list[UUID]:
    """Queue open gradings without a job, remove workers unseen for an hour,
    and return the gradings queued.
    """
    async with database.begin() as connection:
        if not (await connection.one(_TRY_LOCK)).locked:
            return []
        found = [row.id for row in await connection.rows(_JOBLESS, {"after": JOBLESS_AFTER_S})]
        for grading in found:
            await _lose_and_send(connection, grading, lease_s, begun=False)
        await connection.execute(_FORGET_WORKERS)
    return found


async def _lose_and_send(connection: Connection, grading: UUID, lease_s: float, *, begun: bool) -> None:
    await connection.execute(_LOSE, {"grading": grading, "lease": lease_s})
    await send_gradings(connection, [grading], begun=begun)


_RECENT = "({0} > now() - make_interval(secs => {1}) AND {0} < now() + make_interval(secs => {1}))"
_LEASE = "CAST(%(lease)s AS float)"
_SPAN = f"CASE WHEN j.task_name = 'grade' THEN {_LEASE} ELSE 120 END"

# Jobs taken by a worker whose run is silent or never began, or whose grading is finished. No heartbeat can
# arrive while the database is down, so a lease counts from the database's start at the earliest.
# Procrastinate's own worker heartbeat is ignored: a live worker may have lost track of a job. A sweep has
# no run, and gets 120 s.
_STALE = f"""
DELETE FROM procrastinate_jobs WHERE id IN (
    SELECT j.id FROM procrastinate_jobs j
    WHERE j.status = 'doing' AND NOT {_RECENT.format("pg_postmaster_start_time()", _SPAN)}
        AND NOT EXISTS (
            SELECT FROM procrastinate_events e
            WHERE e.job_id = j.id AND e.type = 'started' AND {_RECENT.format("e.at", _SPAN)})
        AND NOT EXISTS (
            SELECT FROM run WHERE run.grading_id = (j.args->>'attempt')::uuid AND run.end_reason
            IS DISTINCT FROM 'lost'
                AND ({_RECENT.format("run.heartbeat_at", _SPAN)} OR {_RECENT.format("run.ended_at", _SPAN)}))
    FOR UPDATE OF j SKIP LOCKED
) RETURNING args->>'attempt' AS grading, task_name,
    EXISTS (SELECT 1 FROM result WHERE grading_id = (args->>'attempt')::uuid) AS finished
"""

_LOSE = f"""
UPDATE run SET ended_at = now(), end_reason = 'lost', note = 'the worker stopped sending heartbeats'
WHERE grading_id = %(grading)s AND ended_at IS NULL AND NOT {_RECENT.format("heartbeat_at", _LEASE)}
"""

# Silent runs without a job.
_ORPHANS = f"""
SELECT DISTINCT grading_id FROM run LEFT JOIN result USING (grading_id)
WHERE run.ended_at IS NULL AND result.grading_id IS NULL
    AND NOT {_RECENT.format("heartbeat_at", _LEASE)}
    AND NOT {_RECENT.format("pg_postmaster_start_time()", _LEASE)}
    AND NOT EXISTS (SELECT 1 FROM procrastinate_jobs j WHERE j.task_name = 'grade'
    AND j.args->>'attempt' = run.grading_id::text)
"""

_TRY_LOCK = "SELECT pg_try_advisory_xact_lock(2626) AS locked"

_JOBLESS = f"""
SELECT a.id FROM grading a LEFT JOIN result r ON r.grading_id = a.id
WHERE r.grading_id IS NULL AND NOT {_RECENT.format("a.requested_at", "CAST(%(after)s AS float)")}
    AND NOT EXISTS (
    SELECT 1 FROM procrastinate_jobs j
    WHERE j.status IN ('todo', 'doing') AND j.task_name = 'grade' AND j.args->>'attempt' = a.id::text)
ORDER BY a.requested_at
"""

_FORGET_WORKERS = "DELETE FROM worker WHERE seen_at < now() - interval '1 hour'"
