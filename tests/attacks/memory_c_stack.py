"""Overflows the C stack by a deeply nested representation."""

# ends: fail slow
import sys

nested = []
for _ in range(10**6):
    nested = [nested]
sys.setrecursionlimit(10**9)
repr(nested)
