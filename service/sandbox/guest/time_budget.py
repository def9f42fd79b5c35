"""The time that a scene or the cells may use, and actions that end when it is spent."""

import signal
from collections.abc import Callable
from time import monotonic, process_time
from typing import Any

import numpy as np

from . import wire
from .wire import CLOCK_FACTOR

REPEAT_S = 0.2  # interval of the alarm once a budget may be spent


class OutOfTime(BaseException):
    """The budget of a scene is spent. Not an Exception, so that a broad ``except`` in a submission does not
    swallow it.
    """


class Budget:
    """A budget that starts now: ``seconds`` of CPU time and CLOCK_FACTOR times as many of wall-clock time."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._cpu, self._clock = process_time() + seconds, monotonic() + CLOCK_FACTOR * seconds

    def left(self) -> float:
        """Return the seconds left, of CPU time or of wall-clock time, whichever is less."""
        return max(0.0, min(self._cpu - process_time(), self._clock - monotonic()))

    def sentence(self) -> str:
        """Return a sentence that names the exceeded limit."""
        if process_time() >= self._cpu:
            return f"your code used more than {self.seconds:g} s of CPU time"
        return (
            f"your code did not finish within {CLOCK_FACTOR * self.seconds:g} s (of which it may compute"
            f" {self.seconds:g} s)"
        )


def limited(action: Callable[[], None], budget: Budget) -> BaseException | None:
    """Run ``action`` within ``budget`` and return what it raised, OutOfTime if the budget is spent."""

    def check_budget(signum: int, frame: Any) -> None:
        if not budget.left() and not wire.writing:  # else the next alarm ends the action
            raise OutOfTime

    signal.signal(signal.SIGALRM, check_budget)
    signal.setitimer(signal.ITIMER_REAL, max(0.01, budget.left()), REPEAT_S)
    try:
        try:
            with np.errstate(all="ignore"):
                action()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    except BaseException as error:
        return error
    return None
