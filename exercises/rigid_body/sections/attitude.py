"""Exercise 6: the attitude, and its animation."""

import numpy as np

import reference
from ecp.film import moving_share
from exercises.assignment import Animation, Exercise
from exercises.checks import Arrays, below, close, holds
from exercises.rigid_body import figures
from exercises.rigid_body.mistakes import STILL
from exercises.rigid_body.scenes import SYMMETRIC as TOP
from exercises.rigid_body.sections.wording import DRIVE, NOTEBOOK, pointwise


def _moves(seen: Arrays) -> tuple[bool, str]:
    share = moving_share(seen["frames"])
    return share > STILL, f"{len(seen['frames'])} stills, up to {share:.2%} of the picture changes"


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
        close(
            "6-attitude",
            "R(t) follows the exact attitude",
            "precession",
            measured=lambda seen: seen["R"],
            expected=lambda truth: truth["R"],
            rtol=0.0,
            atol=1e-8,
            reason=DRIVE,
            locate=lambda index, seen: f"R{index[1] + 1}{index[2] + 1}, t = {seen['t'][index[0]]:.4g} s",
        ),
        below(
            "6-momentum",
            "L stays fixed in space",
            "precession",
            measured=lambda seen: np.ptp(reference.space_momentum(seen["R"], seen["w"], TOP), axis=0),
            limit=1e-8,
            reason=DRIVE,
        ),
        holds(
            "6-moves",
            "animate_precession draws a moving picture",
            "film",
            claim=_moves,
            reason="a picture in which fewer than one pixel in ten thousand changes does not move",
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
