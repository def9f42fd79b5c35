"""Exercise 2: Euler's equations."""

from ecp.checks import conserved
from ecp.exercise import Exercise

from . import figures, motions
from .common_checks import NOTEBOOK, at_time, omega
from .observables import kinetic_energy, momentum_norm
from .parameters import BODY

EULER = Exercise(
    "2",
    "Euler's equations",
    ("euler_eqs",),
    (
        conserved(
            "2-energy",
            "rotational energy conserved (torque-free)",
            "torque-free",
            series=lambda seen: kinetic_energy(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        conserved(
            "2-momentum",
            "|L| conserved (torque-free)",
            "torque-free",
            series=lambda seen: momentum_norm(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        omega("2-motion", "ω(t) follows the exact motion", "torque-free"),
    ),
    figures=(figures.OMEGA, figures.OMEGA_RESIDUAL),
    motions=(motions.TORQUE_FREE,),
)
