"""Exercise 3: polhodes on the two ellipsoids, run through at the exact pace."""

import numpy as np

import reference
from exercises.assignment import Exercise
from exercises.checks import close
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import BODY
from exercises.rigid_body.sections.wording import NOTEBOOK, at_time, omega, pointwise

POLHODE = Exercise(
    "3",
    "Polhodes",
    ("euler_eqs",),
    (
        pointwise("3-pointwise"),
        close(
            "3-energy",
            "polhode lies on the energy ellipsoid",
            "torque-free",
            measured=lambda seen: reference.kinetic_energy(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], reference.kinetic_energy(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        close(
            "3-momentum",
            "polhode lies on the momentum ellipsoid",
            "torque-free",
            measured=lambda seen: reference.momentum_norm(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], reference.momentum_norm(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        omega("3-about-3", "polhode about ê₃ is run through at the exact pace", "polhode-3"),
        omega("3-about-1", "polhode about ê₁ is run through at the exact pace", "polhode-1"),
        omega("3-secret-greatest", "polhode about the axis of the greatest moment of a body not seen before", "drawn-greatest"),
        omega("3-secret-least", "polhode about the axis of the least moment of a body not seen before", "drawn-least"),
    ),
    figures=(figures.POLHODE,),
)
