"""What a worker knows of the usual times of gradings, and from when on it takes one for slow."""

import time
from collections import defaultdict
from collections.abc import Callable
from statistics import median
from uuid import UUID

SLOW_S, TIMES = 3.0, 10  # a grading is slow after both, in seconds and in medians of its assignment
KEPT, ENOUGH = 50, 5  # persons of an assignment, and how many say what is usual


class Stopwatch:
    """The seconds from now on without those by which ``waited_s`` grows, of waiting for a processor."""

    def __init__(self, waited_s: Callable[[], float]) -> None:
        self._waited_s = waited_s
        self._began, self._before = time.monotonic(), waited_s()

    def seconds(self) -> float:
        """Return the seconds until now."""
        return max(0.0, time.monotonic() - self._began - (self._waited_s() - self._before))


class Pace:
    """The times of this worker's last gradings of each assignment, in seconds: one for each person, so that
    nobody alone makes long times usual.
    """

    def __init__(self) -> None:
        self._seconds: defaultdict[str, dict[UUID, float]] = defaultdict(dict)

    def note(self, assignment: str, person: UUID, seconds: float) -> None:
        """Record that a grading of the assignment took ``seconds``, or at least so long."""
        known = self._seconds[assignment]
        known.pop(person, None)
        known[person] = seconds
        if len(known) > KEPT:
            del known[next(iter(known))]

    def slow_after(self, assignment: str) -> float:
        """Return the seconds after which a grading of the assignment is slow.

        An assignment whose every grading takes long soon has no slow ones.
        """
        known = self._seconds[assignment].values()
        return SLOW_S if len(known) < ENOUGH else max(SLOW_S, TIMES * median(known))
