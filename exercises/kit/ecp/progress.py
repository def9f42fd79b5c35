"""One line that tells how far something is, rewritten in its place where the front end can do that."""

import sys
from typing import Any


class Line:
    """A line of plain text in the output of a cell, on a terminal, or, once for each state, in a log."""

    def __init__(self) -> None:
        self._shown = ""
        self._handle = _handle()

    def tell(self, text: str) -> None:
        """Show ``text`` in the place of what was shown before."""
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
        """Show ``text`` and leave it there."""
        self.tell(text)
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
