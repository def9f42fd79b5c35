"""Exercise 5: spin about each axis of the book; the intermediate one lets go."""

import functools

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

import reference
from exercises.assignment import Animation, Exercise
from exercises.checks import Arrays, close, holds
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import BOOK, NUDGE, SPIN, SPIN_TIME, spun
from exercises.rigid_body.sections.wording import film, omega, pointwise

Array = NDArray[np.float64]


def _growth(*runs: Arrays) -> Array:
    return np.array([reference.transverse_growth(run["w"], axis, SPIN) for axis, run in enumerate(runs)])


@functools.cache
def exact_growth() -> Array:
    """The largest transverse |ω| over the spin for each axis, over all times and not only at samples."""
    found = []
    for axis in range(3):
        exact, times = reference.Exact(spun(axis), BOOK), np.linspace(0.0, SPIN_TIME, 400)

        def transverse(t: float, axis: int = axis, exact: reference.Exact = exact) -> float:
            return reference.transverse_growth(exact.omega([t]), axis, SPIN)

        at = times[np.argmax([transverse(t) for t in times])]
        step = times[1]
        most = minimize_scalar(lambda t: -transverse(t), bounds=(at - step, at + step), method="bounded", options={"xatol": 1e-9})
        found.append(-most.fun)
    return np.array(found)


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
            expected=lambda *truth: exact_growth(),
            rtol=1e-4,
            atol=0.0,
            reason="the largest of 1500 samples misses a maximum between two of them by less than 1e-4 of it",
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
