"""Exercise 4: free precession of a symmetric top."""

import numpy as np

import reference
from exercises.assignment import Exercise
from exercises.checks import close
from exercises.rigid_body import figures
from exercises.rigid_body.scenes import SYMMETRIC as TOP
from exercises.rigid_body.sections.wording import NOTEBOOK, omega, pointwise

EVEN = "the notebook's own tolerance: derivatives by differences are off by 1e-4, every known slip by far more"

SYMMETRIC = Exercise(
    "4",
    "Free precession of a symmetric top",
    ("euler_eqs",),
    (
        pointwise("4-pointwise"),
        close(
            "4-constant",
            "ω₃ is constant for the symmetric top",
            "symmetric",
            measured=lambda seen: np.ptp(seen["w"][2]),
            expected=0.0,
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        close(
            "4-rate",
            "free precession rate is (I₃−I₁)/I₁·ω₃",
            "symmetric",
            measured=lambda seen: reference.precession_rate(seen["t"], seen["w"]),
            expected=reference.free_precession_rate(TOP, 3.0),
            rtol=1e-3,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        omega("4-motion", "ω(t) of the symmetric top follows the exact motion", "symmetric"),
        omega("4-secret", "ω(t) of a top with its axis along any of the three follows the exact motion", "drawn-symmetric"),
        omega("4-sphere", "ω of a body with three equal moments stays as it is", "drawn-sphere"),
        close(
            "4-function",
            "precession_rate finds Ω in a given motion",
            "rate",
            measured=lambda seen: seen["rate"],
            expected=lambda truth: truth["rate"],
            rtol=1e-3,
            atol=0.0,
            reason=EVEN,
        ),
        close(
            "4-retrograde",
            "precession_rate is negative where (ω₁, ω₂) turns backwards",
            "rate-retrograde",
            measured=lambda seen: seen["rate"],
            expected=lambda truth: truth["rate"],
            rtol=1e-3,
            atol=0.0,
            reason=EVEN,
        ),
    ),
    figures=(figures.PRECESSION,),
    optional=("precession_rate",),
)
