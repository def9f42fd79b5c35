"""The theta series of ``reference.theta`` for one sample at a time, and the sine, cosine and exponential they
need.

No branches, library calls or arrays, so that the compiler can vectorize over eight samples.
"""

import math
from typing import TypeAlias

import numpy as np
from numba import njit
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import NDArray

Array = NDArray[np.float64]
Table: TypeAlias = tuple[float, ...]
# Taylor coefficients of cos πx and sin πx; the first one left out is below 5e-17 for |x| ≤ ¼.
C2, C4, C6, C8, C10, C12, C14, C16 = (
    (-1) ** k * math.pi ** (2 * k) / math.factorial(2 * k) for k in range(1, 9)
)
S1, S3, S5, S7, S9, S11, S13, S15 = (
    (-1) ** k * math.pi ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(8)
)
# The same of e^x; below 1e-17 for |x| ≤ ½ ln 2, whose leading 32 bits times a whole number are exact.
E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12, E13 = (1 / math.factorial(k) for k in range(2, 14))
LN2, LN2_LOW, LOG2_E = 6.93147180369123816490e-01, 1.90821492927058770002e-10, 1.4426950408889634
POWERS = (64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0)
FACTORS = tuple(2.0**-k for k in POWERS)


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def circle(half_turns: float) -> tuple[float, float]:
    """Return cos πx and sin πx for |x| ≤ ½, by the series at x/2:
    three times as fast as two library calls.
    """
    h = 0.5 * half_turns
    x = h * h
    x2 = x * x
    x4 = x2 * x2
    s = h * (((S1 + S3 * x) + (S5 + S7 * x) * x2) + ((S9 + S11 * x) + (S13 + S15 * x) * x2) * x4)
    c = 1.0 + x * (((C2 + C4 * x) + (C6 + C8 * x) * x2) + ((C10 + C12 * x) + (C14 + C16 * x) * x2) * x4)
    return 1.0 - 2.0 * s * s, 2.0 * s * c


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def decay(x: float) -> float:
    """Return e^(−x) for 0 ≤ x < 88: a power of two times the exponential series of the rest."""
    n = np.rint(x * LOG2_E)
    d = (n * LN2 - x) + n * LN2_LOW
    d2 = d * d
    d4 = d2 * d2
    tail = (E8 + E9 * d) + (E10 + E11 * d) * d2 + (E12 + E13 * d) * d4
    e = 1.0 + (d + d2 * ((E2 + E3 * d) + (E4 + E5 * d) * d2 + ((E6 + E7 * d) + tail * d2) * d4))
    for j in range(7):
        e, n = (e * FACTORS[j], n - POWERS[j]) if n >= POWERS[j] else (e, n)
    return e


@njit(cache=True, error_model="numpy")
def direct_table(c: Table) -> Table:
    """Return q, q², …, the sizes over the series' values at their maxima,
    and the coefficients of re and im.
    """
    ratio, offset = c[16], c[17]
    q = math.exp(-ratio)
    k = np.zeros(21)
    k[0], k[1], k[2], k[3], k[4], k[5] = q, q**2, q**4, q**6, q**9, q**12
    theta2, theta3, theta4 = 1 + k[1] + k[3] + k[5], 1 + 2 * (q + k[2] + k[4]), 1 - 2 * (q - k[2] + k[4])
    k[6], k[7], k[8] = c[6] * theta4 / theta2, c[7] * theta3 / theta2, c[8] * theta4 / theta3
    for j in range(1, 4):
        if ratio < math.inf:
            plus, minus = math.exp(-2 * j * j * ratio + j * offset), math.exp(-2 * j * j * ratio - j * offset)
            sign = -1.0 if j % 2 else 1.0
            k[8 + j], k[11 + j] = sign * (plus + minus), sign * (plus - minus)
    return to_fixed_tuple(k, 21)  # type: ignore[call-arg]  # numba adds the context


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def direct(k: Table, rest: float) -> tuple[float, float, float, float, float]:
    """Return m_a, m_b, m_c before the sign of the half period, and re, im, from the direct series."""
    q, q2, q4, q6, q9, q12 = k[0], k[1], k[2], k[3], k[4], k[5]
    o, s = circle(rest)
    c2, s2 = (o - s) * (o + s), 2 * s * o
    c4 = 2 * c2 * c2 - 1
    c6 = c2 * (2 * c4 - 1)
    even, odd = 1 + 2 * q4 * c4, 2 * (q * c2 + q9 * c6)
    scale = 1 / (even - odd)
    a = o * (1 + q2 * (2 * c2 - 1) + q6 * (2 * c4 - 2 * c2 + 1) + q12 * (2 * c6 - 2 * c4 + 2 * c2 - 1))
    b = s * (1 - q2 * (2 * c2 + 1) + q6 * (2 * c4 + 2 * c2 + 1) - q12 * (2 * c6 + 2 * c4 + 2 * c2 + 1))
    re = 1 + k[9] * c2 + k[10] * c4 + k[11] * c6
    im = s2 * (k[12] + k[13] * (2 * c2) + k[14] * (2 * c4 + 1))
    return k[6] * a * scale, k[7] * b * scale, k[8] * (even + odd) * scale, re, im


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def dual_table(c: Table) -> Table:
    """Return ratio, e^(−ratio/2), powers of q, the sizes, and the coefficients of re and im."""
    k = np.zeros(21)
    q, base = math.exp(-c[16]), math.exp(-c[16] / 2)
    k[0], k[1], k[2], k[3], k[4], k[5] = c[16], base, q, q**2, q**4, q**6
    k[9], k[10] = q**9, q**12
    theta2, theta3, theta4, top, bottom = 0.0, 1.0, 1.0, 0.0, 0.0
    for j in range(5):
        theta2 += 2 * q ** (j * (j + 1))
        sign = -1.0 if j % 2 else 1.0
        top += q ** (j * j) * (1 + q ** (2 * j + 1))
        bottom += sign * q ** (j * j) * (1 - q ** (2 * j + 1))
        if j:
            theta3 += 2 * q ** (j * j)
            theta4 += 2 * sign * q ** (j * j)
        k[11 + j] = base ** (j * j) * math.cos((2 * j + 1) * c[17] / 2)
        k[16 + j] = base ** (j * j) * math.sin((2 * j + 1) * c[17] / 2)
    k[6], k[7], k[8] = c[6] * theta2 / theta4, c[7] * top / bottom, c[8] * theta2 / theta3
    return to_fixed_tuple(k, 21)  # type: ignore[call-arg]  # numba adds the context


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def dual(k: Table, rest: float) -> tuple[float, float, float, float, float]:
    """Return m_a, m_b, m_c before the sign of the half period, and re, im, from the dual series."""
    side = -1.0 if rest < 0 else 1.0
    e = decay(k[0] * abs(rest))
    y = k[1] / e
    q, q2, q4, q6, q9 = k[2], k[3], k[4], k[5], k[9]
    x, w = e * e, y * y
    x2, w2 = x * x, w * w
    x3, w3 = x2 * x, w2 * w
    even, odd = 1 + q2 * x2 + k[10] * x2 * x2, x + q6 * x3
    scale = 1 / (even + odd + q * w + q4 * w2 + q9 * w3)
    b = even - odd - q * w + q4 * w2 - q9 * w3
    plain, waved = 1 + q2 * w2 + q4 * x2, w + q * x + q6 * w3 + q9 * x3
    re = im = 0.0
    power, fade = 1.0, e
    for j in range(5):
        re += k[11 + j] * power * (1 + fade)
        im -= k[16 + j] * power * (1 - fade)
        power, fade = power * y, fade * x
    return (
        k[6] * (plain - waved) * e * scale,
        k[7] * side * b * scale,
        k[8] * (plain + waved) * e * scale,
        re,
        im * side,
    )
