"""Elliptic integrals to fifty digits, and phases that stay exact however long the time.

A body's few constants are worked out once with MPFR's 170-bit numbers (through gmpy2) and kept as pairs of doubles; per sample
there is one exact product, so that the error of a phase does not grow with the number of turns. The functions expect to be
called inside ``with precision():``.
"""

from typing import Any, NamedTuple

import gmpy2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Real = Any  # gmpy2.mpfr, which has no type hints

BITS = 170
_ENOUGH = 1e-26  # quadratic convergence: one more step squares it
_SPLIT = 134217729.0  # 2²⁷ + 1 cuts a double into two halves whose product is exact (Dekker, 1971)


class Pair(NamedTuple):
    """An unevaluated sum of two doubles, good to 32 digits."""

    high: float
    low: float


def precision() -> Any:
    """The context in which everything here is worked out."""
    return gmpy2.context(precision=BITS)


def pair(x: Real) -> Pair:
    """The nearest double and what is left of ``x``."""
    high = float(x)
    return Pair(high, float(x - high))


def complete_k(kc: Real) -> Real:
    """Complete elliptic integral K for the complementary modulus kc = k' > 0, by the arithmetic-geometric mean."""
    a, b = max(kc, gmpy2.mpfr(1)), min(kc, gmpy2.mpfr(1))
    while a - b > a * _ENOUGH:
        a, b = (a + b) / 2, gmpy2.sqrt(a * b)
    return gmpy2.const_pi() / (a + b)


def complete_pi(n: Real, kc: Real) -> Real:
    """Complete elliptic integral Π(n, k) for n ≤ 0 and k' = kc > 0 (Bulirsch's cel, Numer. Math. 13, 1969)."""
    p = gmpy2.sqrt(1 - n)
    a, b, e, em, qc = gmpy2.mpfr(1), 1 / p, kc, gmpy2.mpfr(1), kc
    while True:
        f, g = a, e / p
        a, b, p = a + b / p, 2 * (b + f * g), g + p
        g, em = em, em + qc
        if abs(g - qc) <= g * _ENOUGH:
            return gmpy2.const_pi() / 2 * (b + a * em) / (em * (em + p))
        qc = 2 * gmpy2.sqrt(e)
        e = qc * em


def carlson_rf(x: Real, y: Real, z: Real) -> Real:
    """Carlson's R_F, at most one argument zero (Carlson, Numer. Algorithms 10, 1995: duplication, then a seventh-order series)."""
    start_x, start_y, start_mean = x, y, (x + y + z) / 3
    mean, scale = start_mean, 1.0
    spread = 500 * max(abs(mean - x), abs(mean - y), abs(mean - z))
    while spread * scale > mean:
        root_x, root_y, root_z = gmpy2.sqrt(x), gmpy2.sqrt(y), gmpy2.sqrt(z)
        shift = root_x * (root_y + root_z) + root_y * root_z
        x, y, z, mean, scale = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4, (mean + shift) / 4, scale / 4
    dx, dy = (start_mean - start_x) * scale / mean, (start_mean - start_y) * scale / mean
    dz = -dx - dy
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    series = 1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44 - 5 * e2**3 / 208 + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16
    return series / gmpy2.sqrt(mean)


NOTHING = Pair(0.0, 0.0)


def turns(rate: Pair, t: Array, start: Pair = NOTHING) -> tuple[Array, Array]:
    """``rate·t + start`` as the nearest whole number and the rest, in [−½, ½]; the product is exact before it is reduced."""
    product = rate.high * t
    cut = _SPLIT * rate.high
    rate_top = cut - (cut - rate.high)
    rate_bottom = rate.high - rate_top
    t_top = _SPLIT * t
    t_top = t_top - (t_top - t)
    t_bottom = t - t_top
    error = ((rate_top * t_top - product) + rate_top * t_bottom + rate_bottom * t_top) + rate_bottom * t_bottom
    error += rate.low * t
    error += start.low
    whole = np.rint(product + start.high)
    rest = product - whole
    total = rest + start.high
    shift = total - rest
    error += (rest - (total - shift)) + (start.high - shift)
    return whole, total + error
