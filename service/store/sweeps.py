"""Sweeps of submissions' own functions, speed against accuracy: asked for one at a time or for a class, and kept as artefacts."""

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
    """A job to sweep the function of this grading, unless there is one: a person waits, so it goes before regrades."""
    async with database.begin() as connection:
        await _ask(connection, grading, "interactive")


async def request_class(database: Database, class_: Iterable[StudentRow]) -> int:
    """The same for every submission that counts and has not been swept, behind everybody who waits for a grade; how many."""
    gradings = _gradings(class_)
    done = {row.grading_id for row in await database.rows(_DONE, {"gradings": gradings})}
    async with database.begin() as connection:
        return sum([await _ask(connection, grading, "bulk") for grading in gradings if grading not in done])


async def count(database: Database, class_: Iterable[StudentRow]) -> tuple[int, int]:
    """How many of the submissions that count have been swept, and how many that could be have not."""
    gradings = _gradings(class_)
    rows = await database.rows(_DONE, {"gradings": gradings})
    return sum(row.name == SWEPT for row in rows), len(gradings) - len(rows)


async def documents(database: Database, class_: Iterable[StudentRow]) -> list[dict[str, Any]]:
    """The sweeps there are of the submissions that count, as JSON."""
    rows = await database.rows(_CONTENTS, {"gradings": _gradings(class_), "name": SWEPT})
    return [json.loads(row.content) for row in rows]


def _gradings(class_: Iterable[StudentRow]) -> list[UUID]:
    return [s.grading for s in class_ if s.grading is not None and s.status == "graded"]


async def _ask(connection: AsyncConnection, grading: UUID, kind: str) -> bool:
    await connection.execute(_ONE_ASKS, {"grading": str(grading)})
    if (await connection.execute(_SENT, {"grading": str(grading)})).first() is not None:
        return False
    await send(connection, grading, task="sweep", priority=STEP * KINDS[kind] - STEP // 2)
    return True


_ONE_ASKS = text("SELECT pg_advisory_xact_lock(hashtextextended('sweep' || :grading, 0))")

_SENT = text("""
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
