"""Exercise 5: spin about each axis of the book; the intermediate one lets go."""

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.assignment import Animation, Exercise
from exercises.checks import Arrays, close, holds
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import NUDGE, SPIN
from exercises.rigid_body.sections.wording import film, omega, pointwise

Array = NDArray[np.float64]


def _growth(*runs: Arrays) -> Array:
    return np.array([reference.transverse_growth(run["w"], axis, SPIN) for axis, run in enumerate(runs)])


def _spin_claim(*runs: Arrays) -> tuple[bool, str]:
    low, mid, high = _growth(*runs)
    steady = 5 * NUDGE
    return bool(low < steady and mid > 10 * steady and high < steady), f"growth: min {low:.3f}, mid {mid:.3f}, max {high:.3f}"


INTERMEDIATE = Exercise(
    "5",
    "The intermediate axis",
    ("euler_eqs",),
    (
        pointwise("5-pointwise"),
        holds(
            "5-notebook",
            "spin is stable about the extreme axes, unstable about the intermediate axis",
            "spin-min",
            "spin-mid",
            "spin-max",
            claim=_spin_claim,
            reason="steady: growth under 5 times the nudge; unstable: over 50 times",
        ),
        close(
            "5-growth",
            "transverse growth about each axis is the exact one",
            "spin-min",
            "spin-mid",
            "spin-max",
            measured=_growth,
            expected=_growth,
            rtol=1e-6,
            atol=0.0,
            reason="seen and exact motion are sampled at the same times, so only the integrator's 1e-9 remains",
            locate=lambda index, *seen: f"spin about ê{'₁₂₃'[index[0]]}",
        ),
        omega("5-motion", "the tumble about the intermediate axis follows the exact motion", "spin-mid"),
        omega("5-secret", "a body not seen before turns over when it should", "drawn-tumble"),
        *film("5", "tumble-film", "animate_tumble", None, "the body"),
    ),
    figures=(figures.GROWTH, figures.TUMBLE),
    animations=(
        Animation(
            "tumble-yours",
            "Your animation of the tumbling box",
            "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its frames.",
            "tumble-film",
        ),
    ),
    optional=("animate_tumble",),
)
