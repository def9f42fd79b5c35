"""Stability: which steady spins are stable, how fast the intermediate one grows, and how much a motion
magnifies small errors.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.euler import euler_rhs
from reference.exact import Exact
from reference.inertia import check_moments

Array = NDArray[np.float64]
STEP = 0.1  # of a step of the variational equation times its rate


def steady_spin_growth_rate(I: ArrayLike, axis: int, spin: float) -> float:
    """Return σ in 1/s: a small transverse ω grows as exp(σt) about ``axis`` (0, 1, 2); 0 if it only
    oscillates.

    Linearized Euler equations: σ² = (I_k − I_i)(I_j − I_k) Ω² / (I_i I_j), positive only for the intermediate
    axis (Landau & Lifshitz, Mechanics, §37). ``I`` (3,) in kg m², ``spin`` Ω in rad/s.
    """
    moments = np.asarray(I, dtype=float)
    k, i, j = moments[axis], moments[axis - 2], moments[axis - 1]
    return float(abs(spin) * np.sqrt(max(0.0, (k - i) * (j - k) / (i * j))))


def free_precession_rate(I: ArrayLike, w3: float) -> float:
    """Return Ω = (I₃ − I₁) ω₃ / I₁ in rad/s of a symmetric top with moments ``I`` (3,) (Landau & Lifshitz,
    Mechanics, §36).

    Raises ValueError unless I₁ = I₂ to 1e-12.
    """
    i1, i2, i3 = np.asarray(I, dtype=float)
    if not np.isclose(i1, i2, rtol=1e-12, atol=0.0):
        raise ValueError(f"free precession at one rate needs I₁ = I₂; got {i1} and {i2}")
    return float((i3 - i1) / i1 * w3)


def sensitivity(w0: ArrayLike, I: ArrayLike, t_end: float, samples: int = 400) -> float:
    """Return κ: a relative error ε anywhere in the right-hand side moves ω by at most κ ε |ω₀| until
    ``t_end`` s, to first order in ε.

    κ = max_t ∫₀ᵗ ‖∂ω(t)/∂ω(s)‖ |ω̇(s)| ds / |ω₀|, with the derivatives from the variational equation along
    the exact motion, by the trapezoidal rule on ``samples`` times. A steady scene has κ of a few; near the
    separatrix κ grows like the inverse distance for each passage. An integrator's local errors, relative to
    ω̇ as its tolerances are, spread the same way. Raises ValueError for moments that no body has.
    """
    return sensitivities(w0, I, t_end, samples)[0]


def sensitivities(w0: ArrayLike, I: ArrayLike, t_end: float, samples: int = 400) -> tuple[float, float]:
    """Return κ as ``sensitivity`` does, and in s: an error of at most δ rad/s² anywhere in ω̇ moves ω by at
    most that times δ.

    It is max_t ∫₀ᵗ ‖∂ω(t)/∂ω(s)‖ ds.
    """
    moments, start, times = check_moments(I), np.asarray(w0, dtype=float), np.linspace(0.0, t_end, samples)
    exact = Exact(start, moments)
    speed = np.linalg.norm(euler_rhs(exact.omega(times), moments), axis=0)
    between = np.zeros(
        (samples, samples, 3, 3)
    )  # ∂ω(tᵢ)/∂ω(tⱼ) for i ≥ j, forwards only: nothing is inverted
    between[range(samples), range(samples)] = np.eye(3)
    for k, across in enumerate(_propagators(exact, moments, times)):
        between[k + 1, : k + 1] = across @ between[k, : k + 1]
    later, earlier = np.tril_indices(samples)
    flow, norms = between[later, earlier], np.zeros((samples, samples))
    norms[later, earlier] = np.sqrt(np.linalg.eigvalsh(np.swapaxes(flow, 1, 2) @ flow)[:, -1])
    weighted = norms * np.array([speed, np.ones(samples)])[:, None]
    worst = (
        np.tril((weighted[:, :, 1:] + weighted[:, :, :-1]) / 2 * np.diff(times), -1).sum(axis=2).max(axis=1)
    )
    return float(worst[0]) / float(np.linalg.norm(start)), float(worst[1])


def _propagators(exact: Exact, moments: Array, times: Array) -> Array:
    """Return ∂ω(tᵢ₊₁)/∂ω(tᵢ) (n − 1, 3, 3) of evenly spaced ``times`` (n,), by the classical Runge-Kutta
    step, all intervals at the same time.
    """
    gap = float(times[1] - times[0])
    fastest = float(np.linalg.norm(_jacobian(exact.omega(times), moments), axis=(1, 2)).max())
    steps = max(2, int(np.ceil(gap * fastest / STEP)))
    h = gap / steps
    fine = np.linspace(0.0, times[-1], (len(times) - 1) * 2 * steps + 1)
    jacobian = _jacobian(exact.omega(fine), moments)
    one = np.eye(3)
    across = np.broadcast_to(one, (len(times) - 1, 3, 3))
    for s in range(0, 2 * steps, 2):
        first, middle, last = (jacobian[s + k : len(fine) - 2 * steps + s + k : 2 * steps] for k in range(3))
        k1 = first
        k2 = middle @ (one + h / 2 * k1)
        k3 = middle @ (one + h / 2 * k2)
        k4 = last @ (one + h * k3)
        across = (one + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)) @ across
    return across


def _jacobian(w: Array, moments: Array) -> Array:
    """Return ∂ω̇/∂ω (n, 3, 3) for ω (3, n)."""
    k1, k2, k3 = (moments[[1, 2, 0]] - moments[[2, 0, 1]]) / moments
    w1, w2, w3 = w
    nothing = np.zeros_like(w1)
    rows = [[nothing, k1 * w3, k1 * w2], [k2 * w3, nothing, k2 * w1], [k3 * w2, k3 * w1, nothing]]
    return np.moveaxis(np.array(rows), 2, 0)
