"""Speed against accuracy of the student's ``euler_eqs``: adaptive solvers over their tolerances, on the
motion of exercise 2, ω and R, of which ω is compared.
"""

from pathlib import Path

import numpy as np

import reference
from exercises.authoring.assignments.assignment import ArraySpec, Inputs, Scene, Sweep
from exercises.authoring.assignments.sweep import BUDGET_S, SETTINGS, result
from exercises.rigid_body.public.quantities import BODY, TORQUE_FREE, as_closely
from exercises.rigid_body.scenes import SCENES
from polhode.judging.checks import Arrays
from polhode.judging.outcome import SweepResult

MOTION = next(scene for scene in SCENES if scene.name == "torque-free")
assert not callable(MOTION.inputs)
N, T_END = MOTION.inputs["n"], MOTION.inputs["t_end"]
T = np.linspace(0.0, T_END, N)
MOST_CALLS = 20_000  # of one run; right functions need 7000
INPUTS = {
    "w0": list(TORQUE_FREE),
    "I": list(BODY),
    "t": T.tolist(),
    "settings": SETTINGS,
    "orientation": True,
    "most_calls": MOST_CALLS,
}
RETURNS = {
    "w": ArraySpec((len(SETTINGS), 3, N)),
    "calls": ArraySpec((len(SETTINGS),)),
    "seconds": ArraySpec((len(SETTINGS),)),
    "per_call": ArraySpec(()),
}


def _truth(inputs: Inputs) -> Arrays:
    return {"w": reference.motion(TORQUE_FREE, BODY, T).w}


def read(seen: Arrays, truth: Arrays) -> SweepResult:
    """Return the error of ω of every run relative to |ω₀|, and a summary line. Raises ValueError for
    impossible calls and seconds.
    """
    with np.errstate(all="ignore"):
        worst = np.abs(seen["w"] - truth["w"]).max(axis=(1, 2)) / np.linalg.norm(TORQUE_FREE)
    return result("exercise 2", "euler_eqs", seen, worst, MOST_CALLS + 1)


SWEEP = Sweep(
    Scene("sweep", "sweep", "euler_eqs", INPUTS, RETURNS, _truth, budget_s=BUDGET_S),
    read,
    tolerance=as_closely(MOTION.truth(MOTION.inputs)).limit,
    sensitivity=lambda: reference.sensitivity(TORQUE_FREE, BODY, T_END),
    exact=lambda: reference.motion(TORQUE_FREE, BODY, T, need="orientation"),
    solution=Path(__file__).parent / "samples" / "right_all.py",
)
