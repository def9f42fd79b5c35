"""The solutions of the author's notebook: functions, classes and cells, found by the names that they
define.
"""

import ast
import contextlib
import functools
import inspect
import io
import threading
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from exercises.authoring.questions import author_notebook
from exercises.authoring.questions.author_notebook import Cell
from polhode.notebook.cell_to_python import DEFINITION, Statement, statements_of

_WORKING_FOLDER = threading.RLock()
"""Held while a Setup runs: a process has one working folder."""


IN_JUPYTER: Mapping[str, Any] = {"display": lambda *shown, **named: None, "get_ipython": lambda: None}
"""The names that Jupyter adds, which a Setup may use: here they do nothing."""


class NoSolution(LookupError):
    """The notebook does not define a solution, or defines it more than once; the message says which."""


class NotebookSolution:
    """One right solution: its name, its source, and what it is called with. It runs when it is first
    called.
    """

    def __init__(self, solutions: "Solutions", name: str, source: str, node: ast.AST | None) -> None:
        self.solutions, self.__name__, self.source = solutions, name, source
        self.__signature__ = _signature(node)
        self.is_function = isinstance(node, ast.FunctionDef)

    @property
    def names(self) -> Mapping[str, Any]:
        """The global names of the notebook: those of its Setup, of given cells and of all solutions."""
        return self.solutions.names

    def __call__(self, *values: Any, **named: Any) -> Any:
        """Call the solution."""
        return self.names[self.__name__](*values, **named)


class Solutions:
    """The solutions in the ``cells`` of the author's notebook in ``folder``.

    ``asked`` are the names that questions ask for.
    """

    def __init__(self, cells: Sequence[Cell], folder: Path) -> None:
        self.cells, self.folder = cells, folder
        self.asked: set[str] = set()
        self._found: dict[str, NotebookSolution] = {}

    @functools.cached_property
    def bound(self) -> frozenset[str]:
        """The global names that the notebook's cells bind."""
        return frozenset(name for cell in self.cells for name in cell.bound())

    def function(self, name: str) -> NotebookSolution:
        """Return the function or class that a cell defines. Raises NoSolution."""
        found = [s for _, s in self._statements(name) if isinstance(s.node, DEFINITION)]
        if not found:
            raise NoSolution(f"no cell of the notebook defines the function {name}")
        if len(found) > 1:
            raise NoSolution(
                f"{len(found)} cells of the notebook define {name}: keep one, which is the solution"
            )
        return self._solution(name, _text_of(found[0]), found[0].node)

    def is_variable(self, name: str) -> bool:
        """Return whether a cell assigns the name, and none defines a function or class of it."""
        found = self._statements(name)
        return bool(found) and not any(isinstance(s.node, DEFINITION) for _, s in found)

    def cell(self, names: Sequence[str]) -> NotebookSolution:
        """Return the cell that assigns the variables ``names``. Raises NoSolution."""
        number = {name: sorted({k for k, _ in self._statements(name)}) for name in names}
        if absent := [name for name in names if not number[name]]:
            raise NoSolution(f"no solution cell of the notebook assigns {', '.join(absent)}")
        found = sorted({k for cells in number.values() for k in cells})
        if len(found) > 1:
            places = "; ".join(
                f"{name} in code cell {', '.join(map(str, at))}" for name, at in number.items()
            )
            raise NoSolution(
                f"one solution cell must assign {', '.join(names)}, but they are assigned in several:"
                f" {places}"
            )
        return self._solution(names[0], self._code[found[0] - 1].source.strip("\n"), None)

    @functools.cached_property
    def names(self) -> Mapping[str, Any]:
        """The global names after Setup, given constants, and the definitions of all solution cells ran. They
        run in the assignment's folder, where its data files are, as in the sandbox.

        A package that is not installed here, such as the course's, is left out with what needs it at once.
        """
        found: dict[str, Any] = {"__name__": f"solutions of {self.folder.name}", **IN_JUPYTER}
        absent = set[str]()
        # what the Setup prints is not for the output of a command
        with _WORKING_FOLDER, contextlib.chdir(self.folder), contextlib.redirect_stdout(io.StringIO()):
            for statement in self._all_statements:
                if _is_missing(statement.node) or statement.names.now & absent:
                    absent |= statement.names.bound
                else:
                    body = ast.Module([statement.node], [])
                    exec(compile(body, str(self.folder / "notebook"), "exec"), found)
        return found

    @functools.cached_property
    def _all_statements(self) -> list[Statement]:
        setup = author_notebook.setup_with_constants(self.cells, self.asked)
        solved = [s for c in self._code if c.is_solution(self.asked) for s in statements_of(c.source)]
        kept = (*DEFINITION, ast.Import, ast.ImportFrom)
        return [*statements_of(setup), *(one for one in solved if isinstance(one.node, kept))]

    @functools.cached_property
    def _code(self) -> list[Cell]:
        return [cell for cell in self.cells if cell.kind == "code"]

    def _statements(self, name: str) -> list[tuple[int, Statement]]:
        """Return the statements of solution cells that bind a name, each with the number of its code cell."""
        self.asked.add(name)
        tagged = [(k, cell) for k, cell in enumerate(self._code, 1) if author_notebook.SOLUTION in cell.tags]
        cells = tagged if any(name in cell.bound() for _, cell in tagged) else list(enumerate(self._code, 1))
        return [
            (k, statement)
            for k, cell in cells
            for statement in statements_of(cell.source)
            if name in statement.names.bound
        ]

    def _solution(self, name: str, source: str, node: ast.AST | None) -> NotebookSolution:
        return self._found.setdefault(name, NotebookSolution(self, name, source, node))


def _is_missing(node: ast.AST) -> bool:
    """Return whether a statement imports a package that is not installed."""
    if isinstance(node, ast.ImportFrom):
        names = [node.module or ""]
    else:
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    return any(find_spec(name.partition(".")[0]) is None for name in names)


def _text_of(statement: Statement) -> str:
    return statement.text.strip("\n") + "\n"


def _signature(node: ast.AST | None) -> inspect.Signature:
    """Return the signature of a function, or of a class's ``__init__`` without self; defaults stand for
    themselves.
    """
    skipped = 0
    if isinstance(node, ast.ClassDef):
        made = [n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__"]
        node, skipped = made[0] if made else None, 1
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return inspect.Signature()
    named = [*node.args.posonlyargs, *node.args.args]
    without_default = len(named) - len(node.args.defaults)
    parameters = [
        inspect.Parameter(
            a.arg,
            inspect.Parameter.POSITIONAL_OR_KEYWORD,
            default=inspect.Parameter.empty if k < without_default else ...,
        )
        for k, a in enumerate(named)
    ]
    return inspect.Signature(parameters[skipped:])
