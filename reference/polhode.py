"""A body's polhode worked out to fifty digits: which axis it encircles, its size, modulus, period and starting point.

Formulas: momentum components are m_a = A_a cn u, m_b = A_b sn u, m_c = A_c dn u about the encircled axis c (Landau & Lifshitz,
Mechanics, §37; van Zon & Schofield, J. Comput. Phys. 225, 2007). All differences are formed from the exact doubles given, so
that nothing cancels near the separatrix, near symmetry or near a steady spin.
"""

from dataclasses import dataclass

import gmpy2

from reference.precise import Pair, Real, carlson_rf, complete_k, complete_pi, pair, precision


@dataclass(frozen=True)
class Steady:
    """ω does not change: a sphere, or a spin about a principal axis: the unit vector ``axis``, and half the turns per second."""

    axis: tuple[float, float, float]
    half_turns: Pair


@dataclass(frozen=True)
class Polhode:
    """A polhode about body axis ``axes[2]``, seen in the right-handed triad ``signs``·``axes`` = (a, b, c) with m_c > 0.

    ``moments`` and ``sizes`` (A_a, A_b, A_c) belong to a, b, c; ``momentum`` is |L|. ``k2`` + ``kc2`` = 1. ``phase`` is u/2K in
    turns per second, ``start`` its value at t = 0; ``swing`` is the mean rate of the half angle about L, in turns per second.
    ``nome_ratio`` is πK'/K and ``offset`` πy₀/K (direct) or their duals πK/K' and πy₀/2K'. On the separatrix ``phase`` is λ itself
    and ``start`` is u₀.
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
    """Work out the motion from ω(0) = ``w0`` of a body with ``moments``; both are taken as the exact doubles they are."""
    with precision():
        return _polhode([gmpy2.mpfr(x) for x in w0], [gmpy2.mpfr(x) for x in moments])


def _polhode(spin: list[Real], moments: list[Real]) -> Steady | Polhode:
    order = sorted(range(3), key=lambda i: moments[i])
    (i1, i2, i3), w = (moments[i] for i in order), [spin[i] for i in order]
    m = [i1 * w[0], i2 * w[1], i3 * w[2]]
    if (i2 - i3) * w[1] * w[2] == (i3 - i1) * w[2] * w[0] == (i1 - i2) * w[0] * w[1] == 0:
        return _steady(spin)
    i21, i31, i32 = i2 - i1, i3 - i1, i3 - i2
    q1, q2, q3 = (m[k] * w[k] for k in range(3))
    d1, d2, d3 = q2 * i21 + q3 * i31, q3 * i32 - q1 * i21, q1 * i31 + q2 * i32
    if d2 > 0 or (d2 == 0 and i32 > 0 and i21 > 0):
        a, b, c, da, dc, iab, icb, sense = 0, 1, 2, d1, d3, i21, i32, 1
    else:
        a, b, c, da, dc, iab, icb, sense = 2, 1, 0, d3, d1, i32, i21, -1
    axes = (order[a], order[b], order[c])
    sign_c = 1 if m[c] > 0 else -1
    sign_a = sign_c if (axes[1] - axes[0]) % 3 == 1 else -sign_c
    ia, ib, ic = (i1, i2, i3)[a], i2, (i1, i2, i3)[c]
    size_a, size_b, size_c = gmpy2.sqrt(ia * dc / i31), gmpy2.sqrt(ib * dc / icb), gmpy2.sqrt(ic * da / i31)
    momentum = gmpy2.sqrt(sum(x * x for x in m))
    k2, kc2 = iab * dc / (icb * da), i31 * abs(d2) / (icb * da)
    rate = gmpy2.sqrt(da * icb / (ia * ib * ic))
    cn, sn = sign_a * m[a] / size_a, m[b] / size_b
    along, across = ib * i31, (ia * icb, ic * iab)  # sn²(y₀, k') and cn² are across / along: moments only
    shape = _Shape(k2, kc2, cn, sn, across[0] / along, across[1] / along)
    if kc2 == 0:
        swing = pair((momentum / ic + sense * dc / (ic * momentum)) / (4 * gmpy2.const_pi()))
        phase, start, nome, offset, period = _separatrix(shape, sense * rate)
    else:
        n, kc = -ic * iab / (ia * icb), gmpy2.sqrt(kc2)
        quarter = complete_k(kc)
        mean = (complete_pi(n, kc) - size_c / momentum * gmpy2.const_pi() / (2 * gmpy2.sqrt(1 - n))) / quarter
        swing = pair((momentum / ic + sense * momentum * i31 / (ia * ic) * mean) / (4 * gmpy2.const_pi()))
        phase, start, nome, offset, period = _periodic(shape, quarter, sense * rate)
    return Polhode(
        axes=axes,
        signs=(sign_a, 1, sign_c),
        moments=(float(ia), float(ib), float(ic)),
        sizes=(float(size_a), float(size_b), float(size_c)),
        momentum=float(momentum),
        k2=float(k2),
        kc2=float(kc2),
        phase=phase,
        start=start,
        swing=swing,
        nome_ratio=nome,
        offset=offset,
        period=period,
        far_side=cn < 0,
    )


@dataclass(frozen=True)
class _Shape:
    k2: Real
    kc2: Real
    cn: Real
    sn: Real
    sn2_offset: Real
    cn2_offset: Real


def _steady(spin: list[Real]) -> Steady:
    speed = gmpy2.sqrt(sum(x * x for x in spin))
    x, y, z = (float(s / speed) if speed else 0.0 for s in spin)
    return Steady((x, y, z), pair(speed / (4 * gmpy2.const_pi())))


def _start(shape: _Shape) -> Real:
    """|u₀| in [0, K], with the sign of sn."""
    norm = shape.cn**2 + shape.sn**2
    c2, s2 = shape.cn**2 / norm, shape.sn**2 / norm
    u0 = gmpy2.sqrt(s2) * carlson_rf(c2, c2 + shape.kc2 * s2, gmpy2.mpfr(1))
    return u0 if shape.sn >= 0 else -u0


def _periodic(shape: _Shape, quarter: Real, rate: Real) -> tuple[Pair, Pair, float, float, float]:
    period = float(abs(4 * quarter / rate))
    u0 = _start(shape) if shape.cn >= 0 else 2 * quarter - _start(shape)
    phase, start = pair(rate / (2 * quarter)), pair(u0 / (2 * quarter))
    if shape.k2 == 0:
        return phase, start, float("inf"), 0.0, period
    dual_quarter = complete_k(gmpy2.sqrt(shape.k2))
    y0 = gmpy2.sqrt(shape.sn2_offset) * carlson_rf(shape.cn2_offset, 1 - shape.kc2 * shape.sn2_offset, gmpy2.mpfr(1))
    if shape.k2 <= shape.kc2:
        nome, offset = gmpy2.const_pi() * dual_quarter / quarter, gmpy2.const_pi() * y0 / quarter
    else:
        nome, offset = gmpy2.const_pi() * quarter / dual_quarter, gmpy2.const_pi() * y0 / (2 * dual_quarter)
    return phase, start, float(nome), float(offset), period


def _separatrix(shape: _Shape, rate: Real) -> tuple[Pair, Pair, float, float, float]:
    y0 = gmpy2.sqrt(shape.sn2_offset) * carlson_rf(shape.cn2_offset, gmpy2.mpfr(1), gmpy2.mpfr(1))
    return pair(rate), pair(_start(shape)), 0.0, float(y0), float("inf")
