"""Stability: which steady spins hold, how fast the intermediate one lets go, and how much a motion magnifies small errors."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from reference.euler import euler_rhs
from reference.exact import Exact
from reference.inertia import check_moments

Array = NDArray[np.float64]


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


def sensitivity(w0: ArrayLike, I: ArrayLike, t_end: float, samples: int = 400) -> float:
    """κ: a relative error ε anywhere in the right-hand side moves ω by at most κ ε |ω₀| until ``t_end`` (to first order in ε).

    κ = max_t ∫₀ᵗ ‖∂ω(t)/∂ω(s)‖ |ω̇(s)| ds / |ω₀|, with the derivatives from the variational equation along the exact motion, by
    the trapezoidal rule on ``samples`` times. A steady scene has κ of a few; near the separatrix κ grows like the inverse
    distance for each passage. An integrator's local errors, relative to ω̇ as its tolerances are, spread the same way.
    """
    moments, start, times = check_moments(I), np.asarray(w0, dtype=float), np.linspace(0.0, t_end, samples)
    exact = Exact(start, moments)

    def spread(t: float, columns: Array) -> Array:
        return (_jacobian(exact.omega([t])[:, 0], moments) @ columns.reshape(3, 3)).ravel()

    run = solve_ivp(spread, (0.0, t_end), np.eye(3).ravel(), method="DOP853", t_eval=times, rtol=1e-8, atol=1e-10)
    flow = run.y.T.reshape(-1, 3, 3)
    # The flow has determinant 1 in L, so its inverse is as well known as itself.
    speed = np.linalg.norm(euler_rhs(exact.omega(times), moments), axis=0)
    inverse = np.linalg.inv(flow)
    gaps = np.diff(times)
    worst = 0.0
    for k in range(1, samples):
        norms = np.linalg.norm(flow[k] @ inverse[: k + 1], ord=2, axis=(1, 2)) * speed[: k + 1]
        worst = max(worst, float(np.sum((norms[1:] + norms[:-1]) / 2 * gaps[:k])))
    return worst / float(np.linalg.norm(start))


def _jacobian(w: Array, moments: Array) -> Array:
    """∂ω̇/∂ω (3, 3)."""
    k1, k2, k3 = (moments[[1, 2, 0]] - moments[[2, 0, 1]]) / moments
    w1, w2, w3 = w
    return np.array([[0.0, k1 * w3, k1 * w2], [k2 * w3, 0.0, k2 * w1], [k3 * w2, k3 * w1, 0.0]])
