"""Motions drawn for an attempt are of the family they are to be, and a right function is within what each
allows.
"""

import numpy as np
import pytest

import reference
from exercises.rigid_body import plays
from exercises.rigid_body.draws import DRAWN
from exercises.rigid_body.public import quantities
from polhode.judging.judge import Verdict
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
        drawn = DRAWN[name](np.random.default_rng(seed))
        w0, I = np.array(drawn["w0"]), np.array(drawn["I"])
        exact = reference.Exact(w0, I)
        low, mid, high = np.sort(I)
        side = np.sum((I * w0) ** 2) - 2 * reference.kinetic_energy(w0, I) * mid
        assert low > 0 and high <= low + mid and np.isfinite(drawn["t_end"])
        if name == "symmetric top":
            assert exact.model == "symmetric" and I[0] == I[1]
        elif name == "sphere":
            assert exact.model == "steady" and low == high
        elif name == "least":
            assert side < 0
        elif name == "greatest":
            assert side > 0
        elif name == "tumble":
            spin = int(np.argsort(I)[1])
            path = exact.omega(np.linspace(0.0, drawn["t_end"], 400))[spin] / w0[spin]
            assert path.min() < -0.9, "it turns over"


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("name", ["torque-free", "spin-mid", "precession"])
def test_a_right_function_is_well_within_what_is_allowed(name, spelling, rigid_body):
    scene = rigid_body.scene(name)
    probes = rigid_body.scene("probes")
    points = draw_inputs(probes, 1)
    along, exact_along = plays.pointwise({"euler_eqs": SPELLINGS[spelling]}, points), truth(probes, points)
    exact = truth(scene, scene.inputs)
    seen = {**plays.trajectory({"euler_eqs": SPELLINGS[spelling]}, scene.inputs), "t": exact["t"]}
    checks = [c for e in rigid_body.exercises for c in e.checks if c.scenes == (name, "probes")]
    assert checks
    for check in checks:
        outcome = check.judge([seen, along], [exact, exact_along])
        assert (outcome.verdict is Verdict.PASS and outcome.margin is None) or outcome.margin > 3, check.id
        assert outcome.tolerance.limit and "sensitivity" in outcome.tolerance.reason


def test_the_tolerance_is_the_product_it_says():
    allowed = quantities.as_closely({"kappa": np.array(40.0), "angle": np.array(20.0)})
    assert allowed.limit == pytest.approx(10 * 1e-11 * 60, rel=1e-2)
    assert allowed.reason == "rtol 1e-11 × (sensitivity 40 + 20 rad turned) × safety 10"
    assert quantities.RTOL == plays.RTOL
