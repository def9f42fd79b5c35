"""Trusted integration of a student's ``euler_eqs`` on the host, call by call: whole motions, and stretches to
compare.
"""

from collections.abc import Mapping

import numpy as np

import reference
from ecp.checks import Arrays
from ecp.integration import Evaluate, integrate
from exercises.assignment import ArraySpec, Ask, HostVerification, Inputs
from exercises.rigid_body.public.quantities import Array

EXACT = 1e-12  # of the scale of each point: correct formulas stay well below it
RTOL, ATOL = 1e-10, 1e-12
MOST_CALLS, MOST_OF_A_STRETCH = 40_000, 4000
STRETCHES, STRETCH = 2, 0.01  # their number, and their length as a fraction of the motion
FOLLOWS = 1e-6  # of the largest |ω| and of R; a motion of other equations is off by far more


class TooManyCalls(ArithmeticError):
    """Integration failed: too many calls of the student's function."""


def certified(inputs: Inputs, seen: Arrays, truth: Arrays) -> bool:
    """Return whether the rates are exact at every probe, the random ones and those along the exact motions."""
    return bool(np.all(np.abs(seen["wdot"] - truth["wdot"]) <= EXACT * truth["scale"]))


def follows(inputs: Inputs, seen: Arrays, ask: Ask, rng: np.random.Generator) -> bool:
    """Return whether random stretches of the motion agree with an integration of ``ask`` from their start."""
    times, w, R = np.linspace(0.0, inputs["t_end"], inputs["n"]), seen["w"], seen.get("R")
    length = max(1, round(STRETCH * len(times)))
    for k in rng.integers(0, len(times) - length, STRETCHES):
        start, end = (_state(w[:, at], None if R is None else R[at]) for at in (k, k + length))
        scale = np.repeat([np.abs(w).max(), 1.0], [3, len(start) - 3])
        try:
            found = _integrate(start, times[[k, k + length]], inputs["I"], ask, MOST_OF_A_STRETCH)[:, -1]
        except (ArithmeticError, ValueError):
            return False
        if not np.all(np.abs(found - end) <= FOLLOWS * scale):
            return False
    return True


def motion(inputs: Inputs, ask: Ask) -> Mapping[str, Array]:
    """Return the whole motion that ``ask`` drives. Raises TooManyCalls or ValueError if there is none."""
    times = np.linspace(0.0, inputs["t_end"], inputs["n"])
    start = _state(np.asarray(inputs["w0"], dtype=float), np.eye(3) if inputs["orientation"] else None)
    y = _integrate(start, times, inputs["I"], ask, MOST_CALLS)
    return {"w": y[:3]} | ({"R": y[3:].T.reshape(-1, 3, 3)} if inputs["orientation"] else {})


DRIVE = HostVerification("probes", certified, follows, motion, "rate", {"wdot": ArraySpec((3,))})


def _state(w: Array, R: Array | None) -> Array:
    return w if R is None else np.concatenate([w, R.ravel()])


def _integrate(start: Array, times: Array, I: Array, ask: Ask, most_calls: int) -> Array:
    moments, calls = np.asarray(I, dtype=float), 0

    def rates(y: Array, out: Array) -> Evaluate:
        def evaluate(t: float) -> None:
            nonlocal calls
            calls += 1
            if calls > most_calls:
                raise TooManyCalls(f"more than {most_calls} calls")
            out[:3] = ask({"t": t, "w": y[:3], "I": moments})["wdot"]
            if len(y) > 3:
                out[3:] = reference.attitude_rate(y[3:].reshape(3, 3), y[:3]).ravel()

        return evaluate

    with np.errstate(all="ignore"):
        return integrate(rates, start, times, RTOL, ATOL)
