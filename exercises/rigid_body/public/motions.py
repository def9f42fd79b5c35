"""The motions of exercises 2, 5 and 6 that can be played: the student's attitude R(t) and the exact one as
boxes.
"""

import numpy as np
from numpy.typing import ArrayLike

from polhode.judging.exercise import Motion

from .quantities import BODY, BOX, SYMMETRIC


def _half(I: ArrayLike) -> tuple[float, float, float]:
    """Return half edges (3,) of a uniform box whose moments have the ratios of ``I`` (3,), the longest 1."""
    moments = np.asarray(I, dtype=float)
    edges = np.sqrt(moments.sum() / 2 - moments)
    a, b, c = (edges / edges.max()).tolist()
    return a, b, c


TORQUE_FREE = Motion(
    "torque-free",
    "The body in space, turned by your equations",
    "Two boxes turning side by side, yours and the exact one, with the angular momentum and the path of body"
    " axis ê₃.",
    "torque-free",
    _half(BODY),
    2,
)
_BOOK = (BOX[1] / 2, BOX[2] / 2, BOX[3] / 2)
SPINS = (
    Motion(
        "spin-least",
        "The book spun about ê₁, the axis of the least moment: stable",
        "Two books side by side, yours and the exact one, spun about body axis ê₁, which stays near the"
        " angular momentum.",
        "spin-min",
        _BOOK,
        0,
    ),
    Motion(
        "tumble",
        "The book spun about ê₂, the intermediate axis: it tumbles",
        "Two books side by side, yours and the exact one, spun about body axis ê₂, which turns over and back"
        " again.",
        "spin-mid",
        _BOOK,
        1,
    ),
    Motion(
        "spin-greatest",
        "The book spun about ê₃, the axis of the greatest moment: stable",
        "Two books side by side, yours and the exact one, spun about body axis ê₃, which stays near the"
        " angular momentum.",
        "spin-max",
        _BOOK,
        2,
    ),
)
PRECESSION = Motion(
    "precession",
    "The free precession",
    "Two symmetric boxes side by side, yours and the exact one; body axis ê₃ goes round the vertical angular"
    " momentum on a cone.",
    "precession",
    _half(SYMMETRIC),
    2,
)
