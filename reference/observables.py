"""Observables: functions of arrays that say something about a motion without knowing how it was made."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def kinetic_energy(w: ArrayLike, I: ArrayLike) -> Array:
    """T = ½ Σ Iᵢ ωᵢ² in J; ``w`` (3, ...), ``I`` (3,); returns (...)."""
    return 0.5 * np.einsum("i,i...->...", np.asarray(I, dtype=float), np.asarray(w, dtype=float) ** 2)


def angular_momentum(w: ArrayLike, I: ArrayLike) -> Array:
    """L = (I₁ω₁, I₂ω₂, I₃ω₃) in kg m²/s, *body* components; ``w`` (3, ...), ``I`` (3,); returns (3, ...)."""
    return np.einsum("i,i...->i...", np.asarray(I, dtype=float), np.asarray(w, dtype=float))


def momentum_norm(w: ArrayLike, I: ArrayLike) -> Array:
    """|L| in kg m²/s; ``w`` (3, ...), ``I`` (3,); returns (...)."""
    return np.asarray(np.linalg.norm(angular_momentum(w, I), axis=0))


def space_momentum(R: ArrayLike, w: ArrayLike, I: ArrayLike) -> Array:
    """L in *space* components, constant without torque; ``R`` (n, 3, 3), ``w`` (3, n); returns (n, 3)."""
    return np.einsum("nij,jn->ni", np.asarray(R, dtype=float), angular_momentum(w, I))


def orthonormality_error(R: ArrayLike) -> Array:
    """max |RᵀR − 1| of each attitude; ``R`` (n, 3, 3); returns (n,)."""
    attitude = np.asarray(R, dtype=float)
    gram = np.einsum("nji,njk->nik", attitude, attitude)
    return np.asarray(np.abs(gram - np.eye(3)).max(axis=(1, 2)))


def precession_rate(t: ArrayLike, w: ArrayLike) -> float:
    """Mean rate (rad/s) at which the transverse part of ω turns about ê₃, in the sense ê₁ → ê₂.

    ``t`` (n,), ``w`` (3, n) sampled finely enough that the phase moves by less than π between samples.
    """
    w_body = np.asarray(w, dtype=float)
    phase = np.unwrap(np.arctan2(w_body[1], w_body[0]))
    return float(np.polyfit(np.asarray(t, dtype=float), phase, 1)[0])


def transverse_growth(w: ArrayLike, axis: int, spin: float) -> float:
    """Largest transverse |ω| over the run, in units of ``spin`` (rad/s), for a spin started about body axis ``axis`` (0, 1, 2)."""
    transverse = np.delete(np.asarray(w, dtype=float), axis, axis=0)
    return float(np.hypot(*transverse).max() / spin)
