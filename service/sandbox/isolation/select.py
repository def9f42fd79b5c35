"""Selection of the isolation level: the strongest one that this machine supports, and never a weaker one than
required.
"""

import os
import platform
import subprocess
from collections.abc import Collection

from service.sandbox.guest.confinement import landlock
from service.sandbox.guest.confinement.syscalls import MACHINES
from service.sandbox.isolation.bubblewrap import find_bubblewrap, namespace_isolation
from service.sandbox.isolation.levels import CHANGE_USER, TRY_S, Isolation, Level, process_isolation


class IsolationUnavailable(Exception):
    """This machine does not support the required isolation level. The message says what is missing."""


def choose(least: Level = "process", allow_root: bool = False) -> Isolation:
    """Return the strongest isolation that this machine supports; its guest may stay root only with
    ``allow_root``.

    Raises IsolationUnavailable if the level is below ``least``.
    """
    if platform.machine() not in MACHINES:
        raise IsolationUnavailable(
            f"polhode has no system call filter for this processor ({platform.machine()}); supported:"
            f" {', '.join(MACHINES)}"
        )
    if landlock.version() < 1:
        raise IsolationUnavailable(
            "this kernel has no Landlock; use Linux 5.13 or later and name landlock in the boot option lsm="
        )
    isolation, reason = try_namespaces(allow_root)
    if isolation is not None:
        return isolation
    if least == "namespaces":
        raise IsolationUnavailable(
            f"POLHODE_MIN_ISOLATION is namespaces, but namespaces are not available: {reason}"
        )
    return process_isolation(allow_root=allow_root)


def with_packages(isolation: Isolation, more: Collection[str]) -> Isolation:
    """Return ``isolation`` for a guest that can also import those of the distributions ``more`` that are
    installed.
    """
    if not more:
        return isolation
    if isolation.level == "process":
        return process_isolation(isolation.layers, more, isolation.allow_root)
    return namespace_isolation(isolation.around[0], isolation.layers, more, isolation.allow_root)


def try_namespaces(allow_root: bool = False) -> tuple[Isolation | None, str]:
    """Start a process in namespaces. Return their isolation and "", or None and the reason of the failure."""
    program = find_bubblewrap()
    if program is None:
        return None, "bubblewrap is not installed (apt install bubblewrap)"
    isolation = namespace_isolation(program, allow_root=allow_root)
    statement = CHANGE_USER if os.geteuid() == 0 and not isolation.stays_root else "pass"
    try:
        tried = subprocess.run(
            [*isolation.around, isolation.inside[0], "-I", "-S", "-c", statement],
            capture_output=True, text=True, timeout=TRY_S, check=False, env=dict(isolation.environment),
                cwd="/",
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)
    return (
        (isolation, "")
        if tried.returncode == 0
        else (None, tried.stderr.strip() or f"bwrap exited with code {tried.returncode}")
    )
