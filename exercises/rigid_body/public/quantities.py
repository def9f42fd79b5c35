"""The bodies and spins of notebook 2.6 in SI units, the quantities that the public checks measure, and the
tolerance of a motion. They are part of the students' kit, which therefore lacks the equations asked for.

Sums are written element by element: the last bits of einsum depend on an array's place in memory, and a
student's kernel must print the same digits as the server.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polhode.judging.checks import Arrays
from polhode.judging.outcome import Tolerance

Array = NDArray[np.float64]

BOX = (1.0, 2.0, 1.4, 0.4)  # mass and edges of the book, kg and m
SPIN = 6.0  # rad/s about each axis of the book in turn
SPIN_TIME = 2.5  # s
NUDGE = 0.02  # both other components, as a fraction of the spin
BODY = (2.0, 3.0, 4.0)  # moments of exercises 2 and 3
TORQUE_FREE = (1.0, 0.6, 0.8)  # and their spin: T = 2.82 J, |L| = 4.180909 kg m²/s
SYMMETRIC = (1.0, 1.0, 1.6)  # moments of exercises 4 and 6
SYMMETRIC_RATE = 1.8  # rad/s, (I₃ − I₁)/I₁ · ω₃ with ω₃ = 3

RTOL = 1e-11  # of the integrations in plays.py
# ten thousand motions of the right equations (make bench) use less than a tenth of the resulting limit
SAFETY = 10.0


def as_closely(truth: Arrays) -> Tolerance:
    """Return the tolerance of one scene: the integrator's tolerance for every radian, magnified by the
    motion's sensitivity.
    """
    kappa, angle = float(truth["kappa"]), float(truth["angle"])
    reason = f"rtol {RTOL:g} × (sensitivity {kappa:.4g} + {angle:.4g} rad turned) × safety {SAFETY:g}"
    return Tolerance(limit=float(f"{RTOL * (kappa + angle) * SAFETY:.2e}"), reason=reason)


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
