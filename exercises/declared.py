"""What an author passes to the functions that make questions, and the errors of arguments of a wrong type."""

import ast
import inspect
import math
import reprlib
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any

import numpy as np

from ecp.checks import MOST_POINTS
from ecp.kinds.alignment import UP_TO
from ecp.outcome import Tolerance

ARGUMENTS = "fiubU"  # kinds of dtype
SHORT = reprlib.Repr()
SHORT.maxother = SHORT.maxstring = 90
Draw = Callable[[np.random.Generator], Any]


@dataclass(frozen=True)
class Rule:
    """What a value must be besides its type; ``text`` continues the sentence "it must be"."""

    text: str
    holds: Callable[[Any], bool]


def _parses(text: str) -> bool:
    try:
        ast.parse(text, mode="eval")
    except (SyntaxError, ValueError):
        return False
    return True


def _is_named(function: Callable[..., Any]) -> bool:
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return False
    return all(p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) for p in parameters)


def _numbers(kinds: str, holds: Callable[[Any], Any] = np.isfinite) -> Callable[[Any], bool]:
    """Return whether a value is a number or an array, with a dtype of one of the ``kinds``, whose numbers all hold."""

    def is_such(value: Any) -> bool:
        try:
            array = np.asarray(value)
        except ValueError:  # a ragged list
            return False
        return array.dtype.kind in kinds and array.size > 0 and bool(np.all(holds(array)))

    return is_such


Positive = Annotated[float, Rule("a number > 0", lambda x: 0 < x < math.inf)]
Count = Annotated[int, Rule("an integer ≥ 1", lambda n: n >= 1)]
Rows = tuple[Count, Annotated[int, Rule("an integer ≥ 0", lambda n: n >= 0)]]
Numbers = Annotated[Any, Rule("a real number or an array of real numbers", _numbers("fiu"))]
Deviations = Annotated[Any, Rule("a number > 0, or an array of such numbers", _numbers("fiu", lambda a: (a > 0) & (a < np.inf)))]
Expression = Annotated[str, Rule("an expression", _parses)]
Named = Annotated[Callable[..., Any], Rule("a function whose parameters have names", _is_named)]
Points = Annotated[int, Rule(f"an integer from 1 to {MOST_POINTS}", lambda n: 1 <= n <= MOST_POINTS)]
UpTo = Annotated[str, Rule(f"one of: {', '.join(UP_TO)}", UP_TO.__contains__)]
Limit = Annotated[Tolerance, Rule("Tolerance(limit=…, reason=…)", lambda t: t.limit is not None)]
Close = Annotated[Tolerance, Rule("Tolerance(rtol=…, atol=…, reason=…)", lambda t: t.limit is None)]
Absolute = Annotated[Tolerance, Rule("Tolerance(atol=…, reason=…)", lambda t: t.atol is not None)]


Asked = Annotated[
    Any, Rule("a real number, a string, an array of real numbers, a draw or a family", _numbers(ARGUMENTS, lambda a: True))
]


@dataclass(frozen=True)
class Family:
    """A function argument: an expression ``text`` over some variables, with parameters that are constant or drawn."""

    text: Expression
    over: tuple[str, ...]
    given: Mapping[str, Draw | Asked]


Ask = Mapping[str, Family | Draw | Asked]


@dataclass(frozen=True)
class Mistake:
    """A known wrong answer: ``old`` in the right solution's source replaced by ``new``.

    With a ``code`` it is a diagnosis, whose ``sentence`` says what the student did. ``line`` is its place in the declaration.
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

    reason: str


@dataclass(frozen=True)
class Value:
    """A value that a function returns: its tolerance, its label, and what it leaves ``up_to`` (ecp.kinds.alignment).

    ``points`` is what each of its checks is worth, the public and the hidden one. With ``partial`` a ✗ earns the points times the
    fraction of inputs that are right, rounded down.
    """

    tolerance: Tolerance
    label: str | None = None
    up_to: UpTo | None = None
    points: Points = 1
    partial: bool = False


Agree = Tolerance | Value | Annotated[Mapping[str, Tolerance | Value], Rule("a dict of them for several values", bool)]
"""A tolerance, or one with its label and points, of a single value, or those of several values by name."""
Truth = Named | Itself
LimitOrValue = Limit | Annotated[Value, Rule("Value(Tolerance(limit=…))", lambda v: getattr(v.tolerance, "limit", 0) is not None)]


def named_values(agree: Agree, label: str | None = None, **of_one: Any) -> dict[str, Value]:
    """Return the values that a question agrees on by name; a single one, with the other arguments of Value, is "value"."""
    if not isinstance(agree, Tolerance) and (label or of_one.get("up_to") or of_one.get("partial") or of_one.get("points", 1) != 1):
        raise ValueError("label=, up_to=, points= and partial= are for a single Tolerance: give them to each Value(…) instead")
    if isinstance(agree, Mapping):
        return {name: value if isinstance(value, Value) else Value(value) for name, value in agree.items()}
    return {"value": agree if isinstance(agree, Value) else Value(agree, label, **of_one)}


def tolerance_data(tolerance: Tolerance) -> dict[str, Any]:
    """Return a tolerance as JSON: the arguments of Tolerance."""
    return {key: number for key, number in vars(tolerance).items() if number is not None}


def type_errors(name: str, value: Any, hint: Any) -> Iterator[str]:
    """Yield what a value, or a part of it, is and what its type ``hint`` requires, as sentences; and the errors of tolerances."""
    options = typing.get_args(hint) if typing.get_origin(hint) in (typing.Union, UnionType) else (hint,)
    option = next((one for one in options if _fits(value, one)), None)
    if option is None:
        yield f"{name} is {SHORT.repr(value)}; it must be {' or '.join(map(_text, options))}"
        return
    errors = [error for at, part, of in _parts(value, option) for error in type_errors(f"{name}{at}", part, of)]
    if isinstance(value, Tolerance) and not errors:
        errors = [f"{name}: {error}" for error in tolerance_errors(value)]
    yield from errors


def tolerance_errors(tolerance: Tolerance) -> Iterator[str]:
    """Yield the errors of a tolerance."""
    numbers = [number for number in (tolerance.rtol, tolerance.atol, tolerance.limit) if number is not None]
    if not numbers:
        yield "the tolerance has no number: give rtol, atol or limit"
    if tolerance.limit is not None and len(numbers) > 1:
        yield "the tolerance has limit beside rtol or atol: give one or the other"
    if any(not (isinstance(number, int | float) and number >= 0 and math.isfinite(number)) for number in numbers):
        yield "a tolerance must be a finite number ≥ 0"
    if not tolerance.reason.strip():
        yield "the tolerance has no reason"


def _split(hint: Any) -> tuple[Any, tuple[Any, ...], list[Rule]]:
    """Return the class of a type hint, the types of its parts, and its rules."""
    base, *rules = typing.get_args(hint) if typing.get_origin(hint) is Annotated else (hint,)
    return typing.get_origin(base) or base, typing.get_args(base), rules


def _fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of the class of a type hint and follows its rules, whatever its parts are."""
    kind, parts, rules = _split(hint)
    if kind is Callable:
        fits = callable(value)
    elif kind in (int, float):
        fits = isinstance(value, int | kind) and not isinstance(value, bool)
    elif kind in (tuple, Sequence):
        fits = isinstance(value, tuple | list) and (kind is Sequence or parts[-1] is ... or len(value) == len(parts))
    elif kind is Mapping:
        fits = isinstance(value, Mapping) and all(isinstance(key, str) for key in value)
    else:
        fits = kind is Any or isinstance(value, kind)
    return fits and all(rule.holds(value) for rule in rules)


def _parts(value: Any, hint: Any) -> list[tuple[str, Any, Any]]:
    """Return the parts of a value, each with its place and its type hint."""
    kind, parts, _ = _split(hint)
    if is_dataclass(kind):
        return [(f": {name}", getattr(value, name), of) for name, of in typing.get_type_hints(kind, include_extras=True).items()]
    if kind is Mapping:
        return [(f": {name}", part, parts[1]) for name, part in value.items()]
    if kind in (tuple, Sequence):
        each = parts if kind is tuple and parts[-1] is not ... else [parts[0]] * len(value)
        return [(f"[{k}]", part, of) for k, (part, of) in enumerate(zip(value, each, strict=True))]
    return []


WORDS = {Callable: "a function", str: "a string", int: "an integer", float: "a number", bool: "True or False", NoneType: "None"}


def _text(hint: Any) -> str:
    kind, parts, rules = _split(hint)
    if rules:
        return rules[-1].text
    if kind in (typing.Union, UnionType):
        return " or ".join(map(_text, parts))
    if kind is Mapping:
        return "a dict" + (f" of {_text(parts[1])}" if parts[1] is not Any else "")
    if kind is Sequence or (kind is tuple and parts[-1] is ...):
        return f"a list of {_text(parts[0])}"
    if kind is tuple:
        return f"({', '.join(map(_text, parts))})"
    return WORDS.get(kind) or f"{kind.__name__ if kind in (Tolerance, Value) else kind.__name__.lower()}(…)"
