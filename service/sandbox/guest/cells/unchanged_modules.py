"""Modules and builtins as given cells find them: those that a submission has not changed.

What these cells compute stands in their lines, so a submission must not choose what ``np.linalg.norm`` or
``range`` means in them. Code of the submission that a given cell itself calls can still change something for
the time of that call. What is changed when the cell ends is noticed.
"""

import ast
import builtins
import importlib
import inspect
import sys
import types
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from .claim_recorder import Recorder
from .jupytext_cells import nodes_of

Names = dict[str, Any]
KIT = "polhode"
HEAP = 1 << 9  # the flag of a class whose attributes can be set
MISSING = object()
OF_A_NOTEBOOK = {"display", "get_ipython", "exit", "quit"}  # which have their own
CHANGED = "your code changed {name} while the cell ran: leave the modules of others as they are"


class Given:
    """The given cells of a notebook, by their ``sources``, whose claims the ``recorder`` has to find. Make it
    before the submission runs.

    Names of builtins that the submission is asked for, ``asked``, and those that given cells bind themselves,
    are not touched.
    """

    def __init__(self, sources: Sequence[str], asked: Collection[str], recorder: Recorder) -> None:
        nodes = [node for source in sources for node in nodes_of(source)]
        self._imports = _imported(nodes)
        bound = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        bound |= {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        self._own = {*bound, *asked}
        self._builtins = {name for name in vars(builtins) if name[0] != "_"} - OF_A_NOTEBOOK
        packages = {"ast", "numpy"}  # which run the cells and record their claims
        packages |= {word.__module__.partition(".")[0] for word in recorder.words}
        packages |= {getattr(value, "__module__", "").partition(".")[0] for value in self._imports.values()}
        packages |= {
            value.__name__.partition(".")[0] for value in self._imports.values() if _is_module(value)
        }
        self._modules = {
            name: module
            for name, module in list(sys.modules.items())
            if name.partition(".")[0] in packages and _is_module(module) and name != KIT
        } | {"builtins": builtins}
        self._kinds = {name: type(module) for name, module in self._modules.items()}
        self._spaces = [(name, vars(module), _parts(vars(module))) for name, module in self._modules.items()]
        found = {id(value): value for _, _, parts in self._spaces for value in parts.values()}
        inner = [getattr(value, "_implementation", value) for value in found.values()]
        inner += [inspect.unwrap(word) for word in recorder.words]
        self._cells = [
            (cell, cell.cell_contents) for word in recorder.words for cell in word.__closure__ or ()
        ]
        self._functions = [
            (one, (one.__code__, one.__defaults__, one.__kwdefaults__))
            for one in inner
            if isinstance(one, types.FunctionType)
        ]
        self._classes = [
            (value, _parts(vars(value)))
            for value in found.values()
            if isinstance(value, type) and value.__flags__ & HEAP and value.__module__ in self._modules
        ]
        self.changed = ""

    @contextmanager
    def in_place(self, names: Names) -> Iterator[None]:
        """Let a given cell that runs in ``names`` inside the ``with`` block find everything unchanged, and
        the submission its own changes afterwards. Then ``changed`` says what its code changed meanwhile.
        """
        sys.settrace(None)
        sys.setprofile(None)
        theirs = self._restore()
        hidden = self._shown(names)
        try:
            yield
        finally:
            public = [name for name, *_ in self._restore() if not name.rpartition(".")[2].startswith("_")]
            self.changed = CHANGED.format(name=public[0]) if public else ""
            for _, holder, key, value in theirs:
                _put(holder, key, value)
            for name, (ours, value) in hidden.items():
                if names.get(name, MISSING) is ours:
                    _put(names, name, value)

    def _shown(self, names: Names) -> dict[str, tuple[Any, Any]]:
        """Put what the given cells import, and the builtins, in place of what the submission calls so. Return
        both values of each name.
        """
        found = dict[str, tuple[Any, Any]]()
        wanted = {name: value for name, value in self._imports.items() if name in names}
        wanted |= dict.fromkeys(self._builtins & names.keys() - self._imports.keys(), MISSING)
        wanted["__builtins__"] = builtins
        for name, value in wanted.items():
            if name not in self._own and names.get(name, MISSING) is not value:
                found[name] = (value, names.get(name, MISSING))
                _put(names, name, value)
        return found

    def _restore(self) -> list[tuple[str, Any, str, Any]]:
        """Undo all changes. Return each: its name, what had it, its key, and the value."""
        found = list[tuple[str, Any, str, Any]]()
        for name, module in self._modules.items():
            if (other := sys.modules.get(name, MISSING)) is not module:
                found.append((name, sys.modules, name, other))
                sys.modules[name] = module
            if type(module) is not self._kinds[name]:
                found.append((name, module, "__class__", type(module)))
                module.__class__ = self._kinds[name]
        for name, space, parts in self._spaces:
            for key, value in parts.items():
                if (other := space.get(key, MISSING)) is not value:
                    found.append((f"{name}.{key}", space, key, other))
                    space[key] = value
        for one, parts in self._classes:
            for key, value in parts.items():
                if (other := vars(one).get(key, MISSING)) is not value:
                    with suppress(TypeError, AttributeError):
                        setattr(one, key, value)
                        found.append((f"{one.__name__}.{key}", one, key, other))
        for cell, value in self._cells:
            cell.cell_contents = value
        return [*found, *self._restore_code()]

    def _restore_code(self) -> Iterator[tuple[str, Any, str, Any]]:
        for function, code in self._functions:
            present = _code(function)
            if any(a is not b for a, b in zip(present, code, strict=True)):
                for key, value, own in zip(CODE, present, code, strict=True):
                    setattr(function, key, own)
                    yield function.__name__, function, key, value


CODE = ("__code__", "__defaults__", "__kwdefaults__")


def _code(function: types.FunctionType) -> tuple[Any, ...]:
    return function.__code__, function.__defaults__, function.__kwdefaults__


def _imported(nodes: Sequence[ast.AST]) -> Names:
    """Return what import statements bind, by name, as far as it can be imported."""
    found = Names()
    for node in nodes:
        if not isinstance(node, ast.Import | ast.ImportFrom):
            continue
        for alias in node.names:
            with suppress(Exception):  # what fails here fails in the cell too
                if isinstance(node, ast.Import):
                    module = importlib.import_module(alias.name)
                    top = sys.modules[alias.name.partition(".")[0]]
                    found[alias.asname or top.__name__] = module if alias.asname else top
                elif node.module and not node.level and node.module.partition(".")[0] != KIT:
                    value = getattr(importlib.import_module(node.module), alias.name)
                    found[alias.asname or alias.name] = value
    return found


def _is_module(value: Any) -> bool:
    return isinstance(value, types.ModuleType)


def _parts(space: Mapping[str, Any]) -> Names:
    """Return what is called or used as a module, by name: other values may change as the library works."""
    kinds = (types.ModuleType, property, classmethod, staticmethod)
    return {name: value for name, value in space.items() if callable(value) or isinstance(value, kinds)}


def _put(holder: Any, key: str, value: Any) -> None:
    if not isinstance(holder, dict):
        setattr(holder, key, value) if value is not MISSING else delattr(holder, key)
    elif value is MISSING:
        holder.pop(key, None)
    else:
        holder[key] = value
