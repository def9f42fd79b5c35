"""Observables: quantities of a motion that do not depend on how it was computed."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def kinetic_energy(w: ArrayLike, I: ArrayLike) -> Array:
    """Return T = ½ Σ Iᵢ ωᵢ² (...) in J of ``w`` (3, ...) in rad/s and ``I`` (3,) in kg m²."""
    return 0.5 * np.einsum("i,i...->...", np.asarray(I, dtype=float), np.asarray(w, dtype=float) ** 2)


def angular_momentum(w: ArrayLike, I: ArrayLike) -> Array:
    """Return L = (I₁ω₁, I₂ω₂, I₃ω₃) (3, ...) in kg m²/s, *body* components, of ``w`` (3,
    ...) and ``I`` (3,).
    """
    return np.einsum("i,i...->i...", np.asarray(I, dtype=float), np.asarray(w, dtype=float))


def momentum_norm(w: ArrayLike, I: ArrayLike) -> Array:
    """Return |L| (...) in kg m²/s of ``w`` (3, ...) and ``I`` (3,)."""
    return np.asarray(np.linalg.norm(angular_momentum(w, I), axis=0))


def space_momentum(R: ArrayLike, w: ArrayLike, I: ArrayLike) -> Array:
    """Return L (n, 3) in kg m²/s, *space* components, of ``R`` (n, 3, 3), ``w`` (3, n) and ``I`` (3,);
    constant without torque.
    """
    return np.einsum("nij,jn->ni", np.asarray(R, dtype=float), angular_momentum(w, I))


def orthonormality_error(R: ArrayLike) -> Array:
    """Return max |RᵀR − 1| (n,) of each attitude in ``R`` (n, 3, 3)."""
    attitude = np.asarray(R, dtype=float)
    gram = np.einsum("nji,njk->nik", attitude, attitude)
    return np.asarray(np.abs(gram - np.eye(3)).max(axis=(1, 2)))


def precession_rate(t: ArrayLike, w: ArrayLike) -> float:
    """Return the mean rate in rad/s at which the transverse part of ω turns about ê₃, positive from ê₁ to ê₂.

    ``t`` (n,) in s, ``w`` (3, n) in rad/s, sampled finely enough that the phase moves by less than π between
    samples.
    """
    w_body = np.asarray(w, dtype=float)
    phase = np.unwrap(np.arctan2(w_body[1], w_body[0]))
    return float(np.polyfit(np.asarray(t, dtype=float), phase, 1)[0])


def transverse_growth(w: ArrayLike, axis: int, spin: float) -> float:
    """Return the largest transverse |ω| over the run, in units of ``spin`` (rad/s), for a spin started about
    body axis ``axis`` (0, 1, 2).
    """
    transverse = np.delete(np.asarray(w, dtype=float), axis, axis=0)
    return float(np.hypot(*transverse).max() / spin)
