"""One component of a student's ω̇ read as algebra: its product of ω, its weights of the moments, and its
divisor.

Every component that is wrong by its indices, signs and factors has the form

    (α₁ I₁ + α₂ I₂ + α₃ I₃) · ωₐ ω_b / D,      D one of 1, Iₐ, Iₐ I_b, 1/Iₐ, Iₐ + I_b, I₁ + I₂ + I₃, |I|,

so one linear fit for each product and divisor finds it, whatever the errors and however many.
"""

import functools
import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exercises.rigid_body.causes.agreement import AGREEMENT

Array = NDArray[np.float64]

LEAST_POINTS = 10  # a fit of three weights to fewer points is not conclusive
ORDINARY = (1e-2, 1e2)  # sizes of |ω| and I to which forms are fitted; they are confirmed at all points
PRODUCTS: tuple[tuple[int, ...], ...] = (
    *itertools.combinations_with_replacement(range(3), 2),
    *((a,) for a in range(3)),
    (),
)
OTHERS = 10  # OTHERS + a stands for the sum of the two moments other than a
TOTAL, NORM = 20, 21  # for the sum of all three and the root of the sum of their squares; ~a for a moment that is multiplied by
DIVISORS: tuple[tuple[int, ...], ...] = (
    (),
    *((a,) for a in range(3)),
    *itertools.combinations_with_replacement(range(3), 2),
    *((~a,) for a in range(3)),
    *((OTHERS + a,) for a in range(3)),
    (TOTAL,),
    (NORM,),
)


class Form(NamedTuple):
    """``weights`` of the three moments, or a ``constant`` if none is weighted, times the ω of ``product``
    over ``divisor``.
    """

    product: tuple[int, ...]
    divisor: tuple[int, ...]
    weights: tuple[float, float, float]
    constant: float | None = None


class Points:
    """The probes, prepared once for all fits: ω and I (n, 3).

    A fit uses the ``ordinary`` points, each divided by |ω|² through ``weight``; every point must confirm it.
    """

    def __init__(self, w: Array, moments: Array) -> None:
        products = np.array([np.prod(w[:, list(axes)], axis=1) for axes in PRODUCTS])
        divisors = np.array([_divisor(moments, axes) for axes in DIVISORS])
        designs = products[:, None, :, None] * moments / divisors[None, :, :, None]
        self._cells = list(itertools.product(PRODUCTS, DIVISORS))
        self._designs = designs.reshape(len(self._cells), *moments.shape)
        self.ordinary, self.weight = ordinary(w, moments)
        if len(self.ordinary) >= LEAST_POINTS:
            self._q, r = np.linalg.qr(self._designs[:, self.ordinary] * self.weight[:, None])
            self._back = np.linalg.inv(r)

    def forms(self, column: Array, agreement: float = AGREEMENT) -> list[Form | None]:
        """Return every form that gives ``column`` (n,) to ``agreement``; only None for a column of zeros."""
        if not column.any():
            return [None]
        if len(self.ordinary) < LEAST_POINTS:
            return []
        weighted = column[self.ordinary] * self.weight
        along = np.einsum("cnk,n->ck", self._q, weighted)
        left = np.abs(weighted - np.einsum("cnk,ck->cn", self._q, along)).max(axis=1)
        found: dict[Form | None, None] = {}
        for cell in np.flatnonzero(left <= agreement * np.abs(weighted).max()):
            weights = self._back[cell] @ along[cell]
            terms = self._designs[cell] * weights
            if np.all(np.abs(terms.sum(axis=1) - column) <= 10 * agreement * np.abs(terms).sum(axis=1)):
                found[_plain(*self._cells[cell], weights, 10 * agreement)] = None
        return list(found)


def ordinary(w: Array, moments: Array) -> tuple[NDArray[np.intp], Array]:
    """Return indices (m,) of the points with ω and I of ordinary size and no ω zero, and 1/|ω|² (m,) there."""
    low, high = ORDINARY
    speed = np.linalg.norm(w, axis=1)
    sized = (speed > low) & (speed < high) & np.all(w != 0, axis=1) & np.all((moments > low) & (moments < high), axis=1)
    chosen = np.flatnonzero(sized)
    return chosen, 1 / speed[chosen] ** 2


def _divisor(moments: Array, axes: tuple[int, ...]) -> Array:
    divisor = np.ones(len(moments))
    for a in axes:
        if a < 0:
            divisor = divisor / moments[:, ~a]
        elif a < OTHERS:
            divisor = divisor * moments[:, a]
        elif a == NORM:
            divisor = divisor * np.linalg.norm(moments, axis=1)
        else:
            divisor = divisor * (moments.sum(axis=1) - (moments[:, a - OTHERS] if a < TOTAL else 0.0))
    return divisor


def _plain(product: tuple[int, ...], divisor: tuple[int, ...], fitted: Array, whole: float) -> Form:
    """Return the form without factors that cancel: 3 I₁/I₁ is the constant 3."""
    size = float(np.abs(fitted).max())
    first, second, third = (_rounded(float(x), size, whole) for x in fitted)
    weights = (first, second, third)
    for a in set(divisor):
        if 0 <= a < OTHERS and weights[a] and all(x == 0 for b, x in enumerate(weights) if b != a):
            rest = list(divisor)
            rest.remove(a)
            return Form(product, tuple(rest), (0.0, 0.0, 0.0), weights[a])
    return Form(product, divisor, weights)


def _rounded(x: float, size: float, whole: float) -> float:
    """Return ``x``, or the 0, 1 or −1 it equals to the precision of the fit, with its significant digits."""
    if abs(x) <= whole * size:
        return 0.0
    near = float(np.sign(x))
    return near if abs(x - near) <= whole else float(f"{x:.{round(-np.log10(whole))}g}")


@functools.cache
def relabelled(form: Form, order: tuple[int, int, int]) -> Form:
    """Return the form as its author wrote it if the moments came in another order: I number a was really
    number order[a].
    """
    if order == (0, 1, 2):
        return form
    back = {real: a for a, real in enumerate(order)}
    divisor = tuple(sorted(_relabelled_axis(a, back) for a in form.divisor))
    first, second, third = (form.weights[order[a]] for a in range(3))
    return form._replace(divisor=divisor, weights=(first, second, third))


def _relabelled_axis(a: int, back: dict[int, int]) -> int:
    if a < 0:
        return ~back[~a]
    if a < OTHERS:
        return back[a]
    return a if a >= TOTAL else OTHERS + back[a - OTHERS]
