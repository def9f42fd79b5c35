"""Momentum and attitude phase along a polhode, as theta series of at most five terms in double precision.

Each model is a table of coefficients, made once for a body, and a few powers per sample: the series are one matrix product.
A model called with the whole and the rest of u/2K (n,) answers ``Along``: the momentum components m_a, m_b, m_c (n,), the complex
number re + i im whose argument is the periodic part of half the angle about L, and what is to be added to that angle. Series in
the nome q = exp(−πK'/K) serve k² ≤ ½, their imaginary transforms in exp(−πK/K') the rest, so that q ≤ 0.0432 in both
(DLMF §20.2, §20.7(viii), §22.2; for the attitude van Zon & Schofield 2007, Celledoni et al. 2008, in our own form).
"""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from reference.polhode import Polhode

Array = NDArray[np.float64]
TERMS = 5
# cos 2jv, j = 0..3, in powers of cos 2v: Chebyshev's polynomials.
CHEBYSHEV = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [-1, 0, 2, 0], [0, -3, 0, 4]], dtype=float)


class Along(NamedTuple):
    """See the module."""

    a: Array
    b: Array
    c: Array
    re: Array | float
    im: Array | float
    extra: Array | float


class Series(Protocol):
    """A periodic model, made for a polhode and called with the whole and the rest of u/2K."""

    def __init__(self, p: Polhode) -> None: ...

    def __call__(self, whole: Array, rest: Array) -> Along:
        """See the module."""
        ...


class Symmetric:
    """Two equal moments: a circle at a constant rate; ψ has no periodic part."""

    def __init__(self, p: Polhode) -> None:
        self._sizes = p.sizes

    def __call__(self, whole: Array, rest: Array) -> Along:
        """See the module."""
        angle, flip, (a, b, c) = np.pi * rest, _flip(whole), self._sizes
        return Along(a * flip * np.cos(angle), b * flip * np.sin(angle), np.full_like(rest, c), 1.0, 0.0, 0.0)


class Direct:
    """k² ≤ ½: Fourier series in v = πu/2K, each a polynomial in cos 2v."""

    def __init__(self, p: Polhode) -> None:
        q = float(np.exp(-p.nome_ratio))
        q2, q4, q6, q9, q12 = q**2, q**4, q**6, q**9, q**12
        theta2, theta3, theta4 = 1 + q2 + q6 + q12, 1 + 2 * (q + q4 + q9), 1 - 2 * (q - q4 + q9)
        plus = [float(np.exp(-2 * j * j * p.nome_ratio + j * p.offset)) for j in (1, 2, 3)]
        minus = [float(np.exp(-2 * j * j * p.nome_ratio - j * p.offset)) for j in (1, 2, 3)]
        total, gap = np.add(plus, minus), np.subtract(plus, minus)
        base = 1 - q2 + q6 - q12
        rows = [
            [base, 2 * (q2 - q6 + q12), 2 * (q6 - q12), 2 * q12],  # cn / cos v
            [base, -2 * (q2 - q6 + q12), 2 * (q6 - q12), -2 * q12],  # sn / sin v
            [1, 2 * q, 2 * q4, 2 * q9],  # dn
            [1, -2 * q, 2 * q4, -2 * q9],  # their denominator
            [1, -total[0], total[1], -total[2]],  # re
            [-gap[0] - gap[2], 2 * gap[1], -2 * gap[2], 0],  # im / sin 2v
        ]
        sizes = [p.sizes[0] * theta4 / theta2, p.sizes[1] * theta3 / theta2, p.sizes[2] * theta4 / theta3, 1, 1, 1]
        self._table = np.array(sizes)[:, None] * (np.array(rows) @ CHEBYSHEV)

    def __call__(self, whole: Array, rest: Array) -> Along:
        """See the module."""
        v = np.pi * rest
        s, c = np.sin(v), np.cos(v)
        powers = np.empty((4, rest.size))
        powers[0] = 1.0
        np.multiply(c - s, c + s, out=powers[1])
        np.multiply(powers[1], powers[1], out=powers[2])
        np.multiply(powers[1], powers[2], out=powers[3])
        ma, mb, mc, bottom, re, im = self._table @ powers
        scale = 1 / bottom
        flipped = scale * _flip(whole)
        return Along(ma * c * flipped, mb * s * flipped, mc * scale, re, im * (2 * s * c), 0.0)


class Dual:
    """k² > ½: series in e = exp(−π|u|/2K') and y = exp(π(|u| − K)/2K'), both at most 1, however near the separatrix."""

    def __init__(self, p: Polhode) -> None:
        self._ratio, self._offset = p.nome_ratio, p.offset
        q, self._root = float(np.exp(-p.nome_ratio)), float(np.exp(-p.nome_ratio / 2))
        table = np.zeros((6, 13))  # columns: 1, e, e², e³, e⁴, e⁵, e⁶, e⁸, y, y², y³, y⁴, y⁶
        even, w = [0, 2, 4, 6, 7], [9, 11, 12]
        for row, sign in ((1, -1.0), (3, 1.0)):  # sn's numerator and the denominator, both over (1 ± e²)
            table[row, even] = [1, sign, q**2, sign * q**6, q**12]
            table[row, w] = [sign * q, q**4, sign * q**9]
        for row, sign in ((0, -1.0), (2, 1.0)):  # cn and dn, over e
            table[row, even[:4]] = [1, sign * q, q**4, sign * q**9]
            table[row, w] = [sign, q**2, sign * q**6]
        for j in range(TERMS):
            angle, near, far = (2 * j + 1) * p.offset / 2, self._root ** (j * j), self._root ** (j * j + j)
            power = 0 if j == 0 else 7 + j
            table[4, power] += near * np.cos(angle)
            table[4, 1 + j] += far * np.cos(angle)
            table[5, power] -= near * np.sin(angle)
            table[5, 1 + j] += far * np.sin(angle)
        table[:3] *= np.array(_dual_sizes(p, q))[:, None]
        self._table = table

    def __call__(self, whole: Array, rest: Array) -> Along:
        """See the module."""
        powers = np.empty((13, rest.size))
        powers[0] = 1.0
        e, y = powers[1], powers[8]
        np.exp(-self._ratio * np.abs(rest), out=e)
        np.divide(self._root, e, out=y)
        for target, one, two in (
            (2, 1, 1),
            (3, 2, 1),
            (4, 2, 2),
            (5, 4, 1),
            (6, 4, 2),
            (7, 4, 4),
            (9, 8, 8),
            (10, 9, 8),
            (11, 9, 9),
            (12, 11, 9),
        ):
            np.multiply(powers[one], powers[two], out=powers[target])
        ma, mb, mc, bottom, re, im = self._table @ powers
        scale = 1 / bottom
        flipped, faded = scale * _flip(whole), e * scale
        return Along(
            ma * e * flipped, np.copysign(mb, rest) * flipped, mc * faded, re, np.copysign(1.0, rest) * im, rest * self._offset
        )


class Separatrix:
    """Exactly on the separatrix: hyperbolic functions of u itself, one passage and no return."""

    def __init__(self, p: Polhode) -> None:
        self._sizes, self._half, self._side = p.sizes, p.offset / 2, -1.0 if p.far_side else 1.0

    def __call__(self, u: Array) -> Along:
        """The same for u (n,)."""
        (a, b, c), side = self._sizes, self._side
        e, sign = np.exp(-np.abs(u)), np.copysign(1.0, u)
        scale = 1 / (1 + e * e)
        re, im = np.cos(self._half) * (1 + e), -side * np.sin(self._half) * (1 - e) * sign
        return Along(side * a * 2 * e * scale, b * sign * (1 - e * e) * scale, c * 2 * e * scale, re, im, 0.0)


def _dual_sizes(p: Polhode, q: float) -> tuple[float, float, float]:
    """A_a, A_b, A_c over the series' values where cn, sn and dn are 1."""
    theta2 = 2 * sum(q ** (j * (j + 1)) for j in range(4))
    theta3 = 1 + 2 * sum(q ** (j * j) for j in range(1, 5))
    theta4 = 1 + 2 * sum((-1) ** j * q ** (j * j) for j in range(1, 5))
    top = sum(q ** (j * j) * (1 + q ** (2 * j + 1)) for j in range(TERMS))
    bottom = sum((-1) ** j * q ** (j * j) * (1 - q ** (2 * j + 1)) for j in range(TERMS))
    return p.sizes[0] * theta2 / theta4, p.sizes[1] * top / bottom, p.sizes[2] * theta2 / theta3


def _flip(whole: Array) -> Array:
    """+1 for an even number of half periods, −1 for an odd one."""
    half = 0.5 * whole
    return 1.0 - 4.0 * (half - np.floor(half))
