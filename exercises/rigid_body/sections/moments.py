"""Exercise 1: principal moments of a box."""

import numpy as np
from numpy.typing import NDArray

from exercises.assignment import Exercise
from exercises.checks import Arrays, close
from exercises.rigid_body import figures
from exercises.rigid_body.sections.wording import NOTEBOOK, ROUNDING, at_body, at_moment

Array = NDArray[np.float64]


def _sorted(arrays: Arrays) -> Array:
    return np.sort(arrays["moments"], axis=-1)


MOMENTS = Exercise(
    "1",
    "Principal moments of a box",
    ("box_moments", "principal_moments"),
    (
        close(
            "1-notebook",
            "principal moments match the analytic box result",
            "tensor",
            measured=lambda seen: _sorted(seen)[0],
            expected=lambda truth: truth["moments"][0],
            rtol=1e-10,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        close(
            "1-boxes",
            "box_moments is m/12 (b² + c²) and cyclically, for any box",
            "boxes",
            measured=lambda seen: seen["moments"],
            expected=lambda truth: truth["moments"],
            rtol=1e-12,
            atol=0.0,
            reason=ROUNDING,
            locate=at_moment,
        ),
        close(
            "1-tensors",
            "principal_moments finds the moments of any tilted box",
            "tensors",
            measured=_sorted,
            expected=lambda truth: truth["moments"],
            rtol=0.0,
            atol=1e-9,
            reason="eigenvalues are exact to rounding; by the characteristic polynomial they lose some digits, none of this size",
            locate=at_moment,
        ),
        close(
            "1-trace",
            "their sum is the trace of the tensor",
            "tensors",
            measured=lambda seen: seen["moments"].sum(axis=1),
            expected=lambda truth: truth["trace"],
            rtol=1e-12,
            atol=0.0,
            reason=ROUNDING,
            locate=at_body,
        ),
        close(
            "1-determinant",
            "their product is the determinant of the tensor",
            "tensors",
            measured=lambda seen: seen["moments"].prod(axis=1),
            expected=lambda truth: truth["determinant"],
            rtol=1e-9,
            atol=1e-12,
            reason="a small moment is exact to rounding of the largest one, so that their product loses some digits",
            locate=at_body,
        ),
    ),
    figures=(figures.BOX,),
)
