"""Random walks and Monte Carlo: seven exercises, their exact answers and known mistakes.

Each truth has a second source in tests/exercises/test_random_walks.py: the master equation in exact fractions
(1, 6), all resampled means (2), the diffusion equation (3), Newton's method in 50 digits (4), a product rule
of quadrature (5), exact integers (7). Sums over a few walkers do not show that one of many walkers repeats or
mirrors another; the correlations of all pairs do.
"""

from math import comb, erf, pi, sqrt
from statistics import variance

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import rv_discrete

from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.random import estimate, generator, samples
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author import (
    Notebook,
    Tolerance,
    Value,
    family,
    integers,
    mistake,
    uniform,
)

notebook = Notebook("Random walks and Monte Carlo", notebook="notebook.ipynb", data=("track.csv",))
ROUNDING = Tolerance(limit=1e-12, reason="a thousand rounding errors")
OTHER_GENERATOR = mistake("rng.", "np.random.default_rng().")
# of rows, or of columns
PAIRS = "(lambda d: max(np.abs(np.triu(np.corrcoef(one), 1)).max() for one in (d, d.T)))"
APART = Tolerance(
    atol=0.7, reason="six times the spread of the correlation of two times 80 independent numbers"
)


def ends(low, high):
    """Return a draw from the lowest or the highest tenth of a range."""
    return lambda rng: low + (high - low) * abs(rng.choice([0, 1]) - rng.uniform(0, 0.1))


def walk(walkers, steps, p, rng):
    """Return the positions (walkers, steps + 1) of walkers on a line, from 0."""
    step = np.where(rng.random((walkers, steps)) < p, 1, -1)
    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])


ask = {"walkers": 25, "steps": 20, "p": uniform(0.05, 0.95), "rng": generator()}
counted = mistake(
    "1, -1)",
    "1, 0)",
    "wrong-quantity",
    "the steps to the right are counted: a step to the left is 0 instead of −1",
)
wrong = [
    counted,
    mistake("< p", "> p", "wrong-comparison", "p is the probability of a step to the left"),
    mistake("< p", "< 0.5", "missing-term", "both directions are equally likely, whatever p is"),
    mistake("(rng.random((walkers, steps))", "(rng.random((walkers, 1)) * np.ones(steps)"),
    OTHER_GENERATOR,
]
each = "(np.diff(walk(walkers, steps, p, rng)) + 1) / 2"
each_step = samples(
    walk, ask, "bernoulli", p=lambda p: p, call=each, repetitions=160, label="steps of walk", mistakes=wrong
)
zeros = "steps)) < p, 1, -1)\n    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])"
late = "steps + 1)) < p, 1, -1)\n    return np.cumsum(step, axis=1)"
dealt = "rng.permutation((np.arange(walkers * steps) + 0.5) / (walkers * steps)).reshape(walkers, steps)"
wrong = [
    counted,
    mistake(
        zeros, late, "off-by-one", "the first column is the place after the first step, ±1, instead of 0"
    ),
    mistake("np.cumsum", "1 + np.cumsum", "extra-term", "each walker is one place too far to the right"),
    mistake("rng.random((walkers, steps))", dealt),  # as many steps to the right as expected, in random order
]
total = "sum(np.sum(np.array(walk(n, 30 // n, p, rng))[:, -1]) for n in (1, 2, 3, 30))"  # of 120 steps
sums = {
    "sd": lambda p: sqrt(480 * p * (1 - p)),
    "call": total,
    "label": "sums of places of walk",
    "repetitions": 1000,
}
place_sum = estimate(
    walk, {"p": ends(0.05, 0.95), "rng": generator()}, lambda p: 120 * (2 * p - 1), **sums, mistakes=wrong
)
wrong = [
    mistake("rng.random((walkers, steps))", "np.resize(rng.random((64, steps)), (walkers, steps))"),
    mistake("rng.random((walkers, steps))", "np.resize(rng.random((walkers, 64)), (walkers, steps))"),
    # the last walker mirrors the first
    mistake("np.cumsum(step,", "np.cumsum(np.vstack([step[:-1], -step[:1]]),"),
]
apart = Value(APART, label="walk: neither walkers nor steps repeat or mirror each other")
ask = {"p": uniform(0.45, 0.55), "seed": integers(0, 999)}
call = PAIRS + "(np.diff(walk(80, 80, p, np.random.default_rng(seed))))"
pairs = values(walk, ask, apart, truth=lambda: 0, call=call, rows=(1, 2), mistakes=wrong)
notebook.exercise("1", "A walk with a bias", each_step, place_sum, pairs)


def mean_square(r):
    """Return the mean squared displacement (times,) in µm² of tracks r (walkers, times, 2) in µm, and its
    error.
    """
    square = np.sum((r - r[:, :1]) ** 2, axis=2)
    return square.mean(axis=0), square.std(axis=0, ddof=1) / np.sqrt(len(r))


def by_moments(r):
    """Return the same from the moments of the coordinates."""
    x, y = np.moveaxis(r - r[:, :1], 2, 0)
    second, fourth = np.mean(x * x + y * y, axis=0), np.mean(x**4 + y**4 + 2 * x * x * y * y, axis=0)
    return second, np.sqrt((fourth - second**2) / (len(r) - 1))


wrong = [
    mistake(" - r[:, :1]", "", "missing-term", "the start of each walker is not subtracted"),
    mistake(
        " / np.sqrt(len(r))", "", "missing-division", "the error is the spread of one walker, not of the mean"
    ),
    mistake(
        ", ddof=1", "", "missing-argument", "the variance divides by the number of walkers, not by one less"
    ),
    mistake(
        "np.sqrt(len(r))", "len(r)", "wrong-power", "the square root of the number of walkers is missing"
    ),
]
agree = {"msd": ROUNDING, "error": ROUNDING}
tracks = lambda rng: 5 * rng.uniform(-1, 1, (9, 1, 2)) + rng.normal(size=(9, 6, 2)).cumsum(axis=1)  # noqa: E731
msd = values(mean_square, {"r": tracks}, truth=by_moments, agree=agree, mistakes=wrong)
notebook.exercise("2", "The mean squared displacement and its error", msd)


def brownian(walkers, t, D, rng):
    """Return the positions (walkers, times, 2) in µm at the times t (times,) in s, from the origin; D in
    µm²/s.
    """
    step = rng.normal(size=(walkers, len(t) - 1, 2)) * np.sqrt(2 * D * np.diff(t))[:, None]
    return np.concatenate([np.zeros((walkers, 1, 2)), np.cumsum(step, axis=1)], axis=1)


def uneven(intervals):
    """Return a draw of times at very uneven intervals, from 0."""
    return lambda rng: np.append(0, np.cumsum(np.exp(rng.uniform(np.log(0.02), np.log(2), intervals))))


ask = {"walkers": 25, "t": uneven(5), "D": uniform(0.2, 2), "rng": generator()}
wrong = [
    mistake("2 * D", "4 * D", "constant-factor", "4Dt is the variance of x and y together, 2Dt that of one"),
    mistake("np.diff(t)", "t[1:]", "wrong-variable", "each step has the variance of the whole time"),
    mistake("np.cumsum(step, axis=1)", "np.sqrt(2 * D * t[1:])[:, None] * rng.normal(size=step.shape)"),
    mistake(
        "rng.normal(size",
        "np.sqrt(3) * rng.uniform(-1, 1, size",
        "wrong-function",
        "steps are uniformly distributed",
    ),
    OTHER_GENERATOR,
]
scaled = "np.diff(np.swapaxes(brownian(walkers, t, D, rng), 1, 2)) / np.sqrt(2 * D * np.diff(t))"
each_step = samples(
    brownian, ask, "norm", call=scaled, repetitions=160, label="steps of brownian", mistakes=wrong
)
ask = {"t": uneven(2), "D": uniform(0.2, 2), "rng": generator()}
total = "sum(np.sum(np.array(brownian(n, t, D, rng))[:, -1]) for n in (1, 2, 3))"
moved = mistake(
    "np.cumsum(step, axis=1)], axis=1)",
    "np.cumsum(step, axis=1)], axis=1) + 1",
    "extra-term",
    "all places are moved",
)
wrong = [
    moved,
    mistake("1, 2)) *", "1, 1)) * np.ones(2) *", "wrong-index", "x and y take the same steps"),
    mistake("(step, axis=1)", "(step - step[::-1], axis=1) / np.sqrt(2)"),  # mirror images
]
sums = {"sd": lambda t, D: sqrt(24 * D * t[-1]), "call": total, "label": "sums of places of brownian"}
place_sum = estimate(brownian, ask, 0, **sums, mistakes=wrong)
wrong = [moved, mistake("(step, axis=1)", "(np.resize(step[: walkers // 2], step.shape), axis=1)")]
agree = {
    "start": Value(
        Tolerance(atol=0, reason="the start is given"), label="brownian: all particles start at the origin"
    ),
    "pairs": Value(
        APART, label="brownian: neither coordinates of particles nor steps repeat or mirror each other"
    ),
}
ask = {"t": uneven(80), "D": uniform(0.2, 2), "seed": integers(0, 999)}
scaled = "(np.diff(np.swapaxes(r, 1, 2)).reshape(80, 80) / np.sqrt(np.diff(t)))"
call = (
    f"(lambda r: (np.abs(r[:, 0]).max(), {PAIRS}{scaled}))(np.array(brownian(40, t, D,"
    " np.random.default_rng(seed))))"
)
pairs = values(brownian, ask, agree, truth=lambda: (0, 0), call=call, rows=(1, 2), mistakes=wrong)
notebook.exercise("3", "Brownian motion", each_step, place_sum, pairs)


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
times, drawn = np.geomspace(0.1, 10, 15), {"K": uniform(0.6, 2), "alpha": ends(0.5, 1.1)}
near = Tolerance(
    limit=0.05,
    reason="of a standard deviation: four times what the least exact optimizer, Nelder-Mead, deviates",
)
fitted = fit(
    fit_diffusion, power_law, x=times, sigma=0.12 * times, drawn=drawn, agree=(near, near), mistakes=wrong
)
notebook.exercise("4", "Anomalous diffusion: a fit", fitted)


def integrate(f, L, n, rng):
    """Return the Monte Carlo estimate of the integral of f(x, y, z) over the cube from 0 to L,
    and its error.
    """
    found = L**3 * f(*rng.uniform(0, L, (3, n)))
    return found.mean(), found.std(ddof=1) / np.sqrt(n)


def cloud(k, L):
    """Return the exact integral, which factorizes."""
    return (sqrt(pi / k) / 2 * erf(sqrt(k) * L)) ** 3


def spread(k, L, n):
    """Return the standard deviation of an estimate."""
    return sqrt((L**3 * cloud(2 * k, L) - cloud(k, L) ** 2) / n)


density = family("exp(-k * (x**2 + y**2 + z**2))", "x", "y", "z", k=uniform(0.2, 0.5))
ask = {"f": density, "L": uniform(1, 2), "n": 400, "rng": generator()}
wrong = [
    mistake("L**3 * ", "", "missing-term", "the volume L³ is missing"),
    mistake(" / np.sqrt(n)", "", "missing-division", "the error is the spread of one point, not of the mean"),
    mistake("found.std(ddof=1)", "1.5 * found.std(ddof=1)"),
    mistake("found.std(ddof=1)", "0.85 * found.std(ddof=1)"),
    mistake(
        "uniform(0, L, (3, n))",
        "uniform(0, L, n) * np.ones((3, 1))",
        "wrong-index",
        "x, y and z are the same number",
    ),
    mistake("found.mean()", "np.median(found)", "wrong-function", "the median stands for the mean"),
    OTHER_GENERATOR,
]
error = Tolerance(limit=0.25, reason="five times the spread of the error of 400 points")
mean = Tolerance(
    limit=0.08,
    reason="errors from 20 batches of 20 points are 1.3 % too small, their mean of 400 scatters by 0.8 %",
)
integral = estimate(integrate, ask, cloud, sd=spread, error=error, mean_error=mean, mistakes=wrong)
seen = "seen.extend(np.reshape(np.stack(np.broadcast_arrays(x, y, z), -1), (-1, 3)).tolist())"
# each once: a right function may use f twice at each
points = "np.resize(list(dict.fromkeys(map(tuple, seen))), (n, 3))"
call = (
    f"(lambda seen: (integrate(lambda x, y, z: ({seen}, np.add(x, np.multiply(y, z)))[1], L, n, rng),"
    f" {points})[1])([])"
)
wrong = [
    mistake(
        "uniform(0, L, (3, n))",
        "uniform(0, L, n) * np.ones((3, 1))",
        "wrong-index",
        "x, y and z are the same number",
    ),
    # of a grid
    mistake("uniform(0, L, (3, n))", "integers(0, 10, (3, n)) * L / 10 + rng.uniform(0, 1e-9, (3, n))"),
]
ask = {"L": uniform(1, 2), "n": 100, "rng": generator()}
points = {"scale": lambda L: L, "call": call, "label": "points of integrate", "repetitions": 100}
uniform_points = samples(integrate, ask, "uniform", **points, mistakes=wrong)
notebook.exercise("5", "Monte Carlo integration", integral, uniform_points)


def first_passage(walkers, steps, start, p, rng):
    """Return the number (walkers,) of the step that first takes each walker from start to 0, or steps + 1."""
    there = start + walk(walkers, steps, p, rng) == 0
    return np.where(there.any(axis=1), there.argmax(axis=1), steps + 1)


def ballot(steps, start, p):
    """Return the numbers from 1 to steps + 1 and their probabilities (2, steps + 1),
    by the ballot theorem.
    """
    right = {k: (k - start) // 2 for k in range(start, steps + 1, 2)}
    chance = {k: start / k * comb(k, m) * p**m * (1 - p) ** (k - m) for k, m in right.items()}
    chance[steps + 1] = 1 - sum(chance.values())
    return [range(1, steps + 2), [chance.get(k, 0) for k in range(1, steps + 2)]]


ask = {"walkers": 25, "steps": 30, "start": integers(1, 5), "p": uniform(0.05, 0.7), "rng": generator()}
reverse = "p is the probability of a step to the left"
wrong = [
    mistake(
        "there.argmax(axis=1)", "there.argmax(axis=1) - 1", "off-by-one", "the first step has the number 0"
    ),
    mistake("steps + 1)", "steps)", "off-by-one", "walkers that do not arrive get the number steps"),
    mistake("start + walk", "walk", "missing-term", "the walkers start at 0"),
    mistake(
        "there.argmax",
        "steps - there[:, ::-1].argmax",
        "wrong-function",
        "the last passage stands for the first",
    ),
    mistake("start + walk", "start - walk", "wrong-comparison", reverse),
    mistake("p, rng) ==", "1 - p, rng) ==", "wrong-comparison", reverse),
    mistake("p, rng) ==", "p, np.random.default_rng()) =="),
]
repeat = mistake(
    "walk(walkers, steps, p, rng)", "np.repeat(walk(walkers // 2 + 1, steps, p, rng), 2, axis=0)[:walkers]"
)
asked = {"repetitions": 160, "uses": [walk], "mistakes": [*wrong, repeat]}
passage = samples(first_passage, ask, "rv_discrete", values=ballot, **asked)
wrong += [
    mistake(
        " == 0\n",
        " == 0\n    there[:, -1] = False\n",
        "off-by-one",
        "walkers that arrive at the last step get steps + 1",
    ),
    mistake(
        "walk(walkers, steps, p, rng)",
        "np.resize(walk((walkers + 1) // 2, steps, p, rng), (walkers, steps + 1))",
    ),
]
ask = {"steps": 4, "p": uniform(0.1, 0.5), "rng": generator()}
total = "sum(np.sum(first_passage(n, steps, 2, p, rng)) for n in (1, 2, 3, 6))"
sums = {
    "call": total,
    "label": "sums of first_passage",
    "repetitions": 800,
    "uses": [walk],
    "mistakes": wrong,
}
arrival = lambda steps, p: rv_discrete(values=ballot(steps, 2, p))  # noqa: E731
mean, sd = lambda steps, p: 12 * arrival(steps, p).mean(), lambda steps, p: sqrt(12) * arrival(steps, p).std()
few = estimate(first_passage, ask, mean, sd=sd, **sums)
ask = {"steps": integers(1, 3), "p": uniform(0.1, 0.5), "seed": integers(0, 999)}
none = Value(
    Tolerance(atol=0, reason="integers"), label="first_passage: no walker arrives in fewer steps than start"
)
wrong = [
    mistake("steps + 1)\n", "steps)\n", "off-by-one", "walkers that do not arrive get the number steps"),
    mistake("steps + 1)\n", "max(start, steps))\n"),
]
call = "first_passage(2, steps, 5, p, np.random.default_rng(seed))"
late = values(
    first_passage,
    ask,
    none,
    truth=lambda steps: [steps + 1] * 2,
    call=call,
    rows=(1, 2),
    uses=[walk],
    mistakes=wrong,
)
notebook.exercise("6", "First passage", passage, few, late)


def boltzmann(r, dt, T, eta, a):
    """Return the drift (2,) of a particle's track r (N + 1, 2), its diffusion constant with error, and
    Boltzmann's constant.
    """
    step = np.diff(r, axis=0)
    D = step.var(axis=0, ddof=1).sum() / (4 * dt)
    return step.mean(axis=0) / dt, D, D / np.sqrt(len(step) - 1), 6 * np.pi * eta * a * 1e-6 * D * 1e-12 / T


def by_sums(r, dt, T, eta, a):
    """Return the same from the exact sums of the statistics module."""
    D = sum(map(variance, np.diff(r, axis=0).T.tolist())) / (4 * dt)
    return (r[-1] - r[0]) / (dt * (len(r) - 1)), D, D / sqrt(len(r) - 2), 6e-18 * pi * eta * a * D / T


ask = {
    "r": lambda rng: rng.normal(rng.uniform(-0.5, 0.5, 2), 0.7, (300, 2)).cumsum(axis=0),
    "dt": uniform(0.1, 2),
}
ask |= {"T": uniform(275, 320), "eta": uniform(5e-4, 2e-3), "a": uniform(0.2, 2)}
wrong = [
    mistake(" / dt", "", "missing-division", "the drift is that of a step, not of a second"),
    mistake(
        "step.var(axis=0, ddof=1)", "np.mean(step**2, axis=0)", "missing-term", "the drift is not subtracted"
    ),
    mistake(
        ", ddof=1", "", "missing-argument", "the variance divides by the number of steps, not by one less"
    ),
    mistake(
        "len(step) - 1",
        "2 * len(step)",
        "constant-factor",
        "the error divides by the root of 2N, not of N − 1",
    ),
    mistake("1e-12 / T", "1 / T", "units", "D is in µm²/s, not in m²/s"),
    mistake("/ T", "/ (T - 273.15)", "units", "the temperature is in degrees Celsius, not in K"),
    mistake("a * 1e-6", "a", "units", "the radius is in µm, not in m"),
    mistake("a * 1e-6", "2e-6 * a", "constant-factor", "the diameter stands for the radius"),
]
digits = Tolerance(rtol=1e-9, atol=0, reason="rounding errors of a thousand steps, a thousand times")
names = ("drift", "D", "D_error", "k_B")
of_track = values(boltzmann, ask, dict.fromkeys(names, digits), truth=by_sums, mistakes=wrong)
notebook.exercise("7", "Boltzmann's constant from a track", of_track)
