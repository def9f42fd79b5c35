"""How far a batch is: a line that is written over on a terminal, and each file's report as soon as it is its turn."""

import sys
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import TextIO

from service.formats.check_text import one_line, sanitize
from service.grading.result import GradedFile

CLEAR = "\r\x1b[K"


class Progress:
    """Of ``total`` files, of which those shown as good are ``kind``. The live line goes to standard error, only to a terminal.

    ``guard`` makes words of students fit to be printed where a line can be a command; all of them then go to standard output, as
    a guard that is opened on one stream may be closed by the other.
    """

    def __init__(self, total: int, kind: str = "all ✓", guard: Callable[[str], str] | None = None) -> None:
        self._total, self._kind, self._guard, self._done, self._good = total, kind, guard, 0, 0
        self._live, self._began, self._lock = total > 1 and sys.stderr.isatty(), time.monotonic(), threading.Lock()

    def __enter__(self) -> "Progress":
        self._draw()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._clear()

    def tell(self, done: int) -> None:
        """So many files are done; from any thread."""
        with self._lock:
            self._done = done
            self._draw()

    def show(self, file: GradedFile, *, text: bool) -> None:
        """Print a file's report (``text``), or why there is none."""
        name = sanitize(str(file.file)).replace("\n", "\ufffd")  # a line of its own could be a command where it is printed
        if file.report is None:
            self.say(f"polhode: {name}: {one_line(file.why)}", good=False, to=sys.stderr)
        else:
            self.say(f"== {name}\n{file.report.text()}" if text else "", good=file.passed)

    def say(self, words: str, *, good: bool, to: TextIO | None = None) -> None:
        """Print the ``words`` for one file, if there are any."""
        with self._lock:
            self._clear()
            self._good += good
            if words:
                print(self._guard(words) if self._guard else words, file=None if self._guard else to, flush=True)
            self._draw()

    def _draw(self) -> None:
        if self._live:
            seconds = time.monotonic() - self._began
            line = f"{self._done} of {self._total} graded, {self._good} {self._kind} so far, {seconds:.0f} s"
            print(CLEAR + line, end="", file=sys.stderr, flush=True)

    def _clear(self) -> None:
        if self._live:
            print(CLEAR, end="", file=sys.stderr, flush=True)
