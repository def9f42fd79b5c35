"""Landlock rules: open only the named files, write only below a folder of its own, use no TCP port, signal no
process outside.

Kernel documentation: Documentation/userspace-api/landlock.rst; numbers: <linux/landlock.h>. Version 1
suffices: what it does not govern (truncation by name, TCP, signals), the system call filter denies.
"""

import ctypes
import os
import stat
import struct
from collections.abc import Iterable

from .syscalls import LANDLOCK_CREATE, LANDLOCK_RESTRICT, add_rule, syscall

WRITE_FILE, READ_FILE, READ_DIR = 1 << 1, 1 << 2, 1 << 3
REMOVE_DIR, REMOVE_FILE, MAKE_DIR, MAKE_REG = 1 << 4, 1 << 5, 1 << 7, 1 << 8
REFER, TRUNCATE = 1 << 13, 1 << 14
OF_A_FILE = READ_FILE | WRITE_FILE
OWN = OF_A_FILE | READ_DIR | REMOVE_DIR | REMOVE_FILE | MAKE_DIR | MAKE_REG | REFER | TRUNCATE
SINK = "/dev/null"  # the only file outside of its own folder that a child may write to
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


class Paths:
    """Files and folders ``readable`` and ``listable``, which stay open: later this process may not be allowed
    to open them.

    Raises OSError if the kernel has no Landlock.
    """

    def __init__(self, readable: Iterable[str], listable: Iterable[str]) -> None:
        self._version = version()
        if self._version < 1:
            raise OSError("this kernel has no Landlock")
        self._rules = [
            _rule(path, READ_FILE | READ_DIR | (WRITE_FILE if path == SINK else 0)) for path in readable
        ]
        self._rules += [_rule(path, READ_DIR) for path in listable]

    def ruleset(self, own: str | None) -> int:
        """Return a descriptor of rules that allow only reading and listing below these paths, and writing
        below the folder ``own``, if there is one.
        """
        known = self._version
        rights = (1 << FILE_RIGHTS.get(known, NEWEST_FILE_RIGHTS)) - 1
        attributes = (ctypes.c_uint64 * 3)(rights, TCP if known >= 4 else 0, SCOPES if known >= 6 else 0)
        size = 8 if known < 4 else 16 if known < 6 else 24
        rules = syscall(LANDLOCK_CREATE, ctypes.byref(attributes), size, 0)
        for rule in (*self._rules, *([] if own is None else [_rule(own, OWN & rights)])):
            add_rule(rules, PATH_BENEATH, rule)
        return rules


def restrict(rules: int) -> None:
    """Apply the rules to this process. Needs no_new_privs."""
    syscall(LANDLOCK_RESTRICT, rules, 0)


def _rule(path: str, rights: int) -> bytes:
    parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
    if not stat.S_ISDIR(os.fstat(parent).st_mode):
        rights &= OF_A_FILE
    return PATH_BENEATH_ATTR.pack(rights, parent)
