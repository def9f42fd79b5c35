"""Which walls: the strongest tier that can be put up here, found by doing it, and never less than was asked for."""

import platform
import subprocess
from collections.abc import Collection

from service.sandbox.bubblewrap import find_bubblewrap, tier_a
from service.sandbox.guest import landlock
from service.sandbox.guest.syscalls import MACHINES
from service.sandbox.isolation import Walls, tier_b

TRY_S = 20.0


class WallsMissing(Exception):
    """No walls of the least tier asked for can be put up here; the message says what to do."""


def choose(least: str = "B") -> Walls:
    """Tier A if its namespaces can be had, else tier B if that is enough; WallsMissing where neither is to be had."""
    if platform.machine() not in MACHINES:
        raise WallsMissing(f"no filter of system calls for this processor ({platform.machine()}); known: {', '.join(MACHINES)}")
    if landlock.version() < 1:
        raise WallsMissing("this kernel has no Landlock (it is in Linux 5.13 and later, if the boot option lsm= names it)")
    walls, reason = try_namespaces()
    if walls is not None:
        return walls
    if least == "A":
        raise WallsMissing(f"POLHODE_MIN_TIER is A, and there are no namespaces here: {reason}")
    return tier_b()


def with_packages(walls: Walls, more: Collection[str]) -> Walls:
    """The same walls around a guest that can also import ``more`` distributions, as far as they are installed."""
    if not more:
        return walls
    return tier_a(walls.around[0], walls.layers, more) if walls.tier == "A" else tier_b(walls.layers, more)


def try_namespaces() -> tuple[Walls | None, str]:
    """Tier A if a first process could be started in it, else None and why."""
    program = find_bubblewrap()
    if program is None:
        return None, "bubblewrap is not installed (apt install bubblewrap)"
    walls = tier_a(program)
    try:
        told = subprocess.run(
            [*walls.around, walls.inside[0], "-I", "-S", "-c", "pass"],
            capture_output=True, text=True, timeout=TRY_S, check=False, env=dict(walls.environment),
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)
    return (walls, "") if told.returncode == 0 else (None, told.stderr.strip() or f"bwrap ended with {told.returncode}")
