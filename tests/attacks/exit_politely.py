"""Leaves by sys.exit in the function."""

# ends: fail
import sys


def euler_eqs(t, w, I):
    sys.exit(0)
