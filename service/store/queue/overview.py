"""Show the queue to the staff, and regrade submissions immediately."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from service.store.course import audit
from service.store.database import Database, Row
from service.store.queue import runs
from service.store.queue.jobs import lock_persons
from service.store.submissions.accepting import add_grading
from service.store.submissions.records import LAST


@dataclass(frozen=True)
class QueueSnapshot:
    """Snapshot of the queue: waiting jobs by kind, the first jobs in order, active runs, workers, and
    submissions whose grading ended in a system fault or was cancelled."""

    waiting: Sequence[Row]
    places: Sequence[Row]
    going: Sequence[Row]
    workers: Sequence[Row]
    faults: Sequence[Row]


async def snapshot(database: Database) -> QueueSnapshot:
    """Read the present state of the queue."""
    return QueueSnapshot(
        *[await database.rows(query) for query in (_WAITING, _PLACES, _GOING, _WORKERS, _FAULTS)]
    )


async def regrade(
    database: Database, which: Sequence[UUID] | str, actor: str, *, faults: bool = False
) -> int:
    """Queue a new grading, with the same seed, for each selected submission and return their number.

    ``which`` is a list of ids, "faults" (submissions without a report) or "all"; with ``faults``,
    submissions that have a report are skipped. Submissions that are being graded are skipped. The former
    result stays visible until the new one is recorded.
    """
    faults = faults or which == "faults"
    values = {"ids": None if isinstance(which, str) else list(which), "faults": faults}
    count = 0
    for one in await database.rows(_AGAIN, values):
        # One transaction each, so that a student who submits meanwhile waits only for their own.
        async with database.begin() as connection:
            await lock_persons(connection, [one.id])
            row = await connection.first(_AGAIN, {"ids": [one.id], "faults": faults})
            if row is None:
                continue
            await add_grading(connection, row.id, "regrade", row.seed)
            await audit.record(connection, actor, "regrade", str(row.id), {"fault": row.fault})
            await runs.notify_in(connection, row.id)
            count += 1
    return count


_WAITING = """
SELECT a.kind, count(*) AS n, min(a.requested_at) AS since, extract(epoch
    FROM now() - min(a.requested_at)) AS waited_s
FROM procrastinate_jobs j JOIN grading a ON a.id::text = j.args->>'attempt'
WHERE j.status = 'todo' AND j.task_name = 'grade' GROUP BY a.kind ORDER BY max(j.priority) DESC
"""

MOST_PLACES = 200

_PLACES = f"""
SELECT j.position, j.total, a.id AS grading, a.kind, a.number, a.preview, a.requested_at, s.id AS submission,
    p.name AS person,
    p.full_name, x.slug AS assignment
FROM (
    SELECT (args->>'attempt')::uuid AS grading, row_number() OVER (ORDER BY priority DESC, id) AS position,
        count(*) OVER () AS total
    FROM procrastinate_jobs WHERE status = 'todo' AND task_name = 'grade' ORDER BY priority DESC, id
    LIMIT {MOST_PLACES}
) j JOIN grading a ON a.id = j.grading JOIN submission s ON s.id = a.submission_id
    JOIN person p ON p.id = s.person_id
    JOIN assignment x ON x.id = s.assignment_id
ORDER BY j.position
"""

_GOING = """
SELECT run.worker, run.phase, run.scene, run.scenes, a.id AS grading, a.kind, a.number, a.preview,
    s.id AS submission,
    p.name AS person, p.full_name, x.slug AS assignment, extract(epoch
    FROM now() - run.started_at) AS running_s,
    extract(epoch FROM now() - run.scene_at) AS scene_s, extract(epoch
    FROM now() - run.heartbeat_at) AS silent_s
FROM run JOIN grading a ON a.id = run.grading_id JOIN submission s ON s.id = a.submission_id
    JOIN person p ON p.id = s.person_id
    JOIN assignment x ON x.id = s.assignment_id
WHERE run.ended_at IS NULL AND NOT EXISTS (SELECT 1 FROM result v WHERE v.grading_id = a.id)
    ORDER BY run.started_at
"""

_WORKERS = """
SELECT name, isolation, unavailable_reason, zygote_restarts, extract(epoch FROM now() - seen_at) AS silent_s
    FROM worker
WHERE seen_at BETWEEN now() - interval '30 s' AND now() + interval '30 s' ORDER BY name
"""

_HAS_REPORT = """EXISTS (
    SELECT 1 FROM grading b JOIN result q ON q.grading_id = b.id
    WHERE b.submission_id = s.id AND NOT b.preview AND q.report IS NOT NULL)
"""

_FAULTS = f"""
SELECT s.id AS submission, p.name AS person, p.full_name, x.slug AS assignment, r.fault, r.cancelled_by,
    r.finished_at
FROM submission s JOIN person p ON p.id = s.person_id JOIN assignment x ON x.id = s.assignment_id JOIN {LAST}
WHERE r.fault IS NOT NULL AND NOT {_HAS_REPORT}
ORDER BY r.finished_at DESC LIMIT 50
"""

_AGAIN = f"""
SELECT s.id, a.seed, r.fault FROM submission s JOIN {LAST}
WHERE (CAST(%(ids)s AS uuid[]) IS NULL OR s.id = ANY(CAST(%(ids)s AS uuid[])))
    AND (NOT CAST(%(faults)s AS boolean) OR (r.fault IS NOT NULL AND NOT {_HAS_REPORT}))
ORDER BY s.submitted_at
"""
