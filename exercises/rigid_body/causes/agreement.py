"""Comparison of two sets of rates to rounding, point by point: the points differ in size by many orders of
magnitude.
"""

import numpy as np
from numpy.typing import NDArray

from exercises.rigid_body.probes import scale

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

AGREEMENT = 1e-11  # of the largest value at a point: the same algebra agrees to rounding
ROUNDING = 1e-14  # of the largest product that the right equations form there


def agree(seen: Array, expected: Array, w: Array, moments: Array) -> Mask:
    """Return whether each of the rates (n, 3) is the expected one, or both are not finite."""
    known, due = np.isfinite(seen), np.isfinite(expected)
    got, want = np.where(known, seen, 0.0), np.where(due, expected, 0.0)
    size = np.maximum(np.abs(got), np.abs(want)).max(axis=1, keepdims=True)
    return np.asarray((known == due) & (np.abs(got - want) <= AGREEMENT * size + ROUNDING * scale(w, moments)))


def same(seen: Array, expected: Array, w: Array, moments: Array) -> bool:
    """Return whether all rates are the expected ones."""
    return bool(np.all(agree(seen, expected, w, moments)))
