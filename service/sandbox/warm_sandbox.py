"""The sandbox of a worker: besides a guest with all libraries, it has small guests, whose children cost less."""

from collections.abc import Callable

from service.sandbox.isolation import Isolation
from service.sandbox.job import Cell, Job
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import DEFAULT_LIMITS, TimeBudget, TimeLimits
from service.sandbox.zygote import LibraryNeeded

SMALL = 2  # a play does not wait until the child of the one before has exited


class WarmSandbox(Sandbox):
    """A sandbox with SMALL more guests without SciPy and matplotlib, a quarter of the memory to copy and to free for each child.

    They play in turn. A submission that uses one of these libraries, or draws, is played by the guest that has them.
    """

    def __init__(self, isolation: Isolation, limits: TimeLimits = DEFAULT_LIMITS) -> None:
        super().__init__(isolation, limits)
        self._small = [Sandbox(isolation, limits, small=True) for _ in range(SMALL)]
        for sandbox in self._small:
            sandbox.cancelled = self.cancelled
        self._needing: tuple[Cell, ...] = ()  # the cells of the last submission that used a library

    @property
    def replaced(self) -> int:
        return super().replaced + sum(sandbox.replaced for sandbox in self._small)

    def self_test(self) -> None:
        for sandbox in (*self._small, super()):
            sandbox.start()
        for sandbox in (*self._small, super()):
            sandbox.self_test()

    def play(self, job: Job, on_scene: Callable[[str], None] = lambda scene: None, budget: TimeBudget | None = None) -> PlayResult:
        budget = budget or TimeBudget(self.limits)
        draws = any(spec.dtype == "uint8" for scene in job.scenes for spec in scene.returns.values())
        if not draws and job.cells != self._needing:
            small = self._small.pop(0)
            self._small.append(small)
            try:
                return small.play(job, on_scene, budget)
            except LibraryNeeded:
                self._needing = job.cells
        return super().play(job, on_scene, budget)

    def close(self) -> None:
        for sandbox in (*self._small, super()):
            sandbox.close()
