"""A worker's side of a grading: claim it, tell that it is alive and how far it is, and write the one result.

Every function is one transaction and harmless to repeat, because a lost connection leaves open whether it was committed.
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


@dataclass(frozen=True)
class GradingJob:
    """What a grading asks: everything that grading it needs, so that no more is read while it runs."""

    grading: UUID
    submission_id: UUID
    assignment: str
    submission: Submission
    exercises: list[str] | None
    seed: int


@dataclass(frozen=True)
class Claim(GradingJob):
    """A grading that this worker grades, as its run ``run``."""

    run: UUID


async def claim(database: Database, grading: UUID, new_run: UUID, worker: str) -> Claim | None:
    """Begin run ``new_run`` of the grading; None where there is nothing to do, as it has its result.

    Where too many runs were lost or failed, the result is a fault, with what is known of them.
    """
    async with database.begin() as connection:
        found = (await connection.execute(_CLAIM, {"grading": grading})).first()
        if found is None or found.finished:
            return None
        if found.lost >= found.max_runs:
            lost = (await connection.execute(_LOST, {"grading": grading})).all()
            known = "; ".join(f"{one.started_at:%Y-%m-%d %H:%M:%S} on {one.worker}: {one.note}" for one in lost)
            fault = f"grading was begun {len(lost)} times and never ended ({known})"
            await connection.execute(insert(result).values(grading_id=grading, fault=fault).on_conflict_do_nothing())
            await send_next(connection, grading, found.submission_id)
            await notify_in(connection, found.submission_id)
            return None
        values = {"id": new_run, "grading_id": grading, "worker": worker, "phase": "starting"}
        await connection.execute(insert(run).values(values).on_conflict_do_nothing())
        await notify_in(connection, found.submission_id)
    return Claim(**_asked(grading, found), run=new_run)


async def read_grading(database: Database, grading: UUID) -> GradingJob:
    """What a grading asks, without claiming it."""
    async with database.begin() as connection:
        return GradingJob(**_asked(grading, (await connection.execute(_CLAIM, {"grading": grading})).one()))


async def heartbeat(database: Database, claimed: Claim, phase: str, scene: int, scenes: int) -> bool:
    """Tell that the run is alive and how far it is. If it was thought to be lost, it is not.

    False where it is wanted no more: it was cancelled, or another run was first.
    """
    values = {"run": claimed.run, "phase": phase, "scene": scene, "scenes": scenes}
    async with database.begin() as connection:
        row = (await connection.execute(_BEAT, values)).first()
        if row is not None and row.moved:
            await notify_in(connection, claimed.submission_id)
    return row is not None


async def finish(database: Database, claimed: Claim, report: Report, artefacts: Mapping[str, bytes]) -> bool:
    """Write the result and its artefacts together. False if another run was first: then nothing of this one is kept."""
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
        kept = [*artefact_statements(claimed.grading, artefacts), *_by_check(claimed.grading, report)]
        for statement in kept if first else []:
            await connection.execute(statement)
        await connection.execute(_END, {"run": claimed.run, "end_reason": "finished" if first else "superseded"})
        if first:
            await send_next(connection, claimed.grading, claimed.submission_id)
            await notify_in(connection, claimed.submission_id)
        return first


async def release(database: Database, claimed: Claim, end_reason: str, note: str) -> None:
    """End a run without result: "released" when the worker stops, "failed" by a failure of ours; the grading is queued again."""
    async with database.begin() as connection:
        values = {"run": claimed.run, "end_reason": end_reason, "note": note[:600]}
        open = (await connection.execute(_END_IF_OPEN, values)).rowcount  # else it was lost, and is queued already
        if open and (await connection.execute(_OWNER, {"grading": claimed.grading})).first() is None:
            await connection.execute(_DROP_JOBS, {"grading": str(claimed.grading)})
            await send_grading(connection, claimed.grading, begun=end_reason == "released")
            await notify_in(connection, claimed.submission_id)


async def supersede(database: Database, claimed: Claim) -> None:
    """End a run whose grading has its result from elsewhere."""
    async with database.begin() as connection:
        await connection.execute(_END, {"run": claimed.run, "end_reason": "superseded"})


async def notify(database: Database, submission_id: UUID) -> None:
    """Wake whoever follows that submission, on any server."""
    async with database.begin() as connection:
        await notify_in(connection, submission_id)


def _asked(grading: UUID, row: Row[tuple[object, ...]]) -> dict[str, Any]:
    return {
        "grading": grading,
        "submission_id": row.submission_id,
        "assignment": row.assignment,
        "submission": Submission(row.source, row.filename),
        "exercises": row.exercises,
        "seed": row.seed,
    }


def _by_check(grading: UUID, report: Report) -> list[Executable]:
    rows = outcome_rows(grading, report)
    return [insert(outcome).values(rows).on_conflict_do_nothing()] if rows else []


async def notify_in(connection: AsyncConnection, submission_id: UUID) -> None:
    """The same when this transaction is committed."""
    await connection.execute(text("SELECT pg_notify(:channel, :id)"), {"channel": CHANNEL, "id": str(submission_id)})


_CLAIM = text("""
SELECT s.id AS submission_id, x.slug AS assignment, s.source, s.filename, s.exercises, a.seed, a.max_runs,
    r.grading_id IS NOT NULL AS finished,
    (SELECT count(*) FROM run WHERE run.grading_id = a.id AND end_reason IN ('lost', 'failed')) AS lost
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN assignment x ON x.id = s.assignment_id
    LEFT JOIN result r ON r.grading_id = a.id
WHERE a.id = :grading FOR NO KEY UPDATE OF a
""")

# A run that came back late is no loss: its worker lives, it was only slow.
_LOST = text("""
SELECT started_at, worker, note FROM run
WHERE grading_id = :grading AND end_reason IN ('lost', 'failed') ORDER BY started_at
""")

_BEAT = text("""
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
    """A row of the table ``outcome`` for each check of the report."""
    return [
        {
            "grading_id": grading,
            "check_id": outcome.id,
            "state": state(outcome, report.scene_ends),
            "counted": outcome.counted,
            "margin": outcome.margin,
            "codes": [cause.code for cause in outcome.diagnosis],
            "causes": [cause.sentence for cause in outcome.diagnosis],
        }
        for outcome in report.outcomes()
    ]
