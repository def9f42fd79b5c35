"""Exercise 4: free precession of a symmetric top."""

import numpy as np

from ecp import judge
from ecp.checks import Arrays, Check, close
from ecp.exercise import Exercise
from ecp.judge import Judgement
from ecp.outcome import Tolerance

from . import figures
from .common_checks import NOTEBOOK, omega
from .observables import turning_rate
from .parameters import SYMMETRIC_RATE

RTOL, ATOL = 1e-3, 1e-9


def _turns(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
    rate = turning_rate(seen[0]["t"], seen[0]["w"], truth[0]["w"], SYMMETRIC_RATE)
    return judge.close(rate, SYMMETRIC_RATE, RTOL, ATOL)


SYMMETRIC = Exercise(
    "4",
    "Free precession of a symmetric top",
    ("euler_eqs",),
    (
        Check(
            "4-rate",
            "free precession rate is (I₃−I₁)/I₁·ω₃",
            ("symmetric",),
            _turns,
            Tolerance(rtol=RTOL, atol=ATOL, reason=NOTEBOOK),
        ),
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
        omega("4-motion", "ω(t) of the symmetric top follows the exact motion", "symmetric"),
    ),
    figures=(figures.PRECESSION,),
    optional=("precession_rate",),
)
