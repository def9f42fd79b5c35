"""A seal on the code that calls a submission and records what it draws: detects that the submission has
replaced part of it.
"""

import functools
import importlib
import sys
import types
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from polhode.judging.return_value import WrongAnswer

REPLACED = "your code replaces {name}, a part of polhode's checks: remove that"


class Seal:
    """The names of some namespaces, the code of their functions, and the attributes of their own classes.

    What runs in the submission's process cannot be protected from it; the seal shows a change that is still
    there. Names may be added, as Python itself does.
    """

    def __init__(self) -> None:
        self._names: tuple[tuple[Mapping[str, Any], tuple[tuple[str, Any], ...]], ...] = ()
        self._functions: tuple[tuple[types.FunctionType, list[int]], ...] = ()

    def close(self, namespaces: Iterable[Mapping[str, Any]], modules: Collection[str]) -> None:
        """Add the present state of ``namespaces`` and of those of their classes that ``modules`` define."""
        spaces = tuple(namespaces)
        classes = [
            v for space in spaces for v in space.values() if isinstance(v, type) and v.__module__ in modules
        ]
        for space in (*spaces, *map(vars, classes)):
            self.close_names(space, space)

    def close_names(self, namespace: Mapping[str, Any], names: Iterable[str]) -> None:
        """Add the present state of the ``names`` that a namespace has."""
        items = tuple((name, namespace[name]) for name in names if name in namespace)
        self._names = (*self._names, (namespace, items))
        known = {id(function) for function, _ in self._functions}
        functions = {id(f): f for _, f in items if isinstance(f, types.FunctionType) and id(f) not in known}
        self._functions = (*self._functions, *((f, _parts(f)) for f in functions.values()))

    def check(self) -> None:
        """Raise WrongAnswer if something has been replaced."""
        for space, items in self._names:
            for name, value in items:
                if space.get(name, self) is not value:
                    raise WrongAnswer(None, REPLACED.format(name=name))
        for function, parts in self._functions:
            if _parts(function) != parts:
                raise WrongAnswer(None, REPLACED.format(name=function.__name__))


@contextmanager
def private_modules(names: tuple[str, ...]) -> Iterator[dict[str, types.ModuleType]]:
    """Put copies of the modules ``names``, which a submission cannot replace, in their place for the ``with``
    block.
    """
    with in_place(copies := _copies(names)):
        yield copies


@functools.cache
def _copies(names: tuple[str, ...]) -> dict[str, types.ModuleType]:
    """Import copies. The zygote does so for its children, of which each has memory of its own."""
    with in_place({name: importlib.import_module(name) for name in names}):
        for name in names:
            del sys.modules[name]
        return {name: importlib.import_module(name) for name in names}


def names_used(code: types.CodeType) -> set[str]:
    """Return the names and attributes that code uses."""
    return set(code.co_names).union(
        *(names_used(part) for part in code.co_consts if isinstance(part, types.CodeType))
    )


@contextmanager
def in_place(modules: Mapping[str, types.ModuleType]) -> Iterator[None]:
    """Import these modules by their names in the ``with`` block.
    Afterwards the former ones are there again.
    """
    former = {name: importlib.import_module(name) for name in modules}
    try:
        _put(modules)
        yield
    finally:
        _put(former)


def _put(modules: Mapping[str, types.ModuleType]) -> None:
    sys.modules |= modules
    for name, module in modules.items():
        parent, _, child = name.rpartition(".")
        setattr(sys.modules[parent], child, module)


def _parts(function: types.FunctionType) -> list[int]:
    """Return the identities of a function's code and defaults."""
    named = (function.__kwdefaults__ or {}).values()
    return [*map(id, (function.__code__, function.__defaults__, function.__kwdefaults__, *named))]
