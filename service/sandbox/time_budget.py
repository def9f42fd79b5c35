"""The time that all processes of one grading may use together in the sandbox, and whether they had a
processor meanwhile.
"""

import contextlib
import re
import threading
import time
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
    """The budget of one grading, which starts now. Each process in the sandbox is charged to it when it ends.

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

    def extend(self, wall_s: float) -> None:
        """Add elapsed time that the submission has not used."""
        with self._lock:
            self._until += wall_s

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


class ProcessorWait:
    """The time, from now on, that processes, given by their ``pidfds``, were ready to run and had no
    processor, see ``processor_wait``.
    """

    def __init__(self, *pidfds: int) -> None:
        self._seconds: dict[int, float] = {}
        for pidfd in pidfds:
            if found := re.search(
                r"^Pid:\s*(\d+)$", Path(f"/proc/self/fdinfo/{pidfd}").read_text(), re.MULTILINE
            ):
                self._seconds[int(found[1])] = processor_wait(int(found[1]))
        self._before = sum(self._seconds.values())

    @property
    def seconds(self) -> float:
        """The time of all processes together at the last update."""
        return sum(self._seconds.values()) - self._before

    def update(self) -> None:
        """Read the time. That of a process stays as it was once it has been reaped."""
        for pid, seconds in self._seconds.items():
            self._seconds[pid] = max(seconds, processor_wait(pid))


def processor_wait(pid: int) -> float:
    """Return the seconds that a process was ready to run and had no processor.

    Source: the second number of /proc/PID/schedstat (Linux, Documentation/scheduler/sched-stats.rst). Zero
    where the kernel does not report it, or the process has ended: then a process without a processor looks
    like one that sleeps.
    """
    with contextlib.suppress(OSError, ValueError, IndexError):
        return int(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9
    return 0.0
