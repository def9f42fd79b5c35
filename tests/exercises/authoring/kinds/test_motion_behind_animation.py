"""The motion behind an animation that a cell showed: recognized among a notebook's numbers, or not judged."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import reference
from exercises.authoring.kinds.motion_behind_animation import AS_FUNCTION, own_motion

I, W0, T = (1.0, 1.0, 1.6), (0.2, 0.3, 3.0), np.linspace(1.0, 9.0, 80)
TURN = Rotation.from_rotvec([0.2, -0.4, 0.9]).as_matrix()
NAMES = {"t": "t", "R": "R", "L": "L"}
R = TURN @ reference.motion(W0, I, T - 1.0, need="orientation").R


def seen(R=R, t=T, moments=((2.0, 3.0, 4.0), W0, I)):
    return {"own_R": np.array(R), "own_t": np.array(t)[:, None], "own_I": np.array(moments)}


def test_the_exact_motion_takes_the_place_of_the_scenes():
    shaky = R + 1e-4 * np.random.default_rng(1).normal(size=R.shape) * (np.arange(len(R)) > 5)[:, None, None]
    found = own_motion(seen(shaky), (), NAMES)
    assert np.abs(found["R"] - R).max() < 0.02 and np.array_equal(found["t"], T)
    L = TURN @ reference.angular_momentum(W0, I)
    assert np.linalg.norm(np.cross(found["L"], L)) < 0.01 * (L @ L) and found["L"] @ L > 0


def test_a_function_was_handed_in():
    assert own_motion(seen(np.zeros((1, 3, 3)), np.zeros(1)), I, NAMES) is None


@pytest.mark.parametrize(
    "changed",
    [
        {"R": R[::-1] * [1, 1, -1]},
        {"R": R**2},
        {"R": np.full_like(R, np.nan)},
        {"R": np.concatenate([R[:40], R[30:70]])},
        {"R": reference.motion((0.1, 3.0, 0.2), (1.0, 2.0, 2.5), T, need="orientation").R},
        {"t": T[::-1]},
        {"t": T[:50]},
        {"t": 1e300 * T},
        {"moments": ((np.inf, np.inf, 1.0),), "R": np.swapaxes(R, 1, 2)},
        {"moments": ((1e-300, 1e-300, 1e-300),), "t": 1e-200 * T},
    ],
    ids=[
        "mirrored",
        "no rotation",
        "nan",
        "jumps",
        "asymmetric",
        "times",
        "short",
        "huge",
        "forged moments",
        "tiny",
    ],
)
def test_what_is_no_motion_of_a_symmetric_top_is_not_judged(changed):
    with np.errstate(all="ignore"):
        assert own_motion(seen(**changed), I, NAMES) == AS_FUNCTION
