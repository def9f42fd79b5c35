"""A state of body momentum (3,) and attitude as a quaternion (4,),
for methods that turn instead of adding.
"""

import math

import numpy as np
from numba import njit

from reference.method import Array


@njit(cache=True)
def multiply(p: Array, s: float, x: float, y: float, z: float) -> None:
    """Multiply p by (s, x, y, z) from the right, in place."""
    a, b, c, d = p[0], p[1], p[2], p[3]
    p[0] = a * s - b * x - c * y - d * z
    p[1] = a * x + b * s + c * z - d * y
    p[2] = a * y - b * z + c * s + d * x
    p[3] = a * z + b * y - c * x + d * s


@njit(cache=True)
def normalise(p: Array) -> None:
    """Normalize p in place, which only removes rounding."""
    scale = 1.0 / math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
    for i in range(4):
        p[i] *= scale


@njit(cache=True)
def turn(m: Array, p: Array, x: float, y: float, z: float) -> None:
    """Turn the body by the vector (x, y, z) in rad, body axes: the attitude by exp, the momentum's body
    components back.
    """
    angle = math.sqrt(x * x + y * y + z * z)
    half = 0.5 * angle
    f = math.sin(half) / angle if angle > 1e-8 else 0.5 - angle * angle / 48
    s, a, b, c = math.cos(half), f * x, f * y, f * z
    multiply(p, s, a, b, c)
    u, v, w = 2 * (m[1] * c - m[2] * b), 2 * (m[2] * a - m[0] * c), 2 * (m[0] * b - m[1] * a)
    m0, m1, m2 = m[0] + s * u + v * c - w * b, m[1] + s * v + w * a - u * c, m[2] + s * w + u * b - v * a
    m[0], m[1], m[2] = m0, m1, m2


@njit(cache=True)
def keep(m: Array, p: Array, I: Array, at: int, w: Array, R: Array) -> None:
    """Copy a state to sample ``at`` of w (n, 3) and R (n, 3, 3)."""
    for i in range(3):
        w[at, i] = m[i] / I[i]
    s, x, y, z = p[0], p[1], p[2], p[3]
    R[at, 0, 0], R[at, 0, 1], R[at, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)
    R[at, 1, 0], R[at, 1, 1], R[at, 1, 2] = 2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)
    R[at, 2, 0], R[at, 2, 1], R[at, 2, 2] = 2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)


@njit(cache=True)
def start(w0: Array, I: Array) -> tuple[Array, Array]:
    """Return momentum (3,) and attitude (4,) at t = 0."""
    p = np.zeros(4)
    p[0] = 1.0
    return w0 * I, p
