"""Progress of a batch: a status line on a terminal, and each file's report as soon as it is ready."""

import sys
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import TextIO

from service.formats.check_text import one_line, sanitize
from service.grading.graded_file import GradedFile

CLEAR = "\r\x1b[K"


class Progress:
    """Progress of ``total`` files; the status line counts the good ones as ``kind``.

    The status line goes to standard error, and only to a terminal. ``escape`` is applied to all printed text
    where a line could be a workflow command. All text then goes to standard output, because escaping opened
    on one stream could be closed on the other.
    """

    def __init__(self, total: int, kind: str = "all ✓", escape: Callable[[str], str] | None = None) -> None:
        self._total, self._kind, self._escape = total, kind, escape
        self._done = self._good = 0
        self._live = total > 1 and sys.stderr.isatty()
        self._began, self._lock = time.monotonic(), threading.Lock()

    def __enter__(self) -> "Progress":
        self._draw()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._clear()

    def update(self, done: int) -> None:
        """Set the number of finished files; callable from any thread."""
        with self._lock:
            self._done = done
            self._draw()

    def show(self, file: GradedFile, *, text: bool) -> None:
        """Print a file's report (if ``text``), or the reason why it has none."""
        name = sanitize(str(file.file)).replace("\n", "\ufffd")  # a line break could start a workflow command
        if file.report is None:
            self.print(f"polhode: {name}: {one_line(file.why)}", good=False, to=sys.stderr)
        else:
            self.print(f"== {name}\n{file.report.text()}" if text else "", good=file.passed)

    def print(self, text: str, *, good: bool, to: TextIO | None = None) -> None:
        """Print the ``text`` of one file, if any, and count the file as good or not."""
        with self._lock:
            self._clear()
            self._good += good
            if text:
                print(
                    self._escape(text) if self._escape else text,
                    file=None if self._escape else to,
                    flush=True,
                )
            self._draw()

    def _draw(self) -> None:
        if self._live:
            seconds = time.monotonic() - self._began
            line = f"{self._done} of {self._total} graded, {self._good} {self._kind} so far, {seconds:.0f} s"
            print(CLEAR + line, end="", file=sys.stderr, flush=True)

    def _clear(self) -> None:
        if self._live:
            print(CLEAR, end="", file=sys.stderr, flush=True)
