"""Strict reading of what a student's function returned: a real array of exactly the expected shape, or an
error sentence.
"""

import dis
import inspect
import re
import traceback
import types
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging.remarks import remark

ONE_NUMBER = "an array of shape {shape}, which is accepted for a number: use x.item()"
OVERWRITES = (
    "{name} returns the same array at each call and overwrites it, which changes the numbers of whoever keeps"
    " it, such as SciPy's DOP853: return a new array"
)


class WrongAnswer(Exception):
    """The function returned something other than what was asked for. ``code`` is the diagnosis code, if one
    fits.
    """

    def __init__(self, code: str | None, sentence: str) -> None:
        super().__init__(sentence)
        self.code = code


class Kept:
    """The last answer of the function ``name``, which remarks that the next call has overwritten it."""

    def __init__(self, name: str) -> None:
        self._name, self._answer, self._copy = name, np.zeros(0), np.zeros(0)

    def replace(self, answer: Any) -> None:
        """Keep the answer of the next call."""
        if self._answer.tobytes() != self._copy.tobytes():
            remark(OVERWRITES.format(name=self._name))
        self._answer = answer if type(answer) is np.ndarray and answer.dtype.kind in "fiuc" else np.zeros(0)
        self._copy = self._answer.copy()


def check_signature(function: Any, names: tuple[str, ...], called: str) -> None:
    """Raise WrongAnswer if ``function``, named ``called``, cannot be called with one argument for each of
    ``names``.
    """
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return  # some callables written in C have no signature
    try:
        signature.bind(*names)
    except TypeError:
        raise WrongAnswer(
            "signature",
            f"the checks call `{called}({', '.join(names)})`, but yours is defined as `{called}{signature}`:"
            " change its parameters",
        ) from None


def exchanged(function: Any, names: tuple[str, ...]) -> str | None:
    """Return the parameters of ``function`` as text if they are ``names`` in another order, else None."""
    try:
        own = tuple(inspect.signature(function).parameters)[: len(names)]
    except (TypeError, ValueError):
        return None
    return f"({', '.join(own)})" if own != names and sorted(own) == sorted(names) else None


def is_written(value: Any, variable: bool = False) -> bool:
    """Return whether ``value`` is a callable, or for a ``variable`` anything but None, ``...`` and
    NotImplemented, and not empty.
    """
    given = not any(value is nothing for nothing in (None, ..., NotImplemented))
    return given and (variable or callable(value)) and not is_empty(value)


def missing(names: Mapping[str, Any], name: str, variable: bool) -> str | None:
    """Return why a submission's ``names`` have no function (or ``variable``) ``name``, or None if they have
    it.
    """
    if name not in names or (variable and not is_written(names[name], variable)):
        return f"{name} is not defined"
    if variable or callable(names[name]):
        return None
    return f"{name} is {_named(names[name])}, not a function"


def _named(value: Any) -> str:
    return "None" if value is None else f"of type {type(value).__name__}"


def is_empty(function: Any) -> bool:
    """Return whether a function's body, or that of each method of a class, is only a docstring, ``...``,
    ``pass`` or ``raise NotImplementedError("…")``: it is not written yet.
    """
    if isinstance(function, type):
        own = [getattr(value, "__func__", getattr(value, "fget", value)) for value in vars(function).values()]
        methods = [value for value in own if isinstance(value, types.FunctionType)]
        return all(map(is_empty, methods)) and bool(methods)
    if not isinstance(function, types.FunctionType) or not _CODE.issuperset(function.__code__.co_code[::2]):
        return False
    steps = list(dis.get_instructions(function))
    names = {getattr(step.argval, "__name__", step.argval) for step in steps if step.opname in _NAMED}
    values = [step.argval for step in steps if step.opname in _CONSTANT]
    if steps[-1].opname == "RAISE_VARARGS":
        return bool(names) and names <= _NOT_WRITTEN
    return names <= _NOT_WRITTEN and all(value in (None, ...) for value in values)


_NOT_WRITTEN = {"NotImplementedError", "NotImplemented"}
_CONSTANT, _NAMED = {"LOAD_CONST", "RETURN_CONST"}, {"LOAD_GLOBAL", "LOAD_COMMON_CONSTANT"}
_CALL = {"CACHE", "PUSH_NULL", "PRECALL", "CALL", "RAISE_VARARGS"}
_CODE = {
    dis.opmap[name]
    for name in (*_CONSTANT, *_NAMED, *_CALL, "RESUME", "NOP", "RETURN_VALUE")
    if name in dis.opmap
}


def real_array(
    value: Any, shape: tuple[int, ...], name: str, is_returned: bool = True
) -> NDArray[np.float64]:
    """Return ``value`` as float64 of exactly ``shape``. Lists and tuples of numbers are converted; nothing is
    broadcast.

    Complex numbers must have the imaginary part 0. An array of one number is accepted for a number, with a
    remark.

    Raises WrongAnswer for None, a ragged list, numbers that are not real, or another shape. Its sentence says
    that the function ``name`` returned it, or unless ``is_returned`` that ``name`` is it.
    """
    if (
        type(value) is np.ndarray and value.shape == shape and value.dtype == np.float64
    ):  # the common case, in a third of the time
        return value.copy()
    if value is None and is_returned:
        raise WrongAnswer("returns-nothing", f"{name} returned None: is a return statement missing?")
    wanted = "a number" if not shape else f"shape {shape}" if is_returned else f"an array of shape {shape}"
    try:
        array = np.asarray(value)
    except ValueError:
        raise WrongAnswer("wrong-shape", wrong_value(name, is_returned, wanted, "a ragged list")) from None
    if (
        array.dtype.kind == "c" and not array.imag.any()
    ):  # as np.linalg.eigvals returns real eigenvalues from NumPy 2.5 on
        array = array.real
    if array.dtype.kind not in "fiu":
        had = f"dtype {array.dtype}" if isinstance(value, np.ndarray) else article(type(value).__name__)
        had = _numbers_of_other_types(array) or had
        raise WrongAnswer(
            "wrong-shape", wrong_value(name, is_returned, "real numbers" if shape else "a real number", had)
        )
    if not shape and array.size == 1 and array.ndim:
        remark(f"{name} {'returned' if is_returned else 'is'} {ONE_NUMBER.format(shape=array.shape)}")
        array = array.reshape(())
    if array.shape != shape:
        had = f"shape {array.shape}" if is_returned else f"an array of shape {array.shape}"
        raise WrongAnswer(
            "wrong-shape", wrong_value(name, is_returned, wanted, had if array.ndim else "a number")
        )
    return np.array(array, dtype=np.float64)


def _numbers_of_other_types(array: NDArray[Any]) -> str:
    """Return what objects that float(x) converts are, and how to convert them, or "" if some are others."""
    names = sorted({type(x).__name__ for x in array.flat if not isinstance(x, int | float | np.number)})
    try:
        if array.dtype.kind != "O" or not all(hasattr(x, "__float__") for x in array.flat):
            return ""
        array.astype(float)
    except Exception:  # a symbol of sympy has no value, for example
        return ""
    convert = "convert it with float(x)" if array.ndim == 0 else "convert each with float(x)"
    return f"{article(names[0]) if array.ndim == 0 else ' and '.join(f'{n}s' for n in names)}: {convert}"


def wrong_value(name: str, is_returned: bool, wanted: str, had: str) -> str:
    """Return the sentence that a function returned, or a variable or expression is, something other than
    wanted.

    >>> wrong_value("speed", True, "a number", "shape (3,)")
    'speed must return a number; it returned shape (3,)'
    """
    return (
        f"{name} must return {wanted}; it returned {had}"
        if is_returned
        else f"{name} must be {wanted}; it is {had}"
    )


def article(noun: str) -> str:
    """Return ``noun`` after its indefinite article.

    >>> article("Equality"), article("str"), article("uint8")
    ('an Equality', 'a str', 'a uint8')
    """
    return f"{'an' if re.match('[aeio]|u(?!fu|int|ni)', noun, re.IGNORECASE) else 'a'} {noun}"


def describe_exception(error: BaseException, own: Callable[[str], bool]) -> dict[str, str | None]:
    """Return the fields ``ended``, ``code``, ``sentence`` and ``traceback`` of a scene end.

    ``own(filename)`` is true for the student's own code.
    """
    match error:
        case WrongAnswer():
            return {"ended": "wrong-answer", "code": error.code, "sentence": str(error)}
        case MemoryError():
            sentence = "your code asked for more memory than is allowed"
            return {
                "ended": "memory",
                "code": "memory",
                "sentence": sentence,
                "traceback": _trace(error, own),
            }
        case SyntaxError():
            return {
                "ended": "syntax-error",
                "code": "syntax-error",
                "sentence": _message(error),
                "traceback": _trace(error, own),
            }
    return {"ended": "raised", "code": "raises", "sentence": _message(error), "traceback": _trace(error, own)}


def _message(error: BaseException) -> str:
    try:
        return f"{type(error).__name__}: {error}"[:500]
    except BaseException:  # its own __str__ fails
        return type(error).__name__[:500]


def _trace(error: BaseException, own: Callable[[str], bool]) -> str | None:
    """Return the student's own frames of the traceback, without those of polhode and the libraries."""
    try:
        frames = [f for f in traceback.extract_tb(error.__traceback__) if own(f.filename)]
        return "".join(traceback.format_list(frames[-8:]) + traceback.format_exception_only(error))[:6000]
    except BaseException:
        return None
