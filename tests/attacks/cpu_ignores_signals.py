"""Ignores every signal, then loops."""

# ends: fail slow
import signal

for number in range(1, 65):
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass


def euler_eqs(t, w, I):
    while True:
        pass
