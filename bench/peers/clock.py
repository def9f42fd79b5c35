"""Wall and CPU time of commands, including all processes that they start."""

import contextlib
import os
import resource
import select
import signal
import statistics
import subprocess
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bench.peers.peer import Command, Workspace

LIMIT_S = 300.0
LOOK_S = 0.05


class Timing(NamedTuple):
    """A wall time and a CPU time, in seconds."""

    wall: float
    cpu: float


class CommandFailed(Exception):
    """A command failed or timed out."""


@dataclass(frozen=True)
class Row:
    """One line of the table of times: tool, task, number of submissions, and all measured times."""

    name: str
    what: str
    count: int
    taken: Sequence[Timing]

    @property
    def median(self) -> Timing:
        """Return the medians of wall and CPU time, each on its own."""
        return Timing(
            statistics.median(t.wall for t in self.taken), statistics.median(t.cpu for t in self.taken)
        )

    @property
    def each(self) -> float:
        """Return the median wall seconds per submission."""
        return self.median.wall / self.count


def clock(commands: Iterable[Command], workspace: Workspace, *, codes: Sequence[int] = (0,)) -> Timing:
    """Run the commands in turn and return the time. Raises CommandFailed for an exit code not in
    ``codes``.
    """
    began = time.perf_counter()
    cpu = sum(_run(command, workspace, codes) for command in commands)
    return Timing(time.perf_counter() - began, cpu)


def spent(pid: int) -> float:
    """Return the CPU seconds of a process, its descendants, and the children that they have waited for."""
    ticks, todo = 0, [pid]
    while todo:
        folder = Path(f"/proc/{todo.pop()}")
        with contextlib.suppress(OSError):  # the process has ended
            ticks += sum(map(int, (folder / "stat").read_text().rsplit(")", 1)[1].split()[11:15]))
            todo += [
                int(child) for file in folder.glob("task/*/children") for child in file.read_text().split()
            ]
    return ticks / os.sysconf("SC_CLK_TCK")


def _run(command: Command, workspace: Workspace, codes: Sequence[int]) -> float:
    """Return the CPU seconds that the kernel reports at the end, or those last seen if that is more.

    The kernel does not report processes killed together with their process namespace, such as polhode's
    guests.
    """
    log, before = workspace.folder / "log", resource.getrusage(resource.RUSAGE_CHILDREN)
    with log.open("w") as printed, (command.out or log).open("w") as out:
        words, where = list(map(str, command.words)), {"cwd": command.folder, "env": workspace.environment}
        process = subprocess.Popen(
            words,
            **where,
            stdin=subprocess.DEVNULL,
            stdout=out if command.out else printed,
            stderr=printed,
            start_new_session=True,
        )
    seen = _watch(process)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if codes and process.returncode not in codes:
        raise CommandFailed(
            f"ended with {process.returncode}: {' '.join(log.read_text(errors='replace').splitlines()[-3:])}"
        )
    return max(seen, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def _watch(process: "subprocess.Popen[bytes]") -> float:
    """Wait for the process and return the most CPU seconds seen. Kill it after LIMIT_S,
    or on an interrupt.
    """
    handle, most, until = os.pidfd_open(process.pid), 0.0, time.monotonic() + LIMIT_S
    try:
        while not select.select([handle], [], [], LOOK_S)[0]:
            most = max(most, spent(process.pid))
            if time.monotonic() > until:
                raise CommandFailed(f"did not end within {LIMIT_S:g} s")
        return most
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(handle)
