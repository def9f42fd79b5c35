"""The cells of a notebook in the order they ran, searched by name."""

import ast
import re
import unicodedata
from collections.abc import Iterator, Sequence
from functools import cached_property

from polhode.notebook.cell_to_python import DEFINITION, Statement, statements_of, unfold


class History:
    """The cells in the order they ran, oldest first."""

    def __init__(self, cells: Sequence[str]) -> None:
        self._cells = cells

    def statements(self, name: str) -> list[Statement]:
        """Return the top-level statements whose text mentions ``name``, oldest first."""
        return [
            s
            for cell in self._cells
            if _mentions(cell, name)
            for s in statements_of(cell)
            if _mentions(s.text, name)
        ]

    def definitions(self, name: str) -> Iterator[tuple[Statement, list[Statement]]]:
        """Yield every ``def name``, ``class name`` and ``name = lambda``, in blocks too, newest first, each
        with the statements after it.
        """
        every = self.statements(name)
        for place in reversed(range(len(every))):
            for inner in reversed(list(unfold(every[place]))):
                if _defines(inner.node, name):
                    yield inner, every[place + 1 :]

    @cached_property
    def imports(self) -> list[ast.Import | ast.ImportFrom]:
        """Return every import outside functions, newest first."""
        found = [
            s.node
            for cell in self._cells
            if "import" in cell
            for top in statements_of(cell)
            for s in unfold(top)
        ]
        return [node for node in reversed(found) if isinstance(node, ast.Import | ast.ImportFrom)]

    @cached_property
    def modules(self) -> set[str]:
        """Return the full names of all modules that are imported or imported from."""
        plain = {alias.name for node in self.imports if isinstance(node, ast.Import) for alias in node.names}
        return plain | {
            node.module for node in self.imports if isinstance(node, ast.ImportFrom) and node.module
        }

    @cached_property
    def futures(self) -> list[str]:
        """Return the imports from ``__future__``: they hold for all later cells."""
        found = [
            node for node in self.imports if isinstance(node, ast.ImportFrom) and node.module == "__future__"
        ]
        return sorted({ast.unparse(node) for node in found})


def _mentions(text: str, name: str) -> bool:
    """Return whether ``name`` occurs, without parsing. Python normalizes identifiers:
    φ and ϕ are one name.
    """
    plain = text if text.isascii() else unicodedata.normalize("NFKC", text)
    return name in plain and re.search(rf"\b{name}\b", plain) is not None


def _defines(node: ast.stmt, name: str) -> bool:
    if isinstance(node, ast.Assign) and isinstance(node.value, ast.Lambda):
        return any(isinstance(target, ast.Name) and target.id == name for target in node.targets)
    return isinstance(node, DEFINITION) and node.name == name
