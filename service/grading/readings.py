"""What wrong numbers are, read from them alone: an argument, a multiple of the right ones, rounded ones."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

SINGLE_PRECISION = 1e-5  # greatest relative error of values that are too few digits
DIGITS = range(1, 11)
ORDER = 1e-6  # greatest relative error of right values in another order
NEARLY_ONE = 1e-3  # a factor that differs less from 1 is no factor but an error of another kind


def numbers_at(given: NDArray[Any] | None, at: int | None) -> NDArray[Any] | None:
    """Return the drawn numbers of an argument, or those at an index of it, None if it has none there."""
    if given is None or given.dtype.kind not in "fiu":
        return None
    if at is None:
        return given
    return given[:, at] if given.ndim == 2 and at < given.shape[1] else None


def constant_factor(got: NDArray[np.float64], want: NDArray[np.float64]) -> float:
    """Return the constant by which all values, at least two different ones, are multiplied; 0.0 if there is
    none.
    """
    large = np.abs(want) > 1e-3 * np.abs(want).max()
    if not large.any() or np.ptp(want[large]) == 0:
        return 0.0
    factor = float(np.median(got[large] / want[large]))
    if abs(factor - 1) < NEARLY_ONE:
        return 0.0
    return factor if np.allclose(got, factor * want, rtol=1e-9, atol=1e-9 * np.abs(want).max()) else 0.0


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
