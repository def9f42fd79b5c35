"""A body's polhode to fifty digits: the axis it encircles, its size, modulus, period and starting point.

Momentum components are m_a = A_a cn u, m_b = A_b sn u, m_c = A_c dn u about the encircled axis c (Landau &
Lifshitz, Mechanics, §37; van Zon & Schofield, J. Comput. Phys. 225, 2007). All differences are formed from
the given doubles exactly, so that nothing cancels near the separatrix, near symmetry or near a steady spin.
"""

import math
from dataclasses import dataclass

import gmpy2

from reference.precise import Pair, Real, integrals, pair, precision


@dataclass(frozen=True)
class Steady:
    """ω is constant (a sphere, or a spin about a principal axis): the unit vector ``axis`` and the ``rate``
    in turns per second.
    """

    axis: tuple[float, float, float]
    rate: Pair


@dataclass(frozen=True)
class Polhode:
    """A polhode about body axis ``axes[2]``, seen in the right-handed triad ``signs``·``axes`` = (a, b, c)
    with m_c > 0.

    ``moments`` (kg m²), ``sizes`` (A_a, A_b, A_c in kg m²/s) of a, b, c, and ``momentum``, which is |L|, are
    divided by one power of two that makes ``momentum`` at least ½ and less than 1.
    ``k2`` + ``kc2`` = 1. ``phase`` is u/2K in turns per second, ``start`` its value at t = 0; ``swing`` is
    the mean rate of the angle about L, in turns per second. ``nome_ratio`` is πK'/K and ``offset`` πy₀/K
    (direct) or their duals πK/K' and πy₀/2K'. On the separatrix ``phase`` is du/dt and ``start`` is u₀.
    """

    axes: tuple[int, int, int]
    signs: tuple[int, int, int]
    moments: tuple[float, float, float]
    sizes: tuple[float, float, float]
    momentum: float
    k2: float
    kc2: float
    phase: Pair
    start: Pair
    swing: Pair
    nome_ratio: float
    offset: float
    period: float
    far_side: bool


def polhode(w0: tuple[float, float, float], moments: tuple[float, float, float]) -> Steady | Polhode:
    """Return the polhode of the motion from ω(0) = ``w0`` (rad/s) of a body with ``moments`` (kg m²), both
    taken as exact doubles.
    """
    o1, o2, o3 = order = sorted(range(3), key=lambda i: moments[i])
    i1, i2, i3 = moments[o1], moments[o2], moments[o3]
    w1, w2, w3 = w0[o1], w0[o2], w0[o3]
    if (i2 == i3 or not w2 or not w3) and (i3 == i1 or not w3 or not w1) and (i1 == i2 or not w1 or not w2):
        return _steady(w0)
    with precision():
        return _polhode(order, [gmpy2.mpfr(x) for x in (i1, i2, i3)], [gmpy2.mpfr(x) for x in (w1, w2, w3)])


def _steady(spin: tuple[float, float, float]) -> Steady:
    with precision():
        speed = gmpy2.sqrt(sum(gmpy2.mpfr(s) ** 2 for s in spin))
        x, y, z = (float(s / speed) if speed else 0.0 for s in spin)
        return Steady((x, y, z), pair(speed / (2 * gmpy2.const_pi())))


def _polhode(order: list[int], moments: list[Real], w: list[Real]) -> Polhode:
    i1, i2, i3 = moments
    m = [i1 * w[0], i2 * w[1], i3 * w[2]]
    q1, q2, q3 = m[0] * w[0], m[1] * w[1], m[2] * w[2]
    i21, i31, i32 = i2 - i1, i3 - i1, i3 - i2
    d1, d2, d3 = q2 * i21 + q3 * i31, q3 * i32 - q1 * i21, q1 * i31 + q2 * i32
    if d2 > 0 or (d2 == 0 and i32 > 0 and i21 > 0):
        a, c, da, dc, iab, icb, qa, sense = 0, 2, d1, d3, i21, i32, q1, 1
    else:
        a, c, da, dc, iab, icb, qa, sense = 2, 0, d3, d1, i32, i21, q3, -1
    axes = (order[a], order[1], order[c])
    sign_c = 1 if m[c] > 0 else -1
    sign_a = sign_c if (axes[1] - axes[0]) % 3 == 1 else -sign_c
    ia, ic, above = moments[a], moments[c], icb * da
    k2, kc2 = iab * dc / above, i31 * abs(d2) / above
    rate = sense * gmpy2.sqrt(above / (ia * i2 * ic))
    momentum, size_c = gmpy2.sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]), gmpy2.sqrt(ic * da / i31)
    # of the amplitude of u at t = 0; their sum is exactly 1
    cos2, sin2, far_side = (
        qa * i31 / dc,
        q2 * icb / dc,
        sign_a * m[a] < 0,
    )
    offset = float(ia * icb), float(ic * iab)  # sn²(y₀, k') : cn²(y₀, k'), from the moments only
    if kc2 == 0:
        mean, start = dc / momentum**2 * ia / i31, gmpy2.asinh(gmpy2.sqrt(sin2 / cos2))
        phase, shape = (
            (-rate if far_side else rate),
            (0.0, math.atan2(math.sqrt(offset[0]), math.sqrt(offset[1])), math.inf),
        )
    else:
        root_n = gmpy2.sqrt(1 + ic * iab / (ia * icb))
        found = integrals(gmpy2.sqrt(kc2), root_n, cos2, sin2)
        mean = (found.pi - size_c / momentum * gmpy2.const_pi() / (2 * root_n)) / found.k
        phase, start = rate / (2 * found.k), found.part
        shape = (*_nome(k2, kc2, found.k, offset), float(abs(2 / phase)))
    if m[1] < 0:
        start = -start
    swing = (momentum / ic + sense * momentum * i31 / (ia * ic) * mean) / (2 * gmpy2.const_pi())
    unit = gmpy2.exp2(gmpy2.frexp(momentum)[0])
    sizes = gmpy2.sqrt(ia * dc / i31), gmpy2.sqrt(i2 * dc / icb), size_c
    return Polhode(
        axes=axes,
        signs=(sign_a, 1, sign_c),
        moments=(float(ia / unit), float(i2 / unit), float(ic / unit)),
        sizes=(float(sizes[0] / unit), float(sizes[1] / unit), float(sizes[2] / unit)),
        momentum=float(momentum / unit),
        k2=float(k2),
        kc2=float(kc2),
        phase=pair(phase),
        start=pair(1 - start if far_side and kc2 else start),
        swing=pair(swing),
        nome_ratio=shape[0],
        offset=shape[1],
        period=shape[2],
        far_side=far_side,
    )


def _nome(k2: Real, kc2: Real, quarter: Real, offset: tuple[float, float]) -> tuple[float, float]:
    """Return πK'/K and πy₀/K for k² ≤ ½, πK/K' and πy₀/2K' above."""
    if k2 == 0:
        return math.inf, 0.0
    sn2, cn2 = (gmpy2.mpfr(part) / sum(offset) for part in offset)
    dual = integrals(gmpy2.sqrt(k2), gmpy2.mpfr(1), cn2, sn2)
    ratio = dual.k / quarter
    if k2 <= kc2:
        return float(gmpy2.const_pi() * ratio), float(2 * gmpy2.const_pi() * dual.part * ratio)
    return float(gmpy2.const_pi() / ratio), float(gmpy2.const_pi() * dual.part)
