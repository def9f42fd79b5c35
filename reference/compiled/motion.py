"""One loop over the samples: momentum, attitude and their conversion, without a temporary array."""

import math

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from reference.compiled.constants import constants
from reference.compiled.doubledouble import product, total
from reference.compiled.series import circle, direct, direct_table, dual, dual_table
from reference.exact import Exact

Array = NDArray[np.float64]
INVERSE_PI = 1 / math.pi


def compiled_motion(w0: ArrayLike, I: ArrayLike, t: ArrayLike, *, orientation: bool = True) -> tuple[Array, Array | None]:
    """ω (3, n) and R (n, 3, 3) or None at times ``t`` (n,), as ``reference.Exact`` gives them; the same errors for bad input."""
    spin, moments = np.array(w0, dtype=float), np.array(I, dtype=float)
    times = np.ascontiguousarray(t, dtype=float)
    if spin.shape == moments.shape == (3,):
        served, w, R = _motion(spin, moments, times, orientation)
        if served:
            return w, R if orientation else None
    sampled = Exact(spin, moments).sample(times, orientation=orientation)
    return sampled.w, sampled.R


@njit(cache=True, error_model="numpy")
def _motion(spin: Array, moments: Array, t: Array, orientation: bool) -> tuple[bool, Array, Array]:
    found, axes = np.empty(18), np.empty(3, dtype=np.int64)
    model = constants(spin, moments, found, axes) if _bodily(spin, moments) else -1
    w, R = np.empty((3, t.size if model >= 0 else 0)), np.empty((t.size if orientation and model >= 0 else 0, 3, 3))
    if model >= 0:
        _sample(model, found, axes, t, w, R)
    return model >= 0, w, R


@njit(cache=True, error_model="numpy")
def _bodily(spin: Array, moments: Array) -> bool:
    """Whether all is plainly in order: what is not goes to ``Exact``, which tells what is wrong."""
    whole, largest = moments[0] + moments[1] + moments[2], max(moments[0], moments[1], moments[2])
    moved = abs(spin[0]) + abs(spin[1]) + abs(spin[2])
    return min(moments[0], moments[1], moments[2]) > 0 and 2 * largest <= whole < math.inf and moved < math.inf


@njit(cache=True, error_model="numpy")
def _turns(high: float, low: float, t: float, start: float, start_low: float) -> tuple[float, float]:
    p, e = product(high, t)
    whole = np.rint(p + start)
    x, lost = total(p - whole, start)
    return whole, x + (lost + e + low * t + start_low)


@njit(cache=True, error_model="numpy")
def _momentum(model: int, c: Array, table: Array, t: float) -> tuple[float, float, float, float, float, float]:
    """Momentum in the triad a, b, c; re, im; and what is to be added to half the angle about L, in half turns."""
    whole, rest = _turns(c[0], c[1], t, c[2], c[3])
    flip = 1.0 - 4.0 * (0.5 * whole - np.floor(0.5 * whole))
    if model == 0:
        a, b, z, re, im = direct(table, rest)
        return a * flip, b * flip, z, re, im, 0.0
    a, b, z, re, im = dual(table, rest)
    return a * flip, b * flip, z, re, im, rest * (c[17] * INVERSE_PI)


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def _quaternion(
    c: Array, t: float, a: float, b: float, z: float, re: float, im: float, extra: float
) -> tuple[float, float, float, float]:
    """The attitude about L as a quaternion of any length and either sign."""
    _, half = _turns(c[4], c[5], t, extra, 0.0)
    k, s = circle(half)
    k, s = k * re - s * im, s * re + k * im
    tall = c[9] + z
    return k * tall, k * b + s * a, s * b - k * a, s * tall


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def _sample(model: int, c: Array, axes: NDArray[np.int64], t: Array, w: Array, R: Array) -> None:
    table = direct_table(c) if model == 0 else dual_table(c)
    w0, w1, w2 = w[axes[0]], w[axes[1]], w[axes[2]]
    a0, a1, a2 = 1 + axes[0], 1 + axes[1], 1 + axes[2]
    k0, k1, k2 = c[13] / c[10], c[14] / c[11], c[15] / c[12]
    if R.shape[0] == 0:
        for i in range(t.size):
            a, b, z, _, _, _ = _momentum(model, c, table, t[i])
            w0[i], w1[i], w2[i] = k0 * a, k1 * b, k2 * z
        return
    a, b, z, re, im, extra = _momentum(model, c, table, 0.0)
    f0, f1, f2, f3 = _quaternion(c, 0.0, a, b, z, re, im, extra)
    q = np.empty(4)
    for i in range(t.size):
        a, b, z, re, im, extra = _momentum(model, c, table, t[i])
        w0[i], w1[i], w2[i] = k0 * a, k1 * b, k2 * z
        p0, p1, p2, p3 = _quaternion(c, t[i], a, b, z, re, im, extra)
        q[a0] = c[13] * (f0 * p1 - f1 * p0 - f2 * p3 + f3 * p2)
        q[a1] = c[14] * (f0 * p2 + f1 * p3 - f2 * p0 - f3 * p1)
        q[a2] = c[15] * (f0 * p3 - f1 * p2 + f2 * p1 - f3 * p0)
        s, x, y, v = f0 * p0 + f1 * p1 + f2 * p2 + f3 * p3, q[1], q[2], q[3]
        n = 2.0 / (s * s + x * x + y * y + v * v)
        nx, ny, nv = n * x, n * y, n * v
        R[i, 0, 0], R[i, 0, 1], R[i, 0, 2] = 1 - (ny * y + nv * v), nx * y - nv * s, nx * v + ny * s
        R[i, 1, 0], R[i, 1, 1], R[i, 1, 2] = nx * y + nv * s, 1 - (nx * x + nv * v), ny * v - nx * s
        R[i, 2, 0], R[i, 2, 1], R[i, 2, 2] = nx * v - ny * s, ny * v + nx * s, 1 - (nx * x + ny * y)
