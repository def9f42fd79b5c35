"""The author's notebook beside ``assignment.py``: its cells, its Setup and its errors."""

import ast
import hashlib
import json
import re
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polhode.notebook.cell_to_python import DEFINITION, python_of, statements_of, without_magics

# tags of cells that students must not see, that install the kit, and that only look at results
SOLUTION, INSTALL, LOOK = "solution", "install", "look"
NUMBER = re.compile(r"\d+[a-z]?(\.\d+)*")  # of an exercise
SEPARATOR = r"[\s.:,;)·\u2010-\u2015\u2212-]*"  # between the number and the title in a heading
_FENCED = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
_HEADING = re.compile(r"^(#{1,6})[ \t]+(.+?)[ \t#]*$", re.MULTILINE)
_SETUP = re.compile(r"[\d.\s]*setup\W*", re.IGNORECASE)
_DEFINED = re.compile(r"^\s*(?:async def|def|class)\s+(\w+)", re.MULTILINE)
_VALID_ID = re.compile(r"[a-zA-Z0-9_-]{1,64}")


class InvalidNotebook(ValueError):
    """The file is no notebook that polhode can read. The message starts with the file's name."""


@dataclass(frozen=True)
class Cell:
    """One cell: ``kind`` is "markdown", "code" or "raw". ``attachments`` are the pictures that its text
    shows.
    """

    kind: str
    source: str
    id: str = ""
    tags: tuple[str, ...] = ()
    attachments: Mapping[str, Any] = field(default_factory=dict)

    @property
    def headings(self) -> list[tuple[int, str]]:
        """The level and text of each heading of a markdown cell."""
        text = _FENCED.sub("", self.source) if self.kind == "markdown" else ""
        return [(len(marks), heading) for marks, heading in _HEADING.findall(text)]

    @property
    def nodes(self) -> list[ast.AST]:
        """All nodes of the syntax trees of a code cell's statements."""
        return (
            [node for s in statements_of(self.source) for node in ast.walk(s.node)]
            if self.kind == "code"
            else []
        )

    def is_solution(self, names: Collection[str]) -> bool:
        """Return whether the cell is tagged as a solution or binds one of the ``names``."""
        return SOLUTION in self.tags or bool(self.bound() & set(names))

    def bound(self) -> set[str]:
        """Return the global names that a code cell binds, or defines below a magic such as %%writefile."""
        if self.kind != "code":
            return set()
        if python_of(self.source) is None:
            return set(_DEFINED.findall(self.source))
        return {name for s in statements_of(self.source) for name in s.names.bound}


def read(path: Path) -> list[Cell]:
    """Return the cells of a notebook, with valid and unique ids. Raises InvalidNotebook."""
    try:
        cells = parse(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        missing = isinstance(error, FileNotFoundError)
        raise InvalidNotebook(
            f"{path.name} {'is missing' if missing else 'cannot be read as UTF-8 text'}"
        ) from error
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise InvalidNotebook(
            f"{path.name} is not a Jupyter notebook (format 4): save it again with Jupyter"
        ) from error
    if not any(cell.kind == "code" for cell in cells):
        raise InvalidNotebook(f"{path.name} has no code cells")
    return cells


def parse(text: str) -> list[Cell]:
    """Return the cells of a notebook's JSON."""
    return [_cell(cell) for cell in json.loads(text)["cells"]]


def errors(cells: Sequence[Cell]) -> Iterator[str]:
    """Yield the errors of a notebook, without the file's name."""
    for number, cell in enumerate((cell for cell in cells if cell.kind == "code"), 1):
        if python_of(cell.source) is None and not cell.source.lstrip().startswith("%%"):
            yield f"code cell {number} is not valid Python: {_syntax_error(cell.source)}"


def setup(cells: Sequence[Cell], names: Collection[str]) -> str:
    """Return the Setup as Python without magics: the code under the heading "Setup", else the code before the
    first solution.

    It ends at the next heading of that level and contains neither a solution, one of the ``names``, nor the
    kit's installation.
    """
    start, end = _setup_region(cells, names)
    taken = [
        python_of(cell.source) or ""
        for cell in cells[start:end]
        if cell.kind == "code" and INSTALL not in cell.tags
    ]
    return "\n\n".join(text.strip("\n") for text in taken) + "\n"


def given_constants(cells: Sequence[Cell], names: Collection[str]) -> str:
    """Return the constants, imports and functions of given cells behind the Setup, as Python.

    What needs a solution, one of the ``names``, or calls anything but a function of a module is left out, and
    so is what a cell with the tag "look" defines.
    """
    _, end = _setup_region(cells, names)
    unknown, taken = set(names), list[str]()
    for cell in (c for c in cells[end:] if c.kind == "code" and not {INSTALL, LOOK} & set(c.tags)):
        is_solution = cell.is_solution(names)
        for statement in statements_of(cell.source):
            needed = statement.names.now | statement.names.later
            if not is_solution and _is_constant(statement.node) and not needed & unknown:
                taken.append(statement.text.strip("\n") + "\n")
            else:
                unknown |= statement.names.bound
    return "".join(f"\n{text}" for text in taken)


def setup_with_constants(cells: Sequence[Cell], names: Collection[str]) -> str:
    """Return the Setup, and behind it the constants of given cells."""
    return setup(cells, names) + given_constants(cells, names)


def _setup_region(cells: Sequence[Cell], names: Collection[str]) -> tuple[int, int]:
    """Return the first cell of the Setup and the one behind its last."""
    marked = [
        (at, level)
        for at, cell in enumerate(cells)
        for level, text in cell.headings
        if _SETUP.fullmatch(text)
    ]
    first, level = marked[0] if marked else (-1, 0)
    for at, cell in enumerate(cells[first + 1 :], first + 1):
        if cell.is_solution(names) or any(other <= level for other, _ in cell.headings):
            return first + 1, at
    return first + 1, len(cells)


def _is_constant(node: ast.AST) -> bool:
    """Whether a statement imports, defines, or assigns what is computed by functions of modules only."""
    if isinstance(node, (*DEFINITION, ast.Import, ast.ImportFrom)):
        return True
    calls = [n.func for n in ast.walk(node) if isinstance(n, ast.Call)]
    return isinstance(node, ast.Assign | ast.AnnAssign) and all(isinstance(f, ast.Attribute) for f in calls)


def with_ids(cells: Sequence[Cell]) -> list[tuple[str, Cell]]:
    """Return each cell with a valid and unique id: its own, else one that depends only on its text."""
    used: set[str] = set()
    found = []
    for cell in cells:
        id = (
            cell.id
            if _VALID_ID.fullmatch(cell.id)
            else hashlib.sha256(f"{cell.kind} {cell.source}".encode()).hexdigest()[:8]
        )
        free = next(
            name for k in range(1, len(cells) + 1) if (name := f"{id[:58]}-{k}" if k > 1 else id) not in used
        )
        used.add(free)
        found.append((free, cell))
    return found


def _cell(cell: Mapping[str, Any]) -> Cell:
    source = cell["source"] if isinstance(cell["source"], str) else "".join(cell["source"])
    source.encode()  # raises ValueError for half of a surrogate pair
    kind, code = str(cell["cell_type"]), cell["cell_type"] == "code"
    if code and source.lstrip("\n").startswith((" ", "\t")):
        source = textwrap.dedent(source)
    shown = {
        name: picture
        for name, picture in cell.get("attachments", {}).items()
        if f"attachment:{name}" in source
    }
    tags = tuple(map(str, cell.get("metadata", {}).get("tags", ())))
    return Cell(kind, source, str(cell.get("id", "")), tags, {} if code else shown)


def _syntax_error(source: str) -> str:
    try:
        compile(without_magics(source), "cell", "exec")
    except (SyntaxError, ValueError) as error:
        return f"line {getattr(error, 'lineno', 1)}: {getattr(error, 'msg', error)}"
    return ""
