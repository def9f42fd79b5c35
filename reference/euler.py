"""Equations of motion: the rates of ω and the attitude without torque."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def euler_rhs(w: ArrayLike, I: ArrayLike) -> Array:
    """Return dω/dt of a torque-free body in its principal axes, in rad/s², in the shape of ``w``.

    I₁ ω̇₁ = (I₂ − I₃) ω₂ ω₃ and cyclically (L. Euler, 1758; Landau & Lifshitz, Mechanics, §36). ``w`` (3,) or
    (3, n) in rad/s, ``I`` (3,) or (3, n) in kg m².
    """
    w1, w2, w3 = np.asarray(w, dtype=float)
    i1, i2, i3 = np.asarray(I, dtype=float)
    return np.array([(i2 - i3) * w2 * w3 / i1, (i3 - i1) * w3 * w1 / i2, (i1 - i2) * w1 * w2 / i3])


def attitude_rate(R: ArrayLike, w: ArrayLike) -> Array:
    """Return dR/dt = R [ω]× (3, 3) in 1/s for an attitude ``R`` (3, 3) body → space and ``w`` (3,) in rad/s,
    body axes.
    """
    w1, w2, w3 = np.asarray(w, dtype=float)
    return np.asarray(R, dtype=float) @ np.array([[0.0, -w3, w2], [w3, 0.0, -w1], [-w2, w1, 0.0]])
