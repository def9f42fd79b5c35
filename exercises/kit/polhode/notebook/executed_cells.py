"""All cells that ran, as Python."""

import ast
from collections.abc import Sequence

from polhode.notebook.cell_to_python import python_of, statements_of


def whole(cells: Sequence[str]) -> list[str]:
    """Return the cells that ran as Python texts that run one by one or joined.

    Of a cell that ran several times only the last run counts, unless it builds on its own results, as ``k = 2
    * k`` does. Magics, and cells that are not Python, become comments.
    """
    modules = {
        n
        for c in cells
        for s in statements_of(c)
        if isinstance(s.node, ast.Import | ast.ImportFrom)
        for n in s.names.bound
    }
    counts = [
        cell not in cells[place + 1 :] or _builds_on_itself(cell, modules) for place, cell in enumerate(cells)
    ]
    return [_readable(cell) for cell, kept in zip(cells, counts, strict=True) if kept and cell.strip()]


def _builds_on_itself(cell: str, modules: set[str]) -> bool:
    """Return whether the cell changes what it reads, so that running it twice differs from running it
    once.
    """
    statements, done = statements_of(cell), set(modules)
    bound = {name for s in statements for name in s.names.bound}
    for s in statements:
        before = s.names.now - done
        if before & bound or any(s.changes(name) for name in before):
            return True
        done |= s.names.bound
    return False


def _readable(cell: str) -> str:
    raw, python = cell.split("\n"), python_of(cell, answer="None")
    if python is None:
        return "\n".join(
            ["# This cell is not Python, so it does not run here:", *(f"# {line}" for line in raw)]
        )
    pairs = zip([""] * (cell.count("\n") - python.count("\n")) + python.split("\n"), raw, strict=True)
    changed = [(line, "" if line.strip() == typed.strip() else f"# {typed.strip()}") for line, typed in pairs]
    return "\n".join("  ".join(filter(None, pair)) for pair in changed)
