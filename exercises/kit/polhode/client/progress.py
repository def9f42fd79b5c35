"""One line of progress, rewritten in place where the front end supports it."""

import sys
from typing import Any


class Line:
    """A line of text in a notebook cell's output or on a terminal. In a log each state is a line."""

    def __init__(self) -> None:
        self._shown = ""
        self._handle = _handle()

    def show(self, text: str) -> None:
        """Show ``text`` in place of the previous text."""
        if text == self._shown:
            return
        if self._handle is not None:
            self._handle.update({"text/plain": text}, raw=True)
        elif sys.stdout.isatty():
            print("\r" + text.ljust(len(self._shown)), end="", flush=True)
        else:
            print(text, flush=True)
        self._shown = text

    def end(self, text: str) -> None:
        """Show ``text`` and end the line."""
        self.show(text)
        if self._handle is None and sys.stdout.isatty():
            print()


def _handle() -> Any:
    try:
        from IPython import get_ipython
        from IPython.display import display
    except ImportError:
        return None
    shell = get_ipython()
    if shell is None or not hasattr(shell, "kernel"):
        return None
    return display({"text/plain": "…"}, raw=True, display_id=True)
