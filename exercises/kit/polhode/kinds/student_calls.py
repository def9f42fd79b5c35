"""Calls of a student's function: the arguments of each row, functions among them,
and the values it returns.
"""

import ast
import builtins
import functools
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging.exercise import Figure
from polhode.judging.remarks import Absent, absent
from polhode.judging.return_value import (
    WrongAnswer,
    article,
    check_signature,
    exchanged,
    is_written,
    real_array,
    wrong_value,
)

# of a function argument, unless the question allows fewer: then ten times as many as it allows, and each call
# counts for its places, see evaluations
MOST_CALLS = 20_000
LONGEST_CALL = 60  # characters of an author's expression in a sentence for students
NAMES = """
    abs arccos arcsin arctan arctan2 arcsinh arctanh array cos cosh cross dot exp expm1 heaviside hypot log
    log10 log1p maximum minimum pi sign sin sinc sinh sqrt stack tan tanh where
"""
MATHEMATICS = {name: getattr(np, name) for name in NAMES.split()} | {"np": np}
KNOWN = {*MATHEMATICS, *dir(builtins)}
"""The names that an author's expressions may use: those of MATHEMATICS, and Python's own, such as sum."""


Array = NDArray[np.float64]


class NotFinite(WrongAnswer):
    """The ``numbers`` of a value are not all finite."""

    def __init__(self, sentence: str, numbers: Array) -> None:
        super().__init__("not-finite", sentence)
        self.numbers = numbers


class Counted:
    """A function that counts its calls, with a ``unit`` as ``evaluations`` does. Raises WrongAnswer at the
    call after ``most``. Has a name, as any function.
    """

    def __init__(self, function: Callable[..., Any], name: str, most: int, unit: int | None = None) -> None:
        self.function, self.__name__, self._most, self._unit, self.calls = function, name, most, unit, 0

    def __call__(self, *values: Any, **named: Any) -> Any:
        """Call the function."""
        self.calls += 1 if self._unit is None else evaluations([*values, *named.values()], self._unit)
        if self.calls > self._most:
            raise WrongAnswer(None, f"it called {self.__name__} more than {self._most} times")
        return self.function(*values, **named)


def evaluations(values: Iterable[Any], unit: int) -> int:
    """Return how many calls a call with these ``values`` counts for: one for each ``unit`` numbers of the
    longest, so that a call with many places at once is not one call.
    """
    return max([1, *(-(-_numbers(value) // unit) for value in values)])


def unit_of(given: Iterable[Any]) -> int:
    """Return the numbers of the longest of the values with which a question calls the student's function."""
    return max([1, *map(_numbers, given)])


def _numbers(value: Any) -> int:
    return sum(map(_numbers, value)) if isinstance(value, (list, tuple)) else int(np.size(value))


def each_row(rows: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the drawn values of each row by name: a number, a text, or an array of its own. Nothing drawn is
    one row.
    """
    if not rows:
        yield {}
    columns = {name: np.asarray(column) for name, column in rows.items()}
    for values in zip(*columns.values(), strict=True):
        yield {name: _plain(value) for name, value in zip(columns, values, strict=True)}


def arguments(question: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of one call by parameter: constants, values of the row, generators, symbols,
    counted functions. A row of a server may hold a function itself, which another process answers.
    """
    given = {
        name: np.array(value) if isinstance(value, list) else value
        for name, value in question["constants"].items()
    }
    values = {**given, **row}
    most, unit = MOST_CALLS, None
    if limit := question.get("calls"):
        most = 10 * limit["limit"]
        unit = unit_of(
            values[name] for name in question["parameters"] if name in values and not callable(values[name])
        )
    for name, family in question["families"].items():
        if (function := values.get(name)) is None:
            scope = {known: values.pop(known) for known in family["given"]}
            function = expression(family["text"], tuple(family["over"]), scope)
        values[name] = Counted(function, name, most, unit)
    values |= {name: np.random.default_rng(values[name]) for name in question.get("generators", ())}
    values |= {name: _symbol(name, assumptions) for name, assumptions in question.get("symbols", {}).items()}
    return {parameter: values[parameter] for parameter in question["parameters"]}


def restart(given: Mapping[str, Any]) -> None:
    """Count the calls of the function arguments from zero again."""
    for value in given.values():
        if isinstance(value, Counted):
            value.calls = 0


def call(
    question: Mapping[str, Any], student: Mapping[str, Any], given: Mapping[str, Any], *, first: bool = True
) -> Any:
    """Return the answer of the student's function to these arguments, or the value of the student's variable.

    Raises WrongAnswer if the function cannot be called with them, of which only the ``first`` call is asked,
    or changes one of them.
    """
    if variables := question.get("variables"):
        named = {name: student.get(name) for name in variables}
        return named if question.get("keys") else named[variables[0]]
    name, parameters = question["function"], tuple(question["parameters"])
    function = student[name]
    if text := question.get("call"):
        return evaluate(text, {**given, name: _copying(function)})
    if first:
        check_signature(function, parameters, name)
    copies = {key: value.copy() if isinstance(value, np.ndarray) else value for key, value in given.items()}
    try:
        answer = function(*copies.values())
    except (TypeError, IndexError, ValueError):
        if own := exchanged(function, parameters):
            raise WrongAnswer(
                "swapped-arguments", f"{name} is called as ({', '.join(parameters)}); yours takes {own}"
            ) from None
        raise
    for key, value in copies.items():
        if isinstance(value, np.ndarray) and not _equal(value, given[key]):
            raise WrongAnswer(
                "mutates-input", f"{name} changes its argument {key}: work on a copy, or build a new array"
            )
    return answer


def _equal(one: NDArray[Any], other: NDArray[Any]) -> bool:
    if (
        one.tobytes() == other.tobytes() and one.shape == other.shape
    ):  # the common case, in a tenth of the time
        return True
    return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


def _copying(function: Any) -> Any:
    """Return a function that returns copies of the arrays that ``function`` returns: an author's expression
    may keep the results of several calls.
    """
    if not inspect.isroutine(function):
        return function

    @functools.wraps(function)
    def copying(*values: Any, **named: Any) -> Any:
        answer = function(*values, **named)
        return answer.copy() if type(answer) is np.ndarray else answer

    return copying


def evaluate(text: str, names: Mapping[str, Any]) -> Any:
    """Return the value of an author's expression, which may use ``names`` and MATHEMATICS, or what the last
    function that ``text`` defines returns: it is called with the ``names`` that it takes.
    """
    if is_source(text):
        function = _defined(text)
        return function(**{name: names[name] for name in inspect.signature(function).parameters})
    return eval(_code(text), {**MATHEMATICS, **names})  # noqa: S307


@functools.cache
def is_source(text: str) -> bool:
    """Return whether an author's ``text`` is a source that defines functions, instead of an expression."""
    return isinstance(ast.parse(text).body[-1], ast.FunctionDef)


def _defined(text: str) -> Callable[..., Any]:
    """Return the last function that a source defines. Its functions may use MATHEMATICS."""
    code, name = _code_and_name(text)
    scope = dict(MATHEMATICS)
    exec(code, scope)
    function: Callable[..., Any] = scope[name]
    return function


@functools.cache
def _code_and_name(source: str) -> tuple[Any, str]:
    """Return the compiled source of functions, and the name of the last one."""
    tree = ast.parse(source)
    return compile(tree, "question", "exec"), tree.body[-1].name  # type: ignore[attr-defined]


def each(
    rows: Mapping[str, Any], answer: Callable[[dict[str, Any]], Mapping[str, Any]]
) -> dict[str, NDArray[np.float64]]:
    """Return the arrays that ``answer`` returns for each row of drawn values, by name, rows along the first
    index.
    """
    return stacked([answer(row) for row in each_row(rows)])


def parts(question: Mapping[str, Any], answer: Any) -> list[Any]:
    """Return the values of an answer in the order that the question states. Raises WrongAnswer if it has
    others. A key that is missing beside others has a WrongAnswer as its value.
    """
    names, keys = [value["name"] for value in question["returns"]], question.get("keys")
    if len(names) == 1 and not keys:
        return [answer]
    if answer is None:
        raise WrongAnswer(
            "returns-nothing", f"{question['function']} returned None: is a return statement missing?"
        )
    is_several = isinstance(answer, Mapping if keys else tuple | list) or (not keys and np.ndim(answer) > 0)
    if is_several and not keys and len(answer) == len(names):
        return list(answer)
    if is_several and keys and set(names) <= set(answer):
        return [answer[name] for name in names]
    if not is_several:
        had = article(type(answer).__name__)
    else:
        had = f"the keys {', '.join(map(str, answer))}" if keys else f"{len(answer)} values"
    wanted = (
        f"a dict with the keys {', '.join(names)}" if keys else f"{len(names)} values ({', '.join(names)})"
    )
    wrong = WrongAnswer("wrong-shape", wrong_value(*_named(question), wanted, had))
    if is_several and keys and not set(names).isdisjoint(answer):
        return [answer.get(name, wrong) for name in names]
    raise wrong


def returned(question: Mapping[str, Any], answer: Any, *, alone: bool = False) -> dict[str, Array]:
    """Return the values of an answer by name, of exactly the shapes that the question states. Raises
    WrongAnswer.

    A complex value of shape s becomes real and imaginary parts of shape (*s, 2). If each stands ``alone``,
    one that is not finite is returned beside others, and one of the wrong kind is noted as absent beside
    others; such an answer is NaN.
    """
    values, found, wrong = question["returns"], dict[str, Array](), dict[str, WrongAnswer]()
    for value, part in zip(values, parts(question, answer), strict=True):
        try:
            found[value["name"]] = _value(question, value, part)
        except WrongAnswer as error:
            if not alone:
                raise
            wrong[value["name"]] = error
    if len(wrong) == len(values):
        raise next(iter(wrong.values()))
    return found | {
        value["name"]: _left_out(value, wrong[value["name"]]) for value in values if value["name"] in wrong
    }


def _left_out(value: Mapping[str, Any], error: WrongAnswer) -> Array:
    """Return the numbers that stand for a wrong value beside right ones. Raises the error if nobody keeps
    notes.
    """
    if isinstance(error, NotFinite):
        return error.numbers
    if not absent(value["name"], Absent(str(error), error.code)):
        raise error
    return np.full((*value["shape"], 2) if value.get("complex") else tuple(value["shape"]), np.nan)


def _value(question: Mapping[str, Any], value: Mapping[str, Any], part: Any) -> Array:
    """Return one value of an answer. Raises WrongAnswer."""
    name, is_returned = _named(question)
    if question.get("variables"):
        name = value["name"]
        if not is_written(part, True):
            raise WrongAnswer("missing-function", f"{name} is not defined")
    elif len(question["returns"]) > 1:
        name = f"{name} ({value['name']})"
    if isinstance(part, WrongAnswer):
        raise part
    array = _number_array(part, value, name, is_returned)
    if not np.isfinite(array).all():
        raise NotFinite(f"{name} {'returned' if is_returned else 'has'} a value that is not finite", array)
    return array


def _named(question: Mapping[str, Any]) -> tuple[str, bool]:
    """Return what a sentence calls the answer, and whether a function of the student returned it."""
    call = question.get("call")
    if call:
        is_short = len(call) <= LONGEST_CALL
        return f"`{call}`" if is_short else f"what the check makes of {question['function']}'s answers", False
    return question["function"], not question.get("variables")


def stacked(answers: Sequence[Mapping[str, Any]]) -> dict[str, NDArray[np.float64]]:
    """Return the arrays of all rows by name, rows along the first index."""
    return {name: np.array([answer[name] for answer in answers]) for name in answers[0]}


def flat(names: Iterable[str], state: Mapping[str, Any]) -> NDArray[np.float64]:
    """Return the arguments ``names`` of a ``state``, numbers and arrays, as one array (d,)."""
    return np.concatenate([np.ravel(state[name]) for name in names]).astype(float)


def split(names: Sequence[str], like: Mapping[str, Any], y: NDArray[np.float64]) -> dict[str, Any]:
    """Return the arguments ``names`` that the array ``y`` (d,) holds,
    with the shapes of those in ``like``.
    """
    parts = np.split(y, np.cumsum([np.size(like[name]) for name in names])[:-1])
    shapes = [np.shape(like[name]) for name in names]
    return {
        n: p.reshape(shape).copy() if shape else float(p[0])
        for n, p, shape in zip(names, parts, shapes, strict=True)
    }


def describe(question: Mapping[str, Any], seen: Mapping[str, Any], row: int) -> str:
    """Return the drawn arguments of one row as text: "M = 0.3, e = 0.5"."""
    return ", ".join(f"{name} = {_short(seen[f'at_{name}'][row])}" for name in question["drawn"])


def part_figure(
    question: Mapping[str, Any], part: str, title: str, alt: str, draw: Callable[..., None]
) -> list[Figure]:
    """Return the figure of a part of the question, none if it has no such part."""
    name = f"{question['id']}-{part}"
    return [Figure(name, title, alt, (name,), draw)] if part in question["parts"] else []


def _number_array(value: Any, spec: Mapping[str, Any], name: str, is_returned: bool) -> NDArray[np.float64]:
    shape = tuple(spec["shape"])
    if spec.get("boolean") and _kind(value) == "b":
        value = np.asarray(value, dtype=float)
    if not spec.get("complex"):
        return real_array(value, shape, name, is_returned)
    both = (np.real(value), np.imag(value)) if _kind(value) == "c" else (value, np.zeros(shape))
    return np.stack([real_array(part, shape, name, is_returned) for part in both], axis=-1)


def _kind(value: Any) -> str:
    try:
        return np.asarray(value).dtype.kind
    except ValueError:  # a ragged list
        return ""


@functools.cache
def _code(text: str) -> Any:
    return compile(ast.parse(text, mode="eval"), "question", "eval")


def expression(text: str, over: tuple[str, ...], given: Mapping[str, Any]) -> Callable[..., Any]:
    """Return the function of the variables ``over`` that an expression is. It may use the values ``given``
    and MATHEMATICS. Instead, ``text`` may define functions, of which the last takes both.

    A list or tuple among its arguments is taken as an array. As of any function, an argument can be given by
    its name.
    """
    made = _defined(text) if is_source(text) else None
    code: Any = None if made else _code(text)
    scope = {**MATHEMATICS, **given}

    def function(*values: Any, **named: Any) -> Any:
        taken = {**dict(zip(over, values, strict=False)), **named}
        if len(values) + len(named) != len(over) or taken.keys() != set(over):
            raise TypeError(f"the function takes ({', '.join(over)})")
        arrays = {
            name: np.array(value) if isinstance(value, list | tuple) else value
            for name, value in taken.items()
        }
        return made(**arrays, **given) if made else eval(code, scope, arrays)  # noqa: S307

    return function


def _symbol(name: str, assumptions: Mapping[str, bool]) -> Any:
    import sympy

    return sympy.Symbol(name, **assumptions)


def _plain(value: Any) -> Any:
    return value.item() if getattr(value, "ndim", None) == 0 else value


def _short(value: Any) -> str:
    if np.ndim(value) == 0:
        return value if isinstance(value, str) else f"{value:.6g}"
    return " ".join(
        np.array2string(
            value, precision=4, threshold=12, edgeitems=3 if value.ndim < 2 else 1, separator=", "
        ).split()
    )
