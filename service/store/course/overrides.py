"""Overrides of scores by instructors.

An override has a reason and is never deleted, only withdrawn or replaced.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from service.store.course import audit
from service.store.database import Connection, Database, Queries, Row
from service.store.queue import runs
from service.store.submissions.records import SHOWN

LONGEST_REASON = 1000


@dataclass(frozen=True)
class Override:
    """Points of a check or, if ``check`` is None, of the submission; valid until withdrawn."""

    id: UUID
    check: str | None
    points: float
    reason: str
    by: str
    at: datetime
    withdrawn_by: str | None
    withdrawn_at: datetime | None

    @property
    def in_force(self) -> bool:
        """Return whether the override counts."""
        return self.withdrawn_at is None


class OverrideRejected(Exception):
    """The override cannot be changed; ``kind`` is "invalid-request", "not-ready" or "changed-meanwhile"."""

    def __init__(self, kind: str, sentence: str, pointer: str | None = None) -> None:
        super().__init__(sentence)
        self.kind, self.pointer = kind, pointer


async def of_submission(database: Queries, submission: UUID) -> Sequence[Override]:
    """Return all overrides of a submission, oldest first, including withdrawn ones."""
    return [Override(**row._asdict()) for row in await database.rows(_ALL, {"id": submission})]


async def of_person(database: Queries, name: str) -> Sequence[Row]:
    """Return the overrides in force of a person's submissions, newest first, with their ``submission`` and
    ``assignment``.
    """
    return await database.rows(_OF_PERSON, {"name": name})


def revision(overrides: Sequence[Override]) -> int:
    """Return a number that grows with every change, with which a form states what its user had seen."""
    return len(overrides) + sum(not one.in_force for one in overrides)


async def give(
    database: Database,
    submission: UUID,
    actor: str,
    *,
    check: str | None,
    points: float,
    reason: str,
    seen: int | None = None,
) -> None:
    """Override the points of a check or of the submission, replacing an override in force.

    ``seen`` is the ``revision`` that the instructor saw. Raises OverrideRejected if the points are invalid,
    the submission is not graded, or the overrides have changed since ``seen``.
    """
    async with database.begin() as connection:
        before = await _locked(connection, submission)
        stored = await of_submission(connection, submission)
        if seen is not None and seen != revision(stored):
            raise OverrideRejected(
                "changed-meanwhile", "someone else changed these points: reload the page and check them"
            )
        outcome = await connection.first(_OUTCOME, {"grading": before.grading, "check": check})
        _validate(before, outcome, check, points, reason)
        old = next((one for one in stored if one.in_force and one.check == check), None)
        if old is not None:
            await connection.execute(_WITHDRAW, {"submission": submission, "id": old.id, "actor": actor})
        values = {
            "submission": submission,
            "check": check,
            "points": points,
            "reason": reason,
            "actor": actor,
        }
        await connection.execute(_GIVE, values)
        measured = before.score if outcome is None else outcome.earned
        detail = {
            "action": "override",
            "check": check,
            "before": measured if old is None else old.points,
            "after": points,
            "reason": reason,
        }
        await _record_change(connection, submission, before, actor, detail)


async def withdraw(database: Database, submission: UUID, id: UUID, actor: str) -> bool:
    """Withdraw an override, so that the measured points count again.

    Return False if the submission has no such override.

    Raises OverrideRejected if it is not in force.
    """
    async with database.begin() as connection:
        before = await _locked(connection, submission)
        stored = await of_submission(connection, submission)
        one = next((one for one in stored if one.id == id), None)
        if one is None:
            return False
        if not one.in_force:
            problem = f"{one.withdrawn_by} has already withdrawn or replaced this override: reload the page"
            raise OverrideRejected("changed-meanwhile", problem)
        await connection.execute(_WITHDRAW, {"submission": submission, "id": id, "actor": actor})
        detail = {
            "action": "override withdrawn",
            "check": one.check,
            "before": one.points,
            "after": None,
            "reason": one.reason,
        }
        await _record_change(connection, submission, before, actor, detail)
    return True


def _validate(before: Row, outcome: Row | None, check: str | None, points: float, reason: str) -> None:
    if before.max_score is None:
        raise OverrideRejected(
            "not-ready", "the submission has no report yet: override its points once it is graded"
        )
    if check is not None and outcome is None:
        raise OverrideRejected("invalid-request", f"the report has no counted check {check[:80]}", "/check")
    most = max(before.max_score, before.total) if outcome is None else outcome.points
    if not 0 <= points <= most:
        what = "the submission" if outcome is None else f"the check {check}"
        raise OverrideRejected(
            "invalid-request", f"the points of {what} must be from 0 to {most:g}", "/points"
        )
    if not 0 < len(reason) <= LONGEST_REASON:
        raise OverrideRejected(
            "invalid-request",
            f"give a reason of at most {LONGEST_REASON} characters: the student reads it",
            "/reason",
        )


async def _locked(connection: Connection, submission: UUID) -> Row:
    """Lock the submission's points until the end of the transaction, and return what is shown for it."""
    await connection.execute(_LOCK, {"id": submission})
    return await connection.one(_SHOWN, {"id": submission})


async def _record_change(
    connection: Connection, submission: UUID, before: Row, actor: str, change: dict[str, Any]
) -> None:
    after = await connection.one(_SHOWN, {"id": submission})
    action = change.pop("action")
    points = {audit.OLD: before.points, audit.NEW: after.points}
    detail = {"person": before.person, **change, "points": points}
    await audit.record(connection, actor, action, str(submission), detail)
    await runs.notify_in(connection, submission)


_ALL = """
SELECT id, check_id AS check, points, reason, given_by AS by, given_at AS at, withdrawn_by, withdrawn_at
FROM override WHERE submission_id = %(id)s ORDER BY given_at, id
"""

_OF_PERSON = """
SELECT o.submission_id AS submission, x.slug AS assignment, o.check_id AS check, o.points, o.reason,
    o.given_by AS by,
    o.given_at AS at
FROM override o JOIN submission s ON s.id = o.submission_id JOIN assignment x ON x.id = s.assignment_id
    JOIN person p ON p.id = s.person_id
WHERE p.name = %(name)s AND o.withdrawn_at IS NULL ORDER BY o.given_at DESC, o.id
"""

_LOCK = "SELECT 1 FROM submission WHERE id = %(id)s FOR NO KEY UPDATE"

_SHOWN = f"""
SELECT p.name AS person, shown.grading, shown.score, shown.max_score, shown.total, given.points
FROM submission s JOIN person p ON p.id = s.person_id JOIN {SHOWN} WHERE s.id = %(id)s
"""

_OUTCOME = """
SELECT points, earned FROM outcome WHERE grading_id = %(grading)s
    AND check_id = CAST(%(check)s AS text) AND counted
"""

_GIVE = """
INSERT INTO override (submission_id, check_id, points, reason, given_by, given_at)
VALUES (%(submission)s, %(check)s, %(points)s, %(reason)s, %(actor)s, clock_timestamp())
"""

_WITHDRAW = """
UPDATE override SET withdrawn_by = %(actor)s, withdrawn_at = clock_timestamp()
WHERE id = %(id)s AND submission_id = %(submission)s AND withdrawn_at IS NULL
"""
