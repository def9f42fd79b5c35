"""Exercise 5: spin about each axis of the book, unstable about the intermediate one."""

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays, close, holds
from ecp.exercise import Animation, Exercise

from . import figures, motions
from .common_checks import film, omega
from .observables import transverse
from .parameters import NUDGE, SPIN

Array = NDArray[np.float64]


def _growth(*runs: Arrays) -> Array:
    return np.array([transverse(run["w"], axis, SPIN).max() for axis, run in enumerate(runs)])


def _spin_claim(*runs: Arrays) -> tuple[bool, str]:
    low, mid, high = _growth(*runs)
    steady = 5 * NUDGE
    return bool(low < steady and mid > 10 * steady and high < steady), f"growth: min {low:.3f}, mid {mid:.3f}, max {high:.3f}"


INTERMEDIATE = Exercise(
    "5",
    "The intermediate axis",
    ("euler_eqs",),
    (
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
            "transverse growth about each axis matches the exact motion",
            "spin-min",
            "spin-mid",
            "spin-max",
            measured=_growth,
            expected=lambda *truth: np.array([exact["growth"] for exact in truth]),
            rtol=1e-4,
            atol=0.0,
            reason="the largest of 1500 samples misses a maximum between two of them by less than 1e-4 of it",
            locate=lambda index, *seen: f"spin about ê{'₁₂₃'[index[0]]}",
        ),
        omega("5-motion", "the tumble about the intermediate axis follows the exact motion", "spin-mid"),
        *film("5", "tumble-film", "animate_tumble", "the body"),
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
    motions=motions.SPINS,
)
