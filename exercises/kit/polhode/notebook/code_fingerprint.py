"""Match functions and classes to the text that defined them, by comparing compiled code."""

import __future__

import ast
import dis
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import CellType, CodeType, FunctionType
from typing import Any

Print = tuple[Any, ...]
"""Equal for codes that do the same; excludes line numbers and file names."""

_HOLDERS = ("__wrapped__", "py_func", "pyfunc", "func", "__func__")
_VARIADIC = 0x04 | 0x08
_CALLING = {"PUSH_NULL", "PRECALL", "EXTENDED_ARG"}
_PLAIN = {"LOAD_METHOD": "LOAD_ATTR"}
_JUMPS = {*dis.hasjabs, *dis.hasjrel}


def makes(text: str, value: Any) -> bool:
    """Return whether running this ``def``, ``class`` or ``name = lambda`` makes such a function, or a class
    with such methods.
    """
    if isinstance(value, FunctionType):
        return fingerprint(value.__code__) in _prints(text)[0]
    own = [m.__func__ if isinstance(m, staticmethod | classmethod) else m for m in vars(value).values()]
    # Methods that dataclass or a decorator added to a class are not in its text.
    written = [
        m
        for m in own
        if isinstance(m, FunctionType) and m.__code__.co_qualname == f"{value.__qualname__}.{m.__name__}"
    ]
    return bool(re.search(rf"\bclass\s+{value.__name__}\b", text)) and {
        fingerprint(m.__code__) for m in written
    } <= fingerprints_in(text)


def same_defaults(text: str, function: FunctionType, values: Mapping[str, Any]) -> bool:
    """Return whether the text, run with these values, gives the function its defaults. Reads plain names and
    constants only.
    """
    made = next(
        (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef | ast.Lambda)), None
    )
    if made is None:  # a second name
        return True
    written = [*made.args.defaults, *(default for default in made.args.kw_defaults if default)]
    held = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]
    return len(written) == len(held) and all(
        _may_be(*pair, values) for pair in zip(written, held, strict=True)
    )


def fingerprints_in(text: str) -> frozenset[Print]:
    """Return the fingerprints of all functions in a text, nested ones included."""
    return _prints(text)[1]


def functions_of(value: Any) -> Iterator[FunctionType]:
    """Yield the functions a value holds: itself, and what it wraps, closes over or, as an instance of a
    notebook's class, has.
    """
    seen: set[int] = set()
    waiting = [value]
    while waiting:
        item = waiting.pop()
        if id(item) in seen or isinstance(item, type) or len(seen) > 200:
            continue
        seen.add(id(item))
        if isinstance(item, FunctionType):
            yield item
        waiting += [part for part in _parts(item) if callable(part)]


@lru_cache(maxsize=2048)
def fingerprint(code: CodeType) -> Print:
    """Return a key that is equal for codes that do the same."""
    counts = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags & _VARIADIC)
    head = (code.co_name, *counts, code.co_varnames)
    if "__firstlineno__" in code.co_names:  # the body of a class keeps its line number in its code
        return (*head, code.co_names, *map(fingerprint, _inside(code)))
    return (*head, *map(_constant, code.co_consts), _steps(code))


def _may_be(written: ast.expr, held: Any, values: Mapping[str, Any]) -> bool:
    if isinstance(written, ast.Name):
        now = values.get(written.id, held)
    else:
        now = written.value if isinstance(written, ast.Constant) else held
    return now is held or (type(now) is type(held) and repr(now) == repr(held))


def _steps(code: CodeType) -> Print:
    """Return its instructions, without those that depend on whether a module was imported in the same
    cell.
    """
    kept: list[dis.Instruction] = []
    place: dict[int, int] = {}
    for step in dis.get_instructions(code):
        place[step.offset] = len(kept)
        kept += [] if step.opname in _CALLING else [step]
    named = [_PLAIN.get(step.opname, step.opname) for step in kept]
    return tuple(
        zip(named, [place.get(s.argval) if s.opcode in _JUMPS else _argument(s) for s in kept], strict=True)
    )


def _argument(step: dis.Instruction) -> Any:
    return None if step.opcode in dis.hasconst else repr(step.argval)


def _constant(value: Any) -> Any:
    if isinstance(value, CodeType):
        return fingerprint(value)
    return frozenset(map(repr, value)) if isinstance(value, frozenset) else repr(value)


def _parts(item: Any) -> list[Any]:
    if isinstance(item, FunctionType):
        return [_content(cell) for cell in item.__closure__ or ()] + list(vars(item).values())
    held = (
        list(vars(item).values()) if type(item).__module__ == "__main__" and hasattr(item, "__dict__") else []
    )
    arguments = (
        [*getattr(item, "args", ()), *getattr(item, "keywords", {}).values()]
        if type(item).__name__ == "partial"
        else []
    )
    return held + arguments + [getattr(item, holder, None) for holder in _HOLDERS]


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # an empty cell
        return None


@lru_cache(maxsize=2048)
def _prints(text: str) -> tuple[frozenset[Print], frozenset[Print]]:
    """Return the fingerprints of the functions at the top of a text, and of all functions in it."""
    top: set[Print] = set()
    every: set[Print] = set()
    for flags in (
        0,
        __future__.annotations.compiler_flag,
    ):  # a notebook's __future__ imports hold for later cells
        code = compile(text, "cell", "exec", flags=flags, dont_inherit=True)
        top |= {fingerprint(c) for c in _inside(code)}
        waiting = [code]
        while waiting:
            inner = list(_inside(waiting.pop()))
            every |= {fingerprint(c) for c in inner}
            waiting += inner
    return frozenset(top), frozenset(every)


def _inside(code: CodeType) -> Iterator[CodeType]:
    return (c for c in code.co_consts if isinstance(c, CodeType))
