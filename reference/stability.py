"""Stability of steady spin: which axes hold, and how fast the intermediate one lets go."""

import numpy as np
from numpy.typing import ArrayLike


def steady_spin_growth_rate(I: ArrayLike, axis: int, spin: float) -> float:
    """σ in 1/s: a small transverse ω grows as exp(σt) about ``axis`` (0, 1, 2); 0 where it only oscillates.

    Linearised Euler equations: σ² = (I_k − I_i)(I_j − I_k) Ω² / (I_i I_j), positive only for the intermediate axis
    (Landau & Lifshitz, Mechanics, §37). ``I`` (3,), ``spin`` Ω in rad/s.
    """
    moments = np.asarray(I, dtype=float)
    k, i, j = moments[axis], moments[axis - 2], moments[axis - 1]
    return float(abs(spin) * np.sqrt(max(0.0, (k - i) * (j - k) / (i * j))))


def free_precession_rate(I: ArrayLike, w3: float) -> float:
    """Ω = (I₃ − I₁) ω₃ / I₁ in rad/s for a symmetric top, I₁ = I₂ (Landau & Lifshitz, Mechanics, §36)."""
    i1, i2, i3 = np.asarray(I, dtype=float)
    if not np.isclose(i1, i2, rtol=1e-12, atol=0.0):
        raise ValueError(f"free precession at one rate needs I₁ = I₂; got {i1} and {i2}")
    return float((i3 - i1) / i1 * w3)
