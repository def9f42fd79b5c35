"""Sweeps: speed against accuracy of a submission's own function, stored as artefacts of its grading.

``sweep.json`` and ``sweep.svg`` are the result, ``sweep.refused`` is the sentence for a submission that
cannot be measured, ``sweep.run.N`` marks the begin of run N, and ``sweep.fault.N`` says why polhode failed in
it.
"""

import json
from collections.abc import Iterable
from importlib import metadata
from typing import Any
from uuid import UUID

from service.store.course.gradebook import StudentRow
from service.store.database import Connection, Database
from service.store.queue.jobs import send_sweep
from service.store.submissions.artefacts import ARTEFACTS, insert_artefacts

SWEPT, REFUSED, FAULT = "sweep.json", "sweep.refused", "sweep.fault"
MOST_RUNS = 3  # of one grading's sweep, lost ones included


async def request(database: Database, grading: UUID) -> str | None:
    """Queue a sweep of this grading's function unless one is queued or done, behind all other jobs.

    Return None, or why polhode failed to measure it: a request runs a failed sweep again only in another
    version of polhode.
    """
    async with database.begin() as connection:
        await connection.execute(_LOCK_SWEEP, {"grading": str(grading)})
        stored = {row.name: row.content for row in await connection.rows(_STORED, {"grading": grading})}
        if faults := sorted(name for name in stored if name not in (SWEPT, REFUSED)):
            fault: dict[str, str] = json.loads(stored[faults[-1]])
            if fault["version"] == metadata.version("polhode") or faults[-1] == LAST_FAULT:
                return fault["reason"]
        if SWEPT not in stored and REFUSED not in stored:
            await _queue_once(connection, grading)
    return None


async def ending(database: Database, grading: UUID) -> tuple[str, str] | None:
    """Return how the sweep of a grading ended: SWEPT with its JSON, REFUSED with the sentence, or FAULT with
    the reason. None if it has not ended.
    """
    stored = {row.name: row.content for row in await database.rows(_STORED, {"grading": grading})}
    for name in (SWEPT, REFUSED):
        if name in stored:
            return name, stored[name].decode()
    return (FAULT, json.loads(stored[max(stored)])["reason"]) if stored else None


async def begin(database: Database, grading: UUID) -> int | None:
    """Record the begin of a run of this sweep and return its number from 1.

    Return None after MOST_RUNS runs; record a fault if all of them were lost with their workers.
    """
    async with database.begin() as connection:
        await connection.execute(_LOCK_SWEEP, {"grading": str(grading)})
        number = (await connection.one(_RUNS, {"grading": grading}))[0] + 1
        lost = fault(MOST_RUNS, f"{MOST_RUNS} runs failed or were lost with their workers")
        begun = {f"sweep.run.{number}": b""} if number <= MOST_RUNS else lost
        await insert_artefacts(connection, grading, begun)
    return number if number <= MOST_RUNS else None


def fault(number: int, reason: str) -> dict[str, bytes]:
    """Return the artefact that says why polhode failed in run ``number`` of a sweep."""
    return {
        f"sweep.fault.{number}": (
            json.dumps({"reason": reason, "version": metadata.version("polhode")}).encode()
        )
    }


LAST_FAULT = f"sweep.fault.{MOST_RUNS}"


async def request_class(database: Database, class_: Iterable[StudentRow]) -> int:
    """Queue sweeps of all counted submissions without one, behind all other jobs, and return their number.

    Sweeps in which polhode failed are queued again, up to MOST_RUNS runs in all.
    """
    gradings = _gradings(class_)
    done = {row.grading_id for row in await database.rows(_DONE, {"gradings": gradings, "last": LAST_FAULT})}
    async with database.begin() as connection:
        return sum([await _queue_once(connection, grading) for grading in gradings if grading not in done])


async def count(database: Database, class_: Iterable[StudentRow]) -> tuple[int, int]:
    """Return how many counted submissions have a sweep, and how many gradable ones have none."""
    gradings = _gradings(class_)
    rows = await database.rows(_DONE, {"gradings": gradings, "last": LAST_FAULT})
    return sum(row.name == SWEPT for row in rows), len(gradings) - len({row.grading_id for row in rows})


async def documents(database: Database, class_: Iterable[StudentRow]) -> list[dict[str, Any]]:
    """Return the stored sweeps of the counted submissions as JSON documents."""
    rows = await database.rows(ARTEFACTS, {"gradings": _gradings(class_), "name": SWEPT})
    return [json.loads(row.content) for row in rows]


def _gradings(class_: Iterable[StudentRow]) -> list[UUID]:
    return [s.grading for s in class_ if s.grading is not None and s.status == "graded"]


async def put_back(database: Database, grading: UUID, number: int) -> None:
    """Queue a sweep again whose run ``number`` gave way to a grading; the run does not count."""
    async with database.begin() as connection:
        await connection.execute(_LOCK_SWEEP, {"grading": str(grading)})
        await connection.execute(_FORGET_RUN, {"grading": grading, "name": f"sweep.run.{number}"})
        await send_sweep(connection, grading)


async def _queue_once(connection: Connection, grading: UUID) -> bool:
    await connection.execute(_LOCK_SWEEP, {"grading": str(grading)})
    if await connection.first(_QUEUED, {"grading": str(grading)}) is not None:
        return False
    await send_sweep(connection, grading)
    return True


_LOCK_SWEEP = "SELECT pg_advisory_xact_lock(hashtextextended('sweep' || %(grading)s, 0))"

_QUEUED = """
SELECT 1 FROM procrastinate_jobs WHERE task_name = 'sweep' AND status IN ('todo', 'doing')
    AND args->>'attempt' = %(grading)s
"""

_DONE = """
SELECT grading_id, name FROM grading_artefact
WHERE grading_id = ANY(CAST(%(gradings)s AS uuid[])) AND name IN ('sweep.json', 'sweep.refused', %(last)s)
"""

_STORED = """
SELECT k.name, a.content FROM grading_artefact k JOIN artefact a USING (sha256)
WHERE k.grading_id = %(grading)s
    AND (k.name IN ('sweep.json', 'sweep.refused') OR k.name LIKE 'sweep.fault.%%')
"""

_FORGET_RUN = "DELETE FROM grading_artefact WHERE grading_id = %(grading)s AND name = %(name)s"

_RUNS = "SELECT count(*) FROM grading_artefact WHERE grading_id = %(grading)s AND name LIKE 'sweep.run.%%'"
