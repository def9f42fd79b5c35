"""Values of a function at points along an exact motion bound the error of its own motion."""

import functools

import numpy as np
import pytest

import reference
from exercises.authoring.assignments.catalogue import find
from exercises.authoring.kinds.dynamics import ALONG
from polhode.judging.verdict import Verdict
from polhode.kinds import play
from service.grading.sandbox_job import draw_inputs, truth

FORMULAS = {
    "terms": lambda t, w, I: [
        (I[1] - I[2]) * w[1] * w[2] / I[0],
        (I[2] - I[0]) * w[2] * w[0] / I[1],
        (I[0] - I[1]) * w[0] * w[1] / I[2],
    ],
    "cross": lambda t, w, I: np.cross(I * w, w) / I,
    "roll": lambda t, w, I: (np.roll(I, -1) - np.roll(I, -2)) * np.roll(w, -1) * np.roll(w, -2) / I,
    "solve": lambda t, w, I: np.linalg.solve(np.diag(I), -np.cross(w, np.diag(I) @ w)),
}
CHECKS = {
    "long": "2-secret",
    "greatest": "3-secret-greatest",
    "least": "3-secret-least",
    "symmetric top": "4-secret",
    "sphere": "4-sphere",
    "tumble": "5-secret",
    "attitude": "6-secret",
}
SAMPLES = 400
STRETCH = 1 / 64  # of a motion: none as long as this passes


@functools.cache
def drawn(seed):
    """Return the inputs of the points of one grading, and the exact answers."""
    scene = find("rigid-body").scene("probes")
    inputs = draw_inputs(scene, seed)
    return inputs, truth(scene, inputs)


def pointwise(function, inputs):
    """Return the values of a function at the points."""
    given = {name: inputs[name] for name in ("t", "w", "I")}
    return play(find("rigid-body").scene("probes").question, {"euler_eqs": function}, given)


def trajectory(function, inputs):
    """Return the motion that a function drives."""
    return play(find("rigid-body").scene("torque-free").question, {"euler_eqs": function}, inputs)


def scale(w, I):
    """Return the largest product Iω² over each moment (3,)."""
    return np.maximum(I.max() * np.abs(w).max() ** 2 / I, 1e-20)


def judged(rigid_body, function, name, seed):
    """Return the outcome of the check of a drawn motion."""
    inputs, exact = drawn(seed)
    with np.errstate(all="ignore"):
        seen = pointwise(function, inputs)
    (check,) = (check for check in rigid_body.checks() if check.id == CHECKS[name])
    return check.judge([seen], [exact])


def test_each_drawn_motion_has_a_check():
    fixed = {scene.name for scene in find("rigid-body").scenes}
    assert CHECKS.keys() == drawn(0)[0]["motions"].keys() - fixed


@pytest.mark.parametrize("name", CHECKS)
@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS.keys())
def test_a_right_function_is_well_within_what_is_allowed(name, formula, rigid_body):
    for seed in range(3):
        outcome = judged(rigid_body, formula, name, seed)
        assert outcome.verdict is Verdict.PASS and (outcome.margin is None or outcome.margin > 3), (
            outcome.text()
        )
        assert outcome.tolerance.limit and "sensitivity" in outcome.tolerance.reason
        assert f"by euler_eqs at {ALONG} points along the exact motion" in outcome.detail


def of(motion):
    """Return ω(0) and the moments of a motion."""
    return motion.start["w"], motion.start["I"]


def wrong_near(motion, start, end, error):
    """Return a function that is wrong by ``error``, relative to the largest product, on the motion between
    two shares of its time and right a little off it.
    """
    path = reference.motion(*of(motion), np.linspace(start, end, 4000) * motion.until).w.T
    near = np.linalg.norm(np.diff(path, axis=0), axis=1).max()

    def euler_eqs(t, w, I):
        is_near = np.linalg.norm(path - w, axis=1).min() <= near
        size = scale(w, np.asarray(I))
        return reference.euler_rhs(w, I) + (error * size if is_near else 0.0)

    return euler_eqs


@pytest.mark.parametrize("name", [name for name in CHECKS if name != "sphere"])  # whose ω is constant
@pytest.mark.parametrize("error", [1.0, 1e-4])
def test_a_function_that_is_wrong_on_a_stretch_of_the_motion_fails(name, error, rigid_body):
    rng = np.random.default_rng(6)
    for seed in range(3):
        motion = drawn(seed)[0]["motions"][name]
        start = rng.uniform(0.0, 1.0 - STRETCH)
        wrong = wrong_near(motion, start, start + STRETCH, error)
        assert judged(rigid_body, wrong, name, seed).verdict is Verdict.FAIL


@pytest.mark.parametrize("name", CHECKS)
@pytest.mark.parametrize("error", [1e-15, 1e-13, 1e-12, 1e-10])
def test_the_error_of_an_integrated_motion_is_within_its_bound(name, error, rigid_body):
    """The rates are off everywhere in one direction, the worst for the motion."""
    motion = drawn(3)[0]["motions"][name]

    def euler_eqs(t, w, I):
        return reference.euler_rhs(w, I) + error * scale(w, I) * 0.99

    bound = judged(rigid_body, euler_eqs, name, 3).measured
    seen = trajectory(euler_eqs, {**motion.inputs, "samples": SAMPLES})
    need = "orientation" if motion.attitude else "omega"
    exact = reference.motion(*of(motion), np.linspace(0.0, motion.until, SAMPLES), need=need)
    off = np.abs(seen["w"] - exact.w).max() / np.linalg.norm(motion.start["w"])
    if motion.attitude:
        off = max(off, np.abs(seen["R"] - exact.R).max())
    assert off <= bound + 1e-9


def test_values_that_are_not_finite_fail(rigid_body):
    outcome = judged(rigid_body, lambda t, w, I: np.full(3, np.nan), "long", 1)
    assert outcome.verdict is Verdict.FAIL


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
    found = {judged(rigid_body, ERRORS[error], "symmetric top", seed).verdict for seed in range(6)}
    assert len(found) == 1


def test_a_right_integration_of_a_function_that_is_wrong_along_the_motion_fails(rigid_body):
    """Its motion is exact, and its values along it are not: it knows who calls."""
    (check,) = (check for check in rigid_body.checks() if check.id == "2-motion")
    _, exact = drawn(1)
    scene = rigid_body.scene("torque-free")
    moved = truth(scene, scene.inputs)
    right = trajectory(FORMULAS["cross"], scene.inputs) | {"t": moved["t"]}
    for factor, verdict in ((1.0, Verdict.PASS), (1.0 + 1e-6, Verdict.FAIL)):
        seen = {"wdot": factor * exact["wdot"]}
        outcome = check.judge([right, seen], [moved, exact])
        assert outcome.verdict is verdict, outcome.text()
    assert "by euler_eqs at 10 points along the exact motion" in outcome.detail


@pytest.mark.parametrize("spelling", FORMULAS)
@pytest.mark.parametrize("name", ["torque-free", "spin-mid", "precession"])
def test_a_right_function_is_well_within_what_an_integrated_motion_allows(name, spelling, rigid_body):
    scene = rigid_body.scene(name)
    points, exact_along = drawn(1)
    along = pointwise(FORMULAS[spelling], points)
    exact = truth(scene, scene.inputs)
    seen = {**trajectory(FORMULAS[spelling], scene.inputs), "t": exact["t"]}
    checks = [c for e in rigid_body.exercises for c in e.checks if c.scenes == (name, "probes")]
    assert checks
    for check in checks:
        outcome = check.judge([seen, along], [exact, exact_along])
        assert (outcome.verdict is Verdict.PASS and outcome.margin is None) or outcome.margin > 3, check.id
        assert outcome.tolerance.limit and "sensitivity" in outcome.tolerance.reason
