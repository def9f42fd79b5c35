"""Alarms with handlers that raise in the harness."""

# ends: any
import signal


def boo(*args):
    raise RuntimeError("boo")


for number in (signal.SIGALRM, signal.SIGCHLD, signal.SIGPIPE, signal.SIGUSR1):
    signal.signal(number, boo)
try:
    signal.setitimer(signal.ITIMER_REAL, 1e-4, 1e-4)
except OSError as error:
    print(error)
