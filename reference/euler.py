"""Equations of motion: how ω and the attitude change when no torque acts."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def euler_rhs(w: ArrayLike, I: ArrayLike) -> Array:
    """dω/dt of a torque-free body in its principal axes.

    I₁ ω̇₁ = (I₂ − I₃) ω₂ ω₃ and cyclically (L. Euler, 1758; Landau & Lifshitz, Mechanics, §36).

    ``w`` (3,) or (3, n) in rad/s, ``I`` (3,) or (3, n) in kg m²; returns the shape of ``w`` in rad/s².
    """
    w1, w2, w3 = np.asarray(w, dtype=float)
    i1, i2, i3 = np.asarray(I, dtype=float)
    return np.array([(i2 - i3) * w2 * w3 / i1, (i3 - i1) * w3 * w1 / i2, (i1 - i2) * w1 * w2 / i3])


def attitude_rate(R: ArrayLike, w: ArrayLike) -> Array:
    """dR/dt = R [ω]× for an attitude ``R`` (3, 3) body → space and ``w`` (3,) in body axes; returns (3, 3) in 1/s."""
    w1, w2, w3 = np.asarray(w, dtype=float)
    return np.asarray(R, dtype=float) @ np.array([[0.0, -w3, w2], [w3, 0.0, -w1], [-w2, w1, 0.0]])
