"""Landlock rules: open only the named files, write to none, use no TCP port, signal no process outside.

Kernel documentation: Documentation/userspace-api/landlock.rst; numbers: <linux/landlock.h>. Version 1
suffices: what it does not govern (truncation, TCP, signals), the system call filter denies.
"""

import ctypes
import os
import stat
import struct
from collections.abc import Iterable

from .syscalls import LANDLOCK_ADD, LANDLOCK_CREATE, LANDLOCK_RESTRICT, syscall

WRITE_FILE, READ_FILE, READ_DIR = 1 << 1, 1 << 2, 1 << 3
SINK = "/dev/null"  # the only file that may be written to
VERSION_QUERY, PATH_BENEATH = 1, 1
PATH_BENEATH_ATTR = struct.Struct(
    "=Qi"
)  # struct landlock_path_beneath_attr, packed: rights, descriptor of the parent
# Rights of the file system governed by each version: 1 has 13, 2 adds REFER, 3 TRUNCATE, 5 IOCTL_DEV.
FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15}
NEWEST_FILE_RIGHTS = 16
TCP, SCOPES = 0b11, 0b11  # bind and connect, from version 4; abstract sockets and signals, from version 6


def version() -> int:
    """Return the kernel's Landlock version, or 0 without Landlock."""
    try:
        return syscall(LANDLOCK_CREATE, ctypes.c_void_p(None), 0, VERSION_QUERY)
    except OSError:
        return 0


def ruleset(readable: Iterable[str], listable: Iterable[str]) -> int:
    """Return a descriptor of rules that allow only reading below ``readable`` and listing below ``listable``.

    Raises OSError if the kernel has no Landlock.
    """
    known = version()
    if known < 1:
        raise OSError("this kernel has no Landlock")
    rights = (1 << FILE_RIGHTS.get(known, NEWEST_FILE_RIGHTS)) - 1
    attributes = (ctypes.c_uint64 * 3)(rights, TCP if known >= 4 else 0, SCOPES if known >= 6 else 0)
    rules = syscall(LANDLOCK_CREATE, ctypes.byref(attributes), 8 if known < 4 else 16 if known < 6 else 24, 0)
    for path in readable:
        _allow(rules, path, READ_FILE | READ_DIR | (WRITE_FILE if path == SINK else 0))
    for path in listable:
        _allow(rules, path, READ_DIR)
    return rules


def restrict(rules: int) -> None:
    """Apply the rules to this process. Needs no_new_privs."""
    syscall(LANDLOCK_RESTRICT, rules, 0)


def _allow(rules: int, path: str, rights: int) -> None:
    parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
    try:
        if not stat.S_ISDIR(os.fstat(parent).st_mode):
            rights &= READ_FILE | WRITE_FILE
        syscall(LANDLOCK_ADD, rules, PATH_BENEATH, PATH_BENEATH_ATTR.pack(rights, parent), 0)
    finally:
        os.close(parent)
