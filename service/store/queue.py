"""The queue: Procrastinate's jobs in our own database. A job holds the id of an attempt and nothing else.

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
RECONNECT_S = 0.5  # the queue's pool's pause between attempts doubles: after a long outage it would sleep long into the day
STEP = 1000  # between kinds; within one, a person's n-th open attempt ranks n lower


def new_app(url: str, name: str, wait_s: float = DATABASE_WAIT_S) -> App:
    """A Procrastinate application on the database; whoever takes jobs from it opens it."""
    return App(
        connector=PsycopgConnector(
            conninfo=url, kwargs=connect_options(name), min_size=0, max_size=3, timeout=wait_s, reconnect_timeout=RECONNECT_S
        )
    )


_sender = App(connector=PsycopgConnector())  # never opened: it writes through the transactions it is handed


async def send(connection: AsyncConnection, attempt: UUID, *, task: str = "grade", priority: int) -> None:
    """Add a job in this transaction."""
    raw = (await connection.get_raw_connection()).driver_connection
    job = _sender.configure_task(task, queue=QUEUE, priority=priority, connection=raw)
    await job.defer_async(attempt=str(attempt))


def priority_of(kind: str, open_before: int) -> int:
    """The priority of an attempt whose person has so many open ones of that kind before it."""
    return STEP * KINDS[kind] - min(STEP - 1, open_before)


async def send_attempt(connection: AsyncConnection, attempt: UUID, *, begun: bool = False) -> None:
    """Add the job of an attempt, ranked by its kind and by how many attempts its person has open before it.

    One that had ``begun`` and lost its worker has waited already: it goes before all others of its kind.
    """
    found = (await connection.execute(_OPEN_BEFORE, {"attempts": [attempt]})).one()
    await send(connection, attempt, priority=priority_of(found.kind, 0) + 1 if begun else priority_of(found.kind, found.open))


async def send_attempts(connection: AsyncConnection, attempts: Sequence[UUID]) -> None:
    """The same for many, none of which was begun."""
    by_rank: defaultdict[int, list[UUID]] = defaultdict(list)
    for row in (await connection.execute(_OPEN_BEFORE, {"attempts": list(attempts)})).all():
        by_rank[priority_of(row.kind, row.open)].append(row.id)
    raw = (await connection.get_raw_connection()).driver_connection
    for priority, those in by_rank.items():
        job = _sender.configure_task("grade", queue=QUEUE, priority=priority, connection=raw)
        asked: list[dict[str, JSONValue]] = [{"attempt": str(attempt)} for attempt in those]
        await job.batch_defer_async(*asked)


async def send_next(connection: AsyncConnection, done: UUID, submission: UUID) -> None:
    """When an attempt has its result, its person's next one moves up, to the end of those of the same rank.

    So persons take turns however many each has sent, and whoever sends again early need not wait for everybody who comes later.
    """
    await lock_person(connection, submission)
    row = (await connection.execute(_NEXT, {"attempt": done})).first()
    if row is not None:
        await connection.execute(text("DELETE FROM procrastinate_jobs WHERE id = :id"), {"id": row.job})
        await send_attempt(connection, row.attempt)


async def lock_person(connection: AsyncConnection, submission: UUID) -> None:
    """Wait until nobody else ranks this person's attempts, to the end of the transaction: a rank counts what others may change."""
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
SELECT j.id AS job, b.id AS attempt
FROM attempt a JOIN submission s ON s.id = a.submission_id JOIN submission t ON t.person_id = s.person_id
    JOIN attempt b ON b.submission_id = t.id AND b.kind = a.kind
    JOIN procrastinate_jobs j ON j.args->>'attempt' = b.id::text AND j.task_name = 'grade' AND j.status = 'todo'
WHERE a.id = :attempt AND mod(j.priority, {STEP}) NOT IN (0, 1)
ORDER BY b.requested_at, b.id LIMIT 1 FOR UPDATE OF j SKIP LOCKED
""")

_OPEN_BEFORE = text("""
SELECT a.id, a.kind, (
    SELECT count(*) FROM attempt b JOIN submission t ON t.id = b.submission_id LEFT JOIN result r ON r.attempt_id = b.id
    WHERE t.person_id = s.person_id AND b.kind = a.kind AND r.attempt_id IS NULL AND (b.requested_at, b.id) < (a.requested_at, a.id)
) AS open
FROM attempt a JOIN submission s ON s.id = a.submission_id WHERE a.id = ANY(:attempts) ORDER BY a.requested_at, a.id
""")
