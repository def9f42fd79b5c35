"""Class statistics: results and margins by check, common diagnoses, submissions per student.

Every student counts once, with their counted submission.
"""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from statistics import median

from markupsafe import Markup

from ecp.checks import Check
from exercises.assignment import Assignment
from service.grading import result
from service.store.course.gradebook import Cell, StudentRow
from service.store.database import Row

SMALL_MARGIN = 3.0  # a passed check with a smaller margin suggests that the tolerance is too tight
DECADES = range(-4, 13)  # bins of log10(margin); the first and last bins include everything beyond
EMPTY = "<td></td>"
CELLS = {
    (state, overridden): f'<td class="{state}">{mark}{"*" if overridden else ""}</td>'
    for state, mark in result.MARKS.items()
    for overridden in (False, True)
}


@dataclass(frozen=True)
class CheckStats:
    """Results of one check over the class.

    ``margins`` are the positive measured ones; ``bins`` counts them by decade. ``exact`` is the number of students who passed
    without a measured deviation.
    """

    check: Check
    exercise: str
    hidden: bool
    states: Counter[str]
    causes: Counter[str]
    margins: Sequence[float]
    exact: int
    smallest_margin: float | None
    bins: Sequence[int]

    @property
    def count(self) -> int:
        """The number of students that the check was made for."""
        return self.states.total()

    @property
    def rate(self) -> float | None:
        """The fraction of these students who passed."""
        return self.states["pass"] / self.count if self.count else None

    @property
    def small(self) -> bool:
        """Whether a student passed so narrowly that the tolerance may be too tight."""
        return self.smallest_margin is not None and self.smallest_margin < SMALL_MARGIN

    @property
    def median_margin(self) -> float | None:
        """The median of the margins, infinite without a deviation; None where no ✓ of the check has a margin."""
        if not self.margins or (self.exact and self.smallest_margin is None):
            return None
        return median([*self.margins, *[math.inf] * self.exact])


@dataclass
class DiagnosisStats:
    """A diagnosis with the number of students that got it and the checks it explains."""

    code: str
    sentence: str
    students: int = 0
    checks: set[str] = field(default_factory=set)


def by_check(assignment: Assignment, students: Sequence[StudentRow]) -> list[CheckStats]:
    """Return the statistics of every check, in the assignment's order."""
    found = [(e.number, c) for e in assignment.exercises for c in e.checks]
    return [_check(check, number, assignment.hidden(check), _cells(students, check.id)) for number, check in found]


def by_cause(students: Iterable[StudentRow]) -> list[DiagnosisStats]:
    """Return the diagnoses, most common first. A student counts once for each."""
    found: dict[tuple[str, str], DiagnosisStats] = {}
    for student in students:
        checks_by_cause: dict[tuple[str, str], set[str]] = {}
        for id, cell in student.cells.items():
            for cause in cell.causes if cell.shown != "pass" else ():
                checks_by_cause.setdefault(cause, set()).add(id)
        for cause, checks in checks_by_cause.items():
            stats = found.setdefault(cause, DiagnosisStats(*cause))
            stats.students += 1
            stats.checks |= checks
    return sorted(found.values(), key=lambda stats: (-stats.students, stats.code, stats.sentence))


def submission_counts(students: Iterable[StudentRow]) -> list[tuple[int, int]]:
    """Return pairs (number of submissions, number of students with so many)."""
    return sorted(Counter(s.submissions for s in students).items())


@dataclass(frozen=True)
class Activity:
    """When a student last submitted, and whether two or more graded submissions brought no points beyond the first."""

    last_at: datetime
    no_gain: bool


def activity(sent: Iterable[Row], most: int) -> dict[str, Activity]:
    """Return by login name the activity of all who submitted: ``sent`` has their submissions, oldest first, of ``most`` points."""
    points: dict[str, list[float]] = {}
    last: dict[str, datetime] = {}
    for one in sent:
        last[one.name] = one.submitted_at
        if one.points is not None:
            points.setdefault(one.name, []).append(one.points)
    return {name: Activity(at, len(got := points.get(name, [])) > 1 and max(got) <= got[0] < most) for name, at in last.items()}


def equal_names(students: Iterable[StudentRow]) -> set[str]:
    """Return the names that several students are shown by."""
    return {name for name, count in Counter(s.display_name for s in students).items() if count > 1}


def row(student: StudentRow, ids: Iterable[str]) -> Markup:
    """Return a student's table cells as HTML.

    A template would be too slow for tens of thousands of cells.
    """
    return Markup("".join([_cell(student.cells.get(id)) for id in ids]))  # noqa: S704 - all cells are of CELLS


def _cell(cell: Cell | None) -> str:
    return EMPTY if cell is None or not cell.counted else CELLS[cell.shown, cell.given is not None]


def passed(students: Sequence[StudentRow], ids: Iterable[str]) -> list[tuple[int, int]]:
    """Return for each check the numbers of students who passed, and of those it was made for."""
    found = [[c.shown == "pass" for s in students if (c := s.cells.get(id)) is not None and c.counted] for id in ids]
    return [(sum(one), len(one)) for one in found]


def _cells(students: Iterable[StudentRow], id: str) -> list[Cell]:
    return [cell for s in students if (cell := s.cells.get(id)) is not None and cell.counted]


def _check(check: Check, exercise: str, hidden: bool, cells: Sequence[Cell]) -> CheckStats:
    margins = [c.margin for c in cells if c.margin is not None and c.margin > 0]
    exact = sum(c.state == "pass" and c.margin is None for c in cells)
    passed = [c.margin for c in cells if c.margin is not None and c.state == "pass"]
    causes = Counter(sentence for c in cells if c.shown != "pass" for _, sentence in c.causes[:1])
    bins = Counter(min(max(math.floor(math.log10(m)), DECADES[0]), DECADES[-1]) for m in margins)
    states, counts = Counter(c.shown for c in cells), [bins[decade] for decade in DECADES]
    return CheckStats(check, exercise, hidden, states, causes, margins, exact, min(passed, default=None), counts)
