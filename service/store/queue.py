"""The queue: Procrastinate's jobs in our own database. A job holds the id of a grading and nothing else.

The queue only wakes workers; the tables are the truth. Whatever was accepted and has no result gets a job again, see
``service.store.workers``.
"""

from collections import defaultdict
from collections.abc import Sequence
from uuid import UUID

from procrastinate import App, PsycopgConnector
from procrastinate.types import JSONValue
from sqlalchemy import text
from sqlalchemy.ext.asyncio import AsyncConnection

from service.settings import DATABASE_WAIT_S
from service.store.database import connect_options

QUEUE = "grade"
KINDS = {"interactive": 2, "regrade": 1, "bulk": 0}
RECONNECT_S = 0.5  # the queue's pool's pause between gradings doubles: after a long outage it would sleep long into the day
STEP = 1000  # between kinds; within one, a person's n-th open grading ranks n lower


def new_app(url: str, name: str, wait_s: float = DATABASE_WAIT_S) -> App:
    """A Procrastinate application on the database; whoever takes jobs from it opens it."""
    return App(
        connector=PsycopgConnector(
            conninfo=url, kwargs=connect_options(name), min_size=0, max_size=3, timeout=wait_s, reconnect_timeout=RECONNECT_S
        )
    )


_sender = App(connector=PsycopgConnector())  # never opened: it writes through the transactions it is handed


async def send(connection: AsyncConnection, grading: UUID, *, task: str = "grade", priority: int) -> None:
    """Add a job in this transaction."""
    raw = (await connection.get_raw_connection()).driver_connection
    job = _sender.configure_task(task, queue=QUEUE, priority=priority, connection=raw)
    await job.defer_async(**job_arguments(grading))


def job_arguments(grading: UUID) -> dict[str, JSONValue]:
    """Return the arguments of a grading's job; ``attempt`` is also the name in jobs queued by older versions."""
    return {"attempt": str(grading)}


def priority_of(kind: str, open_before: int) -> int:
    """The priority of a grading whose person has so many open ones of that kind before it."""
    return STEP * KINDS[kind] - min(STEP - 1, open_before)


async def send_grading(connection: AsyncConnection, grading: UUID, *, begun: bool = False) -> None:
    """Add the job of a grading, ranked by its kind and by how many gradings its person has open before it.

    One that had ``begun`` and lost its worker has waited already: it goes before all others of its kind.
    """
    found = (await connection.execute(_OPEN_BEFORE, {"gradings": [grading]})).one()
    await send(connection, grading, priority=priority_of(found.kind, 0) + 1 if begun else priority_of(found.kind, found.open))


async def send_gradings(connection: AsyncConnection, gradings: Sequence[UUID]) -> None:
    """The same for many, none of which was begun."""
    by_rank: defaultdict[int, list[UUID]] = defaultdict(list)
    for row in (await connection.execute(_OPEN_BEFORE, {"gradings": list(gradings)})).all():
        by_rank[priority_of(row.kind, row.open)].append(row.id)
    raw = (await connection.get_raw_connection()).driver_connection
    for priority, those in by_rank.items():
        job = _sender.configure_task("grade", queue=QUEUE, priority=priority, connection=raw)
        await job.batch_defer_async(*[job_arguments(grading) for grading in those])


async def send_next(connection: AsyncConnection, done: UUID, submission: UUID) -> None:
    """When a grading has its result, its person's next one moves up, to the end of those of the same rank.

    So persons take turns however many each has sent, and whoever sends again early need not wait for everybody who comes later.
    """
    await lock_person(connection, submission)
    row = (await connection.execute(_NEXT, {"grading": done})).first()
    if row is not None:
        await connection.execute(text("DELETE FROM procrastinate_jobs WHERE id = :id"), {"id": row.job})
        await send_grading(connection, row.grading)


async def lock_person(connection: AsyncConnection, submission: UUID) -> None:
    """Wait until nobody else ranks this person's gradings, to the end of the transaction: a rank counts what others may change."""
    await connection.execute(_TURN, {"submission": submission})


async def lock_persons(connection: AsyncConnection, submissions: Sequence[UUID]) -> None:
    """The same for the persons of many, always in the same order, so that two who do this do not wait for each other."""
    await connection.execute(_TURNS, {"submissions": list(submissions)})


PERSON_LOCK = "pg_advisory_xact_lock(hashtextextended({}::text, 0))"
_TURN = text(f"SELECT {PERSON_LOCK.format('person_id')} FROM submission WHERE id = :submission")
_TURNS = text(f"""
SELECT {PERSON_LOCK.format("person_id")}
FROM (SELECT DISTINCT person_id FROM submission WHERE id = ANY(:submissions) ORDER BY person_id) AS persons
""")

_NEXT = text(f"""
SELECT j.id AS job, b.id AS grading
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN submission t ON t.person_id = s.person_id
    JOIN grading b ON b.submission_id = t.id AND b.kind = a.kind
    JOIN procrastinate_jobs j ON j.args->>'attempt' = b.id::text AND j.task_name = 'grade' AND j.status = 'todo'
WHERE a.id = :grading AND mod(j.priority, {STEP}) NOT IN (0, 1)
ORDER BY b.requested_at, b.id LIMIT 1 FOR UPDATE OF j SKIP LOCKED
""")

_OPEN_BEFORE = text("""
SELECT a.id, a.kind, (
    SELECT count(*) FROM grading b JOIN submission t ON t.id = b.submission_id LEFT JOIN result r ON r.grading_id = b.id
    WHERE t.person_id = s.person_id AND b.kind = a.kind AND r.grading_id IS NULL AND (b.requested_at, b.id) < (a.requested_at, a.id)
) AS open
FROM grading a JOIN submission s ON s.id = a.submission_id WHERE a.id = ANY(:gradings) ORDER BY a.requested_at, a.id
""")
