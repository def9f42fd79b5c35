"""Regrade requests: a student states why a submission deserves more points, and the course staff answers."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Literal
from uuid import UUID

from service.store.course import audit
from service.store.database import Database, Row
from service.store.people.people import COURSE
from service.store.submissions.records import SHOWN

LONGEST = 2000  # characters of a reason, and of an answer
MOST = 500
Answer = Literal["accepted", "declined"]
Status = Literal["open", "accepted", "declined"]


@dataclass(frozen=True)
class RegradeRequest:
    """A request about a check of a submission, None for all of it; without an answer while its ``status`` is
    "open".
    """

    id: UUID
    submission: UUID
    check: str | None
    reason: str
    requested_at: datetime
    status: Status
    answer: str | None
    answered_by: str | None
    answered_at: datetime | None


class RequestRejected(Exception):
    """The request cannot be stored or answered; ``kind`` is its problem type, "not-ready" or
    "changed-meanwhile".
    """

    def __init__(self, kind: str, sentence: str) -> None:
        super().__init__(sentence)
        self.kind = kind


async def of_submission(database: Database, submission: UUID) -> Sequence[RegradeRequest]:
    """Return the requests about a submission, oldest first."""
    return [
        RegradeRequest(**row._asdict())
        for row in await database.rows(_OF_SUBMISSION, {"submission": submission})
    ]


async def of_assignment(database: Database, slug: str) -> Sequence[Row]:
    """Return the latest MOST requests about an assignment, open ones first and oldest of these first.

    A row has the fields of RegradeRequest, ``person``, ``full_name``, and the submission's ``points`` and
    ``total``.
    """
    return await database.rows(_OF_ASSIGNMENT, {"slug": slug, "course": COURSE})


async def request(
    database: Database, submission: UUID, person: str, reason: str, check: str | None = None
) -> RegradeRequest:
    """Store a request about a check, None for the whole submission.

    Raises RequestRejected if the submission has no report or an open request.
    """
    async with database.begin() as connection:
        if (await connection.one(_SCORE, {"submission": submission})).score is None:
            raise RequestRejected(
                "not-ready", "the submission has no report yet: request a regrade once it is graded"
            )
        row = await connection.first(_REQUEST, {"submission": submission, "reason": reason, "check": check})
        if row is None:
            raise RequestRejected(
                "changed-meanwhile", "a regrade request for this submission is open: wait for its answer"
            )
        detail = {"reason": reason} | ({"check": check} if check else {})
        await audit.record(connection, person, "regrade request", str(submission), detail)
    return RegradeRequest(**row._asdict())


async def answer(
    database: Database, id: UUID, actor: str, status: Answer, text: str
) -> RegradeRequest | None:
    """Answer an open request and return it; return None if there is none with that id.

    Raises RequestRejected if it is answered already.
    """
    async with database.begin() as connection:
        row = await connection.first(_ANSWER, {"id": id, "status": status, "text": text, "actor": actor})
        if row is None:
            if (found := await connection.first(_ANSWERED_BY, {"id": id})) is None:
                return None
            raise RequestRejected(
                "changed-meanwhile", f"{found.answered_by} has already answered this request: reload the page"
            )
        await audit.record(
            connection, actor, f"regrade request {status}", str(row.submission), {"answer": text}
        )
    return RegradeRequest(**row._asdict())


_COLUMNS = (
    'id, submission_id AS submission, check_id AS "check", reason, requested_at, status, answer, answered_by,'
    " answered_at"
)

_OF_SUBMISSION = (
    f"SELECT {_COLUMNS} FROM regrade_request WHERE submission_id = %(submission)s ORDER BY requested_at, id"
)

_OF_ASSIGNMENT = f"""
SELECT q.id, q.submission_id AS submission, q.check_id AS "check", q.reason, q.requested_at, q.status,
    q.answer, q.answered_by,
    q.answered_at,
    p.name AS person, p.full_name, given.points, shown.total
FROM regrade_request q JOIN submission s ON s.id = q.submission_id JOIN person p ON p.id = s.person_id
    JOIN assignment x ON x.id = s.assignment_id JOIN course c ON c.id = x.course_id JOIN {SHOWN}
WHERE x.slug = %(slug)s AND c.slug = %(course)s
ORDER BY q.answered_at DESC NULLS FIRST, q.requested_at LIMIT {MOST}
"""

_SCORE = f"SELECT shown.score FROM submission s JOIN {SHOWN} WHERE s.id = %(submission)s"

_REQUEST = f"""
INSERT INTO regrade_request (submission_id, check_id, reason) VALUES (%(submission)s, %(check)s, %(reason)s)
    ON CONFLICT DO NOTHING RETURNING {_COLUMNS}
"""

_ANSWER = f"""
UPDATE regrade_request SET status = %(status)s, answer = %(text)s, answered_by = %(actor)s,
    answered_at = clock_timestamp()
WHERE id = %(id)s AND status = 'open' RETURNING {_COLUMNS}
"""

_ANSWERED_BY = "SELECT answered_by FROM regrade_request WHERE id = %(id)s"
