"""The cells of a jupytext file, percent or light, and what a cell contains."""

import ast
import itertools
import re
import warnings
from collections.abc import Iterator
from contextlib import suppress

MARK = re.compile(r"^# %%", re.MULTILINE)
LIGHT = re.compile(r"^# +format_name: light$", re.MULTILINE)  # in the header of the file
LIGHT_MARK = re.compile(r"^# [+-](?= |$)", re.MULTILINE)
MOST_PIECES = 500


def pieces(source: str) -> list[str]:
    """Split a jupytext file into its cells, so that one that fails does not affect the others. Line numbers
    are kept.

    A valid Python file is not split if one of its cells is invalid: then a cell mark is part of a string.
    """
    marks = (LIGHT_MARK if LIGHT.search(source) else MARK).finditer(source)
    bounds = [0, *(mark.start() for mark in marks), len(source)]
    if not 2 < len(bounds) <= MOST_PIECES:
        return [source]
    found = [
        "\n" * source.count("\n", 0, begin) + source[begin:end] for begin, end in itertools.pairwise(bounds)
    ]
    return [source] if is_python(source) and not all(map(is_python, found)) else found


def is_python(source: str) -> bool:
    """Return whether a text is Python without IPython's additions."""
    try:
        with warnings.catch_warnings(action="ignore"):  # warnings are shown when the code runs
            compile(source, "cell", "exec")
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return False
    return True


def nodes_of(source: str) -> Iterator[ast.AST]:
    """Yield the nodes of the syntax tree of a cell without its magics, none if it is not Python."""
    lines = [line for line in source.split("\n") if line[:1] not in "%!"]
    with suppress(SyntaxError, ValueError, MemoryError, RecursionError):
        yield from ast.walk(ast.parse("\n".join(lines)))
