"""Explicit Runge-Kutta methods on (ω, R), twelve numbers: a tableau and one loop."""

from functools import partial

import numpy as np
from numba import njit
from scipy.integrate._ivp import dop853_coefficients as dop853

from reference.method import Array, fixed

EULER = (np.zeros((1, 1)), np.array([1.0]))
# Kutta, 1901
RK4 = (
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1.0, 0]]),
    np.array([1, 2, 2, 1]) / 6,
)
# Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I, §II.5: the eighth-order formula of
# DOP853.
RK8 = (np.ascontiguousarray(dop853.A[:12, :12]), np.ascontiguousarray(dop853.B))


@njit(cache=True)
def rates(y: Array, I: Array, out: Array) -> None:
    """Fill ``out`` (12,) with d(ω, R)/dt of a state (12,), R by rows."""
    w1, w2, w3 = y[0], y[1], y[2]
    out[0] = (I[1] - I[2]) * w2 * w3 / I[0]
    out[1] = (I[2] - I[0]) * w3 * w1 / I[1]
    out[2] = (I[0] - I[1]) * w1 * w2 / I[2]
    for row in range(3, 12, 3):
        a, b, c = y[row], y[row + 1], y[row + 2]
        out[row], out[row + 1], out[row + 2] = b * w3 - c * w2, c * w1 - a * w3, a * w2 - b * w1


@njit(cache=True)
def advance(y: Array, h: float, weights: Array, k: Array, out: Array) -> None:
    """Fill ``out`` with y + h Σ weights·k, summed over as many stages as there are weights."""
    for i in range(12):
        total = 0.0
        for s in range(weights.size):
            total += weights[s] * k[s, i]
        out[i] = y[i] + h * total


@njit(cache=True)
def keep(y: Array, at: int, w: Array, R: Array) -> None:
    """Copy a state (12,) to sample ``at`` of w (n, 3) and R (n, 3, 3)."""
    for i in range(3):
        w[at, i] = y[i]
        for j in range(3):
            R[at, i, j] = y[3 + 3 * i + j]


@njit(cache=True)
def start(w0: Array) -> Array:
    """Return the state (12,) at t = 0."""
    y = np.zeros(12)
    y[:3] = w0
    y[3] = y[7] = y[11] = 1.0
    return y


@njit(cache=True)
def _explicit(
    A: Array, b: Array, w0: Array, I: Array, h: float, intervals: int, steps: int, w: Array, R: Array
) -> int:
    stages = b.size
    y, k, point = start(w0), np.empty((stages, 12)), np.empty(12)
    keep(y, 0, w, R)
    for at in range(1, intervals + 1):
        for _ in range(steps):
            for s in range(stages):
                advance(y, h, A[s, :s], k, point)
                rates(point, I, k[s])
            advance(y, h, b, k, y)
        keep(y, at, w, R)
    return int(intervals * steps * stages)


EXPLICIT = tuple(
    fixed(name, "explicit", order, partial(_explicit, *tableau))
    for name, order, tableau in (("Euler", 1, EULER), ("RK4", 4, RK4), ("RK8 (DOP853, fixed)", 8, RK8))
)
