"""Quantities that the public checks measure. They are part of the students' kit, which therefore lacks the
equations asked for.

Sums are written element by element: the last bits of einsum depend on an array's place in memory, and a
student's kernel must print the same digits as the server.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def kinetic_energy(w: Array, I: ArrayLike) -> Array:
    """Return T = ½ Σ Iᵢ ωᵢ² in J (...) of ``w`` (3, ...) in rad/s and ``I`` (3,) in kg m²."""
    i1, i2, i3 = np.asarray(I, dtype=float)
    return np.asarray(0.5 * (i1 * w[0] ** 2 + i2 * w[1] ** 2 + i3 * w[2] ** 2))


def momentum_norm(w: Array, I: ArrayLike) -> Array:
    """Return |L| in kg m²/s (...) of ``w`` (3, ...) and ``I`` (3,)."""
    return np.asarray(np.linalg.norm(_momentum(w, I), axis=0))


def space_momentum(R: Array, w: Array, I: ArrayLike) -> Array:
    """Return L in *space* components (n, 3), in kg m²/s, of ``R`` (n, 3, 3), ``w`` (3, n) and ``I`` (3,)."""
    return np.asarray((R * _momentum(w, I).T[:, None, :]).sum(axis=2))


def orthonormality_error(R: Array) -> Array:
    """Return max |RᵀR − 1| of each attitude (n,)."""
    gram = (R[:, :, :, None] * R[:, :, None, :]).sum(axis=1)
    return np.asarray(np.abs(gram - np.eye(3)).max(axis=(1, 2)))


def turning_rate(t: Array, w: Array, exact: Array, rate: float) -> float:
    """Return the mean rate in rad/s at which (ω₁, ω₂) turns: the known ``rate`` of the ``exact`` ω (3, n),
    and what ``w`` gains on it.
    """
    ahead = (w[0] + 1j * w[1]) * (exact[0] - 1j * exact[1])
    return rate + float(np.polyfit(t, np.unwrap(np.angle(ahead)), 1)[0])


def transverse(w: Array, axis: int, spin: float) -> Array:
    """Return the transverse |ω| (n,) over ``spin``, for a spin started about body axis ``axis`` (0, 1, 2)."""
    return np.asarray(np.hypot(*np.delete(w, axis, axis=0)) / spin)


def _momentum(w: Array, I: ArrayLike) -> Array:
    return np.asarray((np.asarray(I, dtype=float) * w.T).T)
