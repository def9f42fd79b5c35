"""The system calls that a child may make, by number, for each supported processor. All others are denied.

Numbers: Linux's arch/x86/entry/syscalls/syscall_64.tbl and include/uapi/asm-generic/unistd.h (aarch64); a
test compares them with the kernel headers of the machine. Left out on purpose: fork, vfork, exec, sockets,
ptrace, signals to others, all that makes a link or a device, all that changes the mode, owner, times or
extended attributes of a file, shared memory, timers except the one of a scene's budget, namespaces, keys,
bpf, io_uring, userfaultfd, sessions and every newer call. Landlock governs where a child may make, change and
remove files.
"""

import ctypes
import os
from typing import Any, NamedTuple


class Machine(NamedTuple):
    """A processor: its ``audit`` number (<linux/audit.h>) and the numbers of its ``allowed`` calls.

    ``narrow`` are calls allowed with some arguments only. ``foreign`` is the first number of another ABI on
    the same machine.
    """

    audit: int
    allowed: dict[str, int]
    narrow: dict[str, int]
    foreign: int | None


LANDLOCK_CREATE, LANDLOCK_ADD, LANDLOCK_RESTRICT = 444, 445, 446  # the same on both
CLOSE_RANGE = 436
NEWEST = 470  # calls from this number on are unknown here and fail like calls that the kernel does not have

_X86_64 = {
    **{
        "read": 0,
        "write": 1,
        "close": 3,
        "stat": 4,
        "fstat": 5,
        "lstat": 6,
        "poll": 7,
        "lseek": 8,
        "mmap": 9,
    },
    **{
        "mprotect": 10,
        "munmap": 11,
        "brk": 12,
        "rt_sigaction": 13,
        "rt_sigprocmask": 14,
        "rt_sigreturn": 15,
        "pread64": 17,
    },
    **{
        "pwrite64": 18,
        "readv": 19,
        "writev": 20,
        "access": 21,
        "pipe": 22,
        "select": 23,
        "sched_yield": 24,
        "mremap": 25,
    },
    **{
        "madvise": 28,
        "dup": 32,
        "dup2": 33,
        "nanosleep": 35,
        "getitimer": 36,
        "getpid": 39,
        "exit": 60,
        "uname": 63,
    },
    **{
        "getdents": 78,
        "getcwd": 79,
        "readlink": 89,
        "ftruncate": 77,
        "chdir": 80,
        "rename": 82,
        "mkdir": 83,
        "rmdir": 84,
        "unlink": 87,
        "umask": 95,
        "gettimeofday": 96,
        "getrlimit": 97,
        "getrusage": 98,
    },
    **{
        "sysinfo": 99,
        "times": 100,
        "getuid": 102,
        "getgid": 104,
        "geteuid": 107,
        "getegid": 108,
        "getppid": 110,
        "getpgrp": 111,
    },
    **{
        "rt_sigpending": 127,
        "sigaltstack": 131,
        "statfs": 137,
        "fstatfs": 138,
        "arch_prctl": 158,
        "gettid": 186,
        "time": 201,
    },
    **{
        "futex": 202,
        "getdents64": 217,
        "set_tid_address": 218,
        "restart_syscall": 219,
        "fadvise64": 221,
        "exit_group": 231,
    },
    **{"mkdirat": 258, "unlinkat": 263, "renameat": 264},
    **{"newfstatat": 262, "readlinkat": 267, "faccessat": 269, "pselect6": 270, "ppoll": 271},
    **{
        "set_robust_list": 273,
        "dup3": 292,
        "pipe2": 293,
        "preadv": 295,
        "getcpu": 309,
        "getrandom": 318,
        "membarrier": 324,
    },
    **{"statx": 332, "rseq": 334, "close_range": 436, "faccessat2": 439},
}
_AARCH64 = {
    **{"mkdirat": 34, "unlinkat": 35, "renameat": 38, "ftruncate": 46, "chdir": 49},
    **{
        "getcwd": 17,
        "dup": 23,
        "dup3": 24,
        "statfs": 43,
        "fstatfs": 44,
        "faccessat": 48,
        "close": 57,
        "pipe2": 59,
    },
    **{
        "getdents64": 61,
        "lseek": 62,
        "read": 63,
        "write": 64,
        "readv": 65,
        "writev": 66,
        "pread64": 67,
        "pwrite64": 68,
    },
    **{
        "preadv": 69,
        "pselect6": 72,
        "ppoll": 73,
        "readlinkat": 78,
        "newfstatat": 79,
        "fstat": 80,
        "exit": 93,
        "exit_group": 94,
    },
    **{"set_tid_address": 96, "futex": 98, "set_robust_list": 99, "nanosleep": 101, "getitimer": 102},
    **{
        "sched_yield": 124,
        "restart_syscall": 128,
        "sigaltstack": 132,
        "rt_sigaction": 134,
        "rt_sigprocmask": 135,
    },
    **{
        "rt_sigpending": 136,
        "rt_sigreturn": 139,
        "times": 153,
        "uname": 160,
        "getrlimit": 163,
        "getrusage": 165,
    },
    **{"umask": 166, "getcpu": 168},
    **{
        "gettimeofday": 169,
        "getpid": 172,
        "getppid": 173,
        "getuid": 174,
        "geteuid": 175,
        "getgid": 176,
        "getegid": 177,
    },
    **{
        "gettid": 178,
        "sysinfo": 179,
        "brk": 214,
        "munmap": 215,
        "mremap": 216,
        "mmap": 222,
        "fadvise64": 223,
        "mprotect": 226,
    },
    **{
        "madvise": 233,
        "getrandom": 278,
        "membarrier": 283,
        "statx": 291,
        "rseq": 293,
        "close_range": 436,
        "faccessat2": 439,
    },
}
_NARROW = {  # numbers on x86_64 and on aarch64
    **{
        "openat": (257, 56),
        "clone": (56, 220),
        "clone3": (435, 435),
        "kill": (62, 129),
        "tgkill": (234, 131),
    },
    **{
        "prctl": (157, 167),
        "ioctl": (16, 29),
        "fcntl": (72, 25),
        "prlimit64": (302, 261),
        "setitimer": (38, 103),
    },
    **{
        "seccomp": (317, 277),
        "getpgid": (121, 155),
        "sched_getaffinity": (204, 123),
        "clock_gettime": (228, 113),
    },
    **{"clock_getres": (229, 114), "clock_nanosleep": (230, 115)},
    **{"fsync": (74, 82), "fdatasync": (75, 83), "msync": (26, 227)},
    **{"listxattr": (194, 11), "llistxattr": (195, 12), "flistxattr": (196, 13)},
}

MACHINES = {
    "x86_64": Machine(
        0xC000003E, _X86_64, {name: n for name, (n, _) in _NARROW.items()} | {"open": 2}, foreign=0x40000000
    ),
    "aarch64": Machine(0xC00000B7, _AARCH64, {name: n for name, (_, n) in _NARROW.items()}, foreign=None),
}


_libc = ctypes.CDLL(None, use_errno=True)
_libc.syscall.restype = ctypes.c_long
_add_rule = _libc["syscall"]  # with the types of its arguments, as it is called hundreds of times for a child
_add_rule.argtypes = (ctypes.c_long, ctypes.c_long, ctypes.c_long, ctypes.c_char_p, ctypes.c_long)
_add_rule.restype = ctypes.c_long


def call(name: str, *args: Any) -> None:
    """Call a function of the C library. Raises OSError if it does not return 0."""
    if getattr(_libc, name)(*args) != 0:
        raise _error(name)


def syscall(number: int, *args: Any) -> int:
    """Make a system call by number and return its result. Raises OSError if it fails."""
    result = int(
        _libc.syscall(ctypes.c_long(number), *(ctypes.c_long(a) if isinstance(a, int) else a for a in args))
    )
    if result < 0:
        raise _error(f"system call {number}")
    return result


def add_rule(rules: int, kind: int, attributes: bytes) -> None:
    """Add a rule to a Landlock ruleset. Raises OSError if the kernel refuses."""
    if _add_rule(LANDLOCK_ADD, rules, kind, attributes, 0) < 0:
        raise _error("landlock_add_rule")


def _error(call: str) -> OSError:
    number = ctypes.get_errno()
    return OSError(number, f"{call}: {os.strerror(number)}")
