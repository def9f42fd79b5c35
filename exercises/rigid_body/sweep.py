"""Speed against accuracy of the student's ``euler_eqs``: adaptive solvers over their tolerances, on exercise 2."""

import math

import numpy as np

import reference
from ecp.checks import Arrays
from ecp.outcome import SweepResult, SweptPoint
from exercises.assignment import ArraySpec, Inputs, Scene, Sweep
from exercises.rigid_body.public.parameters import BODY, TORQUE_FREE
from reference.errors import errors
from reference.exact import Sampled
from reference.method import Run
from reference.method import Scene as Charted

CHARTED = Charted("exercise 2", TORQUE_FREE, BODY, 20.0)
SOLVERS = ("DOP853", "RK45", "LSODA")
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
MOST_CALLS = 40_001  # of one run: plays.py stops it then
MOST_S = 80.0  # the longest that the sandbox plays a scene of this budget
NOTEBOOKS = ("DOP853", 1e-11)
ENOUGH = 1e-8
SETTINGS = [(solver, rtol) for solver in SOLVERS for rtol in TOLERANCES]
INPUTS = {"w0": list(TORQUE_FREE), "I": list(BODY), "t": CHARTED.t.tolist(), "settings": SETTINGS, "orientation": True}
N = len(CHARTED.t)
RETURNS = {
    "w": ArraySpec((len(SETTINGS), 3, N)),
    "R": ArraySpec((len(SETTINGS), N, 3, 3)),
    "calls": ArraySpec((len(SETTINGS),)),
    "seconds": ArraySpec((len(SETTINGS),)),
    "per_call": ArraySpec(()),
}


def _truth(inputs: Inputs) -> Arrays:
    exact = reference.motion(TORQUE_FREE, BODY, CHARTED.t, need="orientation")
    assert exact.R is not None
    return {"w": exact.w, "R": exact.R}


def read(seen: Arrays, truth: Arrays) -> SweepResult:
    """Return errors of every run and a summary line: the error at the notebook's setting, the cost of a call,
    the cheapest to 1e-8. Raises ValueError for calls and seconds that no run can have.
    """
    calls, seconds = seen["calls"], np.append(seen["seconds"], seen["per_call"])
    if not np.all((calls >= 1) & (calls <= MOST_CALLS) & (calls == np.trunc(calls))):
        raise ValueError(f"a number of calls is not a whole number from 1 to {MOST_CALLS}")
    if not np.all((seconds >= 0) & (seconds <= MOST_S)):
        raise ValueError(f"a time is not between 0 and {MOST_S:g} s")
    exact, points = Sampled(truth["w"], truth["R"]), []
    for k, (solver, rtol) in enumerate(SETTINGS):
        found = errors(CHARTED, Run(seen["w"][k], seen["R"][k], int(seen["calls"][k])), exact)
        worst = max(found.w, found.R)
        points.append(
            SweptPoint(
                method=solver,
                rtol=rtol,
                calls=int(seen["calls"][k]),
                error=worst if math.isfinite(worst) else None,
                seconds=float(seen["seconds"][k]),
            )
        )
    return SweepResult(scene=CHARTED.name, points=points, line=_line(points, float(seen["per_call"])))


def _line(points: list[SweptPoint], per_call: float) -> str:
    own = next(p for p in points if (p.method, p.rtol) == NOTEBOOKS)
    reached = "diverges" if own.error is None else f"reaches {own.error:.1e}"
    summary = f"a call takes {per_call * 1e6:.3g} µs; {own.method} at rtol {own.rtol:g} {reached} in {own.calls} calls"
    enough = [p for p in points if p.error is not None and p.error <= ENOUGH]
    if not enough:
        return f"{summary}; no solver reaches an error of {ENOUGH:g}: check euler_eqs"
    best = min(enough, key=lambda p: p.calls)
    cheapest = f"{best.method} at rtol {best.rtol:g} ({best.calls} calls)"
    return f"{summary}; the solver that reaches {ENOUGH:g} with the fewest calls is {cheapest}"


SWEEP = Sweep(Scene("sweep", "sweep", "euler_eqs", INPUTS, RETURNS, _truth, budget_s=20.0), read)
