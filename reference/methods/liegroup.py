"""Runge-Kutta-Munthe-Kaas of order 4: the classical tableau for the rotation vector, so |L| and RᵀR are exact
by construction.
"""

import numpy as np
from numba import njit

from reference.method import Array, fixed
from reference.methods.rotation import keep, normalise, start, turn


@njit(cache=True)
def _stage(m: Array, v: Array, I: Array, h: float, k: Array) -> None:
    """Fill ``k`` with h dexp⁻¹(ω) at the point reached by turning by v, to the terms of fourth order
    (Munthe-Kaas, BIT 38, 1998).
    """
    point, quaternion = m.copy(), np.array([1.0, 0.0, 0.0, 0.0])
    turn(point, quaternion, v[0], v[1], v[2])
    a, b, c = point[0] / I[0], point[1] / I[1], point[2] / I[2]
    x, y, z = v[1] * c - v[2] * b, v[2] * a - v[0] * c, v[0] * b - v[1] * a
    xx, yy, zz = v[1] * z - v[2] * y, v[2] * x - v[0] * z, v[0] * y - v[1] * x
    k[0], k[1], k[2] = h * (a + x / 2 + xx / 12), h * (b + y / 2 + yy / 12), h * (c + z / 2 + zz / 12)


@njit(cache=True)
def _rkmk4(w0: Array, I: Array, h: float, intervals: int, steps: int, w: Array, R: Array) -> int:
    m, p = start(w0, I)
    k, zero = np.empty((4, 3)), np.zeros(3)
    keep(m, p, I, 0, w, R)
    for at in range(1, intervals + 1):
        for _ in range(steps):
            _stage(m, zero, I, h, k[0])
            _stage(m, k[0] / 2, I, h, k[1])
            _stage(m, k[1] / 2, I, h, k[2])
            _stage(m, k[2], I, h, k[3])
            v = (k[0] + 2 * k[1] + 2 * k[2] + k[3]) / 6
            turn(m, p, v[0], v[1], v[2])
            normalise(p)
        keep(m, p, I, at, w, R)
    return int(4 * intervals * steps)


LIEGROUP = (fixed("RKMK 4", "Lie group", 4, _rkmk4),)
