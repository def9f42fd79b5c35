"""What a child gives up before it reads a submission. Every step raises on failure: a wall that does not stand stops the play.

Numbers are Linux's: unshare(2) and mount(2) flags from <linux/sched.h> and <linux/mount.h>, prctl(2) options from
<linux/prctl.h>, the capability header from <linux/capability.h>.
"""

import ctypes
import os
import resource
import signal

CLONE_NEWNS, CLONE_NEWIPC, CLONE_NEWUSER, CLONE_NEWPID = 0x00020000, 0x08000000, 0x10000000, 0x20000000
MS_RDONLY, MS_NOSUID, MS_NODEV, MS_REMOUNT, MS_BIND = 0x1, 0x2, 0x4, 0x20, 0x1000
PR_SET_PDEATHSIG, PR_SET_DUMPABLE, PR_SET_NO_NEW_PRIVS = 1, 4, 38
CAPABILITY_VERSION_3 = 0x20080522

MIB = 1 << 20
GUEST_UID = 64001  # an unused number on Debian (64000 to 64999 are reserved); used where the server is root
LIMITS = {
    resource.RLIMIT_AS: 1024 * MIB,
    resource.RLIMIT_DATA: 768 * MIB,
    resource.RLIMIT_FSIZE: 0,
    resource.RLIMIT_CORE: 0,
    resource.RLIMIT_NOFILE: 64,
    resource.RLIMIT_NPROC: 1,
    resource.RLIMIT_MEMLOCK: 0,
    resource.RLIMIT_STACK: 16 * MIB,
}

_libc = ctypes.CDLL(None, use_errno=True)


def own_namespaces(writable: str) -> None:
    """Move into fresh process, IPC and mount namespaces with ``writable`` made read-only; returns in their first process.

    The process that called goes on as a bystander: it waits for that first process and ends the way it ended.
    """
    _call("unshare", CLONE_NEWNS | CLONE_NEWIPC | CLONE_NEWPID | (0 if os.geteuid() == 0 else CLONE_NEWUSER))
    inner = os.fork()
    if inner:
        status = os.waitpid(inner, 0)[1]
        os._exit(128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status))
    flags = MS_REMOUNT | MS_BIND | MS_RDONLY | MS_NOSUID | MS_NODEV
    _call("mount", None, writable.encode(), None, ctypes.c_ulong(flags), None)


def give_up_privileges() -> None:
    """No root, no capabilities, none to be gained, and no life after the parent."""
    if os.geteuid() == 0 and os.getuid() == 0:
        os.setgroups([])
        os.setresgid(GUEST_UID, GUEST_UID, GUEST_UID)
        os.setresuid(GUEST_UID, GUEST_UID, GUEST_UID)
    header = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION_3, 0)
    _call("capset", header, (ctypes.c_uint32 * 6)())
    _call("prctl", PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    _call("prctl", PR_SET_DUMPABLE, 0, 0, 0, 0)
    die_with_parent()


def die_with_parent() -> None:
    """SIGKILL for this process when its parent ends."""
    _call("prctl", PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def limit_resources(cpu_s: int, count_processes: bool) -> None:
    """Memory, files, descriptors and CPU time; processes only where the count is the guest's own."""
    for which, limit in LIMITS.items():
        if which != resource.RLIMIT_NPROC or count_processes:
            resource.setrlimit(which, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))


def _call(name: str, *args: object) -> None:
    if getattr(_libc, name)(*args) != 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")
