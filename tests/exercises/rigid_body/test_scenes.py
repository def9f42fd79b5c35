"""What precession_rate, box_moments and principal_moments are given: every right method passes, every known
slip does not.
"""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import curve_fit

import reference
from exercises.rigid_body import plays
from exercises.rigid_body.scenes import SCENES, TILT
from polhode.judging.judge import Verdict
from service.grading.jobs import draw_inputs, truth


def phase(w):
    return np.unwrap(np.arctan2(w[1], w[0]))


def cosine(t, size, rate, start):
    return size * np.cos(rate * t + start)


def guess(t, w):
    return [1.0, *np.polyfit(t - t.mean(), phase(w), 1)]


def spectral(t, w):
    """The rate fitted to both components from the highest line of their spectrum on,
    at resampled even times.
    """
    if np.ptp(np.diff(t)) > 1e-9 * np.ptp(t):
        even = np.linspace(t[0], t[-1], len(t))
        t, w = even, np.array([CubicSpline(t, row)(even) for row in w])
    z, rates = w[0] + 1j * w[1], 2 * np.pi * np.fft.fftfreq(16 * len(t), t[1] - t[0])
    first = rates[np.abs(np.fft.fft(z, len(rates))).argmax()]
    both, time = np.concatenate([w[0], w[1]]), t - t.mean()
    fitted = curve_fit(
        lambda _, size, rate, start: np.concatenate(
            [cosine(time, size, rate, start), cosine(time, size, rate, start - np.pi / 2)]
        ),
        np.arange(2.0 * len(t)),
        both,
        [np.abs(z).mean(), first, np.angle(z[len(t) // 2])],
    )
    return fitted[0][1]


def crossed(w):
    """The sine of the angle from each sample to the next."""
    size = np.hypot(w[0], w[1])
    return (w[0][:-1] * w[1][1:] - w[1][:-1] * w[0][1:]) / (size[:-1] * size[1:])


def crossings(t, w):
    up = np.flatnonzero((w[0][:-1] < 0) & (w[0][1:] >= 0))
    times = t[up] - w[0][up] * (t[up + 1] - t[up]) / (w[0][up + 1] - w[0][up])
    return np.sign(crossed(w)[0]) * 2 * np.pi / np.diff(times).mean() if len(times) > 1 else 0.0


RIGHT = {
    "slope": lambda t, w: np.polyfit(t, phase(w), 1)[0],
    "total angle": lambda t, w: (phase(w)[-1] - phase(w)[0]) / (t[-1] - t[0]),
    "mean of the gradient": lambda t, w: np.gradient(phase(w), t).mean(),
    "mean of the differences": lambda t, w: np.mean(np.diff(phase(w)) / np.diff(t)),
    "median": lambda t, w: np.median(np.gradient(phase(w), t)),
    "phasors": lambda t, w: np.angle((w[0] + 1j * w[1])[1:] / (w[0] + 1j * w[1])[:-1]).sum() / np.ptp(t),
    "fitted cosine": lambda t, w: curve_fit(cosine, t - t.mean(), w[0], guess(t, w))[0][1],
    "cosine from its spectrum": lambda t, w: spectral(t, w),
    "spline of the phase": lambda t, w: CubicSpline(t, phase(w)).derivative()(t).mean(),
}
WRONG = {
    "derivatives of ω": lambda t, w: np.mean(
        (w[0] * np.gradient(w[1], t) - w[1] * np.gradient(w[0], t)) / (w[0] ** 2 + w[1] ** 2)
    ),
    "arcsin of steps": lambda t, w: np.arcsin(crossed(w)).sum() / np.ptp(t),
    "sine of steps": lambda t, w: np.mean(crossed(w) / np.diff(t)),
    "median of raw jumps": lambda t, w: np.median(np.diff(np.arctan2(w[1], w[0])) / np.diff(t)),
    "zero crossings": lambda t, w: crossings(t, w),
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
        verdicts.append(
            check.judge([seen | {name: exact[name] for name in scene.known}], [exact]).verdict is Verdict.PASS
        )
    assert len(verdicts) == len(ids)
    return all(verdicts)


@pytest.mark.parametrize("seed", range(4))
def test_every_mean_rate_is_accepted_and_what_assumes_even_turning_or_times_is_not(seed, rigid_body):
    ids = ("4-function", "4-retrograde", "4-coarse", "4-short")
    for name, function in RIGHT.items():
        assert passed(rigid_body, ids, {"precession_rate": function}, seed), name
    for name, function in WRONG.items():
        assert not passed(rigid_body, ids, {"precession_rate": function}, seed), name


def test_a_given_motion_starts_off_zero_and_its_samples_lie_less_than_half_a_turn_apart(rigid_body):
    for name, furthest in (
        ("rate", 0.5),
        ("rate-retrograde", 0.5),
        ("rate-coarse", 0.47 * 2 * np.pi),
        ("rate-short", 0.5),
    ):
        given = draw_inputs(rigid_body.scene(name), 2)
        assert given["t"][0] > 0 and np.all(np.diff(given["t"]) > 0)
        assert np.abs(np.diff(phase(given["w"]))).max() < furthest


@pytest.mark.parametrize("seed", range(8))
def test_half_of_the_coarse_steps_jump_and_a_short_record_is_less_than_a_turn(seed, rigid_body):
    coarse, short = (draw_inputs(rigid_body.scene(name), seed)["w"] for name in ("rate-coarse", "rate-short"))
    steps = np.diff(np.arctan2(coarse[1], coarse[0]))
    assert np.count_nonzero(np.abs(steps) > np.pi) == 10 == len(steps) / 2
    assert np.pi < np.ptp(phase(short)) < 2 * np.pi
    assert np.count_nonzero(np.abs(np.diff(np.arctan2(short[1], short[0]))) > np.pi) == 1


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
        assert passed(
            rigid_body, ("1-tensors", "1-trace", "1-determinant"), {"principal_moments": function}, seed
        )
    assert not passed(
        rigid_body,
        ("1-boxes",),
        {"box_moments": lambda m, a, b, c: np.maximum(BOXES["sums"](m, a, b, c), 1e-3)},
        seed,
    )
    only_tilted = {"principal_moments": lambda T: np.linalg.eigvalsh(T) if T[0, 1] else np.full(3, np.nan)}
    assert not passed(rigid_body, ("1-tensors",), only_tilted, seed)


def test_the_film_starts_away_from_every_axis_and_plane():
    given = next(scene for scene in SCENES if scene.name == "film").inputs
    axis, unit = np.array(given["R"])[:, :, 2], np.array(given["L"]) / np.linalg.norm(given["L"])
    assert np.abs(unit).min() > 0.1 and np.abs(axis[0]).min() > 0.1
    assert axis.min(axis=0).max() < -0.1 and axis.max(axis=0).min() > 0.1, (
        "the axis crosses each coordinate plane"
    )
    exact = reference.motion((2.2, 0.0, 0.5), (1.25, 1.25, 2.0), given["t"], need="orientation").R
    assert np.allclose(given["R"], TILT @ exact)
