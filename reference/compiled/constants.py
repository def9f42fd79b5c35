"""A body's constants in double-double arithmetic: the formulas of ``reference.polhode``, for general motion
only.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reference.compiled.doubledouble import DD, add, div, mul, neg, product, root, sub, times, total

Array = NDArray[np.float64]
HALF_PI: DD = (math.pi / 2, 6.123233995736766e-17)
ONE: DD = (1.0, 0.0)
NEAR = 1e-5
ENOUGH, NEARLY_NOTHING = 1e-16, 1e-60


@njit(cache=True, error_model="numpy")
def integrals(kc: DD, root_n: DD, cot: DD) -> tuple[DD, DD, DD]:
    """Return K, Π and F/2K of one body from one arithmetic-geometric mean, as
    ``reference.precise.integrals``; ``cot`` is cot φ.
    """
    p, a, b, mean, e, gap = root_n, ONE, div(ONE, root_n), ONE, kc, kc
    halves, doublings = 0.0, 1.0
    while True:
        a, b = add(a, div(b, p)), times(add(b, mul(a, div(e, p))), 2.0)
        p = add(p, div(e, p))
        cot = sub(cot, div(e, cot if cot[0] != 0.0 else (math.sqrt(e[0]) * NEARLY_NOTHING, 0.0)))
        before, mean = mean, add(mean, gap)
        doublings *= 2.0
        if abs(sub(before, gap)[0]) <= before[0] * ENOUGH:
            break
        halves = 2.0 * halves + (1.0 if cot[0] < 0 else 0.0)
        gap = times(root(e), 2.0)
        e = mul(gap, mean)
    last = math.atan(mean[0] / cot[0]) / math.pi + (1.0 if cot[0] < 0 else 0.0)
    pi = div(mul(HALF_PI, add(b, mul(a, mean))), mul(mean, add(mean, p)))
    return times(div(HALF_PI, mean), doublings), pi, times(total(halves, last), 1.0 / doublings)


@njit(cache=True, error_model="numpy")
def complete_k(kc: float) -> float:
    """Return K for the complementary modulus kc > 0."""
    a, b = max(kc, 1.0), min(kc, 1.0)
    while a - b > 1e-8 * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (a + b)


@njit(cache=True, error_model="numpy")
def carlson_rf(x: float, y: float, z: float) -> float:
    """Return Carlson's R_F (Carlson, Numer. Algorithms 10, 1995)."""
    while True:
        mean = (x + y + z) / 3
        dx, dy = 1 - x / mean, 1 - y / mean
        if max(abs(dx), abs(dy), abs(dx + dy)) < 3e-3:
            e2, e3 = dx * dy - (dx + dy) ** 2, -dx * dy * (dx + dy)
            series = (
                -e2 / 10
                + e3 / 14
                + e2 * e2 / 24
                - 3 * e2 * e3 / 44
                - 5 * e2**3 / 208
                + 3 * e3 * e3 / 104
                + e2 * e2 * e3 / 16
            )
            return (1 + series) / math.sqrt(mean)
        rx, ry, rz = math.sqrt(x), math.sqrt(y), math.sqrt(z)
        shift = rx * (ry + rz) + ry * rz
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4


@njit(cache=True, error_model="numpy")
def constants(w: Array, I: Array, out: Array, axes: NDArray[np.int64]) -> int:
    """Fill ``out`` and ``axes``; return 0 for the direct model, 1 for the dual, −1 if neither applies.

    out: phase, start and swing (pairs), sizes a, b, c, |L|, moments a, b, c, signs a, b, c, nome ratio,
    offset. Units are those of ``reference.polhode.Polhode``.
    """
    order = np.argsort(I)
    n1, n2, n3 = order[0], order[1], order[2]
    i1, i2, i3 = (I[n1], 0.0), (I[n2], 0.0), (I[n3], 0.0)
    m1, m2, m3 = product(I[n1], w[n1]), product(I[n2], w[n2]), product(I[n3], w[n3])
    q1, q2, q3 = times(m1, w[n1]), times(m2, w[n2]), times(m3, w[n3])
    i21, i31, i32 = sub(i2, i1), sub(i3, i1), sub(i3, i2)
    d1, d3 = add(mul(q2, i21), mul(q3, i31)), add(mul(q1, i31), mul(q2, i32))
    d2 = sub(mul(q3, i32), mul(q1, i21))
    if d1[0] == 0.0 or d3[0] == 0.0:
        return -1
    if abs(d2[0]) <= NEAR * (q3[0] * i32[0] + q1[0] * i21[0]):
        return (
            -1
        )  # so near the separatrix, 32 digits do not give the period to the 25 digits that 10⁸ periods need
    if d2[0] > 0:
        ia, ib, ic, da, dc, iab, icb, ma, mc, qa, sense = i1, i2, i3, d1, d3, i21, i32, m1, m3, q1, 1.0
        axes[0], axes[1], axes[2] = n1, n2, n3
    else:
        ia, ib, ic, da, dc, iab, icb, ma, mc, qa, sense = i3, i2, i1, d3, d1, i32, i21, m3, m1, q3, -1.0
        axes[0], axes[1], axes[2] = n3, n2, n1
        d2 = neg(d2)
    sign_c = 1.0 if mc[0] > 0 else -1.0
    sign_a = sign_c if (axes[1] - axes[0]) % 3 == 1 else -sign_c
    momentum = root(add(add(mul(m1, m1), mul(m2, m2)), mul(m3, m3)))
    size_a, size_b, size_c = (
        root(div(mul(ia, dc), i31)),
        root(div(mul(ib, dc), icb)),
        root(div(mul(ic, da), i31)),
    )
    below = mul(icb, da)
    k2, kc2 = div(mul(iab, dc), below), div(mul(i31, d2), below)
    rate = root(div(below, mul(mul(ia, ib), ic)))
    sn2, cn2 = mul(ia, icb), mul(ic, iab)
    root_n = root(add(ONE, div(cn2, sn2)))
    cos2, sin2 = mul(qa, i31), mul(q2, icb)
    cot = root(div(cos2, sin2)) if sin2[0] > 0.0 else (math.inf, 0.0)
    quarter, pi, start = integrals(root(kc2), root_n, cot)
    mean = div(sub(pi, div(mul(div(size_c, momentum), HALF_PI), root_n)), quarter)
    swing = add(div(momentum, ic), times(mul(div(mul(momentum, i31), mul(ia, ic)), mean), sense))
    if m2[0] < 0:
        start = neg(start)
    if sign_a * ma[0] < 0:
        start = sub(ONE, start)
    out[0], out[1] = times(div(rate, times(quarter, 2.0)), sense)
    out[2], out[3] = start
    out[4], out[5] = div(swing, times(HALF_PI, 4.0))
    out[6], out[7], out[8], out[9] = size_a[0], size_b[0], size_c[0], momentum[0]
    out[10], out[11], out[12] = ia[0], ib[0], ic[0]
    out[13], out[14], out[15] = sign_a, 1.0, sign_c
    direct = k2[0] <= kc2[0]
    out[16], out[17] = _nome(k2[0], direct, quarter[0], sn2[0], cn2[0])
    return 0 if direct else 1


@njit(cache=True, error_model="numpy")
def _nome(k2: float, direct: bool, quarter: float, sn2: float, cn2: float) -> tuple[float, float]:
    """Return πK'/K and πy₀/K for the direct series, πK/K' and πy₀/2K' for the dual one."""
    if k2 == 0.0:
        return math.inf, 0.0
    sn2, cn2 = sn2 / (sn2 + cn2), cn2 / (sn2 + cn2)
    dual_quarter, y0 = complete_k(math.sqrt(k2)), math.sqrt(sn2) * carlson_rf(cn2, cn2 + k2 * sn2, 1.0)
    if direct:
        return math.pi * dual_quarter / quarter, math.pi * y0 / quarter
    return math.pi * quarter / dual_quarter, math.pi * y0 / (2 * dual_quarter)
