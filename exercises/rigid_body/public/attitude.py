"""Exercise 6: the attitude, and its animation."""

import numpy as np

from ecp.checks import below, close
from ecp.exercise import Animation, Exercise
from ecp.kinds.animation.body import keeps_momentum

from . import figures, motions
from .common_checks import DRIVE, NOTEBOOK, attitude, film, filmed
from .observables import orthonormality_error, space_momentum
from .parameters import SYMMETRIC

ATTITUDE = Exercise(
    "6",
    "Animating the free precession",
    ("animate_precession",),
    (
        close(
            "6-orthonormal",
            "the integrated orientation stays a proper rotation (RᵀR=I)",
            "precession",
            measured=lambda seen: orthonormality_error(seen["R"]).max(),
            expected=0.0,
            rtol=1e-6,
            atol=1e-6,
            reason=NOTEBOOK,
        ),
        attitude("6-attitude", "R(t) follows the exact attitude", "precession"),
        below(
            "6-momentum",
            "L stays fixed in space",
            "precession",
            measured=lambda seen: np.ptp(space_momentum(seen["R"], seen["w"], SYMMETRIC), axis=0),
            limit=1e-8,
            reason=DRIVE,
        ),
        *film("6", "film", "animate_precession", "the body axis ê₃(t)"),
        keeps_momentum("6-drawn-momentum", "what animate_precession draws along L stays fixed", "film", filmed),
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
    motions=(motions.PRECESSION,),
    prerequisites=("euler_eqs",),
)
