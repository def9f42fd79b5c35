"""Which sandbox features this machine supports, and how to enable those that are missing."""

import argparse
import os
import platform
import resource
from pathlib import Path

from exercises.authoring.assignments import packages
from exercises.authoring.assignments.catalogue import assignments
from service.grading.grade import missing_packages
from service.sandbox.guest.confinement import landlock, lockdown
from service.sandbox.guest.confinement.syscalls import MACHINES
from service.sandbox.isolation.levels import Level
from service.sandbox.isolation.select import IsolationUnavailable, choose, try_namespaces
from service.sandbox.job import MEMORY_MB
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.self_test_job import FORBIDDEN
from service.settings import Settings

SWITCHES = {  # kernel settings that forbid namespaces: the forbidding value and the remedy
    "kernel/apparmor_restrict_unprivileged_userns": (
        "1",
        "sysctl kernel.apparmor_restrict_unprivileged_userns=0",
    ),
    "kernel/unprivileged_userns_clone": ("0", "sysctl kernel.unprivileged_userns_clone=1"),
    "user/max_user_namespaces": ("0", "sysctl user.max_user_namespaces=10000"),
}


def add_doctor(parser: argparse.ArgumentParser) -> None:
    """Set the function of the command, which has no arguments."""
    parser.set_defaults(run=_doctor)


def _doctor(arguments: argparse.Namespace) -> int:
    lines, valid = examine(Settings().min_isolation, Settings().allow_root_guest)
    print("\n".join(lines))
    return 0 if valid else 2


def examine(least: Level, allow_root: bool = False) -> tuple[list[str], bool]:
    """Return the findings as lines, and whether this machine can grade at isolation level ``least`` or
    stronger.
    """
    machine, version = platform.machine(), landlock.version()
    absent = "missing: needs Linux 5.13 and lsm=…,landlock at boot"
    unfiltered = "" if machine in MACHINES else ": no system-call filter"
    lines = [
        f"kernel        {platform.release()} on {machine}{unfiltered}",
        f"Landlock      {f'version {version}' if version else absent}",
        f"user          {'root' if os.geteuid() == 0 else os.geteuid()}",
    ]
    available, reason = try_namespaces(allow_root)
    lines.append(f"namespaces    {'yes' if available else f'no: {reason}'}")
    lines += [f"              try: {advice}" for advice in ([] if available else _advice())]
    try:
        chosen = choose(least, allow_root)
    except IsolationUnavailable as unavailable:
        return [*lines, f"isolation     none: {unavailable}"], False
    lines.append(f"isolation     {chosen.name}")
    sandbox = Sandbox(chosen)
    try:
        sandbox.self_test()
    except SystemFault as fault:
        return [
            *lines,
            f"guest         {sandbox.identity or 'did not start'}",
            f"self-test     {fault}",
        ], False
    finally:
        sandbox.close()
    missing = [sentence for known in assignments().values() if (sentence := missing_packages(known))]
    names = sorted({name for known in assignments().values() for name in known.packages})
    return [
        *lines,
        f"guest         {sandbox.identity}",
        f"self-test     passed: all {len(FORBIDDEN)} forbidden operations were blocked",
        f"limits        {_limits()}",
        f"packages      {packages.listing(names)}",
        *(f"              {sentence}" for sentence in missing),
    ], not missing


def _limits() -> str:
    of, mib = lockdown.LIMITS, lockdown.MIB
    memory = f"address space {MEMORY_MB + lockdown.CODE_MB} MiB, data {MEMORY_MB} MiB"
    files = f"descriptors {of[resource.RLIMIT_NOFILE]}, file size {of[resource.RLIMIT_FSIZE] // mib} MiB"
    return f"{memory}, CPU {Settings().grading_cpu:g} s, {files}"


def _advice() -> list[str]:
    found = [do for name, (value, do) in SWITCHES.items() if _read(Path("/proc/sys") / name) == value]
    if Path("/.dockerenv").exists() or Path("/run/.containerenv").exists():
        # users other than root get these capabilities in a user namespace
        more = " --cap-add SYS_ADMIN --cap-add NET_ADMIN" if os.geteuid() == 0 else ""
        found.append(
            f"in a container: --security-opt seccomp=unconfined --security-opt apparmor=unconfined{more}"
        )
    return found


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
