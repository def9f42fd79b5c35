"""Exercise 2: Euler's equations, point by point and as a motion."""

import reference
from exercises.assignment import Exercise
from exercises.checks import Arrays, close, conserved
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import BODY
from exercises.rigid_body.sections.wording import NOTEBOOK, ROUNDING, at_time, omega


def _at_probe(index: tuple[int, ...], seen: Arrays) -> str:
    return f"ω̇{'₁₂₃'[index[1]]}, probe {index[0] + 1} of {len(seen['wdot'])}"


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
        close(
            "2-pointwise",
            "euler_eqs agrees with Euler's equations point by point",
            "probes",
            measured=lambda seen: seen["wdot"],
            expected=lambda truth: truth["wdot"],
            rtol=1e-12,
            atol=1e-12,
            reason=ROUNDING,
            locate=_at_probe,
        ),
        omega("2-motion", "ω(t) follows the exact motion", "torque-free"),
    ),
    figures=(figures.OMEGA, figures.OMEGA_RESIDUAL),
)
