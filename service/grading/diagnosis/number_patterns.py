"""What wrong numbers are, read from them alone: an argument, a multiple of the right ones, rounded ones."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis

SINGLE_PRECISION = 1e-5  # greatest relative error of values that are too few digits
DIGITS = range(1, 11)
ORDER = 1e-6  # greatest relative error of right values in another order
NEARLY_ONE = 1e-3  # of what a factor differs from 1: a larger rest is an error of another kind


def numbers_at(given: NDArray[Any] | None, at: int | None) -> NDArray[Any] | None:
    """Return the drawn numbers of an argument, or those at an index of it, None if it has none there."""
    if given is None or given.dtype.kind not in "fiu":
        return None
    if at is None:
        return given
    return given[:, at] if given.ndim == 2 and at < given.shape[1] else None


def constant_factor(got: NDArray[np.float64], want: NDArray[np.float64], *, precisely: bool = False) -> float:
    """Return the constant by which all values, at least two different ones, are multiplied; 0.0 if there is
    none. A factor nearly one counts only if the values are known so ``precisely``.
    """
    if not np.all(np.isfinite([got, want])):
        return 0.0
    large = np.abs(want) > 1e-3 * np.abs(want).max()
    if not large.any() or np.ptp(want[large]) == 0:
        return 0.0
    factor = float(np.median(got[large] / want[large]))
    left = float(np.abs(got - factor * want).max() / np.abs(want).max())
    if not left <= min(1e-9, NEARLY_ONE * abs(factor - 1)) or (
        abs(factor - 1) < NEARLY_ONE and not precisely
    ):
        return 0.0
    return factor


DEGREE, RPM, TURN = np.pi / 180, 2 * np.pi / 60, 2 * np.pi
ROUNDED = 2e-4  # relative: what 57.3 or 3.14 for π is off by at most, or nearly so
UNITS = {
    1 / DEGREE: "180/π converts radians into degrees",
    DEGREE: "π/180 converts degrees into radians",
    RPM: "2π/60 converts revolutions per minute into rad/s",
    1 / RPM: "60/2π converts rad/s into revolutions per minute",
    TURN: "2π converts revolutions into radians",
    1 / TURN: "1/2π converts radians into revolutions",
}


def factor_in_words(factor: float, what: str, *, whole: bool) -> tuple[str, str]:
    """Return code and sentence if ``what``, the ``whole`` answer or a component, is the right value times
    ``factor``.
    """
    if factor == -1.0:
        return "sign-reversed" if whole else "sign-flipped", f"{what} has the opposite sign"
    for unit, converts in UNITS.items():
        squared = abs(abs(factor) / unit**2 - 1.0) < ROUNDED
        if squared or abs(abs(factor) / unit - 1.0) < ROUNDED:
            twice = ", and its square is that factor" if squared else ""
            return "units", f"{what} is {factor:.6g} times the right value: {converts}{twice}"
    return "constant-factor", f"{what} is {factor:.10g} times the right value"


def extra_term(
    got: NDArray[np.float64], want: NDArray[np.float64], term: NDArray[np.float64], unit: NDArray[np.float64]
) -> tuple[str, ...]:
    """Return the codes of values that are the right ones, or their negatives, plus a constant times a
    ``term``; none if they are not. ``unit`` is the scale of each right value.
    """
    size = np.maximum(unit, np.abs(got))
    columns = np.stack([want / size, term / size], axis=-1)
    if not (np.all(np.isfinite(columns)) and np.all(np.isfinite(got))):
        return ()
    (own, added), *_ = np.linalg.lstsq(columns, got / size, rcond=None)
    left = float(np.abs(columns @ np.array([own, added]) - got / size).max())
    is_there = float(np.abs(added * columns[:, 1]).max()) > 1e3 * left
    if left > 1e-9 or not is_there or abs(abs(own) - 1.0) > 1e-6:
        return ()
    return ("extra-term",) if own > 0 else ("extra-term", "sign-flipped")


def order_of(got: Sequence[NDArray[Any]], want: Sequence[NDArray[Any]]) -> list[int]:
    """Return which right array each array is, nothing if they are not all of them in another order."""
    if any(array.shape != want[0].shape for array in (*got, *want)):
        return []

    def is_(array: NDArray[Any], right: NDArray[Any]) -> bool:
        return np.allclose(array, right, rtol=ORDER, atol=ORDER * np.abs(right).max())

    alike = [[k for k, right in enumerate(want) if is_(array, right)] for array in got]
    order = [found[0] for found in alike if len(found) == 1]
    return order if sorted(order) == list(range(len(want))) and order != sorted(order) else []


def too_few_digits(got: NDArray[np.float64], want: NDArray[np.float64]) -> str:
    """Return how values were rounded: "is rounded to 3 decimals", or "" if they were not."""
    for digits in DIGITS:
        if np.array_equal(got, np.round(got, digits)) and np.allclose(
            got, want, rtol=0, atol=0.6 * 10.0**-digits
        ):
            return f"is rounded to {digits} decimals"
    near = np.allclose(got, want, rtol=SINGLE_PRECISION, atol=SINGLE_PRECISION * np.abs(want).max())
    if near and np.array_equal(got, got.astype(np.float32)):
        return "has the digits of single precision (float32)"
    return ""


def unrepeatable(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return the diagnosis of answers to equal inputs that differ in any bit, or that depend on the time of a
    right-hand side alone; none if there is no such pair of inputs.
    """
    name, time = question["function"], question.get("time")
    numeric = [n for n in question["drawn"] if np.asarray(seen.get(f"at_{n}")).dtype.kind in "fiub"]
    if len(numeric) < len(question["drawn"]) or not numeric:
        return []
    if not _repeats(question, seen, numeric):
        sentence = (
            f"{name} does not always return the same value for the same arguments: it must not use the clock,"
            " random numbers or results of earlier calls"
        )
        return [Diagnosis("not-deterministic", sentence, 1.0)]
    others = [n for n in numeric if n != time]
    may_differ = question["kind"] != "ode" or time not in numeric or not others
    if (
        not may_differ
        and not _repeats(question, seen, others)
        and _repeats(question, {**seen, **truth}, others)
    ):
        sentence = f"{name} depends on {time}: the right values do not"
        return [Diagnosis("time-dependent", sentence, 1.0)]
    return []


def _repeats(question: Mapping[str, Any], seen: Arrays, drawn: Sequence[str]) -> bool:
    """Return whether answers to inputs that are equal in the ``drawn`` arguments are equal in all bits."""
    rows = np.column_stack(
        [np.asarray(seen[f"at_{n}"], float).reshape(len(seen[f"at_{n}"]), -1) for n in drawn]
    )
    _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    again = first[which.ravel()]
    return all(
        np.array_equal(seen[value["name"]], seen[value["name"]][again], equal_nan=True)
        for value in question["returns"]
        if value["name"] in seen
    )


NEARLY = 0.01  # of the largest exact number of an input
FEW = 0.1  # of the inputs: no hint that so few are right, such as a body at rest
REMEDY = "compute it from the equations, not by numerical differentiation or integration"


def in_general(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return what wrong values that nothing explains have in common: that they are not finite, nearly right,
    or right for some inputs; nothing for values without a scale of their own.
    """
    name, (value, *others) = question["function"], question["returns"]
    got, want = seen[value["name"]], truth[value["name"]]
    if others or not value.get("scaled") or got.ndim != 2:
        return []
    finite = np.isfinite(got).all(axis=1)
    if not finite.all():
        number = f"{(~finite).sum()} of {len(got)} inputs"
        sentence = f"{name} is not finite for {number}: look for a division by zero"
        return [Diagnosis("not-finite", sentence, 1.0)]
    scale = truth[f"{value['name']}_scale"].max(axis=1)
    off, size = np.abs(got - want).max(axis=1), np.maximum(np.abs(want).max(axis=1), 1e-3 * scale)
    right, near = off <= float(value["tolerance"]["limit"]) * scale, off <= NEARLY * size
    if near.mean() > 0.9 and right.mean() < 0.5:
        share = float((off[near] / size[near]).max())
        return [Diagnosis("nearly-right", f"{name} is within {share:.2g} of the right values: {REMEDY}", 0.8)]
    if right.mean() > FEW:
        number = f"{right.sum()} of {len(got)} inputs"
        sentence = f"{name} is right for {number}: look for what differs in the others"
        return [Diagnosis("partly-right", sentence, 1.0)]
    return []
