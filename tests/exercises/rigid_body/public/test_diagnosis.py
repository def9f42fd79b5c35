"""Causes named in the student's kernel: the server names the same codes for the same answers."""

import numpy as np
import pytest

from exercises.rigid_body.causes import diagnose_scene
from exercises.rigid_body.public.diagnosis import diagnose

DEGREES = 180 / np.pi
ANSWERS = {
    "not-finite": lambda w, I, exact: np.where(w[:, :1] > 0, exact, np.nan),
    "returns-zero": lambda w, I, exact: 0 * exact,
    "returns-input": lambda w, I, exact: w * I,
    "missing-division": lambda w, I, exact: exact * I,
    "sign-reversed": lambda w, I, exact: -exact,
    "sign-flipped": lambda w, I, exact: exact * [1, -1, 1],
    "missing-component": lambda w, I, exact: exact * [1, 1, 0],
    "units": lambda w, I, exact: DEGREES * exact,
    "constant-factor": lambda w, I, exact: 3 * exact,
    "component-order": lambda w, I, exact: exact[:, [2, 0, 1]],
    "nearly-right": lambda w, I, exact: exact * (1 + 1e-3 * np.sin(1e5 * w)),
}


@pytest.fixture(scope="module")
def probes(rigid_body):
    """Inputs and exact answers at the points that the kit carries."""
    scene = rigid_body.scene("probes")
    inputs = scene.inputs(np.random.default_rng(0))
    return inputs, scene.truth(inputs)


@pytest.mark.parametrize("code", ANSWERS)
def test_the_kit_and_the_server_name_the_same_code(code, probes):
    inputs, truth = probes
    seen = {"wdot": ANSWERS[code](inputs["w"], inputs["I"], truth["wdot"])}
    with np.errstate(all="ignore"):
        assert {cause.code for cause in diagnose("probes", inputs, seen, truth)} == {code}
    assert code in {cause.code for cause in diagnose_scene("probes", inputs, seen)}


def test_nothing_is_named_where_no_single_cause_fits(probes):
    inputs, truth = probes
    noise = np.random.default_rng(1).normal(size=truth["wdot"].shape)
    for wdot in (truth["wdot"], truth["wdot"] * (1 + 1e-15), noise, truth["wdot"] * np.abs(inputs["w"])):
        assert diagnose("probes", inputs, {"wdot": wdot}, truth) == []
    assert diagnose("torque-free", {}, {}, {}) == []
