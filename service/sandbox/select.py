"""Which walls: the strongest tier that can be put up here, found by doing it, and never less than was asked for."""

import platform
import subprocess
from collections.abc import Collection

from service.sandbox.bubblewrap import find_bubblewrap, namespace_isolation
from service.sandbox.guest import landlock
from service.sandbox.guest.syscalls import MACHINES
from service.sandbox.isolation import Isolation, process_isolation

TRY_S = 20.0


class IsolationUnavailable(Exception):
    """No walls of the least tier asked for can be put up here; the message says what to do."""


def choose(least: str = "B") -> Isolation:
    """Tier A if its namespaces can be had, else tier B if that is enough; WallsMissing where neither is to be had."""
    if platform.machine() not in MACHINES:
        raise IsolationUnavailable(
            f"no filter of system calls for this processor ({platform.machine()}); known: {', '.join(MACHINES)}"
        )
    if landlock.version() < 1:
        raise IsolationUnavailable("this kernel has no Landlock (it is in Linux 5.13 and later, if the boot option lsm= names it)")
    walls, reason = try_namespaces()
    if walls is not None:
        return walls
    if least == "A":
        raise IsolationUnavailable(f"POLHODE_MIN_TIER is A, and there are no namespaces here: {reason}")
    return process_isolation()


def with_packages(walls: Isolation, more: Collection[str]) -> Isolation:
    """The same walls around a guest that can also import ``more`` distributions, as far as they are installed."""
    if not more:
        return walls
    return namespace_isolation(walls.around[0], walls.layers, more) if walls.tier == "A" else process_isolation(walls.layers, more)


def try_namespaces() -> tuple[Isolation | None, str]:
    """Tier A if a first process could be started in it, else None and why."""
    program = find_bubblewrap()
    if program is None:
        return None, "bubblewrap is not installed (apt install bubblewrap)"
    walls = namespace_isolation(program)
    try:
        told = subprocess.run(
            [*walls.around, walls.inside[0], "-I", "-S", "-c", "pass"],
            capture_output=True, text=True, timeout=TRY_S, check=False, env=dict(walls.environment),
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)
    return (walls, "") if told.returncode == 0 else (None, told.stderr.strip() or f"bwrap ended with {told.returncode}")
