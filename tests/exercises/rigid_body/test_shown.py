"""Every check of rigid-body beside its tolerance: half of what is allowed passes, half as much again does
not.
"""

import numpy as np
import pytest

from exercises.rigid_body.shown import SYMMETRIC
from polhode.judging.verdict import Verdict
from service.grading.sandbox_job import draw_inputs, truth

# By check, an error of f times what is allowed, in the arrays ``seen`` of the scenes; ``exact`` is the truth
# of the first of them. The numbers stand here once more on purpose: a tolerance that changes by mistake
# changes one of the two places only.
ERRORS = {
    "1-notebook": lambda f, seen, exact: add(seen[0]["moments"], f * (1e-9 + 1e-10 * exact["moments"])),
    "1-boxes": lambda f, seen, exact: add(
        seen[0]["moments"], f * 1e-12 * exact["moments"].max(axis=1, keepdims=True)
    ),
    "1-tensors": lambda f, seen, exact: add(
        seen[0]["moments"], f * 1e-9 * np.maximum(exact["moments"].max(axis=1, keepdims=True), 1.0)
    ),
    "1-trace": lambda f, seen, exact: add(seen[0]["moments"], f * 1e-12 * exact["moments"]),
    "1-determinant": lambda f, seen, exact: add(seen[0]["moments"], f * (1e-12 + 1e-9 * exact["moments"])),
    "2-energy": lambda f, seen, exact: add(seen[0]["w"][:, -1], f * 1e-6 / 2 * exact["w"][:, -1]),
    "2-momentum": lambda f, seen, exact: add(seen[0]["w"][:, -1], f * 1e-6 * exact["w"][:, -1]),
    "3-energy": lambda f, seen, exact: add(seen[0]["w"][:, -1], f * 1e-6 / 2 * exact["w"][:, -1]),
    "3-momentum": lambda f, seen, exact: add(seen[0]["w"][:, -1], f * 1e-6 * exact["w"][:, -1]),
    "4-constant": lambda f, seen, exact: add(seen[0]["w"][2, -1:], f * 1e-9),
    "4-rate": lambda f, seen, exact: turn(seen[0]["w"], f * 1e-3 * 1.8 * exact["t"]),
    "4-function": lambda f, seen, exact: add(seen[0]["rate"], f * 1e-3 * exact["rate"]),
    "4-retrograde": lambda f, seen, exact: add(seen[0]["rate"], f * 1e-3 * exact["rate"]),
    "4-coarse": lambda f, seen, exact: add(seen[0]["rate"], f * 1e-3 * exact["rate"]),
    "4-short": lambda f, seen, exact: add(seen[0]["rate"], f * 1e-3 * exact["rate"]),
    "5-growth": lambda f, seen, exact: add(seen[0]["w"][1:], f * 1e-4 * exact["w"][1:]),
    "6-orthonormal": lambda f, seen, exact: add(seen[0]["R"][-1], f * 1e-6 / 2 * exact["R"][-1]),
    "6-momentum": lambda f, seen, exact: add(
        seen[0]["w"][:, -1], f * 1e-8 * towards_largest(exact) / np.asarray(SYMMETRIC)
    ),
    **dict.fromkeys(
        (f"{number}-pointwise" for number in "23456"),
        lambda f, seen, exact: add(seen[0]["wdot"], f * 1e-13 * exact["wdot_scale"]),
    ),
}


def add(array, error):
    array += error


def turn(w, angle):
    """Turn (ω₁, ω₂) by ``angle`` (n,)."""
    turned = (w[0] + 1j * w[1]) * np.exp(1j * angle)
    w[0], w[1] = turned.real, turned.imag


def towards_largest(exact):
    """The direction (3,), in body axes at the last sample, of one space axis."""
    return exact["R"][-1][0]


def judged(rigid_body, id, change):
    """The outcome of a check of exact arrays after ``change(seen, exact)``."""
    check = next(check for check in rigid_body.checks() if check.id == id)
    scenes = [rigid_body.scene(name) for name in check.scenes]
    exact = [truth(scene, draw_inputs(scene, 3)) for scene in scenes]
    seen = [
        {name: np.array(arrays[name]) for name in {*scene.returns, *scene.known}}
        for scene, arrays in zip(scenes, exact, strict=True)
    ]
    change(seen, exact[0])
    return check.judge(seen, exact)


@pytest.mark.parametrize("id", ERRORS)
def test_half_of_what_is_allowed_passes_and_half_as_much_again_does_not(rigid_body, id):
    for factor, verdict in ((0.5, Verdict.PASS), (1.5, Verdict.FAIL)):
        outcome = judged(rigid_body, id, lambda seen, exact, factor=factor: ERRORS[id](factor, seen, exact))
        assert outcome.verdict is verdict, (factor, outcome.line)


def test_no_tolerance_is_left_out(rigid_body):
    """Those worked out for each scene are tested with drawn.py."""
    fixed = [
        c.id
        for c in rigid_body.checks()
        if not c.allow and (c.tolerance.limit, c.tolerance.rtol, c.tolerance.atol) != (None,) * 3
    ]
    assert sorted(fixed) == sorted(ERRORS)


def test_a_tumble_needs_both_its_stable_and_its_unstable_axes(rigid_body):
    def steady(seen, exact):
        seen[1]["w"][[0, 2]] *= 0.01

    def tumbling(seen, exact):
        seen[0]["w"][1:] *= 100

    assert judged(rigid_body, "5-notebook", lambda seen, exact: None).verdict is Verdict.PASS
    for change in (steady, tumbling):
        assert judged(rigid_body, "5-notebook", change).verdict is Verdict.FAIL


@pytest.mark.parametrize(("changed", "verdict"), [(0, Verdict.FAIL), (1, Verdict.FAIL), (100, Verdict.PASS)])
def test_a_picture_moves_if_enough_of_it_changes(rigid_body, changed, verdict):
    check = next(check for check in rigid_body.checks() if check.id == "6-moves")
    frames = np.zeros((3, 360, 480, 3), dtype=np.uint8)
    frames[1].reshape(-1, 3)[:changed] = 255
    assert (
        check.judge([{"frames": frames, "cost": np.zeros(6), "visible": np.array([1.0, 0.0])}], [{}]).verdict
        is verdict
    )


def test_a_picture_whose_text_changes_does_not_move(rigid_body):
    check = next(check for check in rigid_body.checks() if check.id == "6-moves")
    frames = np.zeros((3, 360, 480, 3), dtype=np.uint8)
    frames[1] = 255
    outcome = check.judge([{"frames": frames, "cost": np.zeros(6), "visible": np.array([0.0, 1.0])}], [{}])
    assert outcome.verdict is Verdict.FAIL and "nothing changes but text" in outcome.detail
