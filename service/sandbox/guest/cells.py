"""Notebook cells as Python: magics and shell lines are taken out the way a plain interpreter needs it."""

import types

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


def _without_magics(source: str) -> str:
    first, _, rest = source.lstrip().partition("\n")
    if first.startswith("%%"):
        return "\n" + _without_magics(rest) if first.split()[0] in TRANSPARENT else ""
    return "\n".join(_blank(line) for line in source.split("\n"))


def _blank(line: str) -> str:
    """``pass`` in the place of a line magic or shell command, so that line numbers and indentation stay."""
    bare = line.lstrip()
    return line[: len(line) - len(bare)] + "pass" if bare.startswith(("%", "!")) else line
