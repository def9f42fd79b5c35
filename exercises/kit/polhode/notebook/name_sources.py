"""The text behind a notebook's name: an import, its value, or statements of the cells that ran."""

import ast
import builtins
import inspect
import re
import textwrap
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from polhode.notebook.cell_history import History
from polhode.notebook.code_fingerprint import fingerprint, fingerprints_in, functions_of, makes, same_defaults
from polhode.notebook.names import Names, names_in
from polhode.notebook.value_source import import_line, literal, own_file

# IPython's history variables, which change with every cell.
_RECORD = re.compile(r"In|Out|_+|_[dio]h|_i+|_i?\d+")
_OTHER_NUMPY = "_numpy"


@dataclass(frozen=True)
class Source:
    """The text that gives ``name`` its value, and the global names it reads while it runs and later."""

    name: str
    text: str
    names: Names
    kind: str  # "import", "value", "definition" or "statement"


@dataclass(frozen=True)
class Missing:
    """A value that cannot be written as text; ``sentence`` says what to do."""

    name: str
    sentence: str


class Sources:
    """Finds the text behind names. ``values`` are those of the ``namespace``, with the functions given for
    this call.
    """

    def __init__(self, namespace: Mapping[str, Any], values: Mapping[str, Any], history: History) -> None:
        self._numpy = "np" if values.get("np") is np else _OTHER_NUMPY
        self.values = {**values, self._numpy: np}
        self._namespace, self.history = namespace, history

    def find(self, name: str) -> Source | Missing | None:
        """Return the source of a name, or Missing. None if the server has the name anyway, or it does not
        exist.
        """
        value = self.values.get(name)
        if name not in self.values or re.fullmatch(r"__\w+__", name) or _is_shell_builtin(name, value):
            return None
        if _RECORD.fullmatch(name):
            return Missing(
                name, f"`{name}` is part of the notebook's history: assign what you need from it to a name"
            )
        line = import_line(name, value, self.history.imports)
        if line and not own_file(line):
            return _source(name, line, "import")
        written = literal(value, self._numpy)
        if written is not None:
            return _source(name, f"{name} = {written}", "value")
        if line:
            return Missing(
                name,
                f"`{name}` comes from your own file {own_file(line)}: copy its code into a cell and run it",
            )
        found = self._definition(name, value) or self._statements(name, value) or self._inspected(name, value)
        return found or Missing(name, _no_source(name, value))

    def submodules(self, name: str, texts: Collection[str]) -> set[str]:
        """Return imports of submodules of the module ``name`` that the cells import and the texts use."""
        home = f"{self.values[name].__name__}." if isinstance(self.values[name], ModuleType) else "."
        inside = {module for module in self.history.modules if module.startswith(home)}
        paths = {module: re.escape(f"{name}.{module.removeprefix(home)}") for module in inside}
        return {
            f"import {module}"
            for module, path in paths.items()
            if any(re.search(rf"\b{path}\b", t) for t in texts)
        }

    def is_outdated(self, source: Source, texts: Collection[str]) -> bool:
        """Return whether the value has defaults, functions or a class that those texts would not make."""
        value, kind = self.values[source.name], type(self.values[source.name])
        if source.kind == "definition":
            return isinstance(value, FunctionType) and not same_defaults(source.text, value, self.values)
        newer = self.values.get(kind.__name__)
        if kind.__module__ == "__main__" and isinstance(newer, type) and newer is not kind:
            return True
        held = {fingerprint(f.__code__) for f in functions_of(value) if f.__globals__ is self._namespace}
        return bool(held) and not held <= {made for text in texts for made in fingerprints_in(text)}

    def _definition(self, name: str, value: Any) -> Source | None:
        """Return the ``def``, ``class`` or ``lambda`` that made exactly this value."""
        if not isinstance(value, FunctionType | type):
            return None
        own_name = value.__code__.co_name if isinstance(value, FunctionType) else value.__name__
        made_as = name if own_name == "<lambda>" else own_name
        made = [(s.text, after) for s, after in self.history.definitions(made_as) if makes(s.text, value)]
        if not made:
            return None
        same = (isinstance(value, type) or same_defaults(text, value, self.values) for text, _ in made)
        text, after = next((found for found, agrees in zip(made, same, strict=True) if agrees), made[0])
        stores = [s.text for s in after if s.changes(name, calls=False) and not s.binds(name)]
        return self._defined(name, made_as, "\n".join([text, *stores]))

    def _defined(self, name: str, made_as: str, text: str) -> Source | None:
        """Return the definition under its current name: as a second name of ``made_as`` if that is the same,
        else renamed in its text.
        """
        if made_as != name and self.values.get(made_as) is self.values[name]:
            text = f"{name} = {made_as}"
        header = rf"^(\s*(?:def|class)\s+){made_as}\b"
        source = _source(
            name, re.sub(header, rf"\g<1>{name}", text, count=1, flags=re.MULTILINE), "definition"
        )
        return source if name in source.names.bound else None

    def _statements(self, name: str, value: Any) -> Source | None:
        """Return the statements from the last one that bound the name to the last that changed its value."""
        held = {fingerprint(f.__code__) for f in functions_of(value)}
        every = [s for s in self.history.statements(name) if s.binds(name) or s.changes(name)]
        chain = [
            s
            for s in every
            if not isinstance(s.node, ast.FunctionDef) or not held or fingerprints_in(s.text) & held
        ]
        chain = (
            chain or [s for s in every if isinstance(s.node, ast.FunctionDef) and s.node.decorator_list][-1:]
        )
        start = max((place for place, s in enumerate(chain) if s.starts(name)), default=0)
        if not chain or not chain[start].binds(name):
            return None
        text, now = "\n".join(s.text for s in chain[start:]), {n for s in chain[start:] for n in s.names.now}
        return Source(name, text, replace(names_in(text), now=frozenset(now - {name})), "statement")

    def _inspected(self, name: str, value: Any) -> Source | None:
        """Return Python's record of a ``def`` that the history lacks (``%run``, a cleared history)."""
        if not isinstance(value, FunctionType) or "<" in value.__code__.co_qualname:
            return None
        try:
            text = textwrap.dedent(inspect.getsource(value)).rstrip()
            return self._defined(name, value.__code__.co_name, text) if makes(text, value) else None
        except (OSError, TypeError, SyntaxError):
            return None


def _source(name: str, text: str, kind: str) -> Source:
    names = names_in(text)
    return Source(name, text, replace(names, now=names.now - {name}), kind)


def _is_shell_builtin(name: str, value: Any) -> bool:
    """Return whether it is IPython's variant of a builtin function."""
    home = str(getattr(value, "__module__", ""))
    is_open = name == "open" and getattr(value, "__wrapped__", None) is builtins.open
    return is_open or (name in ("exit", "quit") and home.startswith(("IPython", "ipykernel")))


def _no_source(name: str, value: Any) -> str:
    if isinstance(value, FunctionType | type):
        return (
            f"the source of `{name}` was not found (it was made by exec, or its cell is no longer known):"
            f" define it in a cell as `def {name}(...)` and run that cell, or submit a file with"
            " submit(file=...)"
        )
    what = (
        f"an array of shape {value.shape}"
        if isinstance(value, np.ndarray)
        else f"of the type {type(value).__name__}"
    )
    return f"no cell defines `{name}` ({what}): define it in a cell, or inside the function that needs it"
