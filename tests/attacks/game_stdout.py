"""Replaces standard output by an object that raises."""

# ends: any
import sys


class Broken:
    def write(self, text):
        raise RuntimeError("no")

    flush = write


sys.stdout = sys.stderr = sys.__stdout__ = Broken()
