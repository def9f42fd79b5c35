"""Trusted integration of a student's ``euler_eqs`` on the host, call by call: whole motions, and stretches to
compare; and the bound of the error of motions that need no integration.
"""

from collections.abc import Mapping

import numpy as np

import reference
from ecp.checks import Arrays
from ecp.integration import Evaluate, integrate
from exercises.assignment import ArraySpec, Ask, HostVerification, Inputs
from exercises.rigid_body import probes
from exercises.rigid_body.public.quantities import Array, as_closely

EXACT = 1e-12  # of the scale of each point: correct formulas stay well below it
RTOL, ATOL = 1e-10, 1e-12
MOST_CALLS, MOST_OF_A_STRETCH = 40_000, 4000
STRETCHES, STRETCH = 2, 0.01  # their number, and their length as a fraction of the motion
FOLLOWS = 1e-6  # of the largest |ω| and of R; a motion of other equations is off by far more


class TooManyCalls(ArithmeticError):
    """Integration failed: too many calls of the student's function."""


def certified(inputs: Inputs, seen: Arrays, truth: Arrays) -> bool:
    """Return whether the rates are exact at every probe, the random ones and those along the exact
    motions.
    """
    return bool(np.all(np.abs(seen["wdot"] - truth["wdot"]) <= EXACT * truth["scale"]))


def bounded(inputs: Inputs, truth: Arrays, points: Inputs, answers: Arrays) -> Arrays | None:
    """Return the exact motion and a ``bound`` for the motion's error, relative as the tolerance is, if it is
    within that.

    To first order the motion of rates that are off by at most δ at ``points`` along the exact motion is off
    by δ times the ``duration`` of ``truth``, and its attitude by that times the time in addition.
    """
    expected = probes.exact(points)
    if not certified(points, answers, expected):
        return None
    off = float(
        np.linalg.norm(answers["wdot"] - expected["wdot"], axis=1).max() / np.linalg.norm(inputs["w0"])
    )
    bound = off * truth["duration"] * max(1.0, truth["angle"] if inputs["orientation"] else 0.0)
    seen = {name: truth[name] for name in ("w", "R") if name in truth} | {
        "bound": bound,
        "points": np.array(len(points["t"])),
    }
    return seen if bound <= (as_closely(truth).limit or 0.0) else None


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


DRIVE = HostVerification(
    "probes", certified, follows, motion, "rate", {"wdot": ArraySpec((3,))}, probes.along, bounded
)


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
