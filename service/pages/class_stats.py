"""A class in numbers: how each check went, what went wrong most often, how wide the margins are, how often people try.

Every student counts once, with the submission that counts for them.
"""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from statistics import median

from markupsafe import Markup

from ecp.checks import Check
from exercises.assignment import Assignment
from service.grading import result
from service.store.course.gradebook import Cell, StudentRow

THIN = 3.0  # a right submission this close to what is allowed says that the tolerance is too tight
DECADES = range(-4, 13)  # of margins told apart; what lies beyond is told with the last
EMPTY = Markup("<td></td>")
CELLS = {
    (state, given): Markup('<td class="{}">{}{}</td>').format(state, mark, "*" if given else "")
    for state, mark in result.MARKS.items()
    for given in (False, True)
}


@dataclass(frozen=True)
class CheckStats:
    """One check over the class. ``margins`` are those of whom it was measured for; ``bins`` counts them by decade."""

    check: Check
    exercise: str
    hidden: bool
    states: Counter[str]
    causes: Counter[str]
    margins: Sequence[float]
    thinnest: float | None
    bins: Sequence[int]

    @property
    def made(self) -> int:
        """For how many students it was made."""
        return self.states.total()

    @property
    def rate(self) -> float | None:
        """The share of those for whom it passed."""
        return self.states["pass"] / self.made if self.made else None

    @property
    def thin(self) -> bool:
        """Whether somebody passed so barely that the tolerance may be too tight."""
        return self.thinnest is not None and self.thinnest < THIN

    @property
    def middle(self) -> float | None:
        """The median of the margins."""
        return median(self.margins) if self.margins else None


@dataclass
class DiagnosisStats:
    """A named cause of what went wrong, with the students it was told to and the checks it was told at."""

    code: str
    sentence: str
    students: int = 0
    checks: set[str] = field(default_factory=set)


def by_check(assignment: Assignment, class_: Sequence[StudentRow]) -> list[CheckStats]:
    """Every check of the assignment in order."""
    found = [(e.number, c) for e in assignment.exercises for c in e.checks]
    return [_check(check, number, assignment.hidden(check), _cells(class_, check.id)) for number, check in found]


def by_cause(class_: Iterable[StudentRow]) -> list[DiagnosisStats]:
    """The causes told, those of most students first; a student counts once for each."""
    found: dict[tuple[str, str], DiagnosisStats] = {}
    for standing in class_:
        told: dict[tuple[str, str], set[str]] = {}
        for id, cell in standing.cells.items():
            for cause in cell.causes if cell.shown != "pass" else ():
                told.setdefault(cause, set()).add(id)
        for cause, checks in told.items():
            tally = found.setdefault(cause, DiagnosisStats(*cause))
            tally.students += 1
            tally.checks |= checks
    return sorted(found.values(), key=lambda tally: (-tally.students, tally.code, tally.sentence))


def by_attempts(class_: Iterable[StudentRow]) -> list[tuple[int, int]]:
    """Number of submissions, and how many students sent so many."""
    return sorted(Counter(s.submissions for s in class_).items())


def row(standing: StudentRow, ids: Iterable[str]) -> Markup:
    """A student's cells of the class's table. Made here because there are tens of thousands of them."""
    return Markup("").join(_cell(standing.cells.get(id)) for id in ids)


def _cell(cell: Cell | None) -> Markup:
    return EMPTY if cell is None or not cell.counted else CELLS[cell.shown, cell.given is not None]


def _cells(class_: Iterable[StudentRow], id: str) -> list[Cell]:
    return [cell for s in class_ if (cell := s.cells.get(id)) is not None and cell.counted]


def _check(check: Check, exercise: str, hidden: bool, cells: Sequence[Cell]) -> CheckStats:
    margins = [c.margin for c in cells if c.margin is not None and c.margin > 0]
    passed = [c.margin for c in cells if c.margin is not None and c.state == "pass"]
    causes = Counter(sentence for c in cells if c.shown != "pass" for _, sentence in c.causes[:1])
    bins = Counter(min(max(math.floor(math.log10(m)), DECADES[0]), DECADES[-1]) for m in margins)
    states, counts = Counter(c.shown for c in cells), [bins[decade] for decade in DECADES]
    return CheckStats(check, exercise, hidden, states, causes, margins, min(passed, default=None), counts)
