"""Random walks and Monte Carlo: seven exercises, their exact answers and known mistakes.

Each truth has a second source in tests/exercises/test_random_walks.py: the master equation in exact fractions (1, 6), all resampled
means (2), the diffusion equation (3), Newton's method in 50 digits (4), a product rule of quadrature (5), exact integers (7).
"""

from math import comb, erf, pi, sqrt
from pathlib import Path
from statistics import variance

import numpy as np
from scipy.optimize import curve_fit

from exercises.author import Notebook, Tolerance, Value, family, integers, mistake, uniform
from exercises.kinds.fit import fit
from exercises.kinds.random import estimate, generator, samples
from exercises.kinds.values import values
from exercises.kinds.variables import variables

notebook = Notebook("Random walks and Monte Carlo", notebook="notebook.ipynb", data=("track.csv",))
TRACK = np.loadtxt(Path(__file__).with_name("track.csv"), delimiter=",", skiprows=1)
ROUNDING = Tolerance(limit=1e-12, reason="a thousand rounding errors")
OTHER_GENERATOR = mistake("rng.", "np.random.default_rng().")


def walk(walkers, steps, p, rng):
    """Return the positions (walkers, steps + 1) of walkers on a line, from 0."""
    step = np.where(rng.random((walkers, steps)) < p, 1, -1)
    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])


ask = {"walkers": 200, "steps": 20, "p": uniform(0.25, 0.75), "rng": generator()}
wrong = [
    mistake("< p", "> p", "wrong-comparison", "p is the probability of a step to the left"),
    mistake("< p", "< 0.5", "missing-term", "both directions are equally likely, whatever p is"),
    mistake("(rng.random((walkers, steps))", "(rng.random((walkers, 1)) * np.ones(steps)"),
    OTHER_GENERATOR,
]
each = "(np.diff(walk(walkers, steps, p, rng)) + 1) / 2"
each_step = samples(walk, ask, "bernoulli", p=lambda p: p, call=each, label="steps of walk", mistakes=wrong)
wrong = [
    mistake("rng.random((walkers, steps))", "rng.random(steps) * np.ones((walkers, 1))"),
    mistake("np.cumsum", "1 + np.cumsum", "extra-term", "each walker is one place too far to the right"),
]
right = {"n": lambda steps: steps, "p": lambda p: p}
ends = "(np.array(walk(walkers, steps, p, rng))[:, -1] + steps) / 2"
end_points = samples(walk, ask, "binom", **right, call=ends, label="end points of walk", mistakes=wrong)


def scatter(walkers, steps, p):
    """Return the standard deviation of the mean place of independent walkers."""
    return sqrt(4 * steps * p * (1 - p) / walkers)


ask = {**ask, "walkers": 10, "steps": 5}
dealt = "rng.permutation((np.arange(walkers * steps) + 0.5) / (walkers * steps)).reshape(walkers, steps)"
wrong = [mistake("rng.random((walkers, steps))", dealt)]  # as many steps to the right as expected, in random order
means = {"call": "np.mean(np.array(walk(walkers, steps, p, rng))[:, -1])", "label": "mean place of walk", "repetitions": 1600}
mean_place = estimate(walk, ask, lambda steps, p: steps * (2 * p - 1), sd=scatter, **means, mistakes=wrong)
notebook.exercise("1", "A walk with a bias", each_step, end_points, mean_place)


def mean_square(r):
    """Return the mean squared displacement (times,) in µm² of tracks r (walkers, times, 2) in µm, and its error."""
    square = np.sum((r - r[:, :1]) ** 2, axis=2)
    return square.mean(axis=0), square.std(axis=0, ddof=1) / np.sqrt(len(r))


def tracks(rng):
    """Draw the tracks of nine walkers that start anywhere."""
    return 5 * rng.uniform(-1, 1, (9, 1, 2)) + rng.normal(size=(9, 6, 2)).cumsum(axis=1)


def by_moments(r):
    """Return the same from the moments of the coordinates."""
    x, y = np.moveaxis(r - r[:, :1], 2, 0)
    second, fourth = np.mean(x * x + y * y, axis=0), np.mean(x**4 + y**4 + 2 * x * x * y * y, axis=0)
    return second, np.sqrt((fourth - second**2) / (len(r) - 1))


wrong = [
    mistake(" - r[:, :1]", "", "missing-term", "the start of each walker is not subtracted"),
    mistake(" / np.sqrt(len(r))", "", "missing-division", "the error is the spread of one walker, not of the mean"),
    mistake(", ddof=1", "", "missing-argument", "the variance divides by the number of walkers, not by one less"),
    mistake("np.sqrt(len(r))", "len(r)", "wrong-power", "the square root of the number of walkers is missing"),
]
agree = {"msd": ROUNDING, "error": ROUNDING}
msd = values(mean_square, {"r": tracks}, truth=by_moments, agree=agree, mistakes=wrong)
notebook.exercise("2", "The mean squared displacement and its error", msd)


def brownian(walkers, t, D, rng):
    """Return the positions (walkers, times, 2) in µm at the times t (times,) in s, from the origin; D in µm²/s."""
    step = rng.normal(size=(walkers, len(t) - 1, 2)) * np.sqrt(2 * D * np.diff(t))[:, None]
    return np.concatenate([np.zeros((walkers, 1, 2)), np.cumsum(step, axis=1)], axis=1)


def uneven(rng):
    """Draw six times at very uneven intervals, from 0."""
    return np.append(0, np.cumsum(np.exp(rng.uniform(np.log(0.02), np.log(2), 5))))


ask = {"walkers": 200, "t": uneven, "D": uniform(0.2, 2), "rng": generator()}
wrong = [
    mistake("2 * D", "4 * D", "constant-factor", "4Dt is the variance of x and y together, 2Dt that of one"),
    mistake("np.diff(t)", "t[1:]", "wrong-variable", "each step has the variance of the whole time"),
    mistake("np.cumsum(step, axis=1)", "np.sqrt(2 * D * t[1:])[:, None] * rng.normal(size=step.shape)"),
    mistake("rng.normal(size", "np.sqrt(3) * rng.uniform(-1, 1, size", "wrong-function", "steps are uniformly distributed"),
    OTHER_GENERATOR,
]
scaled = "np.diff(np.swapaxes(brownian(walkers, t, D, rng), 1, 2)) / np.sqrt(2 * D * np.diff(t))"
each_step = samples(brownian, ask, "norm", call=scaled, label="steps of brownian", mistakes=wrong)
wrong = [
    mistake("1, 2)) *", "1, 1)) * np.ones(2) *", "wrong-index", "x and y take the same steps"),
    mistake("rng.normal(size=(walkers, len(t) - 1, 2))", "np.repeat(rng.normal(size=(walkers // 2, len(t) - 1, 2)), 2, axis=0)"),
]
scaled = "np.sum(np.array(brownian(walkers, t, D, rng))[:, -1] ** 2, axis=-1) / (4 * D * t[-1])"
end_points = samples(brownian, ask, "expon", call=scaled, label="squared displacement of brownian", mistakes=wrong)
ask = {"t": uneven, "D": uniform(0.2, 2), "seed": integers(0, 999)}
started = "np.array(brownian(3, t, D, np.random.default_rng(seed)))[:, 0]"
agree = Value(Tolerance(atol=0, reason="the start is given"), label="brownian: all particles start at the origin")
wrong = [mistake("np.cumsum(step, axis=1)], axis=1)", "np.cumsum(step, axis=1)], axis=1) + 0.1")]
start = values(brownian, ask, agree, truth=lambda: np.zeros((3, 2)), call=started, mistakes=wrong)
notebook.exercise("3", "Brownian motion", each_step, end_points, start)


def fit_diffusion(t, msd, sigma):
    """Return the fitted (K, alpha) of the model msd = 4 K t**alpha and their covariance (2, 2)."""
    return curve_fit(lambda t, K, alpha: 4 * K * t**alpha, t, msd, (1, 1), sigma, True, xtol=1e-12)


def power_law(t, K, alpha):
    """Return the model."""
    return 4 * K * t**alpha


line = "np.log(4 * K) + alpha * np.log(t), t, np.log(msd), (1, 1), sigma / msd"
wrong = [
    mistake(", sigma, True", "", "missing-term", "the errors of the data are not used"),
    mistake("True", "False", "wrong-option", "the covariance is scaled by χ²/(n − 2)"),
    mistake("4 * K * t**alpha", "K * t**alpha", "constant-factor", "the factor 4 of the model is missing"),
    mistake("4 * K * t**alpha, t, msd, (1, 1), sigma", line),
]
times, drawn = np.geomspace(0.1, 10, 15), {"K": uniform(0.6, 2), "alpha": uniform(0.5, 1.1)}
near = Tolerance(limit=0.05, reason="of a standard deviation: four times what the least exact optimizer, Nelder-Mead, deviates")
fitted = fit(fit_diffusion, power_law, x=times, sigma=0.12 * times, drawn=drawn, agree=(near, near), mistakes=wrong)
notebook.exercise("4", "Anomalous diffusion: a fit", fitted)


def integrate(f, L, n, rng):
    """Return the Monte Carlo estimate of the integral of f(x, y, z) over the cube from 0 to L, and its error."""
    found = L**3 * f(*rng.uniform(0, L, (3, n)))
    return found.mean(), found.std(ddof=1) / np.sqrt(n)


def cloud(k, L):
    """Return the exact integral, which factorizes."""
    return (sqrt(pi / k) / 2 * erf(sqrt(k) * L)) ** 3


def spread(k, L, n):
    """Return the standard deviation of an estimate."""
    return sqrt((L**3 * cloud(2 * k, L) - cloud(k, L) ** 2) / n)


density = family("exp(-k * (x**2 + y**2 + z**2))", "x", "y", "z", k=uniform(0.2, 1))
ask = {"f": density, "L": uniform(1, 2), "n": 400, "rng": generator()}
wrong = [
    mistake("L**3 * ", "", "missing-term", "the volume L³ is missing"),
    mistake(" / np.sqrt(n)", "", "missing-division", "the error is the spread of one point, not of the mean"),
    mistake("found.std(ddof=1)", "1.5 * found.std(ddof=1)"),
    mistake("uniform(0, L, (3, n))", "uniform(0, L, n) * np.ones((3, 1))", "wrong-index", "x, y and z are the same number"),
    mistake("found.mean()", "np.median(found)", "wrong-function", "the median stands for the mean"),
    OTHER_GENERATOR,
]
error = Tolerance(limit=0.25, reason="five times the spread of the error of 400 points")
integral = estimate(integrate, ask, cloud, sd=spread, error=error, mistakes=wrong)
notebook.exercise("5", "Monte Carlo integration", integral)


def first_passage(walkers, steps, start, p, rng):
    """Return the number (walkers,) of the step that first takes each walker from start to 0, or steps + 1."""
    there = start + walk(walkers, steps, p, rng) == 0
    return np.where(there.any(axis=1), there.argmax(axis=1), steps + 1)


def ballot(steps, start, p):
    """Return the numbers from 1 to steps + 1 and their probabilities (2, steps + 1), by the ballot theorem."""
    right = {k: (k - start) // 2 for k in range(start, steps + 1, 2)}
    chance = {k: start / k * comb(k, m) * p**m * (1 - p) ** (k - m) for k, m in right.items()}
    chance[steps + 1] = 1 - sum(chance.values())
    return [range(1, steps + 2), [chance.get(k, 0) for k in range(1, steps + 2)]]


ask = {"walkers": 200, "steps": 30, "start": integers(2, 6), "p": uniform(0.3, 0.6), "rng": generator()}
wrong = [
    mistake("there.argmax(axis=1)", "there.argmax(axis=1) - 1", "off-by-one", "the first step has the number 0"),
    mistake("steps + 1)", "steps)", "off-by-one", "walkers that do not arrive get the number steps"),
    mistake("start + walk", "walk", "missing-term", "the walkers start at 0"),
    mistake("there.argmax", "steps - there[:, ::-1].argmax", "wrong-function", "the last passage stands for the first"),
    mistake("walk(walkers, steps, p, rng)", "np.repeat(walk(walkers // 2, steps, p, rng), 2, axis=0)"),
    mistake("p, rng) ==", "p, np.random.default_rng()) =="),
]
passage = samples(first_passage, ask, "rv_discrete", values=ballot, uses=[walk], mistakes=wrong)
notebook.exercise("6", "First passage", passage)


def boltzmann():
    """Compute Boltzmann's constant from the track of a particle."""
    step = np.diff(TRACK, axis=0)
    drift = step.mean(axis=0) / 0.5
    D = step.var(axis=0, ddof=1).sum() / (4 * 0.5)
    D_error = D / np.sqrt(len(step) - 1)
    k_B = 6 * np.pi * 9.5e-4 * 0.5e-6 * D * 1e-12 / 295.15
    return drift, D, D_error, k_B


def by_sums():
    """Return D from the exact sums of the statistics module."""
    x, y = np.diff(TRACK, axis=0).T.tolist()
    return (variance(x) + variance(y)) / 2


exact = {
    "drift": lambda: (TRACK[-1] - TRACK[0]) / 500,
    "D": by_sums,
    "D_error": lambda: by_sums() / sqrt(999),
    "k_B": lambda: by_sums() * 2.85e-21 * pi / 295.15,
}
wrong = [
    mistake(" / 0.5\n", "\n", "missing-division", "the drift is that of a step, not of a second"),
    mistake("step.var(axis=0, ddof=1)", "np.mean(step**2, axis=0)", "missing-term", "the drift is not subtracted"),
    mistake(", ddof=1", "", "missing-argument", "the variance divides by the number of steps, not by one less"),
    mistake("len(step) - 1", "2 * len(step)", "constant-factor", "the error divides by the root of 2N, not of N − 1"),
    mistake(" * 1e-12", "", "units", "D is in µm²/s, not in m²/s"),
]
digits = Tolerance(rtol=1e-9, atol=0, reason="rounding errors of a thousand steps, a thousand times")
cell = variables(boltzmann, exact, agree=dict.fromkeys(exact, digits), mistakes=wrong)
notebook.exercise("7", "Boltzmann's constant from a track", cell)
