"""Code that calls the submission's functions inside the sandbox and returns arrays. It contains no checks and
no exact answers.

Each play takes the submission's names and a scene's inputs and returns arrays by name. It uses its own
integrator, imported before the submission runs, so that a submission cannot replace ``solve_ivp``. The file
is also part of the students' kit.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from polhode.judging.return_value import WrongAnswer, check_signature, real_array

RTOL, ATOL, MOST_CALLS = 1e-10, 1e-12, 20_000  # a correct submission needs fewer than 2000 calls
CALLED = ("t", "y", "omega", "gamma")


def rates(student, inputs):
    """Return ``rate`` (n, 2): oscillator called once for each row of t (n,), y (n, 2), omega (n,) and gamma
    (n,).
    """
    check_signature(student["oscillator"], CALLED, "oscillator")
    rows = zip(inputs["t"], np.asarray(inputs["y"]), inputs["omega"], inputs["gamma"], strict=True)
    return {"rate": np.array([_rate(student, *row) for row in rows])}


def motion(student, inputs):
    """Return ``y`` (2, n): the integrated motion at n equidistant times from 0 to t_end."""
    calls = 0

    def rate(t, y):
        nonlocal calls
        calls += 1
        if calls > MOST_CALLS:
            raise WrongAnswer(
                None, f"the integrator stalled at t = {t:.3g} s after {MOST_CALLS} calls of oscillator"
            )
        return _rate(student, t, y, inputs["omega"], inputs["gamma"])

    times = np.linspace(0.0, inputs["t_end"], inputs["n"])
    run = solve_ivp(rate, (0.0, times[-1]), inputs["y0"], method="DOP853", t_eval=times, rtol=RTOL, atol=ATOL)
    if not run.success:
        raise WrongAnswer(None, f"the integration stopped: {run.message}")
    return {"y": run.y}


def _rate(student, t, y, omega, gamma):
    answer = real_array(
        student["oscillator"](float(t), np.array(y), float(omega), float(gamma)), (2,), "oscillator"
    )
    if not all(map(math.isfinite, answer)):
        raise WrongAnswer("not-finite", f"oscillator returned {answer.tolist()} at t = {t:.3g} s: not finite")
    return answer
