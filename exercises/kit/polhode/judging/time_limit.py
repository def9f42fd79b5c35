"""A time limit for code in the notebook's own kernel, where no other process can stop it."""

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

AGAIN_S = 0.2  # a bare "except:" may swallow the first OutOfTime
KIT = str(Path(__file__).parent)


class OutOfTime(BaseException):
    """The time limit has passed. Not an Exception, so that a broad ``except`` does not swallow it."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise OutOfTime in the enclosed code after ``seconds``.

    A timer's signal does this in the main thread on Linux and macOS. Elsewhere (Windows, Pyodide, other
    threads) a trace function reads the clock at each step of Python outside the kit and the libraries. A
    debugger's trace function is left in place, and then there is no limit. Python drops a trace function that
    raised, so a bare ``except`` around the loop escapes it. Neither way ends a call that never returns to
    Python.
    """
    has_timer = hasattr(signal, "setitimer") and sys.platform != "emscripten"
    if has_timer and threading.current_thread() is threading.main_thread():
        with _timer(seconds):
            yield
    elif sys.gettrace() is None:
        with _trace(seconds):
            yield
    else:
        yield


@contextmanager
def _timer(seconds: float) -> Iterator[None]:
    def ring(signum: int, frame: FrameType | None) -> None:
        raise OutOfTime

    began, handler = time.monotonic(), signal.signal(signal.SIGALRM, ring)
    left, every = signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, handler or signal.SIG_DFL)
        if left:  # restore the notebook's own timer
            signal.setitimer(signal.ITIMER_REAL, max(left - (time.monotonic() - began), 1e-3), every)


@contextmanager
def _trace(seconds: float) -> Iterator[None]:
    deadline = time.monotonic() + seconds

    def enter(frame: FrameType, event: str, argument: Any) -> Any:
        file = frame.f_code.co_filename
        if file.startswith(KIT) or "site-packages" in file:
            return None
        frame.f_trace_opcodes = (
            True  # before Python 3.12 a loop in one line has no line events; 3.13 may send no others
        )
        return step

    def step(frame: FrameType, event: str, argument: Any) -> Any:
        if event in ("opcode", "line") and time.monotonic() > deadline:
            raise OutOfTime
        return step

    sys.settrace(enter)
    try:
        yield
    finally:
        sys.settrace(None)
