"""The layers that a child applies before it reads a submission. Every step raises on failure, which ends the
play.

Numbers: prctl(2) options from <linux/prctl.h>, the capability header from <linux/capability.h>.
"""

import ctypes
import os
import platform
import resource
import signal
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from . import landlock, scratch, seccomp
from .syscalls import CLOSE_RANGE, MACHINES, call, syscall

PR_SET_PDEATHSIG, PR_SET_DUMPABLE, PR_SET_NO_NEW_PRIVS = 1, 4, 38
CAPABILITY_VERSION_3 = 0x20080522
GUEST_UID = 64001  # an unused number on Debian (64000 to 64999 are reserved); used where the server is root
MIB = 1 << 20
LIMITS = {
    resource.RLIMIT_AS: 768 * MIB,
    resource.RLIMIT_DATA: 512 * MIB,
    resource.RLIMIT_STACK: 8 * MIB,
    resource.RLIMIT_NOFILE: 32,
    resource.RLIMIT_NPROC: 1,
    resource.RLIMIT_FSIZE: scratch.MOST_FILE,
    resource.RLIMIT_CORE: 0,
    resource.RLIMIT_MEMLOCK: 0,
    resource.RLIMIT_MSGQUEUE: 0,
}
KEEP_IGNORED = {
    signal.SIGPIPE,
    signal.SIGXFSZ,
}  # Python turns these into exceptions; their defaults would kill


class Layers:
    """The ``layers`` that each child applies, of "landlock", "seccomp" and "limits". The zygote prepares them
    once.

    A child keeps the open ``folders`` (/proc/self/fd/N), through which it finds files below closed ones. It
    can write to no file unless it has an ``own_folder``.
    """

    def __init__(
        self, layers: list[str], readable: list[str], listable: list[str], folders: Sequence[str] = ()
    ) -> None:
        self._limits = "limits" in layers
        self._paths = landlock.Paths(readable, listable) if "landlock" in layers else None
        self._rules: int | None = None
        self._most_file = 0
        self._folders = [int(os.path.basename(folder)) for folder in folders]
        self._machine = MACHINES.get(platform.machine())
        self._filter: bytes | None = None
        if "seccomp" in layers:
            if self._machine is None:
                raise OSError(f"polhode has no system call filter for this processor ({platform.machine()})")
            self._filter = seccomp.program(self._machine)

    def own_folder(self, path: str | None) -> None:
        """Let this process write below ``path``, if it is not None, when it has applied the layers."""
        if self._paths is not None:
            self._rules = self._paths.ruleset(path)
        self._most_file = 0 if path is None else LIMITS[resource.RLIMIT_FSIZE]

    def apply(self, places: Mapping[int, int], cpu_s: int) -> None:
        """Apply the layers to this process, which cannot undo them, and close all files except ``places``.

        ``places`` maps a file descriptor's number in this process to the open descriptor that is moved there.
        The kernel ends this process after ``cpu_s`` seconds of CPU time, or a second later if it ignores the
        signal.
        """
        os.setpgid(0, 0)  # not a new session, which would be scheduled as a group of its own
        self.close_all_but(places)
        for number in set(signal.valid_signals()) - {signal.SIGKILL, signal.SIGSTOP} - KEEP_IGNORED:
            if signal.getsignal(number) not in (signal.SIG_DFL, None):
                signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        call("prctl", PR_SET_DUMPABLE, 0, 0, 0, 0)
        die_with_parent()
        self.limit()
        if self._limits:
            resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))  # SIGXCPU, then SIGKILL
        call("prctl", PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
        if self._rules is not None:
            landlock.restrict(self._rules)
            os.close(self._rules)
        if self._filter is not None:
            assert self._machine is not None
            seccomp.install(self._machine, self._filter, os.getpid())

    def limit(self) -> None:
        """Apply the limits other than that of CPU time: of memory, and no other process or thread, among
        others.
        """
        if self._limits:
            for which, limit in (LIMITS | {resource.RLIMIT_FSIZE: self._most_file}).items():
                resource.setrlimit(which, (limit, limit))

    def close_all_but(self, places: Mapping[int, int]) -> None:
        """Move open descriptors to ``places`` and close all others, except those that ``apply`` and a child
        need.
        """
        # Move the descriptors above all places first, so that none overwrites another.
        high = {place: _above(fd) for place, fd in places.items()}
        if self._rules is not None:
            self._rules = _above(self._rules)
        for place, fd in high.items():
            os.dup2(fd, place)
        kept = sorted([max(places), *self._folders, *([] if self._rules is None else [self._rules])])
        for before, after in pairwise([*kept, 0x80000000]):
            start, end = before + 1, after - 1
            if start <= end:
                syscall(CLOSE_RANGE, start, end, 0)


def die_with_parent(parent: int | None = None) -> None:
    """Kill this process when the thread that started it ends. Exit now if its parent is not ``parent`` any
    more.
    """
    call("prctl", PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if parent is not None and os.getppid() != parent:
        os._exit(1)


def drop_privileges(user: int | None) -> None:
    """Change to the user id ``user``, if it is not None, and drop all capabilities."""
    if user is not None:
        os.setgroups([])
        os.setresgid(user, user, user)
        os.setresuid(user, user, user)
    header: Any = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION_3, 0)
    call("capset", header, (ctypes.c_uint32 * 6)())


def identity() -> dict[str, Any]:
    """Return this process's users, groups and capabilities, as the kernel reports them."""
    header: Any = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION_3, 0)
    sets: Any = (ctypes.c_uint32 * 6)()  # effective, permitted and inheritable, twice 32 bits each
    call("capget", header, sets)
    capabilities = [n for n in range(64) if any(sets[n // 32 * 3 + kind] >> n % 32 & 1 for kind in range(3))]
    return {
        "users": os.getresuid(),
        "groups": [*os.getresgid(), *os.getgroups()],
        "capabilities": capabilities,
    }


def _above(fd: int) -> int:
    """Return a duplicate of ``fd`` with a number above all places."""
    import fcntl

    return fcntl.fcntl(fd, fcntl.F_DUPFD, 20)
