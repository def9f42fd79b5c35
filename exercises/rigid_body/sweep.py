"""Speed against accuracy of the student's ``euler_eqs``: adaptive solvers over their tolerances, on exercise
2.
"""

import reference
from ecp.checks import Arrays
from ecp.outcome import SweepResult
from exercises.assignment import ArraySpec, Inputs, Scene, Sweep
from exercises.rigid_body.public.quantities import BODY, TORQUE_FREE
from exercises.sweep import BUDGET_S, SETTINGS, result
from reference.errors import errors
from reference.exact import Sampled
from reference.method import Run
from reference.method import Scene as Charted

CHARTED = Charted("exercise 2", TORQUE_FREE, BODY, 20.0)
MOST_CALLS = 40_001  # of one run: plays.py stops it then
INPUTS = {
    "w0": list(TORQUE_FREE),
    "I": list(BODY),
    "t": CHARTED.t.tolist(),
    "settings": SETTINGS,
    "orientation": True,
}
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
    """Return the larger error of ω and R of every run, and a summary line. Raises ValueError for impossible
    calls and seconds.
    """
    exact, worst = Sampled(truth["w"], truth["R"]), []
    for w, R in zip(seen["w"], seen["R"], strict=True):
        found = errors(CHARTED, Run(w, R, 0), exact)
        worst.append(max(found.w, found.R))
    return result(CHARTED.name, "euler_eqs", seen, worst, MOST_CALLS)


SWEEP = Sweep(Scene("sweep", "sweep", "euler_eqs", INPUTS, RETURNS, _truth, budget_s=BUDGET_S), read)
