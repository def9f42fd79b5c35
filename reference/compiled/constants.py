"""A body's constants in double-double: the same formulas as ``reference.polhode``, for general motion only."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reference.compiled.doubledouble import DD, add, div, mul, neg, product, root, sub, times

Array = NDArray[np.float64]
HALF_PI: DD = (math.pi / 2, 6.123233995736766e-17)
ONE: DD = (1.0, 0.0)
NEAR = 1e-5


@njit(cache=True, error_model="numpy")
def complete_k(kc: DD) -> DD:
    """K for the complementary modulus kc."""
    a, b = ONE, kc
    if b[0] > a[0]:
        a, b = b, a
    while a[0] - b[0] > 1e-9 * a[0]:
        a, b = times(add(a, b), 0.5), root(mul(a, b))
    return div(HALF_PI, times(add(times(add(a, b), 0.5), root(mul(a, b))), 0.5))


@njit(cache=True, error_model="numpy")
def complete_pi(one_minus_n: DD, kc: DD) -> DD:
    """Π(n, k), Bulirsch's cel."""
    p = root(one_minus_n)
    a, b, e, em, qc = ONE, div(ONE, p), kc, ONE, kc
    while True:
        f, g = a, div(e, p)
        a = add(a, div(b, p))
        b = times(add(b, mul(f, g)), 2.0)
        p = add(g, p)
        g = em
        em = add(em, qc)
        if abs(sub(g, qc)[0]) <= 1e-16 * g[0]:
            return mul(HALF_PI, div(add(b, mul(a, em)), mul(em, add(em, p))))
        qc = times(root(e), 2.0)
        e = mul(qc, em)


@njit(cache=True, error_model="numpy")
def carlson_rf(x: DD, y: DD, z: DD) -> DD:
    """Carlson's R_F."""
    mean0 = div(add(add(x, y), z), (3.0, 0.0))
    mean, x0, y0, scale = mean0, x, y, 1.0
    spread = 500 * max(abs(mean[0] - x[0]), abs(mean[0] - y[0]), abs(mean[0] - z[0]))
    while spread * scale > mean[0]:
        rx, ry, rz = root(x), root(y), root(z)
        shift = add(mul(rx, add(ry, rz)), mul(ry, rz))
        x, y, z = times(add(x, shift), 0.25), times(add(y, shift), 0.25), times(add(z, shift), 0.25)
        mean, scale = times(add(mean, shift), 0.25), scale * 0.25
    dx, dy = (mean0[0] - x0[0]) * scale / mean[0], (mean0[0] - y0[0]) * scale / mean[0]
    dz = -dx - dy
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    series = -e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44 - 5 * e2**3 / 208 + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16
    return div(add(ONE, (series, 0.0)), root(mean))


@njit(cache=True, error_model="numpy")
def constants(w: Array, I: Array, out: Array, axes: NDArray[np.int64]) -> int:
    """Fill ``out`` and ``axes``; 0 for the direct model, 1 for the dual, −1 where neither serves.

    out: phase, start and swing (pairs), sizes a, b, c, |L|, moments a, b, c, signs a, b, c, nome ratio, offset.
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
        return -1  # so near the separatrix 32 digits do not give the period to the 25 that a hundred million of them need
    if d2[0] > 0:
        ia, ib, ic, da, dc, iab, icb, ma, mb, mc, sense = i1, i2, i3, d1, d3, i21, i32, m1, m2, m3, 1.0
        axes[0], axes[1], axes[2] = n1, n2, n3
    else:
        ia, ib, ic, da, dc, iab, icb, ma, mb, mc, sense = i3, i2, i1, d3, d1, i32, i21, m3, m2, m1, -1.0
        axes[0], axes[1], axes[2] = n3, n2, n1
        d2 = neg(d2)
    sign_c = 1.0 if mc[0] > 0 else -1.0
    sign_a = sign_c if (axes[1] - axes[0]) % 3 == 1 else -sign_c
    momentum = root(add(add(mul(m1, m1), mul(m2, m2)), mul(m3, m3)))
    size_a, size_b, size_c = root(div(mul(ia, dc), i31)), root(div(mul(ib, dc), icb)), root(div(mul(ic, da), i31))
    below = mul(icb, da)
    k2, kc2 = div(mul(iab, dc), below), div(mul(i31, d2), below)
    kc = root(kc2)
    rate = root(div(below, mul(mul(ia, ib), ic)))
    symmetric = k2[0] == 0.0
    quarter = complete_k(kc)
    dual_quarter = quarter if symmetric else complete_k(root(k2))
    one_minus_n = add(ONE, div(mul(ic, iab), mul(ia, icb)))
    mean = sub(complete_pi(one_minus_n, kc), div(mul(div(size_c, momentum), HALF_PI), root(one_minus_n)))
    mean = div(mean, quarter)
    swing = add(div(momentum, ic), times(mul(div(mul(momentum, i31), mul(ia, ic)), mean), sense))
    cn, sn = div(times(ma, sign_a), size_a), div(mb, size_b)
    c2, s2 = mul(cn, cn), mul(sn, sn)
    norm = add(c2, s2)
    c2, s2 = div(c2, norm), div(s2, norm)
    u0 = mul(root(s2), carlson_rf(c2, add(c2, mul(kc2, s2)), ONE))
    if sn[0] < 0:
        u0 = neg(u0)
    if cn[0] < 0:
        u0 = sub(times(quarter, 2.0), u0)
    along = mul(ib, i31)
    sn2, cn2 = div(mul(ia, icb), along), div(mul(ic, iab), along)
    y0 = (0.0, 0.0) if symmetric else mul(root(sn2), carlson_rf(cn2, sub(ONE, mul(kc2, sn2)), ONE))
    twice = times(quarter, 2.0)
    out[0], out[1] = times(div(rate, twice), sense)
    out[2], out[3] = div(u0, twice)
    out[4], out[5] = div(swing, times(HALF_PI, 4.0))
    out[6], out[7], out[8], out[9] = size_a[0], size_b[0], size_c[0], momentum[0]
    out[10], out[11], out[12] = ia[0], ib[0], ic[0]
    out[13], out[14], out[15] = sign_a, 1.0, sign_c
    direct = k2[0] <= kc2[0]
    below, above = (quarter, dual_quarter) if direct else (dual_quarter, quarter)
    out[16] = math.inf if symmetric else math.pi * above[0] / below[0]
    out[17] = math.pi * y0[0] / below[0] * (1.0 if direct else 0.5)
    return 0 if direct else 1
