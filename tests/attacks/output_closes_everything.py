"""Closes every descriptor."""

# ends: fail
import os

os.closerange(0, 4096)


def euler_eqs(t, w, I):
    return w
