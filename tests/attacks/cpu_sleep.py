"""Sleeps, which costs no CPU time."""

# ends: fail slow
import time


def euler_eqs(t, w, I):
    time.sleep(1e8)
