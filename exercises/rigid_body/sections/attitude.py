"""Exercise 6: the attitude, and its animation."""

import numpy as np

import reference
from exercises.assignment import Animation, Exercise
from exercises.checks import Arrays, below, close, shows
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import SYMMETRIC as TOP
from exercises.rigid_body.sections.wording import DRIVE, NOTEBOOK, attitude, film, pointwise
from exercises.rigid_body.watched import momentum_shown


def _keeps_momentum(seen: Arrays, truth: Arrays) -> tuple[bool | None, str]:
    shown = momentum_shown(seen, truth["t"], truth["R"], truth["L"])
    return shown.found, shown.sentence


ATTITUDE = Exercise(
    "6",
    "Animating the free precession",
    ("animate_precession",),
    (
        pointwise("6-pointwise"),
        close(
            "6-orthonormal",
            "R stays orthonormal (max |RᵀR − 1| over the run)",
            "precession",
            measured=lambda seen: reference.orthonormality_error(seen["R"]).max(),
            expected=0.0,
            rtol=1e-6,
            atol=1e-6,
            reason=NOTEBOOK,
        ),
        attitude("6-attitude", "R(t) follows the exact attitude", "precession"),
        attitude("6-secret", "R(t) of a body of three unequal moments follows the exact attitude", "drawn-attitude"),
        below(
            "6-momentum",
            "L stays fixed in space",
            "precession",
            measured=lambda seen: np.ptp(reference.space_momentum(seen["R"], seen["w"], TOP), axis=0),
            limit=1e-8,
            reason=DRIVE,
        ),
        *film("6", "film", "animate_precession", 2, "the body axis ê₃(t)"),
        shows(
            "6-drawn-momentum",
            "what animate_precession draws along L stays fixed",
            "film",
            claim=_keeps_momentum,
            reason="without torque L is constant in space",
        ),
    ),
    figures=(figures.CONE,),
    animations=(
        Animation(
            "precession",
            "Your animation of the free precession",
            "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its frames.",
            "film",
        ),
    ),
)
