"""What is drawn for each grading: motions are of their families, points miss no order, octant, axis or size;
every right method passes, and every known slip does not.
"""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import curve_fit

import reference
from exercises.authoring.draws import Drawing
from exercises.authoring.kinds.dynamics import ALONG, NODES
from exercises.rigid_body import draws
from polhode import kinds
from polhode.judging.return_value import WrongAnswer
from polhode.judging.verdict import Verdict
from service.grading.sandbox_job import draw_inputs, truth

MOTIONS = (
    draws.long,
    draws.greatest,
    draws.least,
    draws.symmetric_top,
    draws.sphere,
    draws.tumble,
    draws.attitude,
)
DRAWN = {one.__name__: one for one in MOTIONS}


@pytest.mark.parametrize("name", DRAWN)
def test_families(name):
    for seed in range(40):
        drawn = DRAWN[name](Drawing(np.random.default_rng(seed)))
        w0, I = drawn["w"], drawn["I"]
        exact = reference.Exact(w0, I)
        low, mid, high = np.sort(I)
        side = np.sum((I * w0) ** 2) - 2 * reference.kinetic_energy(w0, I) * mid
        assert low > 0 and high <= low + mid and np.isfinite(drawn["until"])
        if name == "symmetric_top":
            assert exact.model == "symmetric" and I[0] == I[1]
        elif name == "sphere":
            assert exact.model == "steady" and low == high
        elif name == "least":
            assert side < 0
        elif name == "greatest":
            assert side > 0
        elif name == "tumble":
            spin = int(np.argsort(I)[1])
            path = exact.omega(np.linspace(0.0, drawn["until"], 400))[spin] / w0[spin]
            assert path.min() < -0.9, "it turns over"


def play(scene, functions, inputs):
    """Return what functions return in a scene, as the sandbox would."""
    given = {name: value for name, value in inputs.items() if name not in scene.withheld}
    return kinds.play(dict(scene.question), functions, given)


SPELLED = {
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
WRONGLY = {
    "NaN where ω₁ = 0": lambda t, w, I: np.cross(I * w, w) / I * (w[0] / w[0]),
    "NaN at rest": lambda t, w, I: np.cross(I * w, w) / I * (w @ w / (w @ w)),
    "NaN where I₁ = I₂": lambda t, w, I: np.cross(I * w, w) / I * ((I[0] - I[1]) / (I[0] - I[1])),
    "small ω cut to zero": lambda t, w, I: np.cross(I * np.where(abs(w) < 1e-3, 0, w), w) / I,
    "large rates clipped": lambda t, w, I: np.clip(np.cross(I * w, w) / I, -1e4, 1e4),
    "1e-9 added": lambda t, w, I: np.cross(I * w, w) / I + 1e-9,
    "one order of moments": lambda t, w, I: np.cross(np.sort(I) * w, w) / np.sort(I),
}


def draws_points():
    return list(draws.points(Drawing(np.random.default_rng(0))))


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
        seen = play(scene, {"euler_eqs": function}, inputs)
    check = next(check for check in rigid_body.checks() if check.id == "2-pointwise")
    return check.judge([seen | {name: exact[name] for name in scene.known}], [exact])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", SPELLED)
def test_every_right_spelling_is_far_within_the_tolerance(name, seed, rigid_body):
    outcome = judged(rigid_body, SPELLED[name], seed)
    assert outcome.verdict is Verdict.PASS and (outcome.margin is None or outcome.margin > 20), outcome.text()


@pytest.mark.parametrize("name", WRONGLY)
def test_what_is_wrong_at_few_points_only_does_not_pass(name, rigid_body):
    assert judged(rigid_body, WRONGLY[name], 3).verdict is Verdict.FAIL


def test_the_worst_point_is_shown(rigid_body):
    outcome = judged(rigid_body, lambda t, w, I: -np.cross(I * w, w) / I, 3)
    assert "w = [" in outcome.where and "I = [" in outcome.where


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
    assert len(w) == len(draws_points()) + 8 * NODES + 7 * ALONG


def test_some_points_are_asked_twice_and_some_at_another_time(rigid_body):
    drawn = draw_inputs(rigid_body.scene("probes"), 3)
    rows = np.column_stack([drawn["t"], drawn["w"], drawn["I"]])
    points, counts = np.unique(rows, axis=0, return_counts=True)
    assert (counts == 2).sum() == draws.REPEATED
    _, again = np.unique(points[:, 1:], axis=0, return_counts=True)
    assert (again == 2).sum() == draws.REPEATED


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
        try:
            seen = play(scene, functions, inputs)
        except WrongAnswer:
            return False
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


def test_a_given_motion_starts_off_zero_and_its_samples_lie_less_than_half_a_turn_apart():
    for name, draw in draws.PRECESSIONS.items():
        given = draw(Drawing(np.random.default_rng(2)))
        furthest = 0.47 * 2 * np.pi if name == "coarse" else 0.5
        assert given["t"][0] > 0 and np.all(np.diff(given["t"]) > 0)
        assert np.abs(np.diff(phase(given["w"]))).max() < furthest


@pytest.mark.parametrize("seed", range(8))
def test_half_of_the_coarse_steps_jump_and_a_short_record_is_less_than_a_turn(seed):
    coarse, short = (draw(Drawing(np.random.default_rng(seed)))["w"] for draw in (draws.coarse, draws.short))
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
