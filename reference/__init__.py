"""The physics of a torque-free rigid body and of the heavy symmetric top, independent of grading.

Conventions of this package:

* ``I`` (3,): principal moments I₁, I₂, I₃ in kg m², in the order of the body axes ê₁, ê₂, ê₃.
* ``w`` (3,) or (3, n): angular velocity ω in rad/s, components along the *body* axes; time runs along the
  last axis.
* ``t`` (n,): seconds. The motion starts at t = 0.
* ``R`` (3, 3) or (n, 3, 3): the attitude as a matrix *body → space*: ``x_space = R @ x_body``; its columns
  are the body axes seen from space.
"""

from reference.euler import attitude_rate, euler_rhs
from reference.exact import Exact
from reference.heavy_top import HeavyTop
from reference.inertia import box_moments, box_tensor, check_moments, principal_moments
from reference.motion import Motion, motion
from reference.observables import (
    angular_momentum,
    kinetic_energy,
    momentum_norm,
    orthonormality_error,
    precession_rate,
    space_momentum,
    transverse_growth,
)
from reference.stability import free_precession_rate, sensitivities, sensitivity, steady_spin_growth_rate

__all__ = [
    "Exact",
    "HeavyTop",
    "Motion",
    "angular_momentum",
    "attitude_rate",
    "box_moments",
    "box_tensor",
    "check_moments",
    "euler_rhs",
    "free_precession_rate",
    "kinetic_energy",
    "momentum_norm",
    "motion",
    "orthonormality_error",
    "precession_rate",
    "principal_moments",
    "sensitivities",
    "sensitivity",
    "space_momentum",
    "steady_spin_growth_rate",
    "transverse_growth",
]
