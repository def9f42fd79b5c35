"""The system call filter (seccomp-BPF): an allow-list that the zygote builds once and each child applies as
its last layer.

Kernel documentation: Documentation/userspace-api/seccomp_filter.rst; instructions: <linux/bpf_common.h>. A
call of another ABI kills the process. A newer, unknown call fails with ENOSYS, so that the C library falls
back, a new thread with EAGAIN, and all others with EPERM.
"""

import ctypes
import errno
import struct

from .syscalls import NEWEST, Machine, syscall

LOAD, EQUAL, AT_LEAST, ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
KILL, ALLOW, FAIL = 0x80000000, 0x7FFF0000, 0x00050000
NUMBER, ARCHITECTURE, ARGUMENTS = 0, 4, 16  # offsets in struct seccomp_data
SET_MODE_FILTER = 1
OWN_PID = 0x7FFFFFF1  # placeholder for the child's process id, which ``install`` fills in

PR_GET_NAME, PR_SET_VMA = (
    16,
    0x53564D41,
)  # PR_SET_NAME would let a submission choose its name in the host's list of processes
TCGETS, FIOCLEX = 0x5401, 0x5451
F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_DUPFD_CLOEXEC = 0, 1, 2, 3, 4, 1030
ITIMER_REAL = 0
# CLOCK_REALTIME (0) to CLOCK_TAI (11); the ids above are the CPU clocks of other processes, and clock devices
CLOCKS = 12
O_ACCMODE, O_TRUNC = 0o3, 0o1000


def program(machine: Machine) -> bytes:
    """Return the filter for a machine, as an array of struct sock_filter."""
    refuse = FAIL | errno.EPERM
    code = [
        _step(LOAD, ARCHITECTURE),
        _step(EQUAL, machine.audit, 1, 0),
        _step(RETURN, KILL),
        _step(LOAD, NUMBER),
    ]
    if machine.foreign is not None:
        code += [_step(AT_LEAST, machine.foreign, 0, 1), _step(RETURN, KILL)]
    own = _only(0, (0, OWN_PID), refuse)
    read_only = [
        _step(LOAD, ARGUMENTS + 16),
        _step(EQUAL, 0, 0, 3),
        _step(LOAD, ARGUMENTS + 20),
        _step(EQUAL, 0, 0, 1),
    ]
    clock = [
        _step(LOAD, ARGUMENTS),
        _step(AT_LEAST, CLOCKS, 0, 1),
        _step(RETURN, refuse),
        _step(RETURN, ALLOW),
    ]
    done, none = [_step(RETURN, FAIL)], [_step(RETURN, FAIL | errno.EOPNOTSUPP)]
    rules = {
        "open": _no_truncation(1),
        "openat": _no_truncation(2),
        "clone3": [_step(RETURN, FAIL | errno.ENOSYS)],
        "clone": [_step(RETURN, FAIL | errno.EAGAIN)],
        **dict.fromkeys(("kill", "tgkill"), _only(0, (OWN_PID,), refuse)),
        **dict.fromkeys(("getpgid", "sched_getaffinity"), own),
        **dict.fromkeys(("clock_gettime", "clock_getres", "clock_nanosleep"), clock),
        "prctl": _only(0, (PR_GET_NAME, PR_SET_VMA), refuse),
        "ioctl": _only(1, (TCGETS, FIOCLEX), FAIL | errno.ENOTTY),
        "fcntl": _only(1, (F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_DUPFD_CLOEXEC), refuse),
        "setitimer": _only(0, (ITIMER_REAL,), refuse),
        # no file outlives the child
        **dict.fromkeys(("fsync", "fdatasync", "msync"), done),
        # as on a file system that has none: copying a file asks for them
        **dict.fromkeys(("listxattr", "llistxattr", "flistxattr"), none),
        # without the step that allows the call: the next ones decide
        "prlimit64": [*own[:-1], *read_only, _step(RETURN, ALLOW), _step(RETURN, refuse)],
    }
    for name in filter(machine.narrow.__contains__, rules):
        code += _rule(machine.narrow[name], rules[name])
    for number in sorted(machine.allowed.values()):
        code += _rule(number, [_step(RETURN, ALLOW)])
    code += [_step(AT_LEAST, NEWEST, 0, 1), _step(RETURN, FAIL | errno.ENOSYS), _step(RETURN, refuse)]
    return b"".join(code)


def install(machine: Machine, filter: bytes, pid: int) -> None:
    """Apply the filter to this process. Needs no_new_privs. Raises OSError if the kernel refuses."""
    own = filter.replace(struct.pack("<I", OWN_PID), struct.pack("<I", pid))
    buffer = ctypes.create_string_buffer(own, len(own))
    syscall(
        machine.narrow["seccomp"],
        SET_MODE_FILTER,
        0,
        ctypes.byref(_Program(len(own) // 8, ctypes.addressof(buffer))),
    )


class _Program(ctypes.Structure):
    """struct sock_fprog."""

    _fields_ = [("length", ctypes.c_ushort), ("filter", ctypes.c_void_p)]


def _step(code: int, k: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("<HBBI", code, if_true, if_false, k)


def _rule(number: int, body: list[bytes]) -> list[bytes]:
    """Return the steps that run ``body`` for that system call. ``body`` always returns, so the number need
    not be loaded again.
    """
    return [_step(EQUAL, number, 0, len(body)), *body]


def _no_truncation(argument: int) -> list[bytes]:
    """Deny O_TRUNC on a file opened for reading, which Landlock before version 3 allows."""
    tests = [_step(ANY_BIT, O_TRUNC, 0, 1), _step(ANY_BIT, O_ACCMODE, 0, 1)]
    return [
        _step(LOAD, ARGUMENTS + 8 * argument),
        *tests,
        _step(RETURN, ALLOW),
        _step(RETURN, FAIL | errno.EACCES),
    ]


def _only(argument: int, values: tuple[int, ...], otherwise: int) -> list[bytes]:
    """Return the steps that allow a call if the low half of that argument is one of ``values``."""
    tests = [_step(EQUAL, value, len(values) - i, 0) for i, value in enumerate(values)]
    return [_step(LOAD, ARGUMENTS + 8 * argument), *tests, _step(RETURN, otherwise), _step(RETURN, ALLOW)]
