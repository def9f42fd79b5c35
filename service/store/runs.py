"""A worker's side of an attempt: claim it, tell that it is alive and how far it is, and write the one result.

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
from service.store.queue import send_attempt, send_next
from service.store.records import artefact_statements
from service.store.tables import outcome, result, run

CHANNEL = "polhode"


@dataclass(frozen=True)
class GradingJob:
    """What an attempt asks: everything that grading it needs, so that no more is read while it runs."""

    attempt: UUID
    submission_id: UUID
    assignment: str
    submission: Submission
    exercises: list[str] | None
    seed: int


@dataclass(frozen=True)
class Claim(GradingJob):
    """An attempt that this worker grades, as its run ``run``."""

    run: UUID


async def claim(database: Database, attempt: UUID, new_run: UUID, worker: str) -> Claim | None:
    """Begin run ``new_run`` of the attempt; None where there is nothing to do, as it has its result.

    Where too many runs were lost or failed, the result is a fault, with what is known of them.
    """
    async with database.begin() as connection:
        found = (await connection.execute(_CLAIM, {"attempt": attempt})).first()
        if found is None or found.finished:
            return None
        if found.lost >= found.most_runs:
            lost = (await connection.execute(_LOST, {"attempt": attempt})).all()
            known = "; ".join(f"{one.started_at:%Y-%m-%d %H:%M:%S} on {one.worker}: {one.note}" for one in lost)
            fault = f"grading was begun {len(lost)} times and never ended ({known})"
            await connection.execute(insert(result).values(attempt_id=attempt, fault=fault).on_conflict_do_nothing())
            await send_next(connection, attempt, found.submission_id)
            await notify_in(connection, found.submission_id)
            return None
        values = {"id": new_run, "attempt_id": attempt, "worker": worker, "phase": "starting"}
        await connection.execute(insert(run).values(values).on_conflict_do_nothing())
        await notify_in(connection, found.submission_id)
    return Claim(**_asked(attempt, found), run=new_run)


async def read_grading(database: Database, attempt: UUID) -> GradingJob:
    """What an attempt asks, without claiming it."""
    async with database.begin() as connection:
        return GradingJob(**_asked(attempt, (await connection.execute(_CLAIM, {"attempt": attempt})).one()))


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
    of = {"attempt": claimed.attempt}
    values = {
        "attempt_id": claimed.attempt,
        "run_id": claimed.run,
        "report": document(report),
        "score": report.score,
        "max_score": report.max_score,
        "version": report.version,
        "walls": report.provenance.isolation,
        "grading_s": sum(report.provenance.phases_ms.values()) / 1e3,
    }
    async with database.begin() as connection:
        written = insert(result).values(values).on_conflict_do_nothing().returning(result.c.run_id)
        owner = (await connection.execute(written)).scalar() or (await connection.execute(_OWNER, of)).scalar()
        first = owner == claimed.run
        kept = [*artefact_statements(claimed.attempt, artefacts), *_by_check(claimed.attempt, report)]
        for statement in kept if first else []:
            await connection.execute(statement)
        await connection.execute(_END, {"run": claimed.run, "ending": "finished" if first else "superseded"})
        if first:
            await send_next(connection, claimed.attempt, claimed.submission_id)
            await notify_in(connection, claimed.submission_id)
        return first


async def release(database: Database, claimed: Claim, ending: str, note: str) -> None:
    """End a run without result: "released" when the worker stops, "failed" by a failure of ours; the attempt is queued again."""
    async with database.begin() as connection:
        values = {"run": claimed.run, "ending": ending, "note": note[:600]}
        open = (await connection.execute(_END_IF_OPEN, values)).rowcount  # else it was lost, and is queued already
        if open and (await connection.execute(_OWNER, {"attempt": claimed.attempt})).first() is None:
            await connection.execute(_DROP_JOBS, {"attempt": str(claimed.attempt)})
            await send_attempt(connection, claimed.attempt, begun=ending == "released")
            await notify_in(connection, claimed.submission_id)


async def supersede(database: Database, claimed: Claim) -> None:
    """End a run whose attempt has its result from elsewhere."""
    async with database.begin() as connection:
        await connection.execute(_END, {"run": claimed.run, "ending": "superseded"})


async def notify(database: Database, submission_id: UUID) -> None:
    """Wake whoever follows that submission, on any server."""
    async with database.begin() as connection:
        await notify_in(connection, submission_id)


def _asked(attempt: UUID, row: Row[tuple[object, ...]]) -> dict[str, Any]:
    return {
        "attempt": attempt,
        "submission_id": row.submission_id,
        "assignment": row.assignment,
        "submission": Submission(row.source, row.filename),
        "exercises": row.exercises,
        "seed": row.seed,
    }


def _by_check(attempt: UUID, report: Report) -> list[Executable]:
    rows = outcome_rows(attempt, report)
    return [insert(outcome).values(rows).on_conflict_do_nothing()] if rows else []


async def notify_in(connection: AsyncConnection, submission_id: UUID) -> None:
    """The same when this transaction is committed."""
    await connection.execute(text("SELECT pg_notify(:channel, :id)"), {"channel": CHANNEL, "id": str(submission_id)})


_CLAIM = text("""
SELECT s.id AS submission_id, x.slug AS assignment, s.source, s.filename, s.exercises, a.seed, a.most_runs,
    r.attempt_id IS NOT NULL AS finished,
    (SELECT count(*) FROM run WHERE run.attempt_id = a.id AND ending IN ('lost', 'failed')) AS lost
FROM attempt a JOIN submission s ON s.id = a.submission_id JOIN assignment x ON x.id = s.assignment_id
    LEFT JOIN result r ON r.attempt_id = a.id
WHERE a.id = :attempt FOR NO KEY UPDATE OF a
""")

# A run that came back late is no loss: its worker lives, it was only slow.
_LOST = text("""
SELECT started_at, worker, note FROM run
WHERE attempt_id = :attempt AND ending IN ('lost', 'failed') ORDER BY started_at
""")

_BEAT = text("""
WITH before AS (SELECT id, phase, scene FROM run WHERE id = :run)
UPDATE run SET beat_at = now(), phase = :phase, scene = :scene, scenes = :scenes, ended_at = NULL, ending = NULL, note = NULL,
    scene_at = CASE WHEN (before.phase, before.scene) = (:phase, :scene) THEN scene_at ELSE now() END
FROM before WHERE run.id = before.id AND (run.ended_at IS NULL OR run.ending = 'lost')
    AND NOT EXISTS (SELECT 1 FROM result r WHERE r.attempt_id = run.attempt_id)
RETURNING (before.phase, before.scene) <> (run.phase, run.scene) AS moved
""")

_OWNER = text("SELECT run_id FROM result WHERE attempt_id = :attempt")

_END = text("""
UPDATE run SET ended_at = now(), ending = :ending, note = NULL
WHERE id = :run AND coalesce(ending, '') NOT IN ('finished', 'cancelled')
""")

_END_IF_OPEN = text("UPDATE run SET ended_at = now(), ending = :ending, note = :note WHERE id = :run AND ended_at IS NULL")

_DROP_JOBS = text("DELETE FROM procrastinate_jobs WHERE args->>'attempt' = :attempt AND task_name = 'grade'")


def outcome_rows(attempt: UUID, report: Report) -> list[dict[str, Any]]:
    """A row of the table ``outcome`` for each check of the report."""
    return [
        {
            "attempt_id": attempt,
            "check_id": outcome.id,
            "state": state(outcome, report.scene_ends),
            "counted": outcome.counted,
            "margin": outcome.margin,
            "codes": [cause.code for cause in outcome.diagnosis],
            "causes": [cause.sentence for cause in outcome.diagnosis],
        }
        for outcome in report.outcomes()
    ]
