"""Whole processes by the wall's clock, and by the processor's including all that they start."""

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

from bench.peers.peer import Command, Place

LIMIT_S = 300.0
LOOK_S = 0.05


class Took(NamedTuple):
    """Seconds."""

    wall: float
    cpu: float


class Broke(Exception):
    """A command did not end as it should."""


@dataclass(frozen=True)
class Row:
    """One line of the table of times: who did what, for how many submissions, and every time it was measured."""

    name: str
    what: str
    count: int
    taken: Sequence[Took]

    @property
    def median(self) -> Took:
        """Of wall and CPU each by itself."""
        return Took(statistics.median(t.wall for t in self.taken), statistics.median(t.cpu for t in self.taken))

    @property
    def each(self) -> float:
        """Median wall seconds per submission."""
        return self.median.wall / self.count


def clock(commands: Iterable[Command], place: Place, *, codes: Sequence[int] = (0,)) -> Took:
    """Run them one after the other; raises Broke with the end of what was printed where one ends otherwise than by ``codes``."""
    began = time.perf_counter()
    cpu = sum(_run(command, place, codes) for command in commands)
    return Took(time.perf_counter() - began, cpu)


def spent(pid: int) -> float:
    """CPU seconds of a process and all below it, and of those that they have waited for."""
    ticks, todo = 0, [pid]
    while todo:
        folder = Path(f"/proc/{todo.pop()}")
        with contextlib.suppress(OSError):  # it has ended meanwhile
            ticks += sum(map(int, (folder / "stat").read_text().rsplit(")", 1)[1].split()[11:15]))
            todo += [int(child) for file in folder.glob("task/*/children") for child in file.read_text().split()]
    return ticks / os.sysconf("SC_CLK_TCK")


def _run(command: Command, place: Place, codes: Sequence[int]) -> float:
    """CPU seconds: as the kernel tells them at the end, or as last seen if that is more.

    It does not tell those of what is killed together with its process namespace, as polhode's guests are.
    """
    log, before = place.folder / "log", resource.getrusage(resource.RUSAGE_CHILDREN)
    with log.open("w") as told, (command.out or log).open("w") as out:
        words, where = list(map(str, command.words)), {"cwd": command.folder, "env": place.environment}
        process = subprocess.Popen(
            words, **where, stdin=subprocess.DEVNULL, stdout=out if command.out else told, stderr=told, start_new_session=True
        )
    seen = _watch(process)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if codes and process.returncode not in codes:
        raise Broke(f"ended with {process.returncode}: {' '.join(log.read_text(errors='replace').splitlines()[-3:])}")
    return max(seen, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def _watch(process: "subprocess.Popen[bytes]") -> float:
    """The most CPU seconds it was seen to have spent, when it has ended; it is killed after LIMIT_S, or if we are interrupted."""
    handle, most, until = os.pidfd_open(process.pid), 0.0, time.monotonic() + LIMIT_S
    try:
        while not select.select([handle], [], [], LOOK_S)[0]:
            most = max(most, spent(process.pid))
            if time.monotonic() > until:
                raise Broke(f"did not end within {LIMIT_S:g} s")
        return most
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(handle)
