"""The exercise with its public checks.

This folder becomes part of the students' kit, so that ``polhode.check`` prints the same lines as the server.
It may import numpy, scipy, the kit, and its own modules (relatively), and must not contain the solution.
"""

import numpy as np

from polhode.judging.checks import Arrays, conserved, within
from polhode.judging.exercise import Exercise

from .figures import MOTION
from .parameters import UNDAMPED


def _energy(seen: Arrays) -> np.ndarray:
    x, v = seen["y"]
    return np.asarray(0.5 * (v**2 + (UNDAMPED[0] * x) ** 2))


def _at_time(index: tuple[int, ...], seen: Arrays) -> str:
    return f"t = {seen['t'][index[-1]]:.4g} s"


OSCILLATOR = Exercise(
    "1",
    "The equation of motion",
    ("oscillator",),
    (
        # A conservation check alone is never enough: a function that returns zeros passes it.
        conserved(
            "1-energy",
            "energy conserved without damping",
            "undamped",
            series=_energy,
            limit=1e-8,
            reason=(
                "the integrator (rtol 1e-10) loses 4.2e-10 of the energy in 40 rad; the limit is over 20"
                " times that"
            ),
            locate=_at_time,
        ),
        within(
            "1-motion",
            "x(t) and v(t) follow the closed form",
            "damped",
            measured=lambda seen: seen["y"],
            expected=lambda truth: truth["y"],
            scale=lambda truth: 1.0,
            limit=1e-8,
            reason="the integrator's error (rtol 1e-10) is 2.4e-10 after 40 rad; the limit is 40 times that",
            locate=_at_time,
        ),
    ),
    figures=(MOTION,),
)

EXERCISES = (OSCILLATOR,)
