"""What a value may leave open, such as the signs of eigenvectors: the equivalent value that is nearest to the
exact one.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def aligned(got: Array, want: Array, up_to: str | None) -> Array:
    """Return the value equivalent to ``got`` that is nearest to ``want``, row by row; both have rows along
    the first index.

    "sign": the whole value may have the other sign. "order": numbers or rows of a list in any order. "column
    signs", "column phases" (complex values, as (…, 2)) and "column order and signs": of the columns of a
    matrix. "span": the columns may be any orthonormal basis of the same space. "full turns": angles in rad,
    to which multiples of 2π may be added.
    """
    if up_to is None or got.shape != want.shape or not np.all(np.isfinite(got)):
        return got
    return np.array([UP_TO[up_to][0](g, w) for g, w in zip(got, want, strict=True)])


def alignment_error(up_to: str, shape: Sequence[int], is_complex: bool) -> str | None:
    """Return why a value of this shape cannot be compared ``up_to``, None if it can."""
    dimensions, needs_complex = UP_TO[up_to][1:]
    if len(shape) < dimensions:
        return f"up_to={up_to!r} is for {'a matrix' if dimensions == 2 else 'a list'}"
    if needs_complex not in (None, is_complex):
        return f"up_to={up_to!r} is for {'complex' if needs_complex else 'real'} numbers"
    return None


def _sign(got: Array, want: Array) -> Array:
    return got if np.sum(got * want) >= 0 else -got


def _order(got: Array, want: Array) -> Array:
    from scipy.optimize import linear_sum_assignment

    distance = np.abs(got[:, None] - want[None, :]).reshape(len(got), len(want), -1).sum(axis=2)
    rows, columns = linear_sum_assignment(distance)
    return got[rows[np.argsort(columns)]]


def _column_signs(got: Array, want: Array) -> Array:
    return got * np.where(np.sum(got * want, axis=0) >= 0, 1.0, -1.0)


def _column_phases(got: Array, want: Array) -> Array:
    z, exact = got[..., 0] + 1j * got[..., 1], want[..., 0] + 1j * want[..., 1]
    overlap = np.sum(z.conj() * exact, axis=0)
    turned = z * np.where(
        np.abs(overlap) > 0, overlap / np.where(np.abs(overlap) > 0, np.abs(overlap), 1.0), 1.0
    )
    return np.stack([turned.real, turned.imag], axis=-1)


def _column_order_and_signs(got: Array, want: Array) -> Array:
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(-np.abs(got.T @ want))
    return _column_signs(got[:, rows[np.argsort(columns)]], want)


def _span(got: Array, want: Array) -> Array:
    if not np.allclose(got.T @ got, np.eye(got.shape[1]), atol=1e-6):
        return got
    left, _, right = np.linalg.svd(got.T @ want)
    return np.asarray(got @ (left @ right))


def _full_turns(got: Array, want: Array) -> Array:
    return np.asarray(got + 2 * np.pi * np.round((want - got) / (2 * np.pi)))


UP_TO: dict[str, tuple[Callable[[Array, Array], Array], int, bool | None]] = {
    "sign": (_sign, 0, None),
    "order": (_order, 1, None),
    "column signs": (_column_signs, 2, False),
    "column phases": (_column_phases, 2, True),
    "column order and signs": (_column_order_and_signs, 2, False),
    "span": (_span, 2, False),
    "full turns": (_full_turns, 0, False),
}
"""How each is aligned, the least number of dimensions it needs, and whether the numbers are complex, if it
matters.
"""
