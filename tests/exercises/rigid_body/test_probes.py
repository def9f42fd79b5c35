"""The points at which euler_eqs is called miss no order of moments, no octant, no axis and no size; right
answers pass.
"""

import numpy as np
import pytest

from exercises.rigid_body import plays, probes
from polhode.judging.judge import Verdict
from service.grading.jobs import draw_inputs, truth

RIGHT = {
    "cross": lambda t, w, I: np.cross(I * w, w) / I,
    "L": lambda t, w, I: np.cross(I * w, (I * w) / I) / I,
    "solve": lambda t, w, I: np.linalg.solve(np.diag(I), -np.cross(w, np.diag(I) @ w)),
    "expanded": lambda t, w, I: [
        I[1] * w[1] * w[2] / I[0] - I[2] * w[1] * w[2] / I[0],
        I[2] * w[2] * w[0] / I[1] - I[0] * w[2] * w[0] / I[1],
        I[0] * w[0] * w[1] / I[2] - I[1] * w[0] * w[1] / I[2],
    ],
    "tilted axes": lambda t, w, I: tilted(w, I),
}
WRONG = {
    "NaN where ω₁ = 0": lambda t, w, I: np.cross(I * w, w) / I * (w[0] / w[0]),
    "NaN at rest": lambda t, w, I: np.cross(I * w, w) / I * (w @ w / (w @ w)),
    "NaN where I₁ = I₂": lambda t, w, I: np.cross(I * w, w) / I * ((I[0] - I[1]) / (I[0] - I[1])),
    "small ω cut to zero": lambda t, w, I: np.cross(I * np.where(abs(w) < 1e-3, 0, w), w) / I,
    "large rates clipped": lambda t, w, I: np.clip(np.cross(I * w, w) / I, -1e4, 1e4),
    "1e-9 added": lambda t, w, I: np.cross(I * w, w) / I + 1e-9,
    "one order of moments": lambda t, w, I: np.cross(np.sort(I) * w, w) / np.sort(I),
}


def tilted(w, I):
    Q = np.linalg.qr(np.arange(9.0).reshape(3, 3) + np.eye(3))[0]
    Q = Q * np.linalg.det(Q)
    J, v = Q @ np.diag(I) @ Q.T, Q @ w
    return Q.T @ np.linalg.solve(J, -np.cross(v, J @ v))


def judged(rigid_body, function, seed):
    scene = rigid_body.scene("probes")
    inputs = draw_inputs(scene, seed)
    exact = truth(scene, inputs)
    with np.errstate(all="ignore"):
        seen = plays.pointwise({"euler_eqs": function}, inputs)
    check = next(check for check in rigid_body.checks() if check.id == "2-pointwise")
    return check.judge([seen | {name: exact[name] for name in scene.known}], [exact])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", RIGHT)
def test_every_right_spelling_is_far_within_the_tolerance(name, seed, rigid_body):
    outcome = judged(rigid_body, RIGHT[name], seed)
    assert outcome.verdict is Verdict.PASS and (outcome.margin is None or outcome.margin > 20), outcome.text()


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_at_few_points_only_does_not_pass(name, rigid_body):
    assert judged(rigid_body, WRONG[name], 3).verdict is Verdict.FAIL


def test_the_worst_point_is_shown_with_both_values(rigid_body):
    outcome = judged(rigid_body, lambda t, w, I: -np.cross(I * w, w) / I, 3)
    assert outcome.where.startswith("ω̇") and ", ω = (" in outcome.where and "), I = (" in outcome.where
    got, expected = (float(part.split()[1]) for part in outcome.where.partition(": ")[2].split(", "))
    assert got == -expected != 0


def test_values_that_differ_in_late_digits_are_shown_with_those(rigid_body):
    outcome = judged(rigid_body, lambda t, w, I: np.cross(I * w, w) / I * (1 + 1e-9), 3)
    got, expected = (float(part.split()[1]) for part in outcome.where.partition(": ")[2].split(", "))
    assert 0 < abs(got / expected - 1) < 1e-6


def test_orders_octants_axes_equal_moments_and_sizes_are_met(rigid_body):
    drawn = draw_inputs(rigid_body.scene("probes"), 5)
    w, I = drawn["w"], drawn["I"]
    generic = np.all(w != 0, axis=1) & (np.diff(np.sort(I, axis=1), axis=1).min(axis=1) > 0)
    met = {(*np.argsort(i), *np.sign(x)) for x, i in zip(w[generic], I[generic], strict=True)}
    assert len(met) == 48
    still = {tuple(row) for row in w == 0}
    assert len(still) == 8, "each axis, each plane, rest and none"
    equal = {tuple(row) for row in np.roll(I, 1, axis=1) == I}
    assert equal >= {(True, False, False), (False, True, False), (False, False, True), (True, True, True)}
    speed = np.linalg.norm(w, axis=1)
    assert speed.max() > 1e4 and 0 < speed[speed > 0].min() < 1e-3 and I.max() > 1e3 and I.min() < 1e-3
    assert np.all(2 * I.max(axis=1) <= I.sum(axis=1)), "only moments that a body can have"
    assert len(w) == probes.number_of_points(8)


def test_some_points_are_asked_twice_and_some_at_another_time(rigid_body):
    drawn = draw_inputs(rigid_body.scene("probes"), 3)
    rows = np.column_stack([drawn["t"], drawn["w"], drawn["I"]])
    points, counts = np.unique(rows, axis=0, return_counts=True)
    assert (counts == 2).sum() == probes.REPEATS
    _, again = np.unique(points[:, 1:], axis=0, return_counts=True)
    assert (again == 2).sum() == probes.RETIMED
