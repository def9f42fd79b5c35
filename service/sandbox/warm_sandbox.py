"""The sandbox of a worker: besides a guest with all libraries it has small guests,
whose children cost less.
"""

from collections import deque

from service.sandbox.isolation import Isolation
from service.sandbox.job import Cell, Job
from service.sandbox.result import OnScene, PlayResult, ignore
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import DEFAULT_LIMITS, TimeBudget, TimeLimits
from service.sandbox.zygote import LibraryNeeded

SMALL_GUESTS = 2  # so that one plays while the last child of the other exits


class WarmSandbox(Sandbox):
    """A sandbox with two small guests without SciPy and matplotlib besides the one that has them.

    Successive plays alternate between the small guests. A child of a small guest copies and frees a quarter
    of the memory. The guest with the libraries plays submissions that
    use one, and scenes that draw.
    """

    def __init__(self, isolation: Isolation, limits: TimeLimits = DEFAULT_LIMITS) -> None:
        super().__init__(isolation, limits)
        self._guests = [Sandbox(isolation, limits, small=True) for _ in range(SMALL_GUESTS)]
        self.keeps = True
        for guest in self._guests:
            guest.cancelled, guest.keeps = self.cancelled, True
        self._with_library = deque[tuple[Cell, ...]](maxlen=8)  # cells of the last plays that used one

    @property
    def replaced(self) -> int:
        """The number of guests that have been replaced."""
        return super().replaced + sum(guest.replaced for guest in self._guests)

    def self_test(self) -> None:
        """Run the self-test in each guest. All of them import the libraries meanwhile."""
        self.start()
        for guest in self._guests:
            guest.start()
        for guest in self._guests:
            guest.self_test()
        super().self_test()
        self.fork_next_child()

    def play(self, job: Job, on_scene: OnScene = ignore, budget: TimeBudget | None = None) -> PlayResult:
        """Play every scene of ``job`` in the next small guest, or in the one with the libraries. See
        ``Sandbox.play``.
        """
        budget = budget or TimeBudget(self.limits)
        if self._is_small(job):
            guest = self._guests.pop(0)
            self._guests.append(guest)
            try:
                return guest.play(job, on_scene, budget)
            except LibraryNeeded:
                self._with_library.append(job.cells)
        return super().play(job, on_scene, budget)

    def start_child(self, job: Job, budget: TimeBudget) -> None:
        """Start the child that plays ``job`` next in the guest whose turn it is.
        See ``Sandbox.start_child``.
        """
        if self._is_small(job):
            self._guests[0].start_child(job, budget)
        else:
            super().start_child(job, budget)

    def end_unused_child(self) -> None:
        """End children that were started and have no job."""
        for guest in self._guests:
            guest.end_unused_child()
        super().end_unused_child()

    def fork_next_child(self) -> None:
        """Let every guest fork its next child in advance. See ``Sandbox.fork_next_child``."""
        for guest in self._guests:
            guest.fork_next_child()
        super().fork_next_child()

    def _is_small(self, job: Job) -> bool:
        """Return whether a small guest is tried for a job: it does not draw, and its cells are not known to
        use a library.
        """
        draws = any(spec.dtype == "uint8" for scene in job.scenes for spec in scene.returns.values())
        return not draws and job.cells not in self._with_library and self.self_tested

    def close(self) -> None:
        """End all guests."""
        for guest in self._guests:
            guest.close()
        super().close()
