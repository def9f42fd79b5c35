"""Exercise 2: Euler's equations, point by point and as a motion."""

import reference
from exercises.assignment import Exercise
from exercises.checks import conserved
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import BODY
from exercises.rigid_body.sections.wording import NOTEBOOK, at_time, omega, pointwise

EULER = Exercise(
    "2",
    "Euler's equations",
    ("euler_eqs",),
    (
        conserved(
            "2-energy",
            "rotational energy conserved (torque-free)",
            "torque-free",
            series=lambda seen: reference.kinetic_energy(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        conserved(
            "2-momentum",
            "angular momentum magnitude conserved (torque-free)",
            "torque-free",
            series=lambda seen: reference.momentum_norm(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        pointwise("2-pointwise"),
        omega("2-motion", "ω(t) follows the exact motion", "torque-free"),
        omega("2-secret", "ω(t) of a body not seen before follows the exact motion for sixty radians", "drawn-long"),
    ),
    figures=(figures.OMEGA, figures.OMEGA_RESIDUAL),
)
