"""A notebook's value as text: an import if it comes from a module, a literal if it is data."""

import ast
import math
import sys
from collections.abc import Iterable, Iterator
from pathlib import PurePath
from types import ModuleType
from typing import Any

import numpy as np

LARGEST = 4096
"""Values with more elements than this are not written out."""

_EXACT_REPR = (int, bool, type(None), type(...), range)
_PLAIN_SCALARS = (int, bool, float, complex, str, bytes)


def literal(value: Any, numpy: str = "np") -> str | None:
    """Return an expression with exactly this value, NaN and infinity included; None if it has more than
    LARGEST elements or no literal.

    Numbers, text, tuples, lists, sets, dicts and numpy arrays of them have one. ``numpy`` is the name of
    numpy in the expression.
    """
    try:
        return _Writer(numpy).write(value)
    except (_NoLiteral, RecursionError, ValueError):
        return None


def import_line(name: str, value: Any, imports: Iterable[ast.Import | ast.ImportFrom] = ()) -> str | None:
    """Return the import that gives ``name`` this value: as in ``imports``, else from the public module that
    offers it. None if there is none.
    """
    for node in imports:
        for alias in node.names:
            if isinstance(node, ast.Import):
                target = alias.name if alias.asname else alias.name.partition(".")[0]
                if (alias.asname or target) == name and _loaded(target) is value:
                    return _with_name(f"import {target}", target, name)
            elif node.module and not node.level and node.module != "__future__":
                taken = name if alias.name == "*" and not name.startswith("_") else alias.name
                if (alias.asname or taken) == name and _offered(node.module, taken) is value:
                    return _with_name(f"from {node.module} import {taken}", taken, name)
    if isinstance(value, ModuleType):
        return (
            _with_name(f"import {value.__name__}", value.__name__, name)
            if _loaded(value.__name__) is value
            else None
        )
    own_name = str(getattr(value, "__name__", ""))
    for module in _offering(value) if own_name.isidentifier() else ():
        if _offered(module, own_name) is value:
            return _with_name(f"from {module} import {own_name}", own_name, name)
    return None


CACHED = "/polhode/assignments/"  # in the path of what the course server sent


def own_file(line: str) -> str | None:
    """Return the name of the student's own file that an import line reads, None for an installed or standard
    module.
    """
    top = line.split()[1].partition(".")[0]
    module = _loaded(top)
    places = [getattr(module, "__file__", None), *getattr(module, "__path__", [])]
    place = next((PurePath(p) for p in places if isinstance(p, str)), None)
    if (
        top in sys.stdlib_module_names
        or top == "polhode"
        or place is None
        or {"site-packages", "dist-packages"} & set(place.parts)
        or CACHED in place.as_posix()
    ):
        return None
    return place.parent.name if place.name == "__init__.py" else place.name


class _NoLiteral(Exception):
    pass


class _Writer:
    def __init__(self, numpy: str) -> None:
        self._numpy, self._left = numpy, LARGEST

    def write(self, value: Any) -> str:
        kind = type(value)
        if kind not in (list, tuple, dict, set, frozenset, np.ndarray):
            self._spend(1 + len(value) // 64 if isinstance(value, str | bytes) else 1)
        if kind in _EXACT_REPR or kind in (str, bytes):
            return repr(value)
        if kind is float:
            return repr(value) if math.isfinite(value) else f'float("{value}")'
        if kind is complex:
            return f"complex({self.write(value.real)}, {self.write(value.imag)})"
        if kind is np.ndarray or isinstance(value, np.generic):
            return self._array(value) if kind is np.ndarray else self._scalar(value)
        return self._collection(value)

    def _collection(self, value: Any) -> str:
        kind = type(value)
        if kind is dict:
            return "{" + ", ".join(f"{self.write(k)}: {self.write(v)}" for k, v in value.items()) + "}"
        if kind is list:
            return "[" + ", ".join(self.write(v) for v in value) + "]"
        if kind is tuple:
            return (
                "("
                + "".join(f"{self.write(v)}, " for v in value)
                .removesuffix(" ")
                .removesuffix("," * (len(value) > 1))
                + ")"
            )
        if kind in (set, frozenset):
            inside = ", ".join(sorted(self.write(v) for v in value))
            return f"{kind.__name__}([{inside}])" if kind is frozenset or not inside else f"{{{inside}}}"
        raise _NoLiteral

    def _scalar(self, value: Any) -> str:
        if type(value.item()) not in _PLAIN_SCALARS:
            raise _NoLiteral
        return f"{self._numpy}.{type(value).__name__}({self.write(value.item())})"

    def _array(self, value: Any) -> str:
        exact = value.dtype.kind in "biufcSU" and type(np.zeros(1, value.dtype).tolist()[0]) in _PLAIN_SCALARS
        if value.size > self._left or not exact:
            raise _NoLiteral
        if not value.size:
            return f'{self._numpy}.empty({value.shape}, dtype="{value.dtype}")'
        kept = value.dtype.isnative and value.dtype.name in ("float64", "int64", "bool", "complex128")
        return f"{self._numpy}.array({self.write(value.tolist())}" + (
            ")" if kept else f', dtype="{value.dtype}")'
        )

    def _spend(self, elements: int) -> None:
        self._left -= elements
        if self._left < 0:
            raise _NoLiteral


def _with_name(line: str, taken: str, name: str) -> str:
    return line if taken == name else f"{line} as {name}"


def _loaded(module: str) -> ModuleType | None:
    return sys.modules.get(module)


def _offered(module: str, name: str) -> Any:
    return getattr(_loaded(module), name, _loaded(f"{module}.{name}") or _NoLiteral)


def _offering(value: Any) -> Iterator[str]:
    """Yield modules that may offer a value: the public ones around the defining module, the nearest first,
    then that module.
    """
    for home in (getattr(value, "__module__", None), type(value).__module__):
        if isinstance(home, str) and home != "__main__":
            parts = home.split(".")
            ahead = [i for i, part in enumerate(parts) if part.startswith("_")]
            public = parts[: ahead[0]] if ahead else parts
            yield from (".".join(parts[:n]) for n in range(len(public), 0, -1))
            yield home
