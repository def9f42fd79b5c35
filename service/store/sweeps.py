"""Sweeps: speed against accuracy of a submission's own function, stored as artefacts."""

import json
from collections.abc import Iterable
from typing import Any
from uuid import UUID

from sqlalchemy import text
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store.course.gradebook import StudentRow
from service.store.database import Database
from service.store.queue import KINDS, STEP, send

SWEPT = "sweep.json"


async def request(database: Database, grading: UUID) -> None:
    """Queue a sweep of this grading's function unless one is queued.

    It goes before regrades, as a person waits for it.
    """
    async with database.begin() as connection:
        await _queue_once(connection, grading, "interactive")


async def request_class(database: Database, class_: Iterable[StudentRow]) -> int:
    """Queue sweeps of all counted submissions without one, behind all other jobs, and return their number."""
    gradings = _gradings(class_)
    done = {row.grading_id for row in await database.rows(_DONE, {"gradings": gradings})}
    async with database.begin() as connection:
        return sum([await _queue_once(connection, grading, "bulk") for grading in gradings if grading not in done])


async def count(database: Database, class_: Iterable[StudentRow]) -> tuple[int, int]:
    """Return how many counted submissions have a sweep, and how many gradable ones have none."""
    gradings = _gradings(class_)
    rows = await database.rows(_DONE, {"gradings": gradings})
    return sum(row.name == SWEPT for row in rows), len(gradings) - len(rows)


async def documents(database: Database, class_: Iterable[StudentRow]) -> list[dict[str, Any]]:
    """Return the stored sweeps of the counted submissions as JSON documents."""
    rows = await database.rows(_CONTENTS, {"gradings": _gradings(class_), "name": SWEPT})
    return [json.loads(row.content) for row in rows]


def _gradings(class_: Iterable[StudentRow]) -> list[UUID]:
    return [s.grading for s in class_ if s.grading is not None and s.status == "graded"]


async def _queue_once(connection: AsyncConnection, grading: UUID, kind: str) -> bool:
    await connection.execute(_LOCK_SWEEP, {"grading": str(grading)})
    if (await connection.execute(_QUEUED, {"grading": str(grading)})).first() is not None:
        return False
    await send(connection, grading, task="sweep", priority=STEP * KINDS[kind] - STEP // 2)
    return True


_LOCK_SWEEP = text("SELECT pg_advisory_xact_lock(hashtextextended('sweep' || :grading, 0))")

_QUEUED = text("""
SELECT 1 FROM procrastinate_jobs WHERE task_name = 'sweep' AND status IN ('todo', 'doing') AND args->>'attempt' = :grading
""")

_DONE = """
SELECT grading_id, name FROM grading_artefact
WHERE grading_id = ANY(CAST(:gradings AS uuid[])) AND name IN ('sweep.json', 'sweep.refused')
"""

_CONTENTS = """
SELECT a.content FROM grading_artefact k JOIN artefact a USING (sha256)
WHERE k.grading_id = ANY(CAST(:gradings AS uuid[])) AND k.name = :name
"""
