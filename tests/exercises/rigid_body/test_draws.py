"""Motions drawn for an attempt are of the family they are to be, and a right function is within what each
allows.
"""

import numpy as np
import pytest

import reference
from ecp.judge import Verdict
from exercises.rigid_body import plays
from exercises.rigid_body.draws import DRAWN
from exercises.rigid_body.public import quantities
from service.grading.jobs import draw_inputs, truth

SPELLINGS = {
    "terms": lambda t, w, I: [
        (I[1] - I[2]) * w[1] * w[2] / I[0],
        (I[2] - I[0]) * w[2] * w[0] / I[1],
        (I[0] - I[1]) * w[0] * w[1] / I[2],
    ],
    "cross": lambda t, w, I: -np.cross(w, I * w) / I,
    "solve": lambda t, w, I: np.linalg.solve(np.diag(I), np.cross(I * w, w)),
}


@pytest.mark.parametrize("name", DRAWN)
def test_families(name):
    for seed in range(40):
        drawn = DRAWN[name][0](np.random.default_rng(seed))
        w0, I = np.array(drawn["w0"]), np.array(drawn["I"])
        exact = reference.Exact(w0, I)
        low, mid, high = np.sort(I)
        side = np.sum((I * w0) ** 2) - 2 * reference.kinetic_energy(w0, I) * mid
        assert low > 0 and high <= low + mid and np.isfinite(drawn["t_end"])
        if name == "drawn-symmetric":
            assert exact.model == "symmetric" and I[0] == I[1]
        elif name == "drawn-sphere":
            assert exact.model == "steady" and low == high
        elif name == "drawn-least":
            assert side < 0
        elif name == "drawn-greatest":
            assert side > 0
        elif name == "drawn-tumble":
            spin = int(np.argsort(I)[1])
            path = exact.omega(np.linspace(0.0, drawn["t_end"], 400))[spin] / w0[spin]
            assert path.min() < -0.9, "it turns over"


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("name", ["torque-free", "spin-mid", "precession", *DRAWN])
def test_a_right_function_is_well_within_what_is_allowed(name, spelling, rigid_body):
    scene = rigid_body.scene(name)
    for seed in range(3):
        inputs = draw_inputs(scene, seed)
        exact = truth(scene, inputs)
        seen = {**plays.trajectory({"euler_eqs": SPELLINGS[spelling]}, inputs), "t": exact["t"]}
        checks = [c for e in rigid_body.exercises for c in e.checks if c.scenes == (name,) and c.allow]
        assert checks
        for check in checks:
            outcome = check.judge([seen], [exact])
            assert (outcome.verdict is Verdict.PASS and outcome.margin is None) or outcome.margin > 3, (
                check.id
            )
            assert outcome.tolerance.limit and "sensitivity" in outcome.tolerance.reason


FACTORS = {"factor": lambda I: np.full(3, 2.0), "divisor": lambda I: I / I[[1, 2, 0]]}
ERRORS = {
    f"{what} of component {k + 1}": lambda t, w, I, k=k, factor=factor: (
        np.where(np.arange(3) == k, factor(I), 1.0) * np.cross(I * w, w) / I
    )
    for k in range(3)
    for what, factor in FACTORS.items()
}


@pytest.mark.parametrize("error", ERRORS)
def test_the_same_error_gets_the_same_verdict_for_every_student(error, rigid_body):
    scene = rigid_body.scene("drawn-symmetric")
    (check,) = (c for e in rigid_body.exercises for c in e.checks if c.scenes == (scene.name,))
    verdicts = set()
    for seed in range(6):
        inputs = draw_inputs(scene, seed)
        exact = truth(scene, inputs)
        seen = {**plays.trajectory({"euler_eqs": ERRORS[error]}, inputs), "t": exact["t"]}
        verdicts.add(check.judge([seen], [exact]).verdict)
    assert len(verdicts) == 1


def test_the_tolerance_is_the_product_it_says():
    allowed = quantities.as_closely({"kappa": np.array(40.0), "angle": np.array(20.0)})
    assert allowed.limit == pytest.approx(10 * 1e-11 * 60, rel=1e-2)
    assert allowed.reason == "rtol 1e-11 × (sensitivity 40 + 20 rad turned) × safety 10"
    assert quantities.RTOL == plays.RTOL
