"""What is read from the tables: a submission with what became of it, and a line of a list."""

import hashlib
import time
from dataclasses import dataclass, field
from datetime import datetime
from uuid import UUID

from ecp.report import Report
from service.grading.submission import Submission


@dataclass(frozen=True)
class New:
    """A submission about to be stored; ``arrived`` is when its request did, by this process's monotonic clock."""

    id: UUID
    assignment: str
    person: str
    submission: Submission
    exercises: list[str] | None
    seed: int
    arrived: float = field(default_factory=time.monotonic)

    @property
    def fingerprint(self) -> str:
        """What two requests must share to be the same submission."""
        parts = [self.assignment, self.submission.filename, self.submission.source, repr(self.exercises)]
        return hashlib.sha256("\x00".join(parts).encode()).hexdigest()


@dataclass(frozen=True)
class Stored:
    """A submission as accepted, with the result shown for it, if there is one: a report, or the fault that kept us from making it.

    ``attempt`` is the one shown: the last with a report, else the last one. ``status`` is queued, running, graded or faulted.
    ``cancelled_by`` tells who of the staff stopped it, ``points`` the score but for what an instructor gave instead.
    """

    id: UUID
    assignment: str
    person: str
    submission: Submission
    exercises: list[str] | None
    submitted_at: datetime
    late: bool
    attempt: UUID
    number: int
    seed: int
    report: Report | None
    fault: str | None
    status: str
    cancelled_by: str | None = None
    points: int | None = None
    full_name: str = ""

    @property
    def finished(self) -> bool:
        """Whether there is a result."""
        return self.status in ("graded", "faulted")


@dataclass(frozen=True)
class Listed:
    """A submission as a list shows it; ``score``, ``max_score``, ``points`` and ``total`` are None where there is no report.

    ``total`` is that of the report, or of the checks made where the report was stored without one.
    """

    id: UUID
    filename: str
    person: str
    submitted_at: datetime
    status: str
    score: int | None
    max_score: int | None
    points: int | None = None
    total: int | None = None
