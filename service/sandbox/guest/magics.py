"""Notebook cells as plain Python: magics and shell commands are removed. Which cells define a function."""

import ast
import itertools
import re
import types
import warnings
from collections.abc import Collection, Iterable
from typing import Any

from ecp.notebook.cells import DEFINITION, without_magics
from ecp.notebook.names import names_in

MARK = re.compile(r"^# %%", re.MULTILINE)
MOST_PIECES = 500
DEFINITIONS = (*DEFINITION, ast.Import, ast.ImportFrom)


def runnable(source: str, name: str) -> types.CodeType:
    """Compile a cell under the file name ``name``. Magics are removed only from a cell that is not valid
    Python.
    """
    return _compiled(source, name, 0)


def statements(source: str, name: str, kinds: tuple[type, ...] = (ast.stmt,)) -> list[types.CodeType]:
    """Compile each top-level statement of a cell that is of one of the ``kinds``."""
    every: list[ast.stmt] = _compiled(source, name, ast.PyCF_ONLY_AST).body
    nodes = [node for node in every if isinstance(node, kinds)]
    future = [node for node in nodes if isinstance(node, ast.ImportFrom) and node.module == "__future__"]
    return [compile(ast.Module([*future, node], []), name, "exec") for node in nodes]


def _compiled(source: str, name: str, flags: int) -> Any:
    try:
        return compile(source, name, "exec", flags)
    except SyntaxError:
        python = without_magics(source, answer="None")
        if python == source:
            raise
        return compile("\n" * (source.count("\n") - python.count("\n")) + python, name, "exec", flags)


def pieces(source: str) -> list[str]:
    """Split a py:percent file into its cells, so that one that fails does not affect the others. Line numbers
    are kept.

    A valid Python file is not split if one of its cells is invalid: then a cell mark is part of a string.
    """
    bounds = [0, *(mark.start() for mark in MARK.finditer(source)), len(source)]
    if not 2 < len(bounds) <= MOST_PIECES:
        return [source]
    found = [
        "\n" * source.count("\n", 0, begin) + source[begin:end] for begin, end in itertools.pairwise(bounds)
    ]
    return [source] if _is_python(source) and not all(map(_is_python, found)) else found


def needed_sources(sources: Iterable[str], names: Collection[str]) -> set[str]:
    """Return the sources that bind one of ``names`` or of the names that such sources use.

    Those that are no valid Python and those that import * are among them, as their names are not known. A
    source that changes an object without binding its name is left out.
    """
    found = {source: names_in(source) for source in sources}
    needed = {
        source for source, its in found.items() if "import *" in source or not its.bound | its.now | its.later
    }
    wanted, grown = set(names), True
    while grown:
        more = {source for source, its in found.items() if its.bound & wanted} - needed
        wanted |= {name for source in needed | more for name in found[source].now | found[source].later}
        needed, grown = needed | more, bool(more)
    return needed


def last_name(source: str) -> str:
    """Return the name on a cell's last line, which a notebook displays, or an empty string."""
    last = source.rstrip().rpartition("\n")[2]
    return last if last.isidentifier() else ""


def _is_python(source: str) -> bool:
    try:
        with warnings.catch_warnings(action="ignore"):  # warnings are shown when the code runs
            compile(source, "cell", "exec")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return False
    return True
