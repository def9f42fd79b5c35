"""Stops Python's clocks and tries to set the machine's."""

# ends: fail slow
import ctypes
import time

time.time = time.perf_counter = time.monotonic = lambda: 0.0
attempt("clock_settime", lambda: raw(227, 0, (ctypes.c_long * 2)(0, 0)))
attempt("adjtimex", lambda: raw(159, (ctypes.c_char * 256)()))


def euler_eqs(t, w, I):
    while True:
        pass
