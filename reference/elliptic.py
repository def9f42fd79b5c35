"""Jacobi's elliptic functions and the elliptic integral of the third kind at real arguments within a quarter
period.
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEAST = 1e-100  # sn of it is 0 to rounding
EVEN = 1e-8  # arithmetic-geometric mean: one more step would change nothing


def jacobi(x: Array, kc: float) -> tuple[Array, Array, Array]:
    """Return sn, cn and dn (n,) of ``x`` (n,) with |x| ≤ K, for the complementary modulus ``kc`` in (0, 1].

    Source: Bulirsch's sncndn (Numer. Math. 7, 1965), which loses no digit where kc is near 0.
    """
    a, b, means = 1.0, kc, [(1.0, kc)]
    while a - b > EVEN * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
        means.append((a, b))
    mean = (a + b) / 2
    angle = mean * np.where(np.abs(x) < LEAST, LEAST, x)
    cot = np.cos(angle) / np.sin(angle)
    c, dn = mean * cot, np.ones_like(cot)
    for a, b in reversed(means):
        cot = cot * c
        c = c * dn
        dn = (b + cot) / (a + cot)
        cot = c / a
    sn = np.copysign(1 / np.hypot(c, 1.0), angle)
    return sn, c * sn, dn


def third_kind(functions: tuple[Array, Array, Array], n: float, nc: float, kc: float) -> Array:
    """Return Π(n; x) (n,) for |x| ≤ K, from sn, cn and dn of x, ``nc`` = 1 − n > 0 and the complementary
    modulus ``kc``.

    By Carlson's symmetric integrals (DLMF §19.25(i)). For n < −1 it is reduced to a characteristic between
    k² and 1, after which every term is positive (Abramowitz & Stegun, 17.7.15; DLMF 19.7.9).
    """
    from scipy.special import elliprc, elliprf, elliprj  # 0.2 s, which a process without tops saves

    sn, cn, dn = functions
    s2, c2, d2 = sn**2, cn**2, dn**2
    first = sn * elliprf(c2, d2, 1.0)

    def direct(n: float, nc: float) -> Array:
        return np.asarray(first + sn * s2 * (n / 3) * elliprj(c2, d2, 1.0, c2 + nc * s2))

    if n >= -1:  # below, the two terms would cancel
        return direct(n, nc)
    other_c = kc**2 / nc
    other = 1 - other_c
    # Rounding takes x beyond K, where cn < 0 and Carlson's integrals are those of the mirrored point.
    arc = sn * np.abs(cn) * elliprc(d2, (c2 + nc * s2) * (c2 + other_c * s2))
    terms = (1 - kc**2) * first - n * (other_c * direct(other, other_c) + other * arc)
    return np.asarray(terms / (nc - kc**2))
