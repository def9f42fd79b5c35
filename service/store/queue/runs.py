"""The runs of a grading, as a worker reports them: claim, heartbeat, and finish or release.

Every function is idempotent, because a lost connection leaves unknown whether its transaction was committed.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from psycopg.types.json import Jsonb

from polhode.report.dataclass_json import document
from polhode.report.report import Report
from service.grading.graded_file import state
from service.grading.submission import Submission
from service.store.database import Connection, Database, Row
from service.store.queue.jobs import PERSON_LOCK, delete_waiting, lock_persons, send_gradings, send_next
from service.store.submissions.artefacts import insert_artefacts

CHANNEL = "polhode"
# ends a notification about a grading that goes on: a request that waits for its result need not look
PROGRESS = " progress"
LONGEST_WAIT = "10 minutes"  # that a slow grading is put off for others
MAX_FAILED_RUNS = 2  # a run that failed is repeated once; one that was lost, up to ``max_runs`` in all


@dataclass(frozen=True)
class GradingJob:
    """All input of a grading, so that the worker reads nothing more while it grades."""

    grading: UUID
    submission_id: UUID
    assignment: str
    submission: Submission
    seed: int


@dataclass(frozen=True)
class Claim(GradingJob):
    """A grading that a worker has claimed, with the id of its run and the name of the worker.

    ``may_wait`` says that it was requested less than LONGEST_WAIT ago: then it is put off while it is slow
    and others wait. ``whose`` is the person; the submission itself on a server without logins, where one
    person is everybody.
    """

    run: UUID
    worker: str
    whose: UUID
    may_wait: bool = False


async def claim(database: Database, grading: UUID, new_run: UUID, worker: str) -> Claim | None:
    """Start run ``new_run`` of a grading. Return None if the grading already has a result.

    After MAX_FAILED_RUNS failed runs, or ``max_runs`` lost or failed ones, record a system fault that lists
    them, and return None.
    """
    found = await database.first(
        _CLAIM, {"run": new_run, "grading": grading, "worker": worker, "most_failed": MAX_FAILED_RUNS}
    )
    if found is None or found.finished:
        return None
    if found.given_up:
        await _record_fault(database, grading, found.submission_id)
        return None
    fields = _job_fields(grading, found)
    return Claim(**fields, run=new_run, worker=worker, whose=found.whose, may_wait=found.may_wait)


async def _record_fault(database: Database, grading: UUID, submission_id: UUID) -> None:
    """Record a system fault that lists the runs that failed or were lost."""
    async with database.begin() as connection:
        lost = await connection.rows(_LOST, {"grading": grading})
        listed = "; ".join(f"{one.started_at:%Y-%m-%d %H:%M:%S} on {one.worker}: {one.note}" for one in lost)
        fault = f"all {len(lost)} runs of this grading failed or were lost ({listed})"
        await connection.execute(_FAULT, {"grading": grading, "fault": fault})
        await lock_persons(connection, [submission_id])
        await send_next(connection, grading)
        await notify_in(connection, submission_id)


async def read_grading(database: Database, grading: UUID) -> GradingJob:
    """Return the input of a grading without claiming it."""
    return GradingJob(**_job_fields(grading, (await database.one(_GRADING, {"grading": grading}))))


async def heartbeat(database: Database, claimed: Claim, phase: str, scene: int, scenes: int) -> bool:
    """Record a heartbeat and the run's progress, reviving a run that was marked lost.

    Return False if the run is obsolete: cancelled, or superseded by another run.
    """
    values = {"run": claimed.run, "phase": phase, "scene": scene, "scenes": scenes}
    async with database.begin() as connection:
        row = await connection.first(_HEARTBEAT, values)
        if row is not None and row.moved:
            await notify_in(connection, claimed.submission_id, PROGRESS)
    return row is not None


async def finish(
    database: Database, claimed: Claim, report: Report, artefacts: Mapping[str, bytes], *, slow: bool = False
) -> bool:
    """Record the result with its artefacts, and whether the run was ``slow``.

    Return False, and store nothing, if another run finished first.
    """
    values = {
        "grading": claimed.grading,
        "submission": claimed.submission_id,
        "run": claimed.run,
        "worker": claimed.worker,
        "outcomes": Jsonb(_outcomes(report)),
        "report": Jsonb(document(report)),
        "score": report.score,
        "max_score": report.max_score,
        "version": report.version,
        "isolation": report.provenance.isolation,
        "grading_s": sum(report.provenance.phases_ms.values()) / 1e3,
        "slow": slow,
    }
    async with database.begin() as connection:
        if await connection.execute(_RESULT, values):
            await insert_artefacts(connection, claimed.grading, artefacts)
            await send_next(connection, claimed.grading)
            return True
        if (await connection.one(_OWNER, values)).run_id == claimed.run:
            return True  # the response to an earlier call was lost
        await connection.execute(_SUPERSEDE, values)
        return False


async def release(
    database: Database, claimed: Claim, end_reason: str, note: str, *, exits: bool = False
) -> None:
    """End a run without result and queue its grading again.

    ``end_reason`` is "released" (the worker stops), "failed", or "postponed": it is slow and others wait. The
    run's job ends with the worker's task; if the worker ``exits`` before, it is deleted here.
    """
    async with database.begin() as connection:
        slow = True if end_reason == "postponed" else None
        values = {"run": claimed.run, "end_reason": end_reason, "note": note[:600], "slow": slow}
        # A run that is not open was marked lost, and its grading is queued already.
        open = await connection.execute(_END_IF_OPEN, values)
        if open and await connection.first(_OWNER, {"grading": claimed.grading}) is None:
            await delete_waiting(connection, [claimed.grading])
            if exits:
                await connection.execute(_DELETE_TAKEN, {"grading": str(claimed.grading)})
            await send_gradings(connection, [claimed.grading], begun=end_reason == "released")
            if slow:
                await lock_persons(connection, [claimed.submission_id])
                await send_next(connection, claimed.grading)
            await notify_in(connection, claimed.submission_id)


async def supersede(database: Database, claimed: Claim) -> None:
    """End a run whose grading got its result from another run or was cancelled."""
    async with database.begin() as connection:
        await connection.execute(_SUPERSEDE, {"run": claimed.run})


async def notify(database: Database, submission_id: UUID) -> None:
    """Notify all servers that the submission has changed."""
    async with database.begin() as connection:
        await notify_in(connection, submission_id)


def _job_fields(grading: UUID, row: Row) -> dict[str, Any]:
    return {
        "grading": grading,
        "submission_id": row.submission_id,
        "assignment": row.assignment,
        "submission": Submission(row.source, row.filename, row.exercises),
        "seed": row.seed,
    }


async def notify_in(connection: Connection, submission_id: UUID, suffix: str = "") -> None:
    """Notify all servers when this transaction is committed. ``suffix`` is PROGRESS or "" for any other
    change.
    """
    await connection.execute(
        "SELECT pg_notify(%(channel)s, %(id)s)", {"channel": CHANNEL, "id": f"{submission_id}{suffix}"}
    )


_GRADING = f"""
SELECT s.id AS submission_id, x.slug AS assignment, s.source, s.filename, s.exercises, a.seed, a.max_runs,
    CASE p.name WHEN 'local' THEN s.id ELSE p.id END AS whose,
    now() - a.requested_at < interval '{LONGEST_WAIT}' AS may_wait,
    r.grading_id IS NOT NULL AS finished,
    (SELECT count(*) FROM run WHERE run.grading_id = a.id AND end_reason = 'lost') AS lost,
    (SELECT count(*) FROM run WHERE run.grading_id = a.id AND end_reason = 'failed') AS failed
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN assignment x ON x.id = s.assignment_id
    JOIN person p ON p.id = s.person_id LEFT JOIN result r ON r.grading_id = a.id
WHERE a.id = %(grading)s
"""

# The worker does not wait for the disk: ``finish`` adds the run again if a database that crashed has lost it.
_CLAIM = f"""
WITH found AS ({_GRADING} FOR NO KEY UPDATE OF a),
judged AS (SELECT *, failed >= %(most_failed)s OR lost + failed >= max_runs AS given_up FROM found),
begun AS (
    INSERT INTO run (id, grading_id, worker, phase)
    SELECT %(run)s, %(grading)s, %(worker)s, 'starting' FROM judged WHERE NOT finished AND NOT given_up
    ON CONFLICT DO NOTHING RETURNING pg_notify('{CHANNEL}', (SELECT submission_id || '{PROGRESS}'
    FROM judged))
)
SELECT judged.*, set_config('synchronous_commit', 'off', true) FROM judged LEFT JOIN begun ON true
"""

# A run that was marked lost and revived does not count: its worker was only slow.
_LOST = """
SELECT started_at, worker, note FROM run
WHERE grading_id = %(grading)s AND end_reason IN ('lost', 'failed') ORDER BY started_at
"""

_HEARTBEAT = """
WITH before AS (SELECT id, phase, scene FROM run WHERE id = %(run)s)
UPDATE run SET heartbeat_at = now(), phase = %(phase)s, scene = %(scene)s, scenes = %(scenes)s,
    ended_at = NULL, end_reason = NULL, note = NULL,
    scene_at = CASE WHEN (before.phase, before.scene) = (%(phase)s, %(scene)s) THEN scene_at ELSE now() END
FROM before WHERE run.id = before.id AND (run.ended_at IS NULL OR run.end_reason = 'lost')
    AND NOT EXISTS (SELECT 1 FROM result r WHERE r.grading_id = run.grading_id)
RETURNING (before.phase, before.scene) <> (run.phase, run.scene) AS moved
"""

_FAULT = "INSERT INTO result (grading_id, fault) VALUES (%(grading)s, %(fault)s) ON CONFLICT DO NOTHING"

# Also ends the run, locks the ranking of the person's gradings, and notifies the servers.
_RESULT = f"""
WITH stored AS (
    INSERT INTO result (grading_id, run_id, report, score, max_score, version, isolation, grading_s)
    VALUES (%(grading)s, %(run)s, %(report)s, %(score)s, %(max_score)s, %(version)s, %(isolation)s,
        %(grading_s)s)
    ON CONFLICT DO NOTHING RETURNING run_id
), ended AS (
    INSERT INTO run (id, grading_id, worker, phase, ended_at, end_reason, slow)
    SELECT run_id, %(grading)s, %(worker)s, 'starting', now(), 'finished', %(slow)s FROM stored
    ON CONFLICT (id) DO UPDATE SET ended_at = now(), end_reason = 'finished', note = NULL, slow = %(slow)s
    WHERE coalesce(run.end_reason, '') NOT IN ('finished', 'cancelled')
), outcomes AS (
    INSERT INTO outcome (grading_id, check_id, state, counted, margin, codes, causes, points, earned)
    SELECT %(grading)s, one.* FROM stored, jsonb_to_recordset(%(outcomes)s) AS one (
        check_id text, state text, counted boolean, margin float8, codes text[], causes text[],
        points integer, earned integer
    ) ON CONFLICT DO NOTHING
)
SELECT pg_notify('{CHANNEL}', CAST(s.id AS text)), {PERSON_LOCK.format("s.person_id")}
FROM stored, submission s WHERE s.id = %(submission)s
"""

_OWNER = "SELECT run_id FROM result WHERE grading_id = %(grading)s"

_SUPERSEDE = """
UPDATE run SET ended_at = now(), end_reason = 'superseded', note = NULL
WHERE id = %(run)s AND coalesce(end_reason, '') NOT IN ('finished', 'cancelled')
"""

_END_IF_OPEN = """
UPDATE run SET ended_at = now(), end_reason = %(end_reason)s, note = %(note)s, slow = %(slow)s
WHERE id = %(run)s AND ended_at IS NULL
"""

_DELETE_TAKEN = """
DELETE FROM procrastinate_jobs WHERE args->>'attempt' = %(grading)s AND task_name = 'grade'
    AND status = 'doing'
"""


def _outcomes(report: Report) -> list[dict[str, Any]]:
    """Return a row of the table ``outcome`` for each check of the report, as JSON, which has no infinite
    numbers.
    """
    return [
        {
            "check_id": outcome.id,
            "state": state(outcome, report.scene_ends),
            "counted": outcome.counted,
            "margin": None if outcome.margin is None else str(outcome.margin),
            "codes": [cause.code for cause in outcome.diagnosis],
            "causes": [cause.sentence for cause in outcome.diagnosis],
            "points": outcome.points,
            "earned": outcome.earned,
        }
        for outcome in report.outcomes()
    ]
