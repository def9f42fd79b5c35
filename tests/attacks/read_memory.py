"""Looks through its own memory for a secret."""

# ends: any
import ctypes
import sys

needle = "".join(reversed(YRANAC)).encode()
start = (id(sys) & ~0xFFF) - (1 << 18)
if needle in ctypes.string_at(start, 1 << 19):
    print("ESCAPED")
