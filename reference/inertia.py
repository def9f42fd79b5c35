"""Moments of inertia: the uniform box, the principal moments of a tensor, and the conditions a real body
meets.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# A flat plate has I₁ + I₂ = I₃ exactly; computed moments may break that by rounding, and only by rounding.
_TRIANGLE_SLACK = 1e-12


def box_moments(m: float, a: float, b: float, c: float) -> Array:
    """Return the principal moments (3,) in kg m² of a uniform box of mass ``m`` (kg) with full edges ``a, b,
    c`` (m) along ê₁, ê₂, ê₃.

    I₁ = m (b² + c²) / 12 and cyclically (Landau & Lifshitz, Mechanics, §32).
    """
    return m / 12.0 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])


def box_tensor(m: float, a: float, b: float, c: float, R: ArrayLike) -> Array:
    """Return the inertia tensor R diag(I) Rᵀ (3, 3) in kg m², space axes, of that box in attitude ``R`` (3,
    3) body → space.
    """
    attitude = np.asarray(R, dtype=float)
    return attitude @ np.diag(box_moments(m, a, b, c)) @ attitude.T


def principal_moments(tensor: ArrayLike) -> Array:
    """Return the principal moments (..., 3), ascending, of symmetric tensors (..., 3, 3) in the tensors'
    unit.
    """
    return np.linalg.eigvalsh(np.asarray(tensor, dtype=float))


def check_moments(I: ArrayLike) -> Array:
    """Return ``I`` as a float array (3,) if a rigid body can have these moments.

    Each moment must be positive and none may exceed the sum of the other two (equality: a flat plate). Raises
    ValueError otherwise.
    """
    moments = np.asarray(I, dtype=float)
    if moments.shape != (3,):
        raise ValueError(f"a rigid body has three principal moments; got shape {moments.shape}")
    plain = moments.tolist()
    if not all(0 < x < math.inf for x in plain):
        raise ValueError(f"principal moments are positive and finite; got {plain}")
    if 2 * max(plain) > sum(plain) * (1 + _TRIANGLE_SLACK):
        raise ValueError(f"no moment exceeds the sum of the other two (triangle inequality); got {plain}")
    return moments
