"""The samples in blocks that fit the first-level cache: momentum and quaternion of a block, then ω and R."""

import math

import numpy as np
from numba import njit
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import ArrayLike, NDArray

from reference.compiled.constants import constants
from reference.compiled.doubledouble import product, total
from reference.compiled.series import Table, circle, direct, direct_table, dual, dual_table
from reference.exact import Exact

Array = NDArray[np.float64]
INVERSE_PI = 1 / math.pi
BLOCK = 64


def compiled_motion(
    w0: ArrayLike, I: ArrayLike, t: ArrayLike, *, orientation: bool = True
) -> tuple[Array, Array | None]:
    """Return ω (3, n) in rad/s, body axes, and R (n, 3, 3) body → space, or None, at times ``t`` (n,) in s.

    Agrees with ``reference.Exact`` to rounding and raises the same ValueError for bad input.
    """
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
    w, R = (
        np.empty((3, t.size if model >= 0 else 0)),
        np.empty((t.size if orientation and model >= 0 else 0, 3, 3)),
    )
    if model >= 0:
        _sample(model, to_fixed_tuple(found, 18), axes, t, w, R)  # type: ignore[call-arg]  # numba adds the context
    return model >= 0, w, R


@njit(cache=True, error_model="numpy")
def _bodily(spin: Array, moments: Array) -> bool:
    """Return whether the input is plainly valid. Other input goes to ``Exact``, which raises the error."""
    whole, largest = moments[0] + moments[1] + moments[2], max(moments[0], moments[1], moments[2])
    moved = abs(spin[0]) + abs(spin[1]) + abs(spin[2])
    return (
        min(moments[0], moments[1], moments[2]) > 0 and 2 * largest <= whole < math.inf and moved < math.inf
    )


@njit(cache=True, error_model="numpy", inline="always")
def _turns(high: float, low: float, t: float, start: float, start_low: float) -> tuple[float, float]:
    p, e = product(high, t)
    whole = np.rint(p + start)
    x, lost = total(p - whole, start)
    return whole, x + (lost + e + low * t + start_low)


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"}, inline="always")
def _quaternion(
    c: Table, t: float, a: float, b: float, z: float, re: float, im: float, extra: float
) -> tuple[float, float, float, float]:
    """Return the attitude about L as a quaternion of any length and either sign."""
    _, half = _turns(c[4], c[5], t, extra, 0.0)
    k, s = circle(half)
    k, s = k * re - s * im, s * re + k * im
    tall = c[9] + z
    return k * tall, k * b + s * a, s * b - k * a, s * tall


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def _block(model: int, c: Table, k: Table, t: Array, orientation: bool, out: Array) -> None:
    """Fill ``out``, row after row, with the momentum in the triad a, b,
    c and the quaternion at BLOCK times.
    """
    for i in range(BLOCK):
        whole, rest = _turns(c[0], c[1], t[i], c[2], c[3])
        flip = 1.0 - 4.0 * (0.5 * whole - np.floor(0.5 * whole))
        if model == 0:
            a, b, z, re, im = direct(k, rest)
            extra = 0.0
        else:
            a, b, z, re, im = dual(k, rest)
            extra = rest * (c[17] * INVERSE_PI)
        a, b = a * flip, b * flip
        out[i], out[BLOCK + i], out[2 * BLOCK + i] = a, b, z
        if orientation:
            p0, p1, p2, p3 = _quaternion(c, t[i], a, b, z, re, im, extra)
            out[3 * BLOCK + i], out[4 * BLOCK + i], out[5 * BLOCK + i], out[6 * BLOCK + i] = p0, p1, p2, p3


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def _sample(model: int, c: Table, axes: NDArray[np.int64], t: Array, w: Array, R: Array) -> None:
    table = direct_table(c) if model == 0 else dual_table(c)
    orientation = R.shape[0] > 0
    part, out = np.zeros(BLOCK), np.empty(7 * BLOCK)
    w0, w1, w2 = w[axes[0]], w[axes[1]], w[axes[2]]
    k0, k1, k2 = c[13] / c[10], c[14] / c[11], c[15] / c[12]
    _block(model, c, table, part, orientation, out)
    start = out[3 * BLOCK], out[4 * BLOCK], out[5 * BLOCK], out[6 * BLOCK]
    for first in range(0, t.size, BLOCK):
        n = min(BLOCK, t.size - first)
        part[:n] = t[first : first + n]
        _block(model, c, table, part, orientation, out)
        for i in range(n):
            w0[first + i], w1[first + i], w2[first + i] = (
                k0 * out[i],
                k1 * out[BLOCK + i],
                k2 * out[2 * BLOCK + i],
            )
        if orientation:
            _matrices(c, axes, start, out, R[first : first + n])


@njit(cache=True, error_model="numpy", fastmath={"contract", "nsz"})
def _matrices(c: Table, axes: NDArray[np.int64], f: tuple[float, ...], out: Array, R: Array) -> None:
    """Fill ``R`` with the rotations from the start ``f``, turned back from the triad to the body's axes."""
    q = np.empty(4)
    a0, a1, a2 = 1 + axes[0], 1 + axes[1], 1 + axes[2]
    for i in range(R.shape[0]):
        p0, p1, p2, p3 = out[3 * BLOCK + i], out[4 * BLOCK + i], out[5 * BLOCK + i], out[6 * BLOCK + i]
        q[a0] = c[13] * (f[0] * p1 - f[1] * p0 - f[2] * p3 + f[3] * p2)
        q[a1] = c[14] * (f[0] * p2 + f[1] * p3 - f[2] * p0 - f[3] * p1)
        q[a2] = c[15] * (f[0] * p3 - f[1] * p2 + f[2] * p1 - f[3] * p0)
        s, x, y, v = f[0] * p0 + f[1] * p1 + f[2] * p2 + f[3] * p3, q[1], q[2], q[3]
        n = 2.0 / (s * s + x * x + y * y + v * v)
        nx, ny, nv = n * x, n * y, n * v
        R[i, 0, 0], R[i, 0, 1], R[i, 0, 2] = 1 - (ny * y + nv * v), nx * y - nv * s, nx * v + ny * s
        R[i, 1, 0], R[i, 1, 1], R[i, 1, 2] = nx * y + nv * s, 1 - (nx * x + nv * v), ny * v - nx * s
        R[i, 2, 0], R[i, 2, 1], R[i, 2, 2] = nx * v - ny * s, ny * v + nx * s, 1 - (nx * x + ny * y)
