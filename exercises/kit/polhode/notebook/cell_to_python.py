"""The raw text of a cell as Python: magics and shell lines removed, and split into statements that stand
alone.
"""

import ast
import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from polhode.notebook.names import Names, calls_on, increments, names_in, stores_into

TRANSPARENT = ("%%time", "%%timeit", "%%capture", "%%prun")
"""Cell magics with ordinary Python below them. The text below other cell magics is not Python of this
notebook.
"""

SHELL_ANSWER = "get_ipython()"
"""Replaces the shell line or magic from which a statement took its value (``files = !ls``): only the notebook
knows the value.
"""

DEFINITION = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
BLOCK = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)


@dataclass(frozen=True)
class Statement:
    """One statement at the top level of a cell, or inside an ``if``, ``try``, ``with`` or loop there, as its
    own text.
    """

    text: str
    node: ast.stmt

    @property
    def names(self) -> Names:
        """Return its global names. A block does not need the names it binds itself, such as a loop's
        variable.
        """
        names = names_in(self.text)
        return (
            Names(names.now - names.bound, names.later, names.bound)
            if isinstance(self.node, BLOCK)
            else names
        )

    def binds(self, name: str) -> bool:
        """Return whether it gives ``name`` a value that does not only change the previous one."""
        return name in self.names.bound and not increments(self.node, name)

    def changes(self, name: str, calls: bool = True) -> bool:
        """Return whether it changes the value of ``name``; with ``calls``, a method called on it counts as a
        change.
        """
        return (
            increments(self.node, name)
            or stores_into(self.node, name)
            or (calls and calls_on(self.node, name))
        )

    def starts(self, name: str) -> bool:
        """Return whether it gives ``name`` a value that does not depend on the previous one."""
        return self.binds(name) and not isinstance(self.node, BLOCK) and name not in self.names.now


def without_magics(cell: str, answer: str = SHELL_ANSWER) -> str:
    """Return the cell, line for line from its first line of Python, with magics and shell lines replaced by
    ``pass``.

    ``answer`` replaces the shell line from which a statement takes its value. A syntax error of the Python
    stays. Empty for a cell magic whose text is not Python.
    """
    first, _, rest = cell.lstrip().partition("\n")
    if first.startswith("%%"):
        return without_magics(rest, answer) if first.split()[0] in TRANSPARENT else ""
    lines = (textwrap.dedent(cell) if cell.lstrip("\n").startswith((" ", "\t")) else cell).split("\n")
    for _ in lines:
        try:
            _tree("\n".join(lines))
            break
        except (SyntaxError, ValueError) as error:
            # Only the line at which Python stopped can be a magic: a % may also continue an expression or
            # stand in a string.
            if not _replace_magic(lines, (getattr(error, "lineno", None) or 1) - 1, answer):
                break
    return "\n".join(lines)


@lru_cache(maxsize=2048)
def _tree(text: str) -> ast.Module:
    return ast.parse(text)


@lru_cache(maxsize=2048)
def python_of(cell: str, answer: str = SHELL_ANSWER) -> str | None:
    """Return the cell ``without_magics``, None if it is not Python."""
    text = without_magics(cell, answer)
    try:
        _tree(text)
    except (SyntaxError, ValueError):
        return None
    return None if cell.strip() and not text else text


@lru_cache(maxsize=2048)
def statements_of(cell: str) -> tuple[Statement, ...]:
    """Return the top-level statements of a cell; empty if it is not Python."""
    text = python_of(cell) or ""
    found = tuple(Statement(_cut(text.split("\n"), node), node) for node in _tree(text).body)
    measured_only = cell.lstrip().startswith("%%timeit")  # binds nothing in the notebook
    return tuple(s for s in found if isinstance(s.node, DEFINITION)) if measured_only else found


def unfold(statement: Statement) -> Iterator[Statement]:
    """Yield the statement, or those inside it if it is a block."""
    if not isinstance(statement.node, BLOCK):
        yield statement
        return
    lines = statement.text.split("\n")
    for node in _in_block(ast.parse(statement.text)):
        yield Statement(_cut(lines, node), node)


def _replace_magic(lines: list[str], at: int, answer: str) -> bool:
    """Replace the magic in that line by Python. Return False if there is none."""
    line = lines[at] if at < len(lines) else ""
    bare = line.lstrip()
    indent = line[: len(line) - len(bare)]
    asked = re.match(r"([^=!%'\"#()]+=)\s*[!%]", bare)
    if bare.startswith("%time "):
        lines[at] = indent + bare.removeprefix("%time ").lstrip()
    elif bare.startswith(("%", "!", "?")) or bare.rstrip().endswith("?"):
        lines[at] = indent + "pass"
    elif asked:
        lines[at] = f"{indent}{asked[1]} {answer}"
    else:
        return False
    while line.endswith("\\") and at + 1 < len(lines):
        at += 1
        line, lines[at] = lines[at], ""
    return True


def _cut(lines: list[str], node: ast.stmt) -> str:
    """Return the statement's own lines. An indented one gets an ``if True:`` above it."""
    first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
    block = lines[first - 1 : node.end_lineno]
    if isinstance(node, DEFINITION + BLOCK):
        return "\n".join(["if True:", *block] if node.col_offset else block)
    block[-1] = block[-1].encode()[: node.end_col_offset].decode()  # columns are counted in bytes
    block[0] = block[0].encode()[node.col_offset :].decode()
    return "\n".join(block)


def _in_block(block: ast.AST) -> Iterator[ast.stmt]:
    for child in ast.iter_child_nodes(block):
        if isinstance(child, ast.stmt) and not isinstance(child, BLOCK):
            yield child
        elif isinstance(child, (*BLOCK, ast.ExceptHandler, ast.match_case)):
            yield from _in_block(child)
