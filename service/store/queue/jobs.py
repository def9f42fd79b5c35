"""Queue gradings as Procrastinate jobs in the same database.

A job holds the id of a grading and nothing else. Its lock is one of its person's places, of which there is
one fewer than workers: so one person's gradings never occupy all workers. Its queue says who may take it.

Jobs only wake workers; the tables are authoritative. ``service.store.queue.workers`` queues every grading
without a result again.
"""

from collections import Counter
from collections.abc import Sequence
from uuid import UUID

from procrastinate import App, PsycopgConnector
from procrastinate.exceptions import ConnectorException
from procrastinate.jobs import Job, Status
from procrastinate.manager import JobManager
from procrastinate.types import JSONValue
from psycopg import AsyncConnection
from psycopg.errors import RaiseException

from service.settings import DATABASE_WAIT_S
from service.store.database import Connection, Row, connect_options

FIRST, LATER, SLOW = "first", "later", "slow"
"""Queues: of first gradings; of regrades and sweeps; and of all gradings that are known to be slow."""
KINDS = {"interactive": 2, "regrade": 1, "bulk": 0}
RECONNECT_S = (
    0.5  # the pool doubles its pause between attempts, so a long outage would leave it asleep for hours
)
STEP = 1000  # priority between kinds; within a kind, a person's n-th open grading ranks n lower
SLOW_STEP = STEP // 2  # how much lower slow gradings of a kind rank


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


async def first_gradings_wait(app: App) -> bool:
    """Return whether somebody waits for a first report, apart from those whose gradings are slow."""
    return bool(await app.job_manager.list_queues_async(queue=FIRST, status="todo"))


_jobs = App(connector=PsycopgConnector()).job_manager  # never opened: it writes in its callers' transactions


def job_arguments(grading: UUID) -> dict[str, JSONValue]:
    """Return the arguments of a job, by which the index ``job_of_grading`` finds it."""
    return {"attempt": str(grading)}


def priority_of(kind: str, earlier: int, *, slow: bool = False) -> int:
    """Return the priority of a grading of that kind whose person has ``earlier`` open gradings before it.

    All slow gradings of a kind rank below the others.
    """
    return STEP * KINDS[kind] - SLOW_STEP * slow - min(SLOW_STEP - 2, earlier)


async def send_gradings(connection: Connection, gradings: Sequence[UUID], *, begun: bool = False) -> None:
    """Add the jobs of gradings, each ranked by its kind and by the person's number of earlier open gradings.

    Gradings that had ``begun`` before their worker was lost go ahead of all others of their kind.
    """
    jobs, taken = [], dict[UUID, Counter[str | None]]()
    for row in await connection.rows(_RANKS, {"gradings": list(gradings)}):
        locks = taken.setdefault(row.person, Counter(row.locks))
        lock = None if row.alone else min(_locks(row), key=locks.__getitem__)
        locks[lock] += 1
        priority = priority_of(row.kind, 0 if begun else row.earlier, slow=row.slow) + begun
        queue = SLOW if row.slow else FIRST if row.kind == "interactive" else LATER
        jobs.append(_job("grade", row.id, queue, priority, lock))
    await _jobs.batch_defer_jobs_async(jobs, connection=connection.raw)


async def send_sweep(connection: Connection, grading: UUID) -> None:
    """Add the job of a sweep, which ranks behind all gradings."""
    row = await connection.one(_PLACES, {"grading": grading})
    lock = None if row.alone else _locks(row)[grading.int % row.places]
    job = _job("sweep", grading, LATER, -STEP, lock)
    await _jobs.batch_defer_jobs_async([job], connection=connection.raw)


def _locks(row: Row) -> Sequence[str]:
    """Return the locks of a person's places. Jobs with the same lock are done one after another."""
    return [f"{row.person}/{place}" for place in range(row.places)]


def _job(task: str, grading: UUID, queue: str, priority: int, lock: str | None) -> Job:
    return Job(
        id=None,
        task_name=task,
        task_kwargs=job_arguments(grading),
        queue=queue,
        priority=priority,
        lock=lock,
        queueing_lock=None,
    )


async def send_next(connection: Connection, done: UUID) -> None:
    """Move the person's next grading up after ``done`` got its result, behind others of its new rank. The
    person must be locked, by an earlier statement.

    So people take turns however many submissions each has queued, and later arrivals do not delay an early
    second submission indefinitely.
    """
    row = await connection.first(_NEXT, {"grading": done})
    if row is not None:
        await _jobs.cancel_job_by_id_async(row.job, delete_job=True, connection=connection.raw)
        await send_gradings(connection, [row.grading])


async def delete_waiting(connection: Connection, gradings: Sequence[UUID]) -> None:
    """Delete the jobs of these gradings that no worker has taken."""
    for row in await connection.rows(_WAITING, {"gradings": [str(grading) for grading in gradings]}):
        await _jobs.cancel_job_by_id_async(row.id, delete_job=True, connection=connection.raw)


async def lock_persons(connection: Connection, submissions: Sequence[UUID]) -> None:
    """Lock the rankings of these submissions' people until the end of the transaction.

    They are locked in a fixed order, which avoids deadlocks.
    """
    await connection.execute(_LOCK_PERSONS, {"submissions": list(submissions)})


PERSON_LOCK = "pg_advisory_xact_lock(hashtextextended({}::text, 0))"
_LOCK_PERSONS = f"""
SELECT {PERSON_LOCK.format("person_id")}
FROM (SELECT DISTINCT person_id FROM submission WHERE id = ANY(%(submissions)s) ORDER BY person_id) AS persons
"""

# Whether the last run of the content of submission ``s``, of whoever sent it, was slow.
KNOWN_SLOW = """coalesce((
    SELECT run.slow FROM submission o JOIN grading g ON g.submission_id = o.id
        JOIN run ON run.grading_id = g.id
    WHERE o.assignment_id = s.assignment_id AND o.sha256 = s.sha256 AND run.slow IS NOT NULL
    ORDER BY run.ended_at DESC LIMIT 1
), false)"""

# A person has one place fewer than there are workers, and at least one. The student of a server without
# logins is everybody, and not limited.
_PLACE = """s.person_id AS person, p.name = 'local' AS alone, (
    SELECT greatest(1, count(*) - 1) FROM worker WHERE isolation IS NOT NULL
    AND seen_at BETWEEN now() - interval '30 s' AND now() + interval '30 s') AS places"""

_PLACES = f"""
SELECT {_PLACE} FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
WHERE a.id = %(grading)s
"""

# The person's earlier open gradings that are as slow count; the locks of all of them are taken. One that was
# put back has two jobs until the former one ends.
_RANKS = f"""
SELECT a.id, a.kind, a.slow, a.person, a.alone, a.places, before.earlier, before.locks
FROM (
    SELECT a.id, a.kind, a.requested_at, {KNOWN_SLOW} AS slow, {_PLACE}
    FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
    WHERE a.id = ANY(%(gradings)s)
) a CROSS JOIN LATERAL (
    SELECT count(*) FILTER (WHERE b.kind = a.kind AND coalesce(j.queue_name = '{SLOW}', false) = a.slow)
        AS earlier, array_agg(j.lock) FILTER (WHERE j.lock IS NOT NULL) AS locks
    FROM grading b JOIN submission t ON t.id = b.submission_id LEFT JOIN result r ON r.grading_id = b.id
        LEFT JOIN LATERAL (
            SELECT queue_name, lock FROM procrastinate_jobs
            WHERE args->>'attempt' = b.id::text AND task_name = 'grade' ORDER BY id DESC LIMIT 1
        ) j ON true
    WHERE t.person_id = a.person AND r.grading_id IS NULL AND (b.requested_at, b.id) < (a.requested_at, a.id)
) before
ORDER BY a.requested_at, a.id
"""

_WAITING = """
SELECT id FROM procrastinate_jobs
WHERE args->>'attempt' = ANY(%(gradings)s) AND task_name = 'grade' AND status = 'todo'
"""

# A grading that was put back as slow lets one move up that is not.
_NEXT = f"""
SELECT j.id AS job, b.id AS grading
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN submission t ON t.person_id = s.person_id
    JOIN grading b ON b.submission_id = t.id AND b.kind = a.kind
    JOIN procrastinate_jobs j ON j.args->>'attempt' = b.id::text AND j.task_name = 'grade'
    AND j.status = 'todo'
WHERE a.id = %(grading)s AND mod(j.priority, {SLOW_STEP}) NOT IN (0, 1)
    AND (j.queue_name = '{SLOW}') = EXISTS (
        SELECT FROM procrastinate_jobs d WHERE d.args->>'attempt' = a.id::text AND d.task_name = 'grade'
        AND d.status = 'doing' AND d.queue_name = '{SLOW}')
ORDER BY b.requested_at, b.id LIMIT 1 FOR UPDATE OF j SKIP LOCKED
"""
