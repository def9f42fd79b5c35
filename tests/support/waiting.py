"""Wait for a condition, in tests."""

import time


def wait_for(found, seconds=30.0):
    """Return what ``found()`` returns as soon as that is true; AssertionError if it never is."""
    until = time.monotonic() + seconds
    while not (answer := found()):
        assert time.monotonic() < until, "not in time"
        time.sleep(0.05)
    return answer
