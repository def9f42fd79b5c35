"""Calling the C library and the kernel through ctypes; every failure raises OSError."""

import ctypes
import os
from typing import Any

_libc = ctypes.CDLL(None, use_errno=True)
_libc.syscall.restype = ctypes.c_long


def call(name: str, *args: Any) -> None:
    """A function of the C library that answers 0, or fails."""
    if getattr(_libc, name)(*args) != 0:
        raise _error(name)


def syscall(number: int, *args: Any) -> int:
    """A system call the C library has no function for."""
    answer = int(_libc.syscall(ctypes.c_long(number), *(ctypes.c_long(a) if isinstance(a, int) else a for a in args)))
    if answer < 0:
        raise _error(f"system call {number}")
    return answer


def _error(what: str) -> OSError:
    number = ctypes.get_errno()
    return OSError(number, f"{what}: {os.strerror(number)}")
