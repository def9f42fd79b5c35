"""Hooks on the end of the interpreter and on collected objects."""

# ends: any
import atexit
import os


class Last:
    def __del__(self):
        os.write(1, b"deleted\n")


keep = Last()
atexit.register(os._exit, 0)
