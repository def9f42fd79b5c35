"""Three ways to state an attitude beside ω, and their rates, with an optional torque.

A state is ω (3,) in rad/s, body axes, followed by R (9,) by rows, by a unit quaternion (4,), or by Euler's
angles θ, φ, ψ (3,) as in ``reference.heavy_top``. The functions are compiled for double or single precision,
whichever the arrays have.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reference.exact import matrices
from reference.heavy_top import attitude
from reference.methods.method import Run, Scene

Array = NDArray[np.float64]
MATRIX, QUATERNION, ANGLES = 0, 1, 2


def start(scene: Scene, form: int) -> Array:
    """Return the state at t = 0."""
    half = scene.tilt / 2
    beside = (scene.R0.ravel(), [math.cos(half), math.sin(half), 0.0, 0.0], [scene.tilt, 0.0, 0.0])
    return np.concatenate((scene.w0, beside[form]))


def run_of(form: int, states: Array, calls: int) -> Run:
    """Return the run of ``states`` (n, d). A quaternion of any length stands for a rotation."""
    w, beside = states[:, :3].T, states[:, 3:]
    if form == MATRIX:
        return Run(w, beside.reshape(-1, 3, 3), calls)
    return Run(w, matrices(beside.T) if form == QUATERNION else attitude(beside.T), calls)


@njit(cache=True)
def rates(form: int, y: Array, I: Array, mgl: float, out: Array) -> None:
    """Fill ``out`` (d,) with dy/dt. The vertical in body axes, R's last row, takes the torque ``mgl``."""
    w1, w2, w3 = y[0], y[1], y[2]
    if form == MATRIX:
        for row in range(3, 12, 3):
            a, b, c = y[row], y[row + 1], y[row + 2]
            out[row], out[row + 1], out[row + 2] = b * w3 - c * w2, c * w1 - a * w3, a * w2 - b * w1
        up1, up2 = y[9], y[10]
    elif form == QUATERNION:
        s, a, b, c = y[3], y[4], y[5], y[6]
        out[3] = -(a * w1 + b * w2 + c * w3) / 2
        out[4], out[5] = (s * w1 + b * w3 - c * w2) / 2, (s * w2 + c * w1 - a * w3) / 2
        out[6] = (s * w3 + a * w2 - b * w1) / 2
        up1, up2 = 2 * (a * c - s * b), 2 * (b * c + s * a)
    else:
        sine, sp, cp = math.sin(y[3]), math.sin(y[5]), math.cos(y[5])
        swing = (w1 * sp + w2 * cp) / sine
        out[3], out[4], out[5] = w1 * cp - w2 * sp, swing, w3 - swing * math.cos(y[3])
        up1, up2 = sine * sp, sine * cp
    out[0] = ((I[1] - I[2]) * w2 * w3 + mgl * up2) / I[0]
    out[1] = ((I[2] - I[0]) * w3 * w1 - mgl * up1) / I[1]
    out[2] = (I[0] - I[1]) * w1 * w2 / I[2]
