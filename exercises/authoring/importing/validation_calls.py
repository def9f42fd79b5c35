"""Calls of ``validate`` in a code cell: their places, labels and tolerances,
read from the source alone.
"""

import ast
import functools
import inspect
from collections.abc import Iterator
from typing import NamedTuple

from polhode.judging import validate
from polhode.judging.claims import KINDS
from polhode.notebook.cells import python_of

LOOPS = (ast.For, ast.AsyncFor, ast.While, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


class Call(NamedTuple):
    """A call of ``validate`` in a cell: its line and column, its kind, its label, its first
    two arguments, and whether it is inside a function, or repeated: inside a loop.

    The expressions of a label that is not a plain string stand in braces; ``is_plain`` is then false.
    ``numbers`` are the tolerances and limits that its text gives as numbers, and ``computed`` the names of
    those that it computes.
    """

    place: tuple[int, int]
    kind: str
    label: str
    arguments: tuple[str, str] = ("", "")
    in_function: bool = False
    repeated: bool = False
    is_plain: bool = False
    numbers: tuple[tuple[str, float], ...] = ()
    computed: tuple[str, ...] = ()


@functools.lru_cache(maxsize=2048)
def calls(source: str) -> tuple[Call, ...]:
    """Return the calls of ``validate`` in a code cell, in the order of the source."""
    tree = ast.parse((python_of(source) if "validate" in source else None) or "")
    functions = [
        n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
    ]
    inside = {id(node) for function in functions for node in ast.walk(function)}
    loops = [n for n in ast.walk(tree) if isinstance(n, LOOPS)]
    repeated = {id(node) for loop in loops for node in ast.walk(loop)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and (kind := _kind(node)):
            label = _given(node, kind, "label") or ast.Constant("")
            numbers = {name: _number(given) for name, given in _given_numbers(node, kind)}
            call = Call(
                (node.lineno, node.col_offset),
                kind,
                _text(label),
                (_argument(node, 0), _argument(node, 1)),
                in_function=id(node) in inside,
                repeated=id(node) in repeated,
                is_plain=isinstance(label, ast.Constant),
                numbers=tuple((name, number) for name, number in numbers.items() if number is not None),
                computed=tuple(name for name, number in numbers.items() if number is None),
            )
            found.append(call)
    return tuple(sorted(found))


def _argument(node: ast.Call, at: int) -> str:
    return " ".join(ast.unparse(node.args[at]).split()) if len(node.args) > at else ""


def _kind(node: ast.Call) -> str | None:
    match node.func:
        case ast.Attribute(value=ast.Name(id="validate") | ast.Attribute(attr="validate"), attr=kind) if (
            kind in KINDS
        ):
            return kind
    return None


def _given(node: ast.Call, kind: str, name: str) -> ast.expr | None:
    """Return the argument ``name`` of a call of the function ``kind``, by name or by its position; None if it
    is not given.
    """
    given: dict[str | None, ast.expr] = dict(
        zip(inspect.signature(getattr(validate, kind)).parameters, node.args, strict=False)
    )
    given |= {keyword.arg: keyword.value for keyword in node.keywords}
    return given.get(name)


def _given_numbers(node: ast.Call, kind: str) -> Iterator[tuple[str, ast.expr]]:
    """Yield the tolerances and limits of a call by name, those that it does not name with their defaults."""
    if any(isinstance(one, ast.Starred) for one in node.args) or any(
        keyword.arg is None for keyword in node.keywords
    ):
        yield from ((name, node) for name in KINDS[kind].numbers)  # only running the call shows them
        return
    parameters = inspect.signature(getattr(validate, kind)).parameters
    for name in KINDS[kind].numbers:
        yield name, _given(node, kind, name) or ast.Constant(parameters[name].default)


def _number(node: ast.expr) -> float | None:
    """Return the number that the text of an expression gives,
    None if the expression needs a name or a call.
    """
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.UnaryOp(op=ast.USub(), operand=inner) if (number := _number(inner)) is not None:
            return -number
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            factors = _number(left), _number(right)
            if factors[0] is None or factors[1] is None or (isinstance(op, ast.Div) and not factors[1]):
                return None
            return factors[0] * factors[1] if isinstance(op, ast.Mult) else factors[0] / factors[1]
    return None


def _text(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=str(text)):
            return " ".join(text.split())
        case ast.JoinedStr(values=parts):
            shown = [
                str(p.value) if isinstance(p, ast.Constant) else ast.unparse(ast.JoinedStr([p]))[2:-1]
                for p in parts
            ]
            return " ".join("".join(shown).split())
    return f"{{{ast.unparse(node)}}}"
