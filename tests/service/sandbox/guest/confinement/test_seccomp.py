"""The filter of system calls, run by an interpreter of its instructions: what it answers for every call of
both processors.
"""

import errno
import os
import re
import struct
from pathlib import Path

import pytest

from service.sandbox.guest.confinement import seccomp
from service.sandbox.guest.confinement.syscalls import MACHINES

HEADERS = {
    "x86_64": (Path("/usr/include/x86_64-linux-gnu/asm/unistd_64.h"), {}),
    "aarch64": (
        Path("/usr/include/asm-generic/unistd.h"),
        {
            "newfstatat": "3264_fstatat",
            "fcntl": "3264_fcntl",
            "mmap": "3264_mmap",
            "lseek": "3264_lseek",
            "fstat": "3264_fstat",
        }
        | {
            "ftruncate": "3264_ftruncate",
            "statfs": "3264_statfs",
            "fstatfs": "3264_fstatfs",
            "fadvise64": "3264_fadvise64",
        },
    ),
}
ME = 4711
EPERM, ENOSYS = seccomp.FAIL | errno.EPERM, seccomp.FAIL | errno.ENOSYS
machines = pytest.mark.parametrize("name", MACHINES)


def answer(name, call, *arguments, audit=None):
    """What the filter of that machine says to a call (a name or a number)."""
    machine = MACHINES[name]
    number = call if isinstance(call, int) else (machine.allowed | machine.narrow)[call]
    code = seccomp.program(machine).replace(struct.pack("<I", seccomp.OWN_PID), struct.pack("<I", ME))
    given = (*arguments, 0, 0, 0, 0, 0, 0)[:6]
    data = struct.pack("<iIQ6Q", number, audit or machine.audit, 0, *(a % 2**64 for a in given))
    at, value = 0, 0
    for _ in range(2000):
        op, if_true, if_false, k = struct.unpack_from("<HBBI", code, 8 * at)
        at += 1
        if op == seccomp.RETURN:
            return k
        if op == seccomp.LOAD:
            (value,) = struct.unpack_from("<I", data, k)
        else:
            tests = {
                seccomp.EQUAL: value == k,
                seccomp.AT_LEAST: value >= k,
                seccomp.ANY_BIT: bool(value & k),
            }
            at += if_true if tests[op] else if_false
    raise AssertionError("the filter does not end")


@machines
def test_numbers_are_those_of_the_kernels_headers(name):
    header, other = HEADERS[name]
    if not header.exists():
        pytest.skip("no kernel headers on this machine")
    text = header.read_text()
    for call, number in (MACHINES[name].allowed | MACHINES[name].narrow).items():
        told = re.search(rf"^#define __NR_?{other.get(call, call)}\s+(\d+)", text, re.MULTILINE)
        if told is None:  # known to the kernel under its newer name only, or newer than the headers
            told = re.search(rf"^#define __NR_{call}\s+(\d+)", text, re.MULTILINE)
        assert told is not None and int(told[1]) == number, call


@machines
def test_every_call_but_the_listed_is_refused(name):
    machine = MACHINES[name]
    listed = set(machine.allowed.values()) | set(machine.narrow.values())
    for number in range(600):
        if number in listed:
            continue
        assert answer(name, number) == (ENOSYS if number >= 470 else EPERM), number
    assert all(answer(name, n) == seccomp.ALLOW for n in machine.allowed.values())


LINKS = ("symlink", "symlinkat", "link", "linkat", "mknod", "mknodat", "renameat2")
ATTRIBUTES = (
    "chmod",
    "fchmod",
    "fchmodat",
    "chown",
    "fchown",
    "fchownat",
    "utimensat",
    "setxattr",
    "truncate",
)


@machines
def test_files_get_no_links_and_no_other_attributes(name):
    """Landlock does not govern these on every kernel, or not at all."""
    machine = MACHINES[name]
    assert not {*LINKS, *ATTRIBUTES} & {*machine.allowed, *machine.narrow}
    assert {answer(name, call) for call in ("fsync", "fdatasync", "msync")} == {
        seccomp.FAIL
    }  # without effect
    asked = {answer(name, call) for call in ("listxattr", "llistxattr", "flistxattr")}
    assert asked == {seccomp.FAIL | errno.EOPNOTSUPP}


@machines
def test_calls_for_some_arguments_only(name):
    assert answer(name, "kill", ME, 9) == answer(name, "tgkill", ME, ME, 6) == seccomp.ALLOW
    assert (
        answer(name, "kill", 1, 9) == answer(name, "kill", -1, 9) == answer(name, "tgkill", 1, ME, 9) == EPERM
    )
    assert answer(name, "clone3") == ENOSYS and answer(name, "clone", 0x11) == seccomp.FAIL | errno.EAGAIN
    assert answer(name, "prlimit64", 0, 7, 4096) == answer(name, "prlimit64", 0, 7, 1 << 32) == EPERM
    assert answer(name, "prlimit64", ME, 7, 4096) == answer(name, "prlimit64", 1, 7, 4096) == EPERM
    assert answer(name, "prctl", 16) == answer(name, "prctl", 0x53564D41, 0) == seccomp.ALLOW
    assert {answer(name, "prctl", option) for option in (1, 4, 15, 22, 23, 35, 36)} == {
        EPERM
    }  # 15: PR_SET_NAME
    assert (
        answer(name, "ioctl", 0, 0x5401) == seccomp.ALLOW
        and answer(name, "ioctl", 0, 0x5412) == seccomp.FAIL | errno.ENOTTY
    )
    assert (
        answer(name, "fcntl", 4, 1030) == seccomp.ALLOW
        and answer(name, "fcntl", 4, 8) == answer(name, "fcntl", 4, 1031) == EPERM
    )
    assert answer(name, "setitimer", 0) == seccomp.ALLOW and answer(name, "setitimer", 1) == EPERM
    assert answer(name, "seccomp", 1) == EPERM
    refused = seccomp.FAIL | errno.EACCES
    for flags in (
        os.O_RDONLY,
        os.O_RDONLY | os.O_CLOEXEC | os.O_DIRECTORY,
        os.O_WRONLY | os.O_TRUNC,
    ):  # writing is Landlock's
        assert answer(name, "openat", -100, 0, flags) == seccomp.ALLOW
    assert answer(name, "openat", -100, 0, os.O_RDONLY | os.O_TRUNC) == refused
    if name == "x86_64":
        assert (
            answer(name, "open", 0, os.O_RDONLY | os.O_TRUNC) == refused
            and answer(name, "open", 0, 0) == seccomp.ALLOW
        )


@machines
@pytest.mark.parametrize("call", ["getpgid", "sched_getaffinity", "prlimit64"])
def test_only_the_own_process_is_asked_about(name, call):
    assert answer(name, call, 0) == answer(name, call, ME) == seccomp.ALLOW
    assert {answer(name, call, pid) for pid in (1, ME - 1, ME + 1, -1, -ME, 1 << 31)} == {EPERM}


@machines
@pytest.mark.parametrize("call", ["clock_gettime", "clock_getres", "clock_nanosleep"])
def test_no_clock_of_another_process_is_read(name, call):
    assert {answer(name, call, clock) for clock in range(12)} == {seccomp.ALLOW}
    kinds = (
        0,
        1,
        2,
        3,
        4,
        5,
        6,
    )  # profiling, virtual and CPU time of a process, a clock device (3), and those of a thread
    others = [~number << 3 | kind for number in (1, 4, ME - 1, 65535) for kind in kinds]
    assert {answer(name, call, clock) for clock in (*others, 12, 1 << 31)} == {EPERM}


@machines
def test_another_mode_of_the_processor_is_killed(name):
    assert answer(name, "read", audit=0x40000003) == seccomp.KILL  # i386
    assert answer("x86_64", 0x40000000 | 39) == answer("x86_64", -1) == seccomp.KILL
