"""Momentum and attitude phase along a polhode, as theta series of at most five terms in double precision.

Each model is a table of coefficients, computed once for a body, and a few powers per sample: the series are
one matrix product. A model is called with the whole part and the rest of u/2K (n,) and returns ``Along``.
Series in the nome q = exp(−πK'/K) are used for k² ≤ ½, their imaginary transforms in exp(−πK/K') above, so
that q ≤ 0.0432 in both (DLMF §20.2, §20.7(viii), §22.2; the attitude after van Zon & Schofield 2007 and
Celledoni et al. 2008, in another form).
"""

import math
from operator import add, mul, sub
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reference.polhode import Polhode

Array = NDArray[np.float64]
TERMS = 5


class Along(NamedTuple):
    """Samples along a polhode: momentum components ``a``, ``b``, ``c`` (n,) = m_a, m_b, m_c in kg m²/s, and
    the phase of the attitude.

    The argument of ``re`` + i ``im`` is the periodic part of half the angle about L; ``extra`` is added to
    it, in rad.
    """

    a: Array
    b: Array
    c: Array
    re: Array | float
    im: Array | float
    extra: Array | float


class Symmetric:
    """Two equal moments: a circle at a constant rate; ψ has no periodic part."""

    def __init__(self, p: Polhode) -> None:
        self._sizes = p.sizes

    def __call__(self, whole: Array, rest: Array) -> Along:
        """Return the samples for the whole part and the rest of u/2K (n,)."""
        angle, flip, (a, b, c) = np.pi * rest, _flip(whole), self._sizes
        return Along(a * flip * np.cos(angle), b * flip * np.sin(angle), np.full_like(rest, c), 1.0, 0.0, 0.0)


class Direct:
    """k² ≤ ½: Fourier series in v = πu/2K, each a polynomial in cos 2v."""

    def __init__(self, p: Polhode) -> None:
        q = math.exp(-p.nome_ratio)
        q2, q4, q6, q9, q12 = q**2, q**4, q**6, q**9, q**12
        theta2, theta3, theta4 = 1 + q2 + q6 + q12, 1 + 2 * (q + q4 + q9), 1 - 2 * (q - q4 + q9)
        plus = [math.exp(-2 * j * j * p.nome_ratio + j * p.offset) for j in (1, 2, 3)]
        minus = [math.exp(-2 * j * j * p.nome_ratio - j * p.offset) for j in (1, 2, 3)]
        (t1, t2, t3), (g1, g2, g3) = (map(add, plus, minus), map(sub, plus, minus))
        base, twice, four = 1 - q2 + q6 - q12, 2 * (q2 - q6 + q12), 2 * (q6 - q12)
        a, b, c = p.sizes[0] * theta4 / theta2, p.sizes[1] * theta3 / theta2, p.sizes[2] * theta4 / theta3
        table = (
            _in_powers(a * base, a * twice, a * four, a * 2 * q12),  # cn / cos v
            _in_powers(b * base, -b * twice, b * four, -b * 2 * q12),  # sn / sin v
            _in_powers(c, c * 2 * q, c * 2 * q4, c * 2 * q9),  # dn
            _in_powers(1, -2 * q, 2 * q4, -2 * q9),  # their denominator
            _in_powers(1, -t1, t2, -t3),  # re
            _in_powers(-g1 - g3, 2 * g2, -2 * g3, 0),  # im / sin 2v
        )
        self._table = np.array(table)

    def __call__(self, whole: Array, rest: Array) -> Along:
        """Return the samples for the whole part and the rest of u/2K (n,)."""
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
    """k² > ½: series in e = exp(−π|u|/2K') and y = exp(π(|u| − K)/2K'), both at most 1, however near the
    separatrix.
    """

    def __init__(self, p: Polhode) -> None:
        self._ratio, self._offset, self._root = p.nome_ratio, p.offset, math.exp(-p.nome_ratio / 2)
        q = self._root**2
        q2, q4, q6, q9, q12, (a, b, c) = q**2, q**4, q**6, q**9, q**12, _dual_sizes(p, q)
        x = [self._root ** (j * j) * math.cos((j + 0.5) * p.offset) for j in range(TERMS)]
        y = [self._root ** (j * j) * math.sin((j + 0.5) * p.offset) for j in range(TERMS)]
        far = [self._root**j for j in range(TERMS)]
        xf, yf = list(map(mul, x, far)), list(map(mul, y, far))
        table = (  # columns: 1, e, e², e³, e⁴, e⁵, e⁶, e⁸, y, y², y³, y⁴, y⁶
            (a, 0, -a * q, 0, a * q4, 0, -a * q9, 0, 0, -a, 0, a * q2, -a * q6),  # cn / e
            (b, 0, -b, 0, b * q2, 0, -b * q6, b * q12, 0, -b * q, 0, b * q4, -b * q9),  # sn
            (c, 0, c * q, 0, c * q4, 0, c * q9, 0, 0, c, 0, c * q2, c * q6),  # dn / e
            (1, 0, 1, 0, q2, 0, q6, q12, 0, q, 0, q4, q9),  # their denominator
            (x[0], xf[0], xf[1], xf[2], xf[3], xf[4], 0, 0, x[1], x[2], x[3], x[4], 0),  # re
            (-y[0], yf[0], yf[1], yf[2], yf[3], yf[4], 0, 0, -y[1], -y[2], -y[3], -y[4], 0),  # im
        )
        self._table = np.array(table)

    def __call__(self, whole: Array, rest: Array) -> Along:
        """Return the samples for the whole part and the rest of u/2K (n,)."""
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
            ma * e * flipped,
            np.copysign(mb, rest) * flipped,
            mc * faded,
            re,
            np.copysign(1.0, rest) * im,
            rest * self._offset,
        )


class Separatrix:
    """Exactly on the separatrix: hyperbolic functions of u itself, one passage and no return."""

    def __init__(self, p: Polhode) -> None:
        self._sizes, self._half, self._side = p.sizes, p.offset / 2, -1.0 if p.far_side else 1.0

    def __call__(self, whole: Array, rest: Array) -> Along:
        """Return the samples; u itself, split into whole part and rest, replaces u/2K."""
        (a, b, c), side, u = self._sizes, self._side, whole + rest
        e, sign = np.exp(-np.abs(u)), np.copysign(1.0, u)
        scale = 1 / (1 + e * e)
        re, im = math.cos(self._half) * (1 + e), -side * math.sin(self._half) * (1 - e) * sign
        return Along(side * a * 2 * e * scale, b * sign * (1 - e * e) * scale, c * 2 * e * scale, re, im, 0.0)


Series = Symmetric | Direct | Dual | Separatrix  # called with the whole part and the rest of u/2K


def _in_powers(c0: float, c1: float, c2: float, c3: float) -> tuple[float, float, float, float]:
    """Return the coefficients of the powers of cos 2v in c₀ + c₁ cos 2v + c₂ cos 4v + c₃ cos 6v
    (Chebyshev).
    """
    return c0 - c2, c1 - 3 * c3, 2 * c2, 4 * c3


def _dual_sizes(p: Polhode, q: float) -> tuple[float, float, float]:
    """Return A_a, A_b, A_c over the series' values where cn, sn and dn are 1."""
    theta2 = 2 * sum(q ** (j * (j + 1)) for j in range(4))
    theta3 = 1 + 2 * sum(q ** (j * j) for j in range(1, 5))
    theta4 = 1 + 2 * sum((-1) ** j * q ** (j * j) for j in range(1, 5))
    top = sum(q ** (j * j) * (1 + q ** (2 * j + 1)) for j in range(TERMS))
    bottom = sum((-1) ** j * q ** (j * j) * (1 - q ** (2 * j + 1)) for j in range(TERMS))
    return p.sizes[0] * theta2 / theta4, p.sizes[1] * top / bottom, p.sizes[2] * theta2 / theta3


def _flip(whole: Array) -> Array:
    """Return +1 for an even number of half periods, −1 for an odd one."""
    half = 0.5 * whole
    return 1.0 - 4.0 * (half - np.floor(half))
