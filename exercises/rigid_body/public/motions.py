"""The motions of exercises 2, 5 and 6 that can be played: the student's attitude R(t) as a box, beside the exact one."""

import numpy as np
from numpy.typing import ArrayLike

from ecp.exercise import Motion

from .setting import BODY, BOX, SYMMETRIC


def _half(I: ArrayLike) -> tuple[float, float, float]:
    """Half edges (3,) of a uniform box whose moments are as ``I`` (3,) to one another, the longest 1."""
    moments = np.asarray(I, dtype=float)
    edges = np.sqrt(moments.sum() / 2 - moments)
    a, b, c = (edges / edges.max()).tolist()
    return a, b, c


TORQUE_FREE = Motion(
    "torque-free",
    "The body in space, turned by your equations",
    "Two boxes turning side by side, yours and the exact one, with the angular momentum and the path of body axis ê₃.",
    "torque-free",
    _half(BODY),
    2,
)
TUMBLE = Motion(
    "tumble",
    "The book spun about its intermediate axis",
    "Two books side by side, yours and the exact one, spun about body axis ê₂, which turns over and back again.",
    "spin-mid",
    (BOX[1] / 2, BOX[2] / 2, BOX[3] / 2),
    1,
)
PRECESSION = Motion(
    "precession",
    "The free precession",
    "Two symmetric boxes side by side, yours and the exact one; body axis ê₃ goes round the angular momentum on a cone.",
    "precession",
    _half(SYMMETRIC),
    2,
)
