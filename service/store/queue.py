"""Queue gradings as Procrastinate jobs in the same database.

A job holds the id of a grading and nothing else.

Jobs only wake workers; the tables are authoritative. ``service.store.workers`` queues every grading without
a result again.
"""

from collections import defaultdict
from collections.abc import Sequence
from uuid import UUID

from procrastinate import App, PsycopgConnector
from procrastinate.exceptions import ConnectorException
from procrastinate.jobs import Status
from procrastinate.manager import JobManager
from procrastinate.types import JSONValue
from psycopg import AsyncConnection
from psycopg.errors import RaiseException

from service.settings import DATABASE_WAIT_S
from service.store.database import Connection, connect_options

QUEUE = "grade"
KINDS = {"interactive": 2, "regrade": 1, "bulk": 0}
RECONNECT_S = (
    0.5  # the pool doubles its pause between attempts, so a long outage would leave it asleep for hours
)
STEP = 1000  # priority between kinds; within a kind, a person's n-th open grading ranks n lower


class Jobs(JobManager):
    """Finishes jobs, also those that were dropped meanwhile: a run that failed or counts as lost has its
    grading queued again in another job.
    """

    async def finish_job_by_id_async(self, job_id: int, status: Status, delete_job: bool) -> None:
        """Finish a job, or do nothing if it is gone."""
        try:
            await super().finish_job_by_id_async(job_id, status, delete_job)
        except ConnectorException as error:
            if not isinstance(error.__cause__, RaiseException):
                raise


def new_app(url: str, name: str, wait_s: float = DATABASE_WAIT_S) -> App:
    """Return a Procrastinate application on the database; the caller opens it to take jobs."""
    app = App(
        connector=PsycopgConnector(
            conninfo=url,
            kwargs=connect_options(name),
            configure=_configure,
            min_size=0,
            max_size=3,
            timeout=wait_s,
            reconnect_timeout=RECONNECT_S,
        )
    )
    app.job_manager = Jobs(app.connector)
    return app


async def _configure(connection: AsyncConnection) -> None:
    """Make each statement a transaction that does not wait for the disk: a job that a crash brings back is
    taken again.
    """
    await connection.set_autocommit(True)
    await connection.execute("SET synchronous_commit = off")


_sender = App(connector=PsycopgConnector())  # never opened: it writes through its callers' transactions


async def send(
    connection: Connection, gradings: Sequence[UUID], *, task: str = "grade", priority: int
) -> None:
    """Add a job for each grading in this transaction. ``task`` is "grade" or "sweep"."""
    job = _sender.configure_task(task, queue=QUEUE, priority=priority, connection=connection.raw)
    await job.batch_defer_async(*map(job_arguments, gradings))


def job_arguments(grading: UUID) -> dict[str, JSONValue]:
    """Return the arguments of a job, by which the index ``job_of_grading`` finds it."""
    return {"attempt": str(grading)}


def priority_of(kind: str, open_before: int) -> int:
    """Return the priority of a grading whose person has ``open_before`` earlier open gradings of that
    kind.
    """
    return STEP * KINDS[kind] - min(STEP - 1, open_before)


async def send_gradings(connection: Connection, gradings: Sequence[UUID], *, begun: bool = False) -> None:
    """Add the jobs of gradings, each ranked by its kind and by the person's number of earlier open gradings.

    Gradings that had ``begun`` before their worker was lost go ahead of all others of their kind.
    """
    by_rank: defaultdict[int, list[UUID]] = defaultdict(list)
    for row in await connection.rows(_OPEN_BEFORE, {"gradings": list(gradings)}):
        by_rank[priority_of(row.kind, 0) + 1 if begun else priority_of(row.kind, row.open)].append(row.id)
    for priority, ids in by_rank.items():
        await send(connection, ids, priority=priority)


async def send_next(connection: Connection, done: UUID) -> None:
    """Move the person's next grading up after ``done`` got its result, behind others of its new rank. The
    person must be locked, by an earlier statement.

    So people take turns however many submissions each has queued, and later arrivals do not delay an early
    second submission indefinitely.
    """
    row = await connection.first(_NEXT, {"grading": done})
    if row is not None:
        await connection.execute("DELETE FROM procrastinate_jobs WHERE id = :id", {"id": row.job})
        await send_gradings(connection, [row.grading])


async def lock_persons(connection: Connection, submissions: Sequence[UUID]) -> None:
    """Lock the rankings of these submissions' people until the end of the transaction.

    They are locked in a fixed order, which avoids deadlocks.
    """
    await connection.execute(_LOCK_PERSONS, {"submissions": list(submissions)})


PERSON_LOCK = "pg_advisory_xact_lock(hashtextextended({}::text, 0))"
_LOCK_PERSONS = f"""
SELECT {PERSON_LOCK.format("person_id")}
FROM (SELECT DISTINCT person_id FROM submission WHERE id = ANY(:submissions) ORDER BY person_id) AS persons
"""

_NEXT = f"""
SELECT j.id AS job, b.id AS grading
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN submission t ON t.person_id = s.person_id
    JOIN grading b ON b.submission_id = t.id AND b.kind = a.kind
    JOIN procrastinate_jobs j ON j.args->>'attempt' = b.id::text AND j.task_name = 'grade'
    AND j.status = 'todo'
WHERE a.id = :grading AND mod(j.priority, {STEP}) NOT IN (0, 1)
ORDER BY b.requested_at, b.id LIMIT 1 FOR UPDATE OF j SKIP LOCKED
"""

_OPEN_BEFORE = """
SELECT a.id, a.kind, (
    SELECT count(*) FROM grading b JOIN submission t ON t.id = b.submission_id
    LEFT JOIN result r ON r.grading_id = b.id
    WHERE t.person_id = s.person_id AND b.kind = a.kind AND r.grading_id IS NULL
    AND (b.requested_at, b.id) < (a.requested_at, a.id)
) AS open
FROM grading a JOIN submission s ON s.id = a.submission_id WHERE a.id = ANY(:gradings)
    ORDER BY a.requested_at, a.id
"""
