"""Class statistics: results and margins by check, submissions per student, activity.

Every student counts once, with their counted submission.
"""

import math
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.checks import Check
from service.grading import graded_file
from service.store.course.gradebook import StudentRow
from service.store.database import Row

SMALL_MARGIN = 3.0  # a passed check with a smaller margin suggests that the tolerance is too tight
DECADES = range(-4, 13)  # bins of log10(margin); the first and last bins include everything beyond
EMPTY = "<td></td>"
STATES = [*graded_file.MARKS]
STARS = ("", "*")  # of an override


def _cell(state: str, text: str) -> str:
    """Return a table cell; what its mark does not tell is its title."""
    title = f' title="{graded_file.WORDS[state]}"' if state not in ("pass", "fail") else ""
    return f'<td class="{state}"{title}>{text}</td>'


CELLS = {
    state + star: _cell(state, mark + star) for state, mark in graded_file.MARKS.items() for star in STARS
}


@dataclass(frozen=True)
class CheckStats:
    """Results of one check over the class.

    ``margins`` are the positive measured ones; ``bins`` counts them by decade. ``exact`` is the number of
    students who passed without a measured deviation.
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
        """The median of the margins, infinite without a deviation;
        None where no ✓ of the check has a margin.
        """
        if not self.margins or (self.exact and self.smallest_margin is None):
            return None
        return median([*self.margins, *[math.inf] * self.exact])


def by_check(assignment: Assignment, outcomes: Mapping[str, Row]) -> list[CheckStats]:
    """Return the statistics of every check, in the assignment's order, from ``outcomes.by_check``."""
    found = [(e.number, c) for e in assignment.exercises for c in e.checks]
    return [
        _check(check, number, assignment.hidden(check), outcomes.get(check.id)) for number, check in found
    ]


def submission_counts(students: Iterable[StudentRow]) -> list[tuple[int, int]]:
    """Return pairs (number of submissions, number of students with so many)."""
    return sorted(Counter(s.submissions for s in students).items())


def has_no_gain(student: StudentRow, most: int) -> bool:
    """Return whether two or more graded submissions brought the student no points of ``most`` beyond the
    first of them.
    """
    earned = [points for points in student.earned if points is not None]
    return len(earned) > 1 and max(earned) <= earned[0] < most


def equal_names(students: Iterable[StudentRow]) -> set[str]:
    """Return the names that several students are shown by."""
    return {name for name, count in Counter(s.display_name for s in students).items() if count > 1}


def cells(outcomes: Mapping[str, str], ids: Iterable[str]) -> list[str]:
    """Return a student's table cells as HTML; ``outcomes`` has the state by check id, with "*" if it is an
    override's.

    A template would be too slow for tens of thousands of cells.
    """
    return [CELLS[outcomes[id]] if id in outcomes else EMPTY for id in ids]


def exercise_cells(outcomes: Mapping[str, str], exercises: Iterable[Sequence[str]]) -> list[str]:
    """Return a student's table cells with one per exercise, given by its check ids.

    A cell has ✓ if all checks passed, else how many of those that were made; its colour is that of the first
    state other than passed.
    """
    return [_exercise_cell([outcomes[id] for id in ids if id in outcomes]) for ids in exercises]


def _exercise_cell(shown: Sequence[str]) -> str:
    if not shown:
        return EMPTY
    right, distinct = shown.count("pass") + shown.count("pass*"), set(shown)
    star = "*" if any(one.endswith("*") for one in distinct) else ""
    if right == len(shown):
        return CELLS[f"pass{star}"]
    worst = next(state for state in STATES[1:] if not distinct.isdisjoint((state, f"{state}*")))
    return _cell(worst, f"{right}/{len(shown)}{star}")


def passed(column: Sequence[str]) -> tuple[int, int]:
    """Return the numbers of students who passed what these cells show, and of those it was made for."""
    return column.count(CELLS["pass"]) + column.count(CELLS["pass*"]), len(column) - column.count(EMPTY)


def _check(check: Check, exercise: str, hidden: bool, outcomes: Row | None) -> CheckStats:
    if outcomes is None:
        return CheckStats(check, exercise, hidden, Counter(), Counter(), [], 0, None, [0] * len(DECADES))
    margins = sorted(outcomes.margins or [])
    edges = [0, *(bisect_left(margins, 10.0**decade) for decade in DECADES[1:]), len(margins)]
    bins = [end - start for start, end in pairwise(edges)]
    states, causes = Counter(outcomes.states.split()), Counter(outcomes.causes or [])
    return CheckStats(
        check, exercise, hidden, states, causes, margins, outcomes.exact, outcomes.smallest, bins
    )
