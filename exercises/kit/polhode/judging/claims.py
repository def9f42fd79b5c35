"""A call of ``validate`` as data, and its judgement: the notebook prints it, and a server can
judge the same numbers again.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polhode.judging import judge
from polhode.judging.judge import Judgement, Verdict

Array = NDArray[np.float64] | NDArray[np.complex128]
MOST_LABEL, MOST_DETAIL = 200, 500  # characters


class Kind(NamedTuple):
    """The names of the arrays and numbers that a kind of claim needs, and the judgement that takes them in
    this order.
    """

    arrays: tuple[str, ...]
    numbers: tuple[str, ...]
    judge: Callable[..., Judgement]


@dataclass(frozen=True)
class Claim:
    """A claim of a notebook. ``unfit`` says why an argument is not an array of numbers; ``arrays`` then
    lacks it. Only those of kind "close" may be complex.

    ``left_out`` says why the arrays of a claim received from elsewhere are missing; the claim is then
    unmeasured. ``detail`` is the text of a claim of kind "check"; other kinds derive theirs from the numbers.
    """

    kind: str
    label: str
    arrays: Mapping[str, Array] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)
    detail: str = ""
    unfit: str = ""
    left_out: str = ""

    def judged(self) -> Judgement:
        """Return the judgement. An argument that is not an array of finite numbers fails, and the detail
        names it.
        """
        kind = KINDS[self.kind]
        if self.left_out:
            return Judgement(Verdict.UNMEASURED, f"not measured: {self.left_out}")
        if self.unfit:
            return Judgement(Verdict.FAIL, self.unfit)
        for name in kind.arrays:
            if not np.all(np.isfinite(self.arrays[name])):
                return Judgement(Verdict.FAIL, f"{name} holds values that are not finite numbers")
        with np.errstate(all="ignore"):
            found = kind.judge(
                *(self.arrays[a] for a in kind.arrays), *(self.numbers[n] for n in kind.numbers)
            )
        return Judgement(
            found.verdict, self.detail or found.detail, found.measured, found.expected, found.margin
        )

    def outcome(self, cell: str) -> "NotebookCheck":
        """Return the judged claim, made in ``cell``, as a report's NotebookCheck."""
        found = self.judged()
        return NotebookCheck(
            cell=cell, kind=self.kind, label=self.label, verdict=found.verdict, detail=found.detail
        )


@dataclass(kw_only=True)
class NotebookCheck:
    """A line of the notebook's own checks in a report, judged again from the numbers that the student's code
    passed.

    It is self-reported: the student's code chooses the numbers. It carries no points and changes no verdict.
    """

    cell: str
    kind: str
    label: str
    verdict: Verdict
    detail: str

    COMPUTED_FIELDS: ClassVar = ("line",)

    @property
    def line(self) -> str:
        """Return the ✓/✗ line as the notebook prints it."""
        return judge.line(self.verdict, self.label, self.detail)


def claim(
    kind: str, label: Any, given: Mapping[str, Any], numbers: Mapping[str, float], detail: Any = ""
) -> Claim:
    """Return a claim for whatever a student passed as ``given``. Never raises for an argument of the wrong
    kind.
    """
    arrays, unfit = {}, ""
    for name, value in given.items():
        try:
            arrays[name] = (
                _truth(value) if kind == "check" else _numbers(name, value, of_complex=kind == "close")
            )
        except _Unfit as reason:
            unfit = unfit or str(reason)
    return Claim(kind, one_line(label, MOST_LABEL), arrays, numbers, one_line(detail, MOST_DETAIL), unfit)


def one_line(value: Any, most: int) -> str:
    """Return ``value`` as text without line breaks, at most ``most`` characters long."""
    try:
        return " ".join(str(value).split())[:most]
    except Exception:
        return type(value).__name__


class _Unfit(Exception):
    """An argument is not an array of numbers that the kind of claim compares."""


def _numbers(name: str, value: Any, *, of_complex: bool) -> Array:
    """Return the values as real numbers, or as complex ones, ``of_complex``, if an imaginary part is not
    zero.
    """
    if isinstance(value, str):
        raise _Unfit(f"{name} is a string: pass the arrays first and the label last")
    if value is None:
        raise _Unfit(f"{name} is None: nothing was computed or returned")
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":
            array = _floats(array)
        if array.dtype.kind == "c" and not np.any(array.imag):
            array = array.real
        if array.dtype.kind in "fiu" or (array.dtype.kind == "c" and of_complex):
            return array.astype(complex if array.dtype.kind == "c" else float)
    except Exception as error:
        raise _Unfit(
            f"{name} is {type(value).__name__}, not an array of numbers ({one_line(error, 80)})"
        ) from None
    raise _Unfit(f"{name} is {array.dtype}, not real numbers")


def _floats(array: NDArray[Any]) -> Array:
    """Return objects, such as numbers of sympy, as real numbers, else as complex ones."""
    try:
        return array.astype(float)
    except TypeError:
        return array.astype(complex)


def _truth(value: Any) -> Array:
    """Return a condition as 1 or 0: True or False of Python, numpy or sympy, or an array that holds one of
    them.
    """
    if type(value).__module__ == "sympy.logic.boolalg" and type(value).__name__ in (
        "BooleanTrue",
        "BooleanFalse",
    ):
        value = bool(value)  # sympy's answer to Rational(1, 2) < 1
    if (
        not isinstance(value, bool | np.bool_ | np.ndarray)
        or np.asarray(value).dtype != bool
        or np.size(value) != 1
    ):
        what = f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__
        reduce = " (use np.all)" if isinstance(value, np.ndarray) and value.size > 1 else ""
        raise _Unfit(f"condition is {what}: pass a single True or False{reduce}")
    return np.asarray(value, dtype=float).reshape(())


def _close(got: Array, expected: Array, rtol: float, atol: float) -> Judgement:
    """Judge two arrays, of which one may be a single number for every element of the other, if it has any."""
    if 0 in (got.ndim, expected.ndim) and got.size and expected.size:
        got, expected = np.broadcast_arrays(got, expected)
    return judge.close(got, expected, rtol, atol)


def _check(condition: Array) -> Judgement:
    ok = bool(np.array_equal(condition, 1.0))
    return judge.holds(ok, str(ok))


KINDS: Mapping[str, Kind] = {
    "close": Kind(("got", "expected"), ("rtol", "atol"), _close),
    "conserved": Kind(("series",), ("rel_drift",), judge.conserved),
    "check": Kind(("condition",), (), _check),
    "positive": Kind(("value",), (), judge.positive),
    "below": Kind(("value",), ("limit",), judge.below),
}
