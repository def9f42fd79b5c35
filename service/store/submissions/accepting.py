"""Accept a submission: check deadline and limit and store it with its job in one transaction."""

import time
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timedelta
from uuid import UUID, uuid4

from psycopg.types.json import Jsonb

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import assignments
from service.store.database import Connection, Database, NoRow, Row
from service.store.people.people import COURSE, add_person
from service.store.queue.jobs import PERSON_LOCK, lock_persons, send_gradings
from service.store.submissions.records import FAULTED, LATE, OWN_DEADLINE, SHOWN, NewSubmission

MAX_RUNS = 3  # runs of a grading that end without result before it becomes a system fault


class KeyReused(Exception):
    """The idempotency key was used before with another body."""


class SubmissionRejected(Exception):
    """The submission is rejected for the reason in the message; ``kind`` is its problem type, ``until`` a
    passed deadline.
    """

    def __init__(self, kind: str, sentence: str, until: datetime | None = None) -> None:
        super().__init__(sentence)
        self.kind, self.until = kind, until


class TooManyOpen(Exception):
    """As many of the person's submissions as permitted are waiting for their reports."""


async def register(database: Database, catalogue: Iterable[Assignment]) -> None:
    """Store the assignments and their versions unless they are stored already."""
    async with database.begin() as connection:
        for one in catalogue:
            for query in _REGISTER, _REGISTER_VERSION:
                await connection.execute(query, {"course": COURSE, "slug": one.slug, "version": one.version})


_REGISTER = """
INSERT INTO assignment (course_id, slug) SELECT id, %(slug)s FROM course WHERE slug = %(course)s
    ON CONFLICT DO NOTHING
"""

_REGISTER_VERSION = """
INSERT INTO assignment_version (assignment_id, version)
SELECT a.id, %(version)s FROM assignment a JOIN course c ON c.id = a.course_id WHERE a.slug = %(slug)s
    AND c.slug = %(course)s
ON CONFLICT DO NOTHING
"""


@dataclass(frozen=True)
class Accepted:
    """A stored submission. If not ``fresh``, an earlier request stored the same source, and it may have a
    result.

    ``repeated`` means that it is the person's last submission, and that another one was not wanted.
    """

    id: UUID
    sha256: str
    submitted_at: datetime
    late: bool
    fresh: bool
    repeated: bool = False


async def accept(
    database: Database,
    new: NewSubmission,
    key: str | None = None,
    *,
    kind: str = "interactive",
    most_open: int | None = None,
    repeat: bool = True,
) -> Accepted:
    """Store a submission and queue its grading; with a known key, return the one stored before.

    Unless ``repeat``, return the person's last submission to the assignment if it has the same content, was
    or will be graded by the present version of the assignment, and did not end in a system fault.

    Waits for a concurrent request with the same key. Raises KeyReused if the stored submission differs,
    SubmissionRejected after the deadline or if no submission is left, and TooManyOpen if ``most_open``
    submissions of the person are not graded yet.
    """
    try:
        return await _accept(database, new, key, kind=kind, most_open=most_open, repeat=repeat)
    except NoRow:  # a backup of a course without this assignment was restored meanwhile
        await register(database, assignments().values())
        return await _accept(database, new, key, kind=kind, most_open=most_open, repeat=repeat)


async def _accept(
    database: Database, new: NewSubmission, key: str | None, *, kind: str, most_open: int | None, repeat: bool
) -> Accepted:
    async with database.begin() as connection:
        person = await add_person(connection, new.person)
        request = {
            "slug": new.assignment,
            "course": COURSE,
            "person": str(person),
            "age": time.monotonic() - new.arrived,
        }
        rules = await connection.one(_RULES, request)
        if not repeat and (last := await _find_same(connection, new, rules.id, person, key)) is not None:
            return last
        values = {
            "id": new.id,
            "assignment": rules.id,
            "person": person,
            "source": new.submission.source,
            "sha256": new.submission.sha256,
            "filename": new.submission.filename,
            "exercises": None if (asked := new.submission.exercises) is None else Jsonb(asked),
            "late": rules.late,
            "at": rules.at,
            "fingerprint": new.fingerprint,
            "key": key,
            "grading": uuid4(),
            "seed": new.seed,
            "max_runs": MAX_RUNS,
            "kind": kind,
        }
        stored = await connection.first(_STORE, values)
        if stored is None:
            return await _find_repeated(connection, new, person, key)
        await _check(connection, rules, person)
        if most_open is not None and stored.open >= most_open:
            raise TooManyOpen
        await send_gradings(connection, [values["grading"]])
    return Accepted(new.id, new.submission.sha256, rules.at, rules.late, fresh=True)


async def add_grading(connection: Connection, of: UUID, kind: str, seed: int) -> UUID:
    """Add the next grading of a submission with its job, and return its id."""
    await lock_persons(connection, [of])
    id = uuid4()
    values = {"id": id, "submission": of, "kind": kind, "seed": seed, "max_runs": MAX_RUNS}
    await connection.execute(_ADD, values)
    await send_gradings(connection, [id])
    return id


# clock_timestamp(), as now() is the start of the transaction.
_ADD = """
INSERT INTO grading (id, submission_id, number, kind, seed, max_runs, requested_at)
SELECT %(id)s, %(submission)s, coalesce(max(number), 0) + 1, %(kind)s, %(seed)s, %(max_runs)s,
    clock_timestamp()
FROM grading WHERE submission_id = %(submission)s
"""

# The submission time is that of the request, by the database's clock. The lock serializes a person's
# submissions, so that two concurrent ones cannot both take the last place.
_RULES = f"""
SELECT x.id, until.due_at, x.grace_s, x.submission_limit, at, coalesce(at > until.due_at, false) AS late,
    coalesce(at > until.due_at + make_interval(secs => x.grace_s), false) AS over,
    {PERSON_LOCK.format("CAST(%(person)s AS text)")}
FROM assignment x JOIN course c ON c.id = x.course_id
    LEFT JOIN extension e ON e.assignment_id = x.id AND e.person_id = CAST(%(person)s AS uuid)
    JOIN LATERAL {OWN_DEADLINE},
    (SELECT clock_timestamp() - make_interval(secs => %(age)s) AS at) arrived
WHERE x.slug = %(slug)s AND c.slug = %(course)s
"""

# A separate statement: it must see what was committed before the lock was granted to count the open gradings.
_STORE = """
WITH stored AS (
    INSERT INTO submission
        (id, assignment_id, person_id, source, sha256, filename, exercises, late, submitted_at, fingerprint,
        idempotency_key)
    VALUES (%(id)s, %(assignment)s, %(person)s, %(source)s, %(sha256)s, %(filename)s, %(exercises)s,
        %(late)s, %(at)s, %(fingerprint)s, %(key)s)
    ON CONFLICT (person_id, idempotency_key) DO NOTHING RETURNING id
)
INSERT INTO grading (id, submission_id, number, kind, seed, max_runs, requested_at)
SELECT %(grading)s, id, 1, %(kind)s, %(seed)s, %(max_runs)s, clock_timestamp() FROM stored
RETURNING (
    SELECT count(*) FROM grading b JOIN submission t ON t.id = b.submission_id
    LEFT JOIN result r ON r.grading_id = b.id
    WHERE t.person_id = %(person)s AND b.kind = %(kind)s AND r.grading_id IS NULL
) AS open
"""

_REPEATED = f"""
SELECT s.id, s.submitted_at, s.fingerprint, {LATE} FROM submission s
    JOIN assignment x ON x.id = s.assignment_id
WHERE s.person_id = %(person)s AND s.idempotency_key = %(key)s
"""

_LAST = f"""
SELECT s.id, s.submitted_at, s.fingerprint, s.idempotency_key AS key, shown.fault, shown.version, {LATE}
FROM submission s JOIN assignment x ON x.id = s.assignment_id JOIN {SHOWN}
WHERE s.person_id = %(person)s AND s.assignment_id = %(assignment)s ORDER BY s.submitted_at DESC LIMIT 1
"""

_USED = f"""
SELECT count(*) FROM submission s WHERE s.person_id = %(person)s AND s.assignment_id = %(assignment)s
    AND NOT {FAULTED}
"""


async def _check(connection: Connection, rules: Row, person: UUID) -> None:
    """Raise SubmissionRejected after the deadline or over the limit; system faults do not count."""
    if rules.over:
        until = rules.due_at + timedelta(seconds=rules.grace_s)
        raise SubmissionRejected(
            "deadline-over", f"the deadline was {until.isoformat(timespec='minutes')}", until
        )
    if rules.submission_limit is not None:
        used = (await connection.one(_USED, {"person": person, "assignment": rules.id}))[0]
        if used > rules.submission_limit:
            sentence = (
                f"all {rules.submission_limit} submissions allowed have been used: ask the course staff for"
                " another one"
            )
            raise SubmissionRejected("none-left", sentence)


async def _find_same(
    connection: Connection, new: NewSubmission, assignment: UUID, person: UUID, key: str | None
) -> Accepted | None:
    """Return the person's last submission if another one would repeat it; None if not, or if this request has
    stored it.
    """
    last = await connection.first(_LAST, {"person": person, "assignment": assignment})
    if (
        last is None
        or last.fingerprint != new.fingerprint
        or last.fault is not None
        or (key is not None and last.key == key)
    ):
        return None
    if last.version not in (None, assignments()[new.assignment].version):
        return None
    return Accepted(last.id, new.submission.sha256, last.submitted_at, last.late, fresh=False, repeated=True)


async def _find_repeated(
    connection: Connection, new: NewSubmission, person: UUID, key: str | None
) -> Accepted:
    found = await connection.one(_REPEATED, {"person": person, "key": key})
    if found.fingerprint != new.fingerprint:
        raise KeyReused
    return Accepted(found.id, new.submission.sha256, found.submitted_at, found.late, fresh=False)
