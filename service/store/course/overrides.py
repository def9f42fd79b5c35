"""Points that an instructor gives instead of what was measured, with a reason: never erased, only withdrawn or replaced."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import Row, text
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.ext.asyncio import AsyncConnection

from service.store import runs
from service.store.course.people import record_audit
from service.store.database import Database
from service.store.records import SHOWN
from service.store.tables import override

LONGEST_REASON = 1000


@dataclass(frozen=True)
class Override:
    """Points given for a check (1 or 0) or, with ``check`` None, for the whole submission; in force until it was withdrawn."""

    id: UUID
    check: str | None
    points: int
    reason: str
    by: str
    at: datetime
    withdrawn_by: str | None
    withdrawn_at: datetime | None

    @property
    def in_force(self) -> bool:
        """Whether it counts."""
        return self.withdrawn_at is None


class OverrideRejected(Exception):
    """These points cannot be given; ``kind`` is "invalid-request", "not-ready" or "changed-meanwhile"."""

    def __init__(self, kind: str, sentence: str) -> None:
        super().__init__(sentence)
        self.kind = kind


async def of_submission(database: Database, submission: UUID) -> Sequence[Override]:
    """All that were ever given, oldest first."""
    return [Override(**row._mapping) for row in await database.rows(_ALL, {"id": submission})]


def revision(known: Sequence[Override]) -> int:
    """A number that grows with every change, so that a form tells what its sender had seen."""
    return len(known) + sum(not one.in_force for one in known)


async def give(
    database: Database, submission: UUID, who: str, *, check: str | None, points: int, reason: str, seen: int | None = None
) -> None:
    """Give these points; what was in force for the same is withdrawn. NotGiven with the reason why they cannot be.

    With ``seen``, a stamp, nothing is given where the overrides have been changed since.
    """
    async with database.begin() as connection:
        before = await _locked(connection, submission)
        known = [Override(**row._mapping) for row in (await connection.execute(text(_ALL), {"id": submission})).all()]
        if seen is not None and seen != revision(known):
            raise OverrideRejected(
                "changed-meanwhile", "somebody else changed these points meanwhile: load the page again, then decide"
            )
        outcome = (await connection.execute(_OUTCOME, {"grading": before.grading, "check": check})).first()
        _judge(before, outcome, check, points, reason)
        old = next((one for one in known if one.in_force and one.check == check), None)
        if old is not None:
            await connection.execute(_WITHDRAW, {"submission": submission, "id": old.id, "who": who})
        values = {"submission_id": submission, "check_id": check, "points": points, "reason": reason, "given_by": who}
        await connection.execute(insert(override).values(values | {"given_at": text("clock_timestamp()")}))
        measured = before.score if outcome is None else int(outcome.state == "pass")
        told = {
            "action": "override",
            "check": check,
            "before": measured if old is None else old.points,
            "after": points,
            "reason": reason,
        }
        await _tell(connection, submission, before, who, told)


async def withdraw(database: Database, submission: UUID, id: UUID, who: str) -> bool:
    """What was measured counts again. False where that submission has no such override; NotGiven where it is over already."""
    async with database.begin() as connection:
        before = await _locked(connection, submission)
        known = [Override(**row._mapping) for row in (await connection.execute(text(_ALL), {"id": submission})).all()]
        one = next((one for one in known if one.id == id), None)
        if one is None:
            return False
        if not one.in_force:
            raise OverrideRejected("changed-meanwhile", f"it was withdrawn or replaced by {one.withdrawn_by} already")
        await connection.execute(_WITHDRAW, {"submission": submission, "id": id, "who": who})
        told = {"action": "override withdrawn", "check": one.check, "before": one.points, "after": None, "reason": one.reason}
        await _tell(connection, submission, before, who, told)
    return True


def _judge(before: Row[Any], outcome: Row[Any] | None, check: str | None, points: int, reason: str) -> None:
    if before.max_score is None:
        raise OverrideRejected("not-ready", "there is no report yet: points can be given once it is graded")
    if check is not None and outcome is None:
        raise OverrideRejected("invalid-request", f"the report has no check {check[:80]} that counts")
    most = before.max_score if check is None else 1
    if not 0 <= points <= most:
        raise OverrideRejected("invalid-request", f"points are 0 to {most}")
    if not 0 < len(reason) <= LONGEST_REASON:
        raise OverrideRejected("invalid-request", f"give a reason of at most {LONGEST_REASON} characters: the student reads it")


async def _locked(connection: AsyncConnection, submission: UUID) -> Row[Any]:
    """What is shown for the submission, whose points nobody else changes in this transaction."""
    await connection.execute(_LOCK, {"id": submission})
    return (await connection.execute(_SHOWN, {"id": submission})).one()


async def _tell(connection: AsyncConnection, submission: UUID, before: Row[Any], who: str, told: dict[str, Any]) -> None:
    after = (await connection.execute(_SHOWN, {"id": submission})).one()
    action = told.pop("action")
    detail = {"person": before.person, **told, "points": [before.points, after.points]}
    await record_audit(connection, who, action, str(submission), detail)
    await runs.notify_in(connection, submission)


_ALL = """
SELECT id, check_id AS check, points, reason, given_by AS by, given_at AS at, withdrawn_by, withdrawn_at
FROM override WHERE submission_id = :id ORDER BY given_at, id
"""

_LOCK = text("SELECT 1 FROM submission WHERE id = :id FOR NO KEY UPDATE")

_SHOWN = text(f"""
SELECT p.name AS person, shown.grading, shown.score, shown.max_score, given.points
FROM submission s JOIN person p ON p.id = s.person_id JOIN {SHOWN} WHERE s.id = :id
""")

_OUTCOME = text("SELECT state FROM outcome WHERE grading_id = :grading AND check_id = CAST(:check AS text) AND counted")

_WITHDRAW = text("""
UPDATE override SET withdrawn_by = :who, withdrawn_at = clock_timestamp()
WHERE id = :id AND submission_id = :submission AND withdrawn_at IS NULL
""")
