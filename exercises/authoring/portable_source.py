"""Functions of the author's file that run in the sandbox: their source, with the names that they use.

Such a function is a mistake, an observation of a solution, or an argument of one. A mistake replaces the
right solution, which it may call. Only source goes into the sandbox: names of ``assignment.py`` are imported
there, written as constants, or taken along as source if they are functions.
"""

import ast
import builtins
import functools
import inspect
import sys
import textwrap
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from polhode.notebook.names import names_in

RIGHT = "right_solution"
"""The name of the right solution in the source of a mistake."""


class NotPortable(ValueError):
    """A mistake uses something that has no source for the sandbox; the message says what."""


@dataclass(frozen=True, eq=False)
class WrittenMistake:
    """A mistake written as ``function`` in place of the solution ``name``; ``given`` are the parameters that
    make it a member of a family.

    ``code``, ``sentence`` and ``line`` are those of ``Mistake``. ``known`` are the names of the
    notebook, which need no source.
    """

    function: FunctionType
    name: str
    code: str | None
    sentence: str
    line: int
    given: Mapping[str, Any] = field(default_factory=dict)
    known: Callable[[], Collection[str]] = frozenset

    def source(self, right: str) -> str:
        """Return the source with the mistake, from that of the right solution. Raises NotPortable."""
        needed, text = _written(self.function, self.name, frozenset(self.known()), frozenset(self.given))
        constants = [f"{name} = {_literal(name, value)}" for name, value in self.given.items()]
        body = "\n".join([*needed, *constants, text, f"return {self.name}"])
        factory = f"def with_mistake({RIGHT}):\n{textwrap.indent(body, '    ')}"
        return f"{right.rstrip()}\n\n\n{factory}\n\n\n{self.name} = with_mistake({self.name})\n"

    def errors(self, right: str) -> list[str]:
        """Return why it cannot be played, one sentence each."""
        try:
            ast.parse(self.source(right))
        except (NotPortable, OSError, TypeError, SyntaxError) as error:
            return [f"the mistake {self.function.__name__}: {error}"]
        return []


@functools.cache
def _written(
    function: FunctionType, name: str, known: frozenset[str], given: frozenset[str]
) -> tuple[list[str], str]:
    """Return the lines that a mistake uses, and its source without the parameters ``given``: the same for all
    members of a family.
    """
    needs = _Needs(name, known)
    node = needs.definition(function, name)
    node.args.args = [a for a in node.args.args if a.arg not in given]
    return needs.lines, ast.unparse(node)


def source_of(function: FunctionType) -> str:
    """Return the source of a function of the author's file, behind that of what it uses. Raises
    NotPortable.
    """
    needs = _Needs("", frozenset())
    node = needs.definition(function, function.__name__)
    return "\n".join([*needs.lines, ast.unparse(node)])


class _Needs:
    """What functions of the author's file use: ``lines`` that define it.

    ``asked`` is the name of the right solution, ``known`` are the names of the notebook.
    """

    def __init__(self, asked: str, known: frozenset[str]) -> None:
        self.asked, self.known = asked, known
        self.lines: list[str] = []
        self._defined: set[str] = set()

    def definition(self, function: FunctionType, name: str) -> ast.FunctionDef:
        """Return the syntax tree of a function under another ``name``, and collect what it uses."""
        (node,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
        if not isinstance(node, ast.FunctionDef):
            raise NotPortable("it must be defined with def")
        node.decorator_list = []
        renamed = {node.name: name}
        used, node.name = names_in(ast.unparse(node)), name
        enclosed = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
        for free in sorted((used.now | used.later) - renamed.keys()):
            if free in enclosed:
                value = enclosed[free].cell_contents
            elif free in function.__globals__:
                value = function.__globals__[free]
            elif free in self.known or hasattr(builtins, free):
                continue
            else:
                raise NotPortable(f"it uses {free}, which neither this file nor the notebook defines")
            if solution := getattr(value, "solution_name", None):
                renamed[free] = RIGHT if solution == self.asked else solution
            elif free not in self._defined:
                self._defined.add(free)
                self.lines += self._lines(free, value)
        for part in ast.walk(node):
            if isinstance(part, ast.Name):
                part.id = renamed.get(part.id, part.id)
        return node

    def _lines(self, name: str, value: Any) -> list[str]:
        """Return the lines that define a name with this value."""
        if isinstance(value, ModuleType):
            return [f"import {value.__name__} as {name}"]
        home = _importable(value)
        if home is not None:
            return [f"from {home} import {value.__name__} as {name}"]
        if isinstance(value, FunctionType):
            return [ast.unparse(self.definition(value, name))]
        return [f"{name} = {_literal(name, value)}"]


def _importable(value: Any) -> str | None:
    """Return the module from which a function or class of an installed package is imported, if it is one."""
    name = getattr(value, "__name__", None)
    if not isinstance(name, str):
        return None
    for home in (getattr(value, "__module__", None), "numpy"):  # numpy's ufuncs do not name their module
        module = sys.modules.get(home or "")
        if module and not module.__name__.startswith("exercises.") and getattr(module, name, None) is value:
            return home
    return None


def _literal(name: str, value: Any) -> str:
    """Return a constant as source. Raises NotPortable."""
    if isinstance(value, np.ndarray):
        return f"__import__('numpy').array({value.tolist()!r})"
    try:
        if ast.literal_eval(repr(value)) == value:
            return repr(value)
    except (ValueError, SyntaxError):
        pass
    raise NotPortable(
        f"it uses {name}, a {type(value).__name__}, which has no source for the sandbox: use numbers,"
        " strings, arrays, modules, and functions defined with def"
    )
