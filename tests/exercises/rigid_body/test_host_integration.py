"""A motion is not integrated only if answers at points along it bound its error within its tolerance."""

import numpy as np
import pytest

import reference
from exercises.rigid_body import host_integration, plays, probes
from exercises.rigid_body.draws import DRAWN
from exercises.rigid_body.public.common_checks import attitude, omega
from service.grading.jobs import draw_inputs, truth

FORMULAS = {
    "cross": lambda t, w, I: np.cross(I * w, w) / I,
    "roll": lambda t, w, I: (np.roll(I, -1) - np.roll(I, -2)) * np.roll(w, -1) * np.roll(w, -2) / I,
    "solve": lambda t, w, I: np.linalg.solve(np.diag(I), -np.cross(w, np.diag(I) @ w)),
}
STRETCH = 1 / 64  # of a motion: none as long as this passes


def drawn(rigid_body, name, seed):
    """Return inputs and truth of a hidden motion, and points along it."""
    scene = rigid_body.scene(name)
    inputs = draw_inputs(scene, seed)
    return inputs, truth(scene, inputs), probes.along(inputs, np.random.default_rng(seed))


def bounded(function, inputs, exact, points):
    return host_integration.bounded(inputs, exact, points, plays.pointwise({"euler_eqs": function}, points))


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS.keys())
def test_a_right_function_needs_no_integration(name, formula, rigid_body):
    for seed in range(4):
        inputs, exact, points = drawn(rigid_body, name, seed)
        found = bounded(formula, inputs, exact, points)
        assert found is not None and np.array_equal(found["w"], exact["w"])


def wrong_near(inputs, start, end, error):
    """Return a function that is wrong by ``error``, relative to the largest product, on the motion between
    two shares of its time and right a little off it.
    """
    path = reference.motion(inputs["w0"], inputs["I"], np.linspace(start, end, 4000) * inputs["t_end"]).w.T
    near = np.linalg.norm(np.diff(path, axis=0), axis=1).max()

    def euler_eqs(t, w, I):
        is_near = np.linalg.norm(path - w, axis=1).min() <= near
        size = probes.scale(w[None], np.asarray(I)[None])[0]
        return reference.euler_rhs(w, I) + (error * size if is_near else 0.0)

    return euler_eqs


@pytest.mark.parametrize("name", [name for name in DRAWN if name != "drawn-sphere"])  # whose ω is constant
@pytest.mark.parametrize("error", [1.0, 1e-4, 1e-11])
def test_a_function_that_is_wrong_on_a_stretch_of_the_motion_is_integrated(name, error, rigid_body):
    rng = np.random.default_rng(6)
    for seed in range(3):
        inputs, exact, points = drawn(rigid_body, name, seed)
        start = rng.uniform(0.0, 1.0 - STRETCH)
        assert bounded(wrong_near(inputs, start, start + STRETCH, error), inputs, exact, points) is None


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("error", [1e-15, 1e-13, 9e-13, 1e-12, 1e-10, 1e-8])
def test_what_is_not_integrated_would_pass_if_it_were(name, error, rigid_body):
    """The error of rates that are off everywhere in one direction, the worst for the motion, is within the
    bound.
    """
    inputs, exact, points = drawn(rigid_body, name, 3)

    def euler_eqs(t, w, I):
        return reference.euler_rhs(w, I) + error * probes.scale(w[None], I[None])[0] * 0.99

    found = bounded(euler_eqs, inputs, exact, points)
    if found is None:
        assert error > 1e-14 or name == "drawn-tumble"
        return
    seen = plays.trajectory({"euler_eqs": euler_eqs}, inputs) | {"t": exact["t"]}
    checks = [omega("w", "ω", name), *([attitude("R", "R", name)] if inputs["orientation"] else [])]
    for check in checks:
        judged = check.judge([seen], [exact])
        assert judged.verdict == "pass" and judged.measured <= found["bound"] + 1e-9


def test_answers_that_are_not_finite_are_integrated(rigid_body):
    inputs, exact, points = drawn(rigid_body, "drawn-long", 1)
    answers = {"wdot": np.full((probes.ALONG, 3), np.nan)}
    assert host_integration.bounded(inputs, exact, points, answers) is None
