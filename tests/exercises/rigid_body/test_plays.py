"""Why an integration ended early is said in the student's terms."""

import numpy as np
import pytest

from ecp.strict import WrongAnswer
from exercises.rigid_body import plays


def refusal(function, rigid_body, scene="torque-free"):
    with pytest.raises(WrongAnswer) as refused, np.errstate(all="ignore"):
        plays.trajectory({"euler_eqs": function}, rigid_body.scene(scene).inputs)
    return refused.value


GROWING = [
    lambda t, w, I: w**3,
    lambda t, w, I: I * w * abs(w),
    lambda t, w, I: (np.roll(I, 1) + np.roll(I, 2)) * np.roll(w, 1) * np.roll(w, 2) / I,
]


@pytest.mark.parametrize("function", GROWING)
@pytest.mark.parametrize("scene", ["torque-free", "precession"])
def test_a_motion_that_blows_up_says_that_energy_is_not_conserved(function, scene, rigid_body):
    refused = refusal(function, rigid_body, scene)
    assert refused.code == "unbounded"
    assert str(refused).startswith("ω grows without bound (energy is not conserved)")


def test_other_ends_keep_their_own_words(rigid_body):
    assert refusal(lambda t, w, I: w * np.nan, rigid_body).code == "not-finite"
    stalled = refusal(lambda t, w, I: 1e3 * np.sign(np.sin(1e7 * t)) * w / abs(w), rigid_body)
    assert stalled.code is None and "stalled" in str(stalled)
