"""The time that all processes of one grading may use together in the sandbox, and whether they had a
processor meanwhile.
"""

import contextlib
import re
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

WALL_PER_CPU = 2  # a grading's wall-clock limit, in units of its CPU limit


@dataclass(frozen=True)
class TimeLimits:
    """Limits of one grading, for all its processes in the sandbox together: seconds of CPU time and of
    wall-clock time.
    """

    cpu_s: float = 60.0
    wall_s: float = 120.0

    def at_least(self, cpu_s: float | None) -> "TimeLimits":
        """Return these limits, raised for an assignment that declares more CPU time."""
        return (
            self
            if cpu_s is None
            else TimeLimits(max(self.cpu_s, cpu_s), max(self.wall_s, WALL_PER_CPU * cpu_s))
        )


DEFAULT_LIMITS = TimeLimits()


class TimeBudget:
    """The budget of one grading, which starts now. Each process in the sandbox is charged to it when it ends,
    however it ends, and so is what the host does in proportion to the submission.

    ``waited_s`` of the ``running_s`` seconds that the processes existed, they were ready to run and had no
    processor.
    """

    def __init__(self, limits: TimeLimits) -> None:
        self.limits = limits
        self.cpu_s = self.waited_s = self.running_s = 0.0
        self._until = time.monotonic() + limits.wall_s
        self._lock = threading.Lock()

    def charge(self, cpu_s: float, waited_s: float, running_s: float) -> None:
        """Add the times of a process that has ended."""
        with self._lock:
            self.cpu_s += cpu_s
            self.waited_s += waited_s
            self.running_s += running_s

    @contextlib.contextmanager
    def charged(self) -> Iterator[None]:
        """Charge the CPU time that this thread uses in the ``with`` block."""
        began = time.thread_time()
        try:
            yield
        finally:
            self.charge(time.thread_time() - began, 0.0, 0.0)

    def cpu_left(self) -> float:
        """Return the seconds of CPU time that are left."""
        return max(0.0, self.limits.cpu_s - self.cpu_s)

    def wall_left(self) -> float:
        """Return the seconds of wall-clock time that are left."""
        return max(0.0, self._until - time.monotonic())

    def exceeded(self) -> str:
        """Return a sentence that names the exceeded limit, or ""."""
        if not self.cpu_left():
            return f"your submission used more than {self.limits.cpu_s:g} s of CPU time in all"
        return (
            ""
            if self.wall_left()
            else f"your submission did not finish within {self.limits.wall_s:g} s in all"
        )

    @property
    def delayed(self) -> bool:
        """Whether the wall-clock limit was reached with CPU time left, and waiting for a processor took a
        tenth of it or more.
        """
        return self.cpu_left() > 0 == self.wall_left() and self.waited_s > 0.1 * self.limits.wall_s

    @property
    def starved(self) -> bool:
        """Whether the processes waited for a processor during most of their time, as on an overloaded
        machine.
        """
        return self.waited_s > self.running_s / 2


class ProcessorTimes:
    """The times, from now on, of processes that are given by their ``pidfds``, as the kernel reports them
    while they run, see ``processor_times``.
    """

    def __init__(self, *pidfds: int) -> None:
        self._times: dict[int, tuple[float, float]] = {}
        for pidfd in pidfds:
            if found := re.search(
                r"^Pid:\s*(\d+)$", Path(f"/proc/self/fdinfo/{pidfd}").read_text(), re.MULTILINE
            ):
                self._times[int(found[1])] = processor_times(int(found[1]))
        self._before = self._sums()

    @property
    def cpu_s(self) -> float:
        """The CPU time of all processes together at the last update."""
        return self._sums()[0] - self._before[0]

    @property
    def waited_s(self) -> float:
        """The time that they were ready to run and had no processor, together at the last update."""
        return self._sums()[1] - self._before[1]

    def update(self) -> None:
        """Read the times. Those of a process stay as they were once it has been reaped."""
        for pid, before in self._times.items():
            self._times[pid] = max(before, processor_times(pid))

    def _sums(self) -> tuple[float, float]:
        return sum(cpu for cpu, _ in self._times.values()), sum(waited for _, waited in self._times.values())


def processor_times(pid: int) -> tuple[float, float]:
    """Return the seconds that a process has run, and those that it was ready to run and had no processor.

    Source: the first two numbers of /proc/PID/schedstat (Linux, Documentation/scheduler/sched-stats.rst).
    Zeros where the kernel does not report them, or the process has ended: then a process without a processor
    looks like one that sleeps.
    """
    with contextlib.suppress(OSError, ValueError):
        running, waiting, _ = Path(f"/proc/{pid}/schedstat").read_text().split()
        return int(running) / 1e9, int(waiting) / 1e9
    return 0.0, 0.0
