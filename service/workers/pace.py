"""What a worker knows of the usual times of gradings, and from when on it takes one for slow."""

from collections import defaultdict, deque
from statistics import median

SLOW_S, TIMES = 3.0, 10  # a grading is slow after both, in seconds and in medians of its assignment
KEPT, ENOUGH = 50, 5  # times of an assignment, and how many say what is usual


class Pace:
    """The times of this worker's last gradings of each assignment, in seconds."""

    def __init__(self) -> None:
        self._seconds: defaultdict[str, deque[float]] = defaultdict(lambda: deque(maxlen=KEPT))

    def note(self, assignment: str, seconds: float) -> None:
        """Record that a grading of the assignment took ``seconds``, or at least so long."""
        self._seconds[assignment].append(seconds)

    def slow_after(self, assignment: str) -> float:
        """Return the seconds after which a grading of the assignment is slow.

        An assignment whose every grading takes long soon has no slow ones.
        """
        known = self._seconds[assignment]
        return SLOW_S if len(known) < ENOUGH else max(SLOW_S, TIMES * median(known))
