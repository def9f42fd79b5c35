"""The runs of a grading, as a worker reports them: claim, heartbeat, and finish or release.

Every function is one idempotent transaction, because a lost connection leaves unknown whether the
transaction was committed.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Executable, Row, text
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import AsyncConnection

from ecp.document import document
from ecp.report import Report
from service.grading.result import state
from service.grading.submission import Submission
from service.store.database import Database
from service.store.queue import send_grading, send_next
from service.store.records import artefact_statements
from service.store.tables import outcome, result, run

CHANNEL = "polhode"
MAX_FAILED_RUNS = 2  # a run that failed is repeated once; one that was lost, up to ``max_runs`` in all


@dataclass(frozen=True)
class GradingJob:
    """All input of a grading, so that the worker reads nothing more while it grades."""

    grading: UUID
    submission_id: UUID
    assignment: str
    submission: Submission
    exercises: list[str] | None
    seed: int


@dataclass(frozen=True)
class Claim(GradingJob):
    """A grading that a worker has claimed, with the id of its run."""

    run: UUID


async def claim(database: Database, grading: UUID, new_run: UUID, worker: str) -> Claim | None:
    """Start run ``new_run`` of a grading. Return None if the grading already has a result.

    After MAX_FAILED_RUNS failed runs, or ``max_runs`` lost or failed ones, record a system fault that lists them, and return None.
    """
    async with database.begin() as connection:
        found = (await connection.execute(_CLAIM, {"grading": grading})).first()
        if found is None or found.finished:
            return None
        if found.failed >= MAX_FAILED_RUNS or found.lost + found.failed >= found.max_runs:
            lost = (await connection.execute(_LOST, {"grading": grading})).all()
            listed = "; ".join(f"{one.started_at:%Y-%m-%d %H:%M:%S} on {one.worker}: {one.note}" for one in lost)
            fault = f"all {len(lost)} runs of this grading failed or were lost ({listed})"
            await connection.execute(insert(result).values(grading_id=grading, fault=fault).on_conflict_do_nothing())
            await send_next(connection, grading, found.submission_id)
            await notify_in(connection, found.submission_id)
            return None
        values = {"id": new_run, "grading_id": grading, "worker": worker, "phase": "starting"}
        await connection.execute(insert(run).values(values).on_conflict_do_nothing())
        await notify_in(connection, found.submission_id)
    return Claim(**_job_fields(grading, found), run=new_run)


async def read_grading(database: Database, grading: UUID) -> GradingJob:
    """Return the input of a grading without claiming it."""
    async with database.begin() as connection:
        return GradingJob(**_job_fields(grading, (await connection.execute(_CLAIM, {"grading": grading})).one()))


async def heartbeat(database: Database, claimed: Claim, phase: str, scene: int, scenes: int) -> bool:
    """Record a heartbeat and the run's progress, reviving a run that was marked lost.

    Return False if the run is obsolete: cancelled, or superseded by another run.
    """
    values = {"run": claimed.run, "phase": phase, "scene": scene, "scenes": scenes}
    async with database.begin() as connection:
        row = (await connection.execute(_HEARTBEAT, values)).first()
        if row is not None and row.moved:
            await notify_in(connection, claimed.submission_id)
    return row is not None


async def finish(database: Database, claimed: Claim, report: Report, artefacts: Mapping[str, bytes]) -> bool:
    """Record the result with its artefacts. Return False, and store nothing, if another run finished first."""
    of = {"grading": claimed.grading}
    values = {
        "grading_id": claimed.grading,
        "run_id": claimed.run,
        "report": document(report),
        "score": report.score,
        "max_score": report.max_score,
        "version": report.version,
        "isolation": report.provenance.isolation,
        "grading_s": sum(report.provenance.phases_ms.values()) / 1e3,
    }
    async with database.begin() as connection:
        written = insert(result).values(values).on_conflict_do_nothing().returning(result.c.run_id)
        owner = (await connection.execute(written)).scalar() or (await connection.execute(_OWNER, of)).scalar()
        first = owner == claimed.run
        statements = [*artefact_statements(claimed.grading, artefacts), *_insert_outcomes(claimed.grading, report)]
        for statement in statements if first else []:
            await connection.execute(statement)
        await connection.execute(_END, {"run": claimed.run, "end_reason": "finished" if first else "superseded"})
        if first:
            await send_next(connection, claimed.grading, claimed.submission_id)
            await notify_in(connection, claimed.submission_id)
        return first


async def release(database: Database, claimed: Claim, end_reason: str, note: str) -> None:
    """End a run without result and queue its grading again.

    ``end_reason`` is "released" (the worker stops) or "failed".
    """
    async with database.begin() as connection:
        values = {"run": claimed.run, "end_reason": end_reason, "note": note[:600]}
        # A run that is not open was marked lost, and its grading is queued already.
        open = (await connection.execute(_END_IF_OPEN, values)).rowcount
        if open and (await connection.execute(_OWNER, {"grading": claimed.grading})).first() is None:
            await connection.execute(_DROP_JOBS, {"grading": str(claimed.grading)})
            await send_grading(connection, claimed.grading, begun=end_reason == "released")
            await notify_in(connection, claimed.submission_id)


async def supersede(database: Database, claimed: Claim) -> None:
    """End a run whose grading got its result from another run or was cancelled."""
    async with database.begin() as connection:
        await connection.execute(_END, {"run": claimed.run, "end_reason": "superseded"})


async def notify(database: Database, submission_id: UUID) -> None:
    """Notify all servers that the submission has changed."""
    async with database.begin() as connection:
        await notify_in(connection, submission_id)


def _job_fields(grading: UUID, row: Row[tuple[object, ...]]) -> dict[str, Any]:
    return {
        "grading": grading,
        "submission_id": row.submission_id,
        "assignment": row.assignment,
        "submission": Submission(row.source, row.filename),
        "exercises": row.exercises,
        "seed": row.seed,
    }


def _insert_outcomes(grading: UUID, report: Report) -> list[Executable]:
    rows = outcome_rows(grading, report)
    return [insert(outcome).values(rows).on_conflict_do_nothing()] if rows else []


async def notify_in(connection: AsyncConnection, submission_id: UUID) -> None:
    """Notify all servers when this transaction is committed."""
    await connection.execute(text("SELECT pg_notify(:channel, :id)"), {"channel": CHANNEL, "id": str(submission_id)})


_CLAIM = text("""
SELECT s.id AS submission_id, x.slug AS assignment, s.source, s.filename, s.exercises, a.seed, a.max_runs,
    r.grading_id IS NOT NULL AS finished,
    (SELECT count(*) FROM run WHERE run.grading_id = a.id AND end_reason = 'lost') AS lost,
    (SELECT count(*) FROM run WHERE run.grading_id = a.id AND end_reason = 'failed') AS failed
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN assignment x ON x.id = s.assignment_id
    LEFT JOIN result r ON r.grading_id = a.id
WHERE a.id = :grading FOR NO KEY UPDATE OF a
""")

# A run that was marked lost and revived does not count: its worker was only slow.
_LOST = text("""
SELECT started_at, worker, note FROM run
WHERE grading_id = :grading AND end_reason IN ('lost', 'failed') ORDER BY started_at
""")

_HEARTBEAT = text("""
WITH before AS (SELECT id, phase, scene FROM run WHERE id = :run)
UPDATE run SET heartbeat_at = now(), phase = :phase, scene = :scene, scenes = :scenes,
    ended_at = NULL, end_reason = NULL, note = NULL,
    scene_at = CASE WHEN (before.phase, before.scene) = (:phase, :scene) THEN scene_at ELSE now() END
FROM before WHERE run.id = before.id AND (run.ended_at IS NULL OR run.end_reason = 'lost')
    AND NOT EXISTS (SELECT 1 FROM result r WHERE r.grading_id = run.grading_id)
RETURNING (before.phase, before.scene) <> (run.phase, run.scene) AS moved
""")

_OWNER = text("SELECT run_id FROM result WHERE grading_id = :grading")

_END = text("""
UPDATE run SET ended_at = now(), end_reason = :end_reason, note = NULL
WHERE id = :run AND coalesce(end_reason, '') NOT IN ('finished', 'cancelled')
""")

_END_IF_OPEN = text("UPDATE run SET ended_at = now(), end_reason = :end_reason, note = :note WHERE id = :run AND ended_at IS NULL")

_DROP_JOBS = text("DELETE FROM procrastinate_jobs WHERE args->>'attempt' = :grading AND task_name = 'grade'")


def outcome_rows(grading: UUID, report: Report) -> list[dict[str, Any]]:
    """Return a row of the table ``outcome`` for each check of the report."""
    return [
        {
            "grading_id": grading,
            "check_id": outcome.id,
            "state": state(outcome, report.scene_ends),
            "counted": outcome.counted,
            "margin": outcome.margin,
            "codes": [cause.code for cause in outcome.diagnosis],
            "causes": [cause.sentence for cause in outcome.diagnosis],
            "points": outcome.points,
            "earned": outcome.earned,
        }
        for outcome in report.outcomes()
    ]
