"""Exercise 1: principal moments of a box."""

import numpy as np

from ecp.checks import close
from ecp.exercise import Exercise

from . import figures
from .common_checks import NOTEBOOK

MOMENTS = Exercise(
    "1",
    "Principal moments of a box",
    ("box_moments", "principal_moments"),
    (
        close(
            "1-notebook",
            "principal moments match the analytic box result",
            "tensor",
            measured=lambda seen: np.sort(seen["moments"], axis=-1)[0],
            expected=lambda truth: truth["moments"][0],
            rtol=1e-10,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
    ),
    figures=(figures.BOX,),
)
