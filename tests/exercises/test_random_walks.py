"""Random walks: each truth against a second, independent source, and right and wrong submissions that no
sample contains.
"""

import itertools
from fractions import Fraction
from math import pi
from pathlib import Path

import mpmath
import numpy as np
import pytest
import scipy.stats

from exercises.random_walks import assignment as walks
from exercises.random_walks.assignment import notebook
from polhode.judging.verdict import Verdict
from polhode.kinds import question_checks


def label(question):
    """Return the label of a question's checks, or of its first check."""
    return question.data.get("label") or next(iter(question.values.values())).label or question.function


QUESTIONS = {label(question): question for question in notebook.questions()}
WALK = "walk: neither walkers nor steps repeat or mirror each other"
FAR = "walk: every step of a walk beyond 128 places is +1 or −1"
BROWNIAN = "brownian: all particles start at the origin"
MANY = "brownian: steps are as often far from their mean as normal numbers"
POINTS = "integrate calls f at n different points"


def exact(name, rows=4):
    """Draw rows of a question; return them and the truth."""
    question = QUESTIONS[name]
    drawn = question.draw(np.random.default_rng(3), rows)
    return drawn, question.exact(drawn)


def master_equation(steps, start, p, barrier=None):
    """Return the probabilities (steps + 1 dicts by place) of a walk, and those to arrive at the barrier at
    each step.
    """
    there, arrived = {start: Fraction(1)}, []
    for _ in range(steps):
        after = {}
        for place, chance in there.items():
            for to, part in ((place + 1, p), (place - 1, 1 - p)):
                after[to] = after.get(to, 0) + part * chance
        arrived.append(after.pop(barrier, Fraction(0)))
        there = after
    return there, arrived


def test_each_step_is_taken_with_the_drawn_probability():
    rows, truth = exact("steps of walk")
    assert np.array_equal(truth["p"], rows["p"])


def test_the_first_passage_is_that_of_the_master_equation():
    rows, truth = exact("first_passage")
    for start, p, (number, chance) in zip(rows["start"], rows["p"], truth["values"], strict=True):
        there, arrived = master_equation(30, int(start), Fraction(p), barrier=0)
        assert number.tolist() == list(range(1, 32))
        np.testing.assert_allclose(
            chance, [float(c) for c in [*arrived, sum(there.values())]], rtol=1e-12, atol=1e-14
        )


def test_the_squared_error_is_the_variance_of_all_resampled_means():
    """It is (N − 1)/N of that of the mean of N walkers, drawn with replacement in all Nᴺ ways."""
    r = np.random.default_rng(1).normal(size=(4, 3, 2))
    square = ((r - r[:, :1]) ** 2).sum(axis=2)
    means = np.array([square[list(drawn)].mean(axis=0) for drawn in itertools.product(range(4), repeat=4)])
    msd, error = QUESTIONS["mean_square is right: msd"].truth(r)
    np.testing.assert_allclose(msd, means.mean(axis=0), rtol=1e-13)
    np.testing.assert_allclose(error**2, means.var(axis=0) * 4 / 3, rtol=1e-12)


def test_the_propagator_of_the_declared_variance_solves_the_diffusion_equation():
    D, t, x, y = map(mpmath.mpf, ("0.7", "1.3", "0.4", "-0.9"))

    def density(t, x, y):
        # variance 2Dt in each coordinate
        return mpmath.exp(-(x**2 + y**2) / (4 * D * t)) / (4 * mpmath.pi * D * t)

    with mpmath.workdps(40):
        rate = mpmath.diff(density, (t, x, y), (1, 0, 0))
        spread = mpmath.diff(density, (t, x, y), (0, 2, 0)) + mpmath.diff(density, (t, x, y), (0, 0, 2))
        assert abs(rate - D * spread) < 1e-12
    for u in (0.1, 1, 3):  # the fraction of it within r² = 4Dt u
        inside = mpmath.quad(lambda r: 2 * mpmath.pi * r * density(t, r, 0), [0, mpmath.sqrt(4 * D * t * u)])
        assert float(inside) == pytest.approx(scipy.stats.expon(scale=1).cdf(u), rel=1e-12)


def test_the_fit_is_that_of_newton_steps_in_50_digits():
    rows, truth = exact("fit_diffusion", 2)
    with mpmath.workdps(50):
        times = [mpmath.mpf(t) for t in np.geomspace(0.1, 10, 15)]
        sigma = [mpmath.mpf(s) for s in 0.12 * np.geomspace(0.1, 10, 15)]
        for msd, p, covariance in zip(rows["msd"], truth["parameters"], truth["covariance"], strict=True):
            K, alpha = mpmath.mpf(1), mpmath.mpf("0.8")
            for _ in range(30):
                model = [4 * K * t**alpha for t in times]
                J = mpmath.matrix(
                    [[m / K / s, m * mpmath.log(t) / s] for m, t, s in zip(model, times, sigma, strict=True)]
                )
                away = mpmath.matrix([(y - m) / s for y, m, s in zip(msd, model, sigma, strict=True)])
                found = (J.T * J) ** -1
                step = found * (J.T * away)
                K, alpha = K + step[0], alpha + step[1]
            assert mpmath.norm(step) < 1e-30
            deviations = np.sqrt(np.diag(covariance))
            assert np.max(np.abs(p - [float(K), float(alpha)]) / deviations) < 1e-6
            assert (
                np.max(
                    np.abs(covariance - np.array(found.tolist(), float)) / np.outer(deviations, deviations)
                )
                < 1e-6
            )


def test_the_integral_and_its_spread_are_those_of_a_product_rule():
    rows, truth = exact("integrate")
    node, weight = np.polynomial.legendre.leggauss(30)
    for k, L, value, sd in zip(rows["k"], rows["L"], truth["value"], truth["sd"], strict=True):
        x, y, z = np.meshgrid(*[(node + 1) * L / 2] * 3)
        w = np.einsum("i,j,k", *[weight * L / 2] * 3)
        f = np.exp(-k * (x**2 + y**2 + z**2))
        mean = np.sum(w * f) / L**3
        assert value == pytest.approx(L**3 * mean, rel=1e-12)
        assert sd == pytest.approx(L**3 * np.sqrt(np.sum(w * (f - mean) ** 2) / L**3 / 400), rel=1e-11)


def test_the_numbers_of_the_track_are_those_of_exact_integers():
    lines = Path(walks.__file__).with_name("track.csv").read_text().split()[1:]
    track = [[round(Fraction(number) * 10_000) for number in line.split(",")] for line in lines]  # in 1e-4 µm
    truth = QUESTIONS["boltzmann is right: drift"].truth
    drift, D, D_error, k_B = truth(np.array(track) / 10_000, 0.5, 295.15, 9.5e-4, 0.5)
    n, variances = len(track) - 1, []
    for k in (0, 1):
        step = [b[k] - a[k] for a, b in itertools.pairwise(track)]
        assert drift[k] == pytest.approx(sum(step) / 10_000 / (n * 0.5), rel=1e-12)
        variances.append(Fraction(n * sum(one**2 for one in step) - sum(step) ** 2, n * (n - 1) * 10**8))
    exactly = float(sum(variances) / 2)
    assert exactly == pytest.approx(D, rel=1e-12)
    assert D_error**2 == pytest.approx(exactly**2 / (n - 1), rel=1e-12)
    assert k_B == pytest.approx(exactly * 1e-12 * 6 * pi * 9.5e-4 * 0.5e-6 / 295.15, rel=1e-12)
    # within two standard errors of the defined constant
    assert abs(k_B / 1.380649e-23 - 1) < 2 / (n - 1) ** 0.5


def moments(chances):
    """Return the mean and variance of a number, from the probabilities of its values."""
    mean = sum(number * chance for number, chance in chances.items())
    return np.array([mean, sum((number - mean) ** 2 * chance for number, chance in chances.items())], float)


def test_the_sums_of_places_scatter_as_the_master_equation_says():
    rows, truth = exact("sums of places of walk")
    for p, value, sd in zip(rows["p"], truth["value"], truth["sd"], strict=True):
        want = sum(n * moments(master_equation(30 // n, 0, Fraction(p))[0]) for n in (1, 2, 3, 30))
        assert (value, sd**2) == pytest.approx(tuple(want), rel=1e-12, abs=1e-12)


def test_the_sums_of_first_passages_scatter_as_the_master_equation_says():
    rows, truth = exact("sums of first_passage")
    for p, value, sd in zip(rows["p"], truth["value"], truth["sd"], strict=True):
        there, arrived = master_equation(4, 2, Fraction(p), barrier=0)
        want = 12 * moments({**dict(enumerate(arrived, 1)), 5: sum(there.values())})
        assert (value, sd**2) == pytest.approx(tuple(want), rel=1e-12)


def test_the_sums_of_places_of_particles_have_the_variance_of_a_simulation():
    rows, truth = exact("sums of places of brownian")
    question = QUESTIONS["sums of places of brownian"]
    found = question.play(question.student, rows)["value"].std(axis=1) / truth["sd"]
    assert truth["value"].tolist() == [0] * 4 and np.all(np.abs(found - 1) < 5 / np.sqrt(800))


BACKWARDS = """
def walk(walkers, steps, p, rng):
    x = np.zeros((walkers, steps + 1))
    x[:, steps] = 2 * rng.binomial(steps, p, walkers) - steps
    for k in range(steps, 1, -1):
        x[:, k - 1] = x[:, k] - np.where(rng.random(walkers) < (x[:, k] + k) / 2 / k, 1, -1)
    return x.tolist()
"""
POLAR = """
def brownian(walkers, t, D, rng):
    r = np.sqrt(rng.exponential(4 * D * np.diff(t), size=(walkers, len(t) - 1)))
    angle = rng.uniform(0, 2 * np.pi, size=r.shape)
    steps = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1)
    return np.insert(np.cumsum(steps, axis=1), 0, 0, axis=1)
"""
MIRRORED = """
def walk(walkers, steps, p, rng):
    u = rng.random((walkers // 2 + 1, steps))
    return np.insert(np.cumsum(np.where(np.vstack([u, 1 - u]) < p, 1, -1), axis=1), 0, 0, axis=1)[:walkers]
"""
MIXED = """
def walk(walkers, steps, p, rng):
    a, b = rng.random((2, walkers // 4 + 1, steps))
    u = np.stack([a, b, a, 1 - b], axis=1).reshape(-1, steps)[:walkers]
    return np.insert(np.cumsum(np.where(u < p, 1, -1), axis=1), 0, 0, axis=1)
"""
CLIPPED = """
def walk(walkers, steps, p, rng):
    step = np.where(rng.random((walkers, steps)) < min(max(p, 0.25), 0.75), 1, -1)
    return np.insert(np.cumsum(step, axis=1), 0, 0, axis=1)
"""
MIRRORED_PARTICLES = """
def brownian(walkers, t, D, rng):
    step = rng.normal(size=(walkers // 2 + 1, len(t) - 1, 2)) * np.sqrt(2 * D * np.diff(t))[:, None]
    return np.insert(np.cumsum(np.vstack([step, -step])[:walkers], axis=1), 0, 0, axis=1)
"""
PASSAGE = """
def first_passage(walkers, steps, start, p, rng):
    T = []
    for _ in range(walkers):
        x, k = start, 0
        while x and k < {last}:
            x += 1 if rng.random() < p else -1
            k += 1
        T.append(float(k) if x == 0 else steps + 1)
    return np.resize(T[:{distinct}], walkers)
"""
LOOP = PASSAGE.format(last="steps", distinct="walkers")
LATE = PASSAGE.format(last="steps - 1", distinct="walkers")
REPEATED = PASSAGE.format(last="steps", distinct="(walkers + 1) // 2")
LAST_TWICE = """
def walk(walkers, steps, p, rng):
    step = np.where(rng.random((walkers, steps)) < p, 1, -1)
    step[{last}] = {sign}step[0]
    return np.insert(np.cumsum(step, axis=1), 0, 0, axis=1)
"""
ONE_IS_FLAT = """
def walk(walkers, steps, p, rng):
    step = np.where(rng.random((walkers, steps)) < p, 1, -1)
    return np.insert(np.cumsum(step, axis=1), 0, 0, axis=1).squeeze()
"""
GRID = """
def integrate(f, L, n, rng):
    m = round(n ** (1 / 3))
    u = (np.arange(m) + 0.5) * L / m
    found = L**3 * f(*np.meshgrid(u, u, u))
    error = found.std() / n**0.5
    return found.mean() + error * rng.normal(), error
"""
ONE_BY_ONE = """
def integrate(f, L, n, rng):
    points = [rng.uniform(0, L, 3) for _ in range(n)]
    mean = L**3 * sum(f(*point) for point in points) / n
    return mean, np.sqrt(sum((L**3 * f(*point) - mean) ** 2 for point in points) / n / (n - 1))
"""
SMALL = """
def walk(walkers, steps, p, rng):
    step = np.where(rng.random((walkers, steps)) < p, 1, -1).astype(np.int8)
    return np.insert(np.cumsum(step, axis=1, dtype=np.int8), 0, 0, axis=1)
"""
CHILD = """
def walk(walkers, steps, p, rng):
    child = np.random.default_rng(rng.integers(2**63))
    return np.insert(np.cumsum(1 - 2 * (child.random((walkers, steps)) >= p), axis=1), 0, 0, axis=1)
"""
SPAWNED = """
def brownian(walkers, t, D, rng):
    spread = np.sqrt(2 * D * np.diff(t))
    paths = [[child.normal(0, spread).cumsum() for _ in "xy"] for child in rng.spawn(walkers)]
    return np.insert(np.swapaxes(paths, 1, 2), 0, 0, axis=1)
"""
SINGLY = """
def brownian(walkers, t, D, rng):
    r = np.zeros((walkers, len(t), 2))
    for i in range(walkers):
        for j in range(len(t) - 1):
            r[i, j + 1] = r[i, j] + rng.normal(0, (2 * D * (t[j + 1] - t[j])) ** 0.5, 2)
    return r
"""
OF_NORMALS = """
def brownian(walkers, t, D, rng):
    {normal}
    return np.insert(np.cumsum(normal * np.sqrt(2 * D * np.diff(t))[:, None], axis=1), 0, 0, axis=1)
"""
TWELVE = OF_NORMALS.format(normal="normal = rng.random((12, walkers, len(t) - 1, 2)).sum(axis=0) - 6")
TOGETHER = OF_NORMALS.format(
    normal="normal = rng.multivariate_normal([0, 0], [[1, 0.3], [0.3, 1]], (walkers, len(t) - 1))"
)
SAME_SIZE = OF_NORMALS.format(
    normal="n = len(t) - 1; normal = rng.normal(size=(walkers, n, 1)) * rng.choice([-1, 1], (walkers, n, 2))"
)
OF_POINTS = """
def integrate(f, L, n, rng):
    x, y, z = {points}
    found = L**3 * f(x, y, z)
    return found.mean(), {error}.std(ddof=1) / np.sqrt(n)
"""
RANDOM, FOUND = "rng.uniform(0, L, (3, n))", "found"
SHORT = OF_POINTS.format(points="rng.uniform(0, L, (3, n - 1))", error=FOUND)
OTHERS = OF_POINTS.format(points=RANDOM, error="(L**3 * f(*rng.uniform(0, L, (3, n))))")
AGAIN = OF_POINTS.format(points=RANDOM, error="(L**3 * f(x, y, z))")
IN_LAYERS = OF_POINTS.format(
    points="(np.arange(n) + rng.random(n)) * L / n, *rng.uniform(0, L, (2, n))", error=FOUND
)
IN_HALVES = OF_POINTS.format(
    points="*rng.uniform(0, L, (2, n)), (np.arange(n) % 2 + rng.random(n)) * L / 2", error=FOUND
)
IN_SINGLE_PRECISION = OF_POINTS.format(points="L * rng.random((3, n), dtype=np.float32)", error=FOUND)


@pytest.mark.parametrize(
    ("name", "source", "wrong"),
    [
        (FAR, BACKWARDS, []),
        (FAR, CHILD, []),
        (FAR, SMALL, ["value"]),
        ("steps of walk", CHILD, []),
        (MANY, POLAR, []),
        (MANY, SPAWNED, []),
        (MANY, SINGLY, []),
        (MANY, TWELVE, ["kurtosis"]),
        (MANY, TOGETHER, ["together"]),
        (MANY, SAME_SIZE, ["together"]),
        (POINTS, ONE_BY_ONE, []),
        (POINTS, AGAIN, []),
        (POINTS, IN_SINGLE_PRECISION, []),
        (POINTS, SHORT, ["number"]),
        (POINTS, OTHERS, ["number"]),
        (POINTS, IN_LAYERS, ["evenness"]),
        (POINTS, IN_HALVES, ["evenness"]),
        ("steps of walk", BACKWARDS, []),
        ("sums of places of walk", BACKWARDS, []),
        (WALK, BACKWARDS, []),
        (WALK, MIRRORED, ["value"]),
        (WALK, MIXED, ["value"]),
        (WALK, LAST_TWICE.format(last="-1", sign=""), ["value"]),
        (WALK, LAST_TWICE.format(last="walkers // 3", sign="-"), ["value"]),
        ("steps of brownian", POLAR, []),
        ("sums of places of brownian", POLAR, []),
        (BROWNIAN, POLAR, []),
        (BROWNIAN, MIRRORED_PARTICLES, ["pairs"]),
        ("integrate", ONE_BY_ONE, []),
        ("points of integrate", ONE_BY_ONE, []),
        ("points of integrate", GRID, ["distribution", "repeated"]),
        ("first_passage", LOOP, []),
        ("sums of first_passage", LOOP, []),
        ("first_passage: no walker arrives in fewer steps than start", LOOP, []),
        ("sums of first_passage", REPEATED, ["spread"]),
    ],
)
def test_functions_made_in_another_way(name, source, wrong):
    assert failed(name, source) == wrong


@pytest.mark.parametrize(
    ("name", "source"),
    [("steps of walk", CLIPPED), ("sums of places of walk", CLIPPED), ("sums of first_passage", LATE)],
)
def test_a_wrong_walk_fails_in_some_row(name, source):
    assert {"distribution", "mean"} & set(failed(name, source, 8))


def test_one_walker_needs_two_indices():
    with pytest.raises(IndexError):
        failed("sums of places of walk", ONE_IS_FLAT)


def failed(name, source, draws=1):
    """Return the checks of a question that fail, of so many drawn rows."""
    question = QUESTIONS[name]
    rows, truth = exact(name, draws)
    seen = {
        **question.play(question.defined_by(source), rows),
        **{n: a for n, a in truth.items() if n.startswith("at_")},
    }
    outcomes = [check.judge([seen], [truth]) for check in question_checks(question.asked, "scene", False)]
    return [outcome.id.rpartition("-")[2] for outcome in outcomes if outcome.verdict is not Verdict.PASS]


def test_right_numbers_are_far_from_the_limits_of_the_tests_of_one_statistic():
    """Each limit is at least 6.4 times the spread, here of 60 gradings."""
    rng, L = np.random.default_rng(8), 1.5
    t = np.linspace(0, 1, 401)
    brownian, many = QUESTIONS[MANY].student["brownian"], walks_observation(MANY)
    found = np.array([many(brownian, t, 0.5, seed) for seed in range(60)])
    assert np.abs(found[:, 0] - 3).max() < 0.07 / 1.5 and found[:, 0].std() < 0.07 / 5.5
    assert found[:, 1].max() < 0.022 / 1.5
    points = rng.uniform(0, L, (60, 400, 65, 3)) / L
    even = [walks.evenness(one) for one in points]
    assert max(np.abs(even)) < 0.4


def walks_observation(name):
    """Return the function that observes a solution in the question with this label."""
    scope = {"np": np}
    exec(QUESTIONS[name].call, scope)
    return scope["observed"]
