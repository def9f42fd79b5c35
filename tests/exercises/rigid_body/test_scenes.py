"""What precession_rate, box_moments and principal_moments are given: every right method passes, every known slip does not."""

import numpy as np
import pytest

from ecp.judge import Verdict
from exercises.rigid_body import plays
from service.grading.grade import draw_inputs, truth


def phase(w):
    return np.unwrap(np.arctan2(w[1], w[0]))


RIGHT = {
    "slope": lambda t, w: np.polyfit(t, phase(w), 1)[0],
    "total angle": lambda t, w: (phase(w)[-1] - phase(w)[0]) / (t[-1] - t[0]),
    "mean of the gradient": lambda t, w: np.gradient(phase(w), t).mean(),
    "mean of the differences": lambda t, w: np.mean(np.diff(phase(w)) / np.diff(t)),
    "median": lambda t, w: np.median(np.gradient(phase(w), t)),
    "phasors": lambda t, w: np.angle((w[0] + 1j * w[1])[1:] / (w[0] + 1j * w[1])[:-1]).sum() / np.ptp(t),
    "derivatives of ω": lambda t, w: np.mean((w[0] * np.gradient(w[1], t) - w[1] * np.gradient(w[0], t)) / (w[0] ** 2 + w[1] ** 2)),
}
WRONG = {
    "over t[-1]": lambda t, w: (phase(w)[-1] - phase(w)[0]) / t[-1],
    "over n equal steps": lambda t, w: (phase(w)[-1] - phase(w)[0]) / (len(t) * (t[1] - t[0])),
    "over n mean steps": lambda t, w: (phase(w)[-1] - phase(w)[0]) / (len(t) * np.diff(t).mean()),
    "slope over equal steps": lambda t, w: np.polyfit(np.arange(len(t)) * np.diff(t).mean(), phase(w), 1)[0],
    "first step": lambda t, w: (phase(w)[1] - phase(w)[0]) / (t[1] - t[0]),
    "last step": lambda t, w: (phase(w)[-1] - phase(w)[-2]) / (t[-1] - t[-2]),
    "fastest": lambda t, w: np.abs(np.gradient(phase(w), t)).max() * np.sign(phase(w)[-1] - phase(w)[0]),
}


def passed(rigid_body, ids, functions, seed):
    verdicts = []
    for check in (c for c in rigid_body.checks() if c.id in ids):
        scene = rigid_body.scene(check.scenes[0])
        inputs = draw_inputs(scene, seed)
        exact = truth(scene, inputs)
        seen = getattr(plays, scene.play)(functions, inputs)
        verdicts.append(check.judge([seen | {name: exact[name] for name in scene.known}], [exact]).verdict is Verdict.PASS)
    assert len(verdicts) == len(ids)
    return all(verdicts)


@pytest.mark.parametrize("seed", range(4))
def test_every_mean_rate_is_accepted_and_what_assumes_even_turning_or_times_is_not(seed, rigid_body):
    ids = ("4-function", "4-retrograde")
    for name, function in RIGHT.items():
        assert passed(rigid_body, ids, {"precession_rate": function}, seed), name
    for name, function in WRONG.items():
        assert not passed(rigid_body, ids, {"precession_rate": function}, seed), name


def test_a_given_motion_starts_off_zero_and_its_samples_lie_less_than_half_a_turn_apart(rigid_body):
    for name in ("rate", "rate-retrograde"):
        given = draw_inputs(rigid_body.scene(name), 2)
        assert given["t"][0] > 0 and np.all(np.diff(given["t"]) > 0)
        assert np.abs(np.diff(phase(given["w"]))).max() < 0.5


BOXES = {
    "sums": lambda m, a, b, c: m / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b]),
    "all but its own": lambda m, a, b, c: m / 12 * (a * a + b * b + c * c - np.array([a, b, c]) ** 2),
}
EIGENVALUES = {
    "eigvalsh": np.linalg.eigvalsh,
    "eig": lambda tensor: np.linalg.eig(tensor)[0],
    "svd": lambda tensor: np.linalg.svd(tensor)[1],
    "polynomial": lambda tensor: np.roots(np.poly(tensor)),
}


@pytest.mark.parametrize("seed", range(4))
def test_moments_of_flat_long_large_and_small_boxes(seed, rigid_body):
    for function in BOXES.values():
        assert passed(rigid_body, ("1-boxes",), {"box_moments": function}, seed)
    for function in EIGENVALUES.values():
        assert passed(rigid_body, ("1-tensors", "1-trace", "1-determinant"), {"principal_moments": function}, seed)
    assert not passed(
        rigid_body, ("1-boxes",), {"box_moments": lambda m, a, b, c: np.maximum(BOXES["sums"](m, a, b, c), 1e-3)}, seed
    )
    only_tilted = {"principal_moments": lambda T: np.linalg.eigvalsh(T) if T[0, 1] else np.full(3, np.nan)}
    assert not passed(rigid_body, ("1-tensors",), only_tilted, seed)
