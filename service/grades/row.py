"""A student's grade for an assignment: the one thing that every form of export is made of."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime


@dataclass(frozen=True, kw_only=True)
class Row:
    """One student and one assignment, with the best of their submissions: most points, of equals the newest.

    ``points`` are the ``score`` unless somebody gave others; None while nothing is graded. ``max_points`` is what the assignment
    has, the same for everybody; ``counted`` is how many checks count in that submission's report, fewer if it left exercises out.
    ``status`` is "none" for a student who sent nothing, else that of the submission. ``checks`` has states as measured and
    ``given`` the points (1 or 0) given for a check instead.
    """

    assignment: str
    title: str
    max_points: int
    student: str
    due_at: datetime | None = None
    full_name: str = ""
    email: str = ""
    student_id: str = ""
    status: str = "none"
    attempts: int = 0
    submission: str | None = None
    submitted_at: datetime | None = None
    late: bool | None = None
    graded_at: datetime | None = None
    score: int | None = None
    points: int | None = None
    counted: int | None = None
    overridden: bool = False
    grader: str = ""
    checks: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, int] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """What the student is called: the full name, or else the name they are known by here."""
        return self.full_name or self.student

    @property
    def percent(self) -> float | None:
        """Of the assignment's points; above 100 with checks of functions that could have been left out."""
        return None if self.points is None or not self.max_points else round(100 * self.points / self.max_points, 2)

    def state(self, check: str) -> str | None:
        """The state of a check, with what was given for it instead; None where it is not in the report."""
        if check not in self.checks or check not in self.given:
            return self.checks.get(check)
        return "pass" if self.given[check] else "fail"


def moment(at: datetime | None) -> str | None:
    """A moment as ISO 8601 in UTC, to the second."""
    return None if at is None else at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
