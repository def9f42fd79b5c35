"""Random walks and Monte Carlo: seven exercises, their exact answers and known mistakes.

Each truth has a second source in tests/exercises/test_random_walks.py: the master equation in exact fractions (1, 6), all resampled
means (2), the diffusion equation (3), Newton's method in 50 digits (4), a product rule of quadrature (5), exact integers (7).
"""

from math import comb, erf, pi, sqrt
from pathlib import Path
from statistics import variance

import numpy as np
from scipy.optimize import curve_fit

from exercises.author import Notebook, Tolerance, Value, choice, family, integers, mistake, uniform
from exercises.kinds.fit import fit
from exercises.kinds.random import estimate, generator, samples
from exercises.kinds.values import values
from exercises.kinds.variables import variables

notebook = Notebook("Random walks and Monte Carlo", notebook="notebook.ipynb", data=("track.csv",))
TRACK = np.loadtxt(Path(__file__).with_name("track.csv"), delimiter=",", skiprows=1)
ROUNDING = Tolerance(limit=1e-12, reason="a thousand rounding errors")
OTHER_GENERATOR = mistake("rng.", "np.random.default_rng().")
TWICE = "np.dot(2 - np.arange(walkers) % 2, {})"  # a sum over walkers that reveals each that repeats or mirrors another


def weights(walkers):
    """Return the weights (walkers,) of the sum that counts every other walker twice."""
    return 2 - np.arange(walkers) % 2


def walk(walkers, steps, p, rng):
    """Return the positions (walkers, steps + 1) of walkers on a line, from 0."""
    step = np.where(rng.random((walkers, steps)) < p, 1, -1)
    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])


ask = {"walkers": 25, "steps": 20, "p": uniform(0.05, 0.95), "rng": generator()}
counted = mistake("1, -1)", "1, 0)", "wrong-quantity", "the steps to the right are counted: a step to the left is 0 instead of −1")
wrong = [
    counted,
    mistake("< p", "> p", "wrong-comparison", "p is the probability of a step to the left"),
    mistake("< p", "< 0.5", "missing-term", "both directions are equally likely, whatever p is"),
    mistake("(rng.random((walkers, steps))", "(rng.random((walkers, 1)) * np.ones(steps)"),
    OTHER_GENERATOR,
]
each = "(np.diff(walk(walkers, steps, p, rng)) + 1) / 2"
each_step = samples(walk, ask, "bernoulli", p=lambda p: p, call=each, repetitions=160, label="steps of walk", mistakes=wrong)
zeros = "steps)) < p, 1, -1)\n    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])"
late = "steps + 1)) < p, 1, -1)\n    return np.cumsum(step, axis=1)"
wrong = [
    counted,
    mistake(zeros, late, "off-by-one", "the first column is the place after the first step, ±1, instead of 0"),
    mistake("rng.random((walkers, steps))", "rng.random(steps) * np.ones((walkers, 1))"),
    mistake("np.cumsum", "1 + np.cumsum", "extra-term", "each walker is one place too far to the right"),
]
ask = {**ask, "steps": integers(6, 20)}
right = {"n": lambda steps: steps, "p": lambda p: p, "label": "end points of walk", "repetitions": 160}
ends = "(np.array(walk(walkers, steps, p, rng))[:, -1] + steps) / 2"
end_points = samples(walk, ask, "binom", **right, call=ends, mistakes=wrong)


def place(walkers, steps, p):
    """Return the expected weighted sum of the last places."""
    return weights(walkers).sum() * steps * (2 * p - 1)


def scatter(walkers, steps, p):
    """Return its standard deviation if the walkers are independent."""
    return sqrt((weights(walkers) ** 2).sum() * 4 * steps * p * (1 - p))


ask = {"walkers": integers(20, 30), "steps": integers(2, 3), "p": uniform(0.1, 0.9), "rng": generator()}
dealt = "rng.permutation((np.arange(walkers * steps) + 0.5) / (walkers * steps)).reshape(walkers, steps)"
halves = "np.resize(rng.random((walkers // 2, steps)), (walkers, steps))"
wrong = [
    counted,
    mistake("rng.random((walkers, steps))", dealt),  # as many steps to the right as expected, in random order
    mistake("rng.random((walkers, steps))", halves),  # the second half repeats the first
]
sums = {"call": TWICE.format("np.array(walk(walkers, steps, p, rng))[:, -1]"), "label": "weighted sum of walk", "repetitions": 1000}
place_sum = estimate(walk, ask, place, sd=scatter, **sums, mistakes=wrong)
notebook.exercise("1", "A walk with a bias", each_step, end_points, place_sum)


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


ask = {"walkers": 25, "t": uneven, "D": uniform(0.2, 2), "rng": generator()}
wrong = [
    mistake("2 * D", "4 * D", "constant-factor", "4Dt is the variance of x and y together, 2Dt that of one"),
    mistake("np.diff(t)", "t[1:]", "wrong-variable", "each step has the variance of the whole time"),
    mistake("np.cumsum(step, axis=1)", "np.sqrt(2 * D * t[1:])[:, None] * rng.normal(size=step.shape)"),
    mistake("rng.normal(size", "np.sqrt(3) * rng.uniform(-1, 1, size", "wrong-function", "steps are uniformly distributed"),
    OTHER_GENERATOR,
]
scaled = "np.diff(np.swapaxes(brownian(walkers, t, D, rng), 1, 2)) / np.sqrt(2 * D * np.diff(t))"
each_step = samples(brownian, ask, "norm", call=scaled, repetitions=160, label="steps of brownian", mistakes=wrong)
wrong = [
    mistake("1, 2)) *", "1, 1)) * np.ones(2) *", "wrong-index", "x and y take the same steps"),
    mistake(
        "rng.normal(size=(walkers, len(t) - 1, 2))",
        "np.repeat(rng.normal(size=(walkers // 2 + 1, len(t) - 1, 2)), 2, axis=0)[:walkers]",
    ),
]
scaled = "np.sum(np.array(brownian(walkers, t, D, rng))[:, -1] ** 2, axis=-1) / (4 * D * t[-1])"
squares = {"label": "squared displacement of brownian", "repetitions": 160}
end_points = samples(brownian, ask, "expon", call=scaled, **squares, mistakes=wrong)
ask = {**ask, "walkers": integers(20, 30), "t": lambda rng: uneven(rng)[:3]}
total = TWICE.format("np.sum(np.array(brownian(walkers, t, D, rng))[:, -1], axis=-1)")
wrong = [
    mistake("(step, axis=1)", "(step - step[::-1], axis=1) / np.sqrt(2)"),  # mirror images
    mistake("(step, axis=1)", "(np.resize(step[: walkers // 2], step.shape), axis=1)"),
]
widths = {"sd": lambda walkers, t, D: sqrt((weights(walkers) ** 2).sum() * 4 * D * t[-1]), "label": "weighted sum of brownian"}
place_sum = estimate(brownian, ask, 0, **widths, call=total, mistakes=wrong)
ask = {"t": uneven, "D": uniform(0.2, 2), "seed": integers(0, 999)}
started = "np.array(brownian(3, t, D, np.random.default_rng(seed)))[:, 0]"
agree = Value(Tolerance(atol=0, reason="the start is given"), label="brownian: all particles start at the origin")
wrong = [mistake("np.cumsum(step, axis=1)], axis=1)", "np.cumsum(step, axis=1)], axis=1) + 0.1")]
start = values(brownian, ask, agree, truth=lambda: np.zeros((3, 2)), call=started, mistakes=wrong)
notebook.exercise("3", "Brownian motion", each_step, end_points, place_sum, start)


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
    mistake("t, K, alpha:", "t, alpha, K:", "component-order", "the order is α, K instead of K, α"),
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
    mistake("found.std(ddof=1)", "0.85 * found.std(ddof=1)"),
    mistake("uniform(0, L, (3, n))", "uniform(0, L, n) * np.ones((3, 1))", "wrong-index", "x, y and z are the same number"),
    mistake("found.mean()", "np.median(found)", "wrong-function", "the median stands for the mean"),
    OTHER_GENERATOR,
]
error = Tolerance(limit=0.25, reason="five times the spread of the error of 400 points")
mean = Tolerance(limit=0.08, reason="errors from 20 batches of 20 points are 1.3 % too small, their mean of 400 scatters by 0.8 %")
integral = estimate(integrate, ask, cloud, sd=spread, error=error, mean_error=mean, mistakes=wrong)
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


def moment(walkers, steps, start, p):
    """Return the expected weighted sum of the numbers."""
    return weights(walkers).sum() * np.dot(*ballot(steps, start, p))


def deviation(walkers, steps, start, p):
    """Return the standard deviation of the weighted sum."""
    number, chance = np.array(ballot(steps, start, p))
    return sqrt((weights(walkers) ** 2).sum() * (np.dot(number**2, chance) - np.dot(number, chance) ** 2))


ask = {"walkers": 25, "steps": 30, "start": integers(1, 5), "p": uniform(0.05, 0.7), "rng": generator()}
reverse = "p is the probability of a step to the left"
wrong = [
    mistake("there.argmax(axis=1)", "there.argmax(axis=1) - 1", "off-by-one", "the first step has the number 0"),
    mistake("steps + 1)", "steps)", "off-by-one", "walkers that do not arrive get the number steps"),
    mistake("start + walk", "walk", "missing-term", "the walkers start at 0"),
    mistake("there.argmax", "steps - there[:, ::-1].argmax", "wrong-function", "the last passage stands for the first"),
    mistake("start + walk", "start - walk", "wrong-comparison", reverse),
    mistake("p, rng) ==", "1 - p, rng) ==", "wrong-comparison", reverse),
    mistake("p, rng) ==", "p, np.random.default_rng()) =="),
]
repeat = mistake("walk(walkers, steps, p, rng)", "np.repeat(walk(walkers // 2 + 1, steps, p, rng), 2, axis=0)[:walkers]")
asked = {"repetitions": 160, "uses": [walk], "mistakes": [*wrong, repeat]}
passage = samples(first_passage, ask, "rv_discrete", values=ballot, **asked)
ask = {"walkers": integers(20, 30), "steps": choice(2, 4), "start": 2, "p": uniform(0.1, 0.5), "rng": generator()}
wrong += [
    mistake(" == 0\n", " == 0\n    there[:, -1] = False\n", "off-by-one", "walkers that arrive at the last step get steps + 1"),
    mistake("walk(walkers, steps, p, rng)", "np.resize(walk(walkers // 2, steps, p, rng), (walkers, steps + 1))"),
]
asked = {"call": TWICE.format("first_passage(walkers, steps, start, p, rng)"), "label": "weighted sum of first_passage"}
short = estimate(first_passage, ask, moment, sd=deviation, **asked, repetitions=600, uses=[walk], mistakes=wrong)
notebook.exercise("6", "First passage", passage, short)


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
    mistake("295.15", "22", "units", "the temperature is in degrees Celsius, not in K"),
    mistake("0.5e-6", "0.5", "units", "the radius is in µm, not in m"),
    mistake("0.5e-6", "1e-6", "constant-factor", "the diameter stands for the radius"),
]
digits = Tolerance(rtol=1e-9, atol=0, reason="rounding errors of a thousand steps, a thousand times")
cell = variables(boltzmann, exact, agree=dict.fromkeys(exact, digits), mistakes=wrong)
notebook.exercise("7", "Boltzmann's constant from a track", cell)
