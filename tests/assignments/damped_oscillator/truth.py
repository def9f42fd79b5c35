"""The exact answers. They stay on the server, except those of public scenes, whose arrays go into the kit."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def rates(y: ArrayLike, omega: ArrayLike, gamma: ArrayLike) -> Array:
    """Return dy/dt (n, 2) for y = (x, v) (n, 2) and x″ = −ω²x − 2γx′; ω in rad/s and γ in 1/s are (n,)."""
    x, v = np.asarray(y, dtype=float).T
    return np.column_stack([v, -(np.asarray(omega) ** 2) * x - 2 * np.asarray(gamma) * v])


def motion(t: ArrayLike, y0: ArrayLike, omega: float, gamma: float) -> Array:
    """Return x in m and v in m/s (2, n) at times t (n,) in s, from y0 = (x, v) at t = 0.

    Uses the closed form for γ < ω, with the frequency √(ω² − γ²).
    """
    t, (x0, v0) = np.asarray(t, dtype=float), np.asarray(y0, dtype=float)
    w = np.sqrt(omega**2 - gamma**2)
    decay, cos, sin = np.exp(-gamma * t), np.cos(w * t), np.sin(w * t)
    return np.array(
        [
            decay * (x0 * cos + (v0 + gamma * x0) / w * sin),
            decay * (v0 * cos - (gamma * v0 + omega**2 * x0) / w * sin),
        ]
    )
