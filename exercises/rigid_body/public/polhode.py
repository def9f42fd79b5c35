"""Exercise 3: polhodes on the two ellipsoids, followed at the exact rate."""

import numpy as np

from ecp.checks import close
from ecp.exercise import Exercise

from . import figures
from .common_checks import NOTEBOOK, at_time, omega
from .observables import kinetic_energy, momentum_norm
from .parameters import BODY

POLHODE = Exercise(
    "3",
    "Polhodes",
    ("euler_eqs",),
    (
        close(
            "3-energy",
            "ω stays on the energy ellipsoid (T constant)",
            "torque-free",
            measured=lambda seen: kinetic_energy(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], kinetic_energy(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        close(
            "3-momentum",
            "ω stays on the angular-momentum ellipsoid (|L| constant)",
            "torque-free",
            measured=lambda seen: momentum_norm(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], momentum_norm(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        omega("3-about-3", "ω(t) on the polhode about ê₃ follows the exact motion", "polhode-3"),
        omega("3-about-1", "ω(t) on the polhode about ê₁ follows the exact motion", "polhode-1"),
    ),
    figures=(figures.POLHODE,),
)
