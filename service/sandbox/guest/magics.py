"""Notebook cells as Python: magics and shell lines are taken out the way a plain interpreter needs it."""

import itertools
import re
import types
import warnings

MARK = re.compile(r"^# %%", re.MULTILINE)
MOST_PIECES = 500
# A cell magic that only measures or captures leaves Python below it; any other means the cell is not Python.
TRANSPARENT = ("%%time", "%%timeit", "%%capture", "%%prun")


def runnable(source: str, name: str) -> types.CodeType:
    """The cell compiled under ``name``; only a cell that is not Python as it stands is cleaned of its magics first."""
    try:
        return compile(source, name, "exec")
    except SyntaxError:
        cleaned = _without_magics(source)
        if cleaned == source:
            raise
        return compile(cleaned, name, "exec")


def pieces(source: str) -> list[str]:
    """Split a py:percent file into its cells, so that one that fails does not cost the others; line numbers stay.

    A file that is Python is left whole where a cell of it is not: its mark stands in a string.
    """
    bounds = [0, *(mark.start() for mark in MARK.finditer(source)), len(source)]
    if not 2 < len(bounds) <= MOST_PIECES:
        return [source]
    found = ["\n" * source.count("\n", 0, begin) + source[begin:end] for begin, end in itertools.pairwise(bounds)]
    return [source] if _is_python(source) and not all(map(_is_python, found)) else found


def last_name(source: str) -> str:
    """The name that a cell ends with, which a notebook shows, or an empty string."""
    last = source.rstrip().rpartition("\n")[2]
    return last if last.isidentifier() else ""


def _is_python(source: str) -> bool:
    try:
        with warnings.catch_warnings(action="ignore"):  # given when the code runs
            compile(source, "cell", "exec")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return False
    return True


def _without_magics(source: str) -> str:
    first, _, rest = source.lstrip().partition("\n")
    if first.startswith("%%"):
        return "\n" + _without_magics(rest) if first.split()[0] in TRANSPARENT else ""
    return "\n".join(_blank(line) for line in source.split("\n"))


def _blank(line: str) -> str:
    """``pass`` in the place of a line magic or shell command, so that line numbers and indentation stay."""
    bare = line.lstrip()
    return line[: len(line) - len(bare)] + "pass" if bare.startswith(("%", "!")) else line
