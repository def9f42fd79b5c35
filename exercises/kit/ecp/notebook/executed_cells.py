"""All cells that ran, as one text for a server that handles line magics."""

import ast
from collections.abc import Sequence

from ecp.notebook.cells import SHELL_ANSWER, python_of, statements_of


def whole(cells: Sequence[str]) -> list[str]:
    """Return the cells that ran as texts that a server can read one by one or joined.

    Of a cell that ran several times only the last run counts, unless it builds on its own results, as ``k = 2
    * k`` does. Magics stay if a server can replace their lines by ``pass``. Cells that are not Python become
    comments.
    """
    modules = {n for c in cells for s in statements_of(c) if isinstance(s.node, ast.Import | ast.ImportFrom) for n in s.names.bound}
    counts = [cell not in cells[place + 1 :] or _builds_on_itself(cell, modules) for place, cell in enumerate(cells)]
    last = [cell for cell, kept in zip(cells, counts, strict=True) if kept and cell.strip()]
    # A server finds magics by their first character, which must then not begin a line of ordinary Python.
    keep = not any(_looks_magic(line) for cell in last for line in (python_of(cell) or "").split("\n"))
    return [_readable(cell, keep) for cell in last]


def _builds_on_itself(cell: str, modules: set[str]) -> bool:
    """Return whether the cell changes what it reads, so that running it twice differs from running it once."""
    statements, done = statements_of(cell), set(modules)
    bound = {name for s in statements for name in s.names.bound}
    for s in statements:
        before = s.names.now - done
        if before & bound or any(s.changes(name) for name in before):
            return True
        done |= s.names.bound
    return False


def _readable(cell: str, keep_magics: bool) -> str:
    python = python_of(cell)
    if python is None:
        return "\n".join(["# This cell is not Python, so it does not run here:", *(f"# {line}" for line in cell.split("\n"))])
    lines = python.split("\n")
    raw = cell.split("\n")
    heads = raw[: len(raw) - len(lines)]
    kept = [head if keep_magics and _looks_magic(head) else _comment(head) for head in heads]
    return "\n".join(kept + [_line(*pair, keep_magics) for pair in zip(raw[len(heads) :], lines, strict=True)])


def _line(raw: str, python: str, keep_magics: bool) -> str:
    if python.endswith(SHELL_ANSWER) and SHELL_ANSWER not in raw:
        return f"{python.removesuffix(SHELL_ANSWER)}None  # {raw.strip()}"
    if python.strip() != "pass" or raw.strip() == python.strip():
        return python
    return raw if keep_magics and _looks_magic(raw) and not raw.endswith("\\") else f"{python}  {_comment(raw)}".rstrip()


def _looks_magic(line: str) -> bool:
    return line.lstrip().startswith(("%", "!"))


def _comment(line: str) -> str:
    return f"# {line.strip()}" if line.strip() else ""
