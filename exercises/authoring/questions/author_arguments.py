"""What an author passes to the methods that ask questions, and the errors of arguments of a wrong type."""

import ast
import inspect
import math
import reprlib
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Annotated, Any

import numpy as np

from polhode.judging.outcome import Tolerance
from polhode.kinds.equivalent_values import UP_TO

ARGUMENTS = "fiubU"  # kinds of dtype


class _Short(reprlib.Repr):
    def repr_Tolerance(self, value: Tolerance, level: int) -> str:
        numbers = ", ".join(f"{name}={self.repr(number)}" for name, number in value.numbers().items())
        return f"a tolerance of {numbers}"


SHORT = _Short()
SHORT.maxother = SHORT.maxstring = 90
Draw = Callable[..., Any]
"""A function of a random generator."""


@dataclass(frozen=True)
class Rule:
    """What a value must be besides its type; ``text`` continues the sentence "it must be"."""

    text: str
    test: Callable[[Any], Any]

    def holds(self, value: Any) -> bool:
        """Return whether the test is true and raises nothing that a wrong value causes."""
        try:
            return bool(self.test(value))
        except (TypeError, ValueError, SyntaxError):
            return False


def is_numeric(value: Any, kinds: str = "fiu") -> bool:
    """Return whether a value is a finite number or a non-empty array of them,
    of a dtype of these ``kinds``.
    """
    array = np.asarray(value)
    return array.dtype.kind in kinds and array.size > 0 and bool(np.all(np.isfinite(array)))


Positive = Annotated[float, Rule("a number > 0", lambda x: 0 < x < math.inf)]
Count = Annotated[int, Rule("an integer ≥ 1", lambda n: n >= 1)]
Rows = tuple[
    Annotated[int, Rule("an integer ≥ 0", lambda n: n >= 0)],
    Annotated[int, Rule("an integer ≥ 0", lambda n: n >= 0)],
]
Numbers = Annotated[
    Any, Rule("a finite number or an array of such numbers", lambda a: is_numeric(a, "fiubc"))
]
Text = Annotated[str, Rule("a text that is not empty", str.strip)]
Expression = Annotated[str, Rule("an expression", lambda text: ast.parse(text, mode="eval"))]
Source = Annotated[str, Rule("an expression, or the source of functions", ast.parse)]
Named = Annotated[
    Callable[..., Any],
    Rule(
        "a function whose parameters have names",
        lambda f: all(
            p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)
            for p in inspect.signature(f).parameters.values()
        ),
    ),
]
UpTo = Annotated[str, Rule(f"one of: {', '.join(UP_TO)}", UP_TO.__contains__)]
Limit = Annotated[
    Tolerance, Rule("relative(…, because=…), or at_most for a count", lambda t: t.limit is not None)
]
Close = Annotated[Tolerance, Rule("close(rtol=…, atol=…, because=…)", lambda t: t.limit is None)]
Absolute = Annotated[Tolerance, Rule("absolute(…, because=…)", lambda t: t.atol is not None)]


Constant = Annotated[
    Any, Rule("a real number, a string, or an array of them", lambda a: np.asarray(a).dtype.kind in ARGUMENTS)
]


@dataclass(frozen=True)
class Family:
    """A function argument: an expression ``text`` over some variables, with parameters that are constant or
    drawn, or the source of a function that takes both.
    """

    text: Source
    over: tuple[str, ...]
    given: Mapping[str, Draw | Constant]

    @property
    def takes_functions(self) -> bool:
        """Whether it calls one of its variables."""
        calls = [node.func for node in ast.walk(ast.parse(self.text)) if isinstance(node, ast.Call)]
        return any(isinstance(one, ast.Name) and one.id in self.over for one in calls)


Given = Annotated[
    Mapping[str, Family | Draw | Constant], Rule("a dict of arguments by name", lambda given: True)
]


@dataclass(frozen=True)
class Mistake:
    """A known wrong answer: ``old`` in the right solution's source replaced by ``new``.

    With a ``code`` it is a diagnosis, whose ``sentence`` says what the student did. ``line`` is its place in
    the declaration.
    """

    old: str
    new: str
    code: str | None = None
    sentence: str = ""
    line: int = 0

    def source(self, right: str) -> str:
        """Return the source with the mistake, from that of the right solution."""
        return right.replace(self.old, self.new)


@dataclass(frozen=True)
class Itself:
    """The declaration that the right solution is its own truth, and why nothing else can be."""

    reason: Text


@dataclass(frozen=True)
class Value:
    """A value that a function returns: its tolerance, its label, and what it leaves ``up_to``
    (polhode.kinds.equivalent_values).

    A ``statistic`` of random numbers has a wide tolerance: a mistake is recognised only if it gives the same
    number to rounding. With ``check`` the id of its check is the exercise's number and this name.
    ``components`` are the names of the numbers of an array.
    """

    tolerance: Tolerance
    label: str | None = None
    up_to: UpTo | None = None
    statistic: bool = False
    check: str | None = None
    components: tuple[str, ...] = ()


Agree = (
    Tolerance
    | Value
    | Annotated[Mapping[str, Tolerance | Value], Rule("a dict of them for several values", bool)]
)
"""A tolerance, or one with its label, of a single value, or those of several values by name."""
Truth = Named | Itself
LimitOrValue = (
    Limit
    | Annotated[
        Value, Rule("Value(relative(…, because=…))", lambda v: getattr(v.tolerance, "limit", 0) is not None)
    ]
)


def named_values(agree: Agree) -> dict[str, Value]:
    """Return the values that a question agrees on by name; a single one is "value"."""
    named = agree if isinstance(agree, Mapping) else {"value": agree}
    return {name: value if isinstance(value, Value) else Value(value) for name, value in named.items()}


def tolerance_data(tolerance: Tolerance) -> dict[str, Any]:
    """Return a tolerance as JSON: the arguments of Tolerance."""
    return {key: number for key, number in vars(tolerance).items() if number is not None}


def type_errors(name: str, value: Any, hint: Any) -> Iterator[str]:
    """Yield what a value, or a part of it, is and what its type ``hint`` requires, as sentences; and the
    errors of tolerances.
    """
    options = typing.get_args(hint) if typing.get_origin(hint) in UNIONS else (hint,)
    parts = next((parts for one in options if (parts := _parts(value, one)) is not None), None)
    if parts is None:
        yield f"{name} is {SHORT.repr(value)}; it must be {_text(hint)}"
        return
    errors = [error for at, part, of in parts for error in type_errors(f"{name}{at}", part, of)]
    if isinstance(value, Tolerance) and not errors:
        errors = [f"{name}: {error}" for error in tolerance_errors(value)]
    yield from errors


def tolerance_errors(tolerance: Tolerance) -> Iterator[str]:
    """Yield the errors of a tolerance."""
    numbers = tolerance.numbers().values()
    if not numbers:
        yield "the tolerance has no number"
    if any(
        not (isinstance(number, int | float) and number >= 0 and math.isfinite(number)) for number in numbers
    ):
        yield "a tolerance must be a finite number ≥ 0"
    if not tolerance.reason.strip():
        yield "the tolerance has no reason: say it with because="


def _split(hint: Any) -> tuple[Any, tuple[Any, ...], list[Rule]]:
    """Return the class of a type hint, the hints of its parts, and its rules."""
    base, *rules = typing.get_args(hint) if typing.get_origin(hint) is Annotated else (hint,)
    return typing.get_origin(base) or base, typing.get_args(base), rules


def _parts(value: Any, hint: Any) -> list[tuple[str, Any, Any]] | None:
    """Return the parts of a value, each with its place and type hint, or None if the value is of another
    class or breaks a rule.
    """
    kind, of, rules = _split(hint)
    parts: list[tuple[str, Any, Any]] | None = None
    if kind is Mapping and isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        parts = [(f": {name}", part, of[1]) for name, part in value.items()]
    elif kind in (tuple, Sequence) and isinstance(value, tuple | list):
        each = [of[0]] * len(value) if kind is Sequence or ... in of else of
        parts = (
            [(f"[{k}]", *part) for k, part in enumerate(zip(value, each, strict=True))]
            if len(each) == len(value)
            else None
        )
    elif kind is Any or (kind is Callable and callable(value)):
        parts = []
    elif kind in (int, float):
        parts = [] if isinstance(value, int | kind) and not isinstance(value, bool) else None
    elif kind not in (Mapping, tuple, Sequence, Callable) and isinstance(value, kind):
        parts = [
            (f": {name}", getattr(value, name), one)
            for name, one in typing.get_type_hints(kind, include_extras=True).items()
        ]
    return parts if parts is not None and all(rule.holds(value) for rule in rules) else None


def _text(hint: Any) -> str:
    """Return what a value must be."""
    kind, of, rules = _split(hint)
    if rules or kind in WORDS:
        return rules[-1].text if rules else WORDS[kind]
    if kind in UNIONS:
        return " or ".join(_text(one) for one in of if one is not NoneType)
    if kind in (tuple, Sequence):
        return (
            f"a list of {_text(of[0])}" if kind is Sequence or ... in of else f"({', '.join(map(_text, of))})"
        )
    if kind is Mapping:
        return f"a dict of {_text(of[1])}"
    return f"{kind.__name__}(…)"


UNIONS = (typing.Union, UnionType)
WORDS = {
    Callable: "a function",
    str: "a string",
    int: "an integer",
    float: "a number",
    bool: "True or False",
    Any: "anything",
    Tolerance: "a tolerance, such as relative(…, because=…)",
    Family: "expression(…)",
    Itself: "is_its_own_truth(because=…)",
}
