"""Stops its own process."""

# ends: fail slow
import os
import signal


def euler_eqs(t, w, I):
    os.kill(os.getpid(), signal.SIGSTOP)
