"""One loop over the samples: momentum, attitude and their conversion, without a temporary array."""

import math

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from reference.compiled.constants import constants
from reference.compiled.doubledouble import product, total
from reference.exact import Exact
from reference.inertia import check_moments

Array = NDArray[np.float64]


def compiled_motion(w0: ArrayLike, I: ArrayLike, t: ArrayLike, *, orientation: bool = True) -> tuple[Array, Array | None]:
    """ω (3, n) and R (n, 3, 3) or None at times ``t`` (n,), as ``reference.Exact`` gives them; the same errors for bad input."""
    moments, spin = check_moments(I), np.ascontiguousarray(w0, dtype=float)
    times = np.ascontiguousarray(t, dtype=float)
    found, axes = np.empty(18), np.empty(3, dtype=np.int64)
    model = -1
    if spin.shape == (3,) and np.all(np.isfinite(spin)):
        model = constants(spin, moments, found, axes)
    if model < 0:
        sampled = Exact(spin, moments).sample(times, orientation=orientation)
        return sampled.w, sampled.R
    w, R = np.empty((3, times.size)), np.empty((times.size if orientation else 0, 3, 3))
    _sample(model, found, axes, times, w, R)
    return w, R if orientation else None


@njit(cache=True, error_model="numpy")
def _turns(high: float, low: float, t: float, start: float, start_low: float) -> tuple[float, float]:
    p, e = product(high, t)
    whole = np.rint(p + start)
    x, lost = total(p - whole, start)
    return whole, x + (lost + e + low * t + start_low)


@njit(cache=True, error_model="numpy")
def _direct_series(c: Array) -> Array:
    """q, q², …, the sizes over the series' values at their maxima, and the coefficients of re and im."""
    ratio, offset = c[16], c[17]
    q = math.exp(-ratio)
    k = np.zeros(24)
    k[0], k[1], k[2], k[3], k[4], k[5] = q, q**2, q**4, q**6, q**9, q**12
    theta2, theta3, theta4 = 1 + k[1] + k[3] + k[5], 1 + 2 * (q + k[2] + k[4]), 1 - 2 * (q - k[2] + k[4])
    k[6], k[7], k[8] = c[6] * theta4 / theta2, c[7] * theta3 / theta2, c[8] * theta4 / theta3
    for j in range(1, 4):
        if ratio < math.inf:
            plus, minus = math.exp(-2 * j * j * ratio + j * offset), math.exp(-2 * j * j * ratio - j * offset)
            sign = -1.0 if j % 2 else 1.0
            k[8 + j], k[11 + j] = sign * (plus + minus), sign * (plus - minus)
    return k


@njit(cache=True, error_model="numpy")
def _direct(k: Array, rest: float) -> tuple[float, float, float, float, float]:
    """m_a, m_b, m_c before the sign of the half period, and re, im."""
    q, q2, q4, q6, q9, q12 = k[0], k[1], k[2], k[3], k[4], k[5]
    s, o = math.sin(math.pi * rest), math.cos(math.pi * rest)
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


@njit(cache=True, error_model="numpy")
def _dual_series(c: Array) -> Array:
    """ratio, e^(−ratio/2), powers of q, the sizes, and the coefficients of re and im."""
    k = np.zeros(24)
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
    return k


@njit(cache=True, error_model="numpy")
def _dual(k: Array, rest: float) -> tuple[float, float, float, float, float]:
    side = -1.0 if rest < 0 else 1.0
    e = math.exp(-k[0] * abs(rest))
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
    return k[6] * (plain - waved) * e * scale, k[7] * side * b * scale, k[8] * (plain + waved) * e * scale, re, im * side


@njit(cache=True, error_model="numpy")
def _state(model: int, c: Array, series: Array, t: float, attitude: bool, m: Array, p: Array) -> None:
    """Momentum in the triad a, b, c into ``m``, and the attitude about L as a quaternion of any length into ``p``."""
    whole, rest = _turns(c[0], c[1], t, c[2], c[3])
    flip = 1.0 - 4.0 * (0.5 * whole - math.floor(0.5 * whole))
    if model == 0:
        a, b, z, re, im = _direct(series, rest)
        extra = 0.0
    else:
        a, b, z, re, im = _dual(series, rest)
        extra = rest * c[17]
    m[0], m[1], m[2] = a * flip, b * flip, z
    if not attitude:
        return
    _, turn = _turns(c[4], c[5], t, 0.0, 0.0)
    half = 2 * math.pi * turn + extra
    k, s = math.cos(half), math.sin(half)
    k, s = k * re - s * im, s * re + k * im
    tall = c[9] + m[2]
    p[0], p[1], p[2], p[3] = k * tall, k * m[1] + s * m[0], s * m[1] - k * m[0], s * tall


@njit(cache=True, error_model="numpy")
def _sample(model: int, c: Array, axes: NDArray[np.int64], t: Array, w: Array, R: Array) -> None:
    series = _direct_series(c) if model == 0 else _dual_series(c)
    m, p, first, q = np.empty(3), np.empty(4), np.empty(4), np.empty(4)
    attitude = R.shape[0] > 0
    _state(model, c, series, 0.0, True, m, first)
    for i in range(t.size):
        _state(model, c, series, t[i], attitude, m, p)
        for j in range(3):
            w[axes[j], i] = c[13 + j] * m[j] / c[10 + j]
        if not attitude:
            continue
        s, a, b, z = first[0], -first[1], -first[2], -first[3]
        q[0] = s * p[0] - a * p[1] - b * p[2] - z * p[3]
        q[1 + axes[0]] = c[13] * (s * p[1] + a * p[0] + b * p[3] - z * p[2])
        q[1 + axes[1]] = c[14] * (s * p[2] - a * p[3] + b * p[0] + z * p[1])
        q[1 + axes[2]] = c[15] * (s * p[3] + a * p[2] - b * p[1] + z * p[0])
        ss, x, y, v = q[0], q[1], q[2], q[3]
        n = 2.0 / (ss * ss + x * x + y * y + v * v)
        R[i, 0, 0], R[i, 0, 1], R[i, 0, 2] = 1 - n * (y * y + v * v), n * (x * y - ss * v), n * (x * v + ss * y)
        R[i, 1, 0], R[i, 1, 1], R[i, 1, 2] = n * (x * y + ss * v), 1 - n * (x * x + v * v), n * (y * v - ss * x)
        R[i, 2, 0], R[i, 2, 1], R[i, 2, 2] = n * (x * v - ss * y), n * (y * v + ss * x), 1 - n * (x * x + y * y)
