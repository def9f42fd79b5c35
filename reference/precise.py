"""Elliptic integrals to fifty digits, and phases whose error does not grow with time.

A body's few constants are computed once with MPFR's 170-bit numbers (through gmpy2) and stored as pairs of
doubles. Each sample takes one exact product, so the error of a phase does not grow with the number of turns.
Call the functions inside ``with precision():``.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import gmpy2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Real = Any  # gmpy2.mpfr, which has no type hints

BITS = 170
_ENOUGH = 1e-26  # quadratic convergence: one more step squares it
_NEARLY_NOTHING = 1e-60
_SPLIT = 134217729.0  # 2²⁷ + 1 cuts a double into two halves whose product is exact (Dekker, 1971)


class Pair(NamedTuple):
    """An unevaluated sum of two doubles, exact to 32 digits."""

    high: float
    low: float


def precision() -> Any:
    """Return the gmpy2 context with BITS bits that this module's functions need."""
    return gmpy2.context(precision=BITS)


NOTHING = Pair(0.0, 0.0)


def pair(x: Real) -> Pair:
    """Return the nearest double to ``x`` and the rest."""
    high = float(x)
    return Pair(high, float(x - high))


class Integrals(NamedTuple):
    """``k`` and ``pi`` are the complete K and Π(n, k), ``part`` is F(φ, k)/2K for φ in [0, π/2]."""

    k: Real
    pi: Real
    part: Real


def integrals(kc: Real, root_n: Real, cos2: Real, sin2: Real) -> Integrals:
    """Return K, Π and F of one body from one arithmetic-geometric mean, for k' = ``kc`` > 0, √(1 − n) =
    ``root_n`` > 0, cos²φ and sin²φ.

    Source: Bulirsch's cel and el1 (Numer. Math. 7, 1965 and 13, 1969), which use the same two sequences.
    """
    p, a, b, mean, e, gap = root_n, gmpy2.mpfr(1), 1 / root_n, gmpy2.mpfr(1), kc, kc
    cot = gmpy2.sqrt(cos2 / sin2) if sin2 else gmpy2.inf()
    halves, doublings = 0, 1
    while True:
        a, b = a + b / p, 2 * (b + a * (e / p))
        p = p + e / p
        cot = cot - e / (cot or gmpy2.sqrt(e) * _NEARLY_NOTHING)
        before, mean = mean, mean + gap
        doublings *= 2
        if abs(before - gap) <= before * _ENOUGH:
            break
        halves = 2 * halves + (cot < 0)
        gap = 2 * gmpy2.sqrt(e)
        e = gap * mean
    quarter = gmpy2.const_pi() / 2
    # to a double's rounding: the doublings divide its error
    last = gmpy2.mpfr(math.atan(mean / cot) / math.pi) + (cot < 0)
    return Integrals(
        quarter * doublings / mean,
        quarter * (b + a * mean) / (mean * (mean + p)),
        (halves + last) / doublings,
    )


def turns(rates: Sequence[Pair], starts: Sequence[Pair], t: Array) -> tuple[Array, Array]:
    """Return ``rate·t + start`` (k, n) as the nearest whole number and the rest in [−½, ½]. The product is
    exact before it is reduced.
    """
    rate, low, top, start, start_low = np.array(
        [(rate.high, rate.low, _top(rate.high), *start) for rate, start in zip(rates, starts, strict=True)]
    ).T[:, :, None]
    bottom = rate - top
    t_top = _SPLIT * t
    t_top = t_top - (t_top - t)
    t_bottom = t - t_top
    product = rate * t
    error = ((top * t_top - product) + top * t_bottom + bottom * t_top) + bottom * t_bottom
    error += low * t
    error += start_low
    whole = np.rint(product + start)
    rest = product - whole
    total = rest + start
    shift = total - rest
    error += (rest - (total - shift)) + (start - shift)
    total += error
    return whole, total


def _top(x: float) -> float:
    cut = _SPLIT * x
    return cut - (cut - x)
