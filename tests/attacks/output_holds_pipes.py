"""Copies its descriptors and leaves."""

# ends: fail
import os

for _ in range(20):
    try:
        os.dup(RESULT)
    except OSError:
        break
os._exit(0)
