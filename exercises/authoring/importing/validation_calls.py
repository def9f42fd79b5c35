"""Calls of validation words in a code cell: their places, labels and tolerances,
read from the source alone.
"""

import ast
import functools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from exercises.authoring.importing.validation_words import Word, Words
from polhode.judging.claims import kind_of
from polhode.notebook.cell_to_python import python_of

LIMIT = "limit"  # the second parameter, whatever a package calls it
LOOPS = (ast.For, ast.AsyncFor, ast.While, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


class Call(NamedTuple):
    """A call of a validation word in a cell: its line and column, its kind, which is the word, its label, its
    first two arguments, the ``function`` as the cell calls it, whether it is inside a function, and the first
    and last line of the ``loop`` that repeats it.

    The expressions of a label that is not a plain string stand in braces; ``is_plain`` is then false.
    ``numbers`` are the tolerances and limits that its text gives as numbers, and ``computed`` the names of
    those that it computes.
    """

    place: tuple[int, int]
    kind: str
    label: str
    arguments: tuple[str, str] = ("", "")
    in_function: bool = False
    loop: tuple[int, ...] = ()
    is_plain: bool = False
    numbers: tuple[tuple[str, float], ...] = ()
    computed: tuple[str, ...] = ()
    function: str = ""

    @property
    def repeated(self) -> bool:
        """Whether the call is inside a loop."""
        return bool(self.loop)


@functools.lru_cache(maxsize=2048)
def calls(source: str, words: Words) -> tuple[Call, ...]:
    """Return the calls of validation words in a code cell, in the order of the source."""
    known = {module: {word.name: word for word in of_module} for module, of_module in words}
    tree = ast.parse((python_of(source) if any(module in source for module in known) else None) or "")
    functions = [
        n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
    ]
    inside = {id(node) for function in functions for node in ast.walk(function)}
    loops = [n for n in ast.walk(tree) if isinstance(n, LOOPS)]
    lines = {id(node): _lines(loop) for loop in reversed(loops) for node in ast.walk(loop)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and (word := _word(node, known)):
            label = _given(node, word, "label") or ast.Constant("")
            numbers = {name: _number(given) for name, given in _given_numbers(node, word)}
            call = Call(
                (node.lineno, node.col_offset),
                word.name,
                _text(label),
                (_argument(node, word, 0), _argument(node, word, 1)),
                in_function=id(node) in inside,
                loop=lines.get(id(node), ()),
                is_plain=isinstance(label, ast.Constant),
                numbers=tuple((name, number) for name, number in numbers.items() if number is not None),
                computed=tuple(name for name, number in numbers.items() if number is None),
                function=ast.unparse(node.func),
            )
            found.append(call)
    return tuple(sorted(found))


def _lines(node: ast.AST) -> tuple[int, ...]:
    """Return the first and the last line of a loop."""
    return (getattr(node, "lineno", 0), getattr(node, "end_lineno", None) or 0)


def _argument(node: ast.Call, word: Word, at: int) -> str:
    given = _given(node, word, word.parameters[at]) if len(word.parameters) > at else None
    return ast.unparse(given) if given is not None else ""


def _word(node: ast.Call, known: Mapping[str, Mapping[str, Word]]) -> Word | None:
    match node.func:
        case ast.Attribute(value=ast.Name(id=module) | ast.Attribute(attr=module), attr=name):
            return known.get(module, {}).get(name)
    return None


def _given(node: ast.Call, word: Word, name: str) -> ast.expr | None:
    """Return the argument ``name`` of a call, by name or by its position; None if it is not given."""
    given: dict[str | None, ast.expr] = dict(zip(word.parameters, node.args, strict=False))
    given |= {keyword.arg: keyword.value for keyword in node.keywords}
    return given.get(name)


def _given_numbers(node: ast.Call, word: Word) -> Iterator[tuple[str, ast.expr]]:
    """Yield the tolerances and limits of a call by name, those that it does not name with their defaults."""
    defaults = dict(word.defaults)
    for name in kind_of(word.name).numbers:
        parameter = word.parameters[1] if name == LIMIT and len(word.parameters) > 1 else name
        given = _given(node, word, parameter) or defaults.get(parameter)
        if (
            given is None
            or any(isinstance(one, ast.Starred) for one in node.args)
            or None in (keyword.arg for keyword in node.keywords)
        ):
            given = node  # only running the call shows it
        yield name, given


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
