"""Random walks and Monte Carlo: what is asked about notebook.ipynb, which holds text, Setup and solutions.

Most exercises ask for random numbers. One number says nothing; the law of many does. Such a function is
therefore called many times with new generators, and a question compares either all numbers with an exact
distribution (``ask.samples``) or mean and spread of a sum with exact ones (``ask.estimate``). What neither
sees, such as a walker that repeats another, a question about one statistic of a large array tells
(``ask.function``).

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

Every truth has a second source in tests/exercises/test_random_walks.py.
"""

from math import comb, erf, log, pi, sqrt
from statistics import variance

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import rv_discrete

from exercises.authoring import (
    Notebook,
    Value,
    absolute,
    at_most,
    between,
    close,
    expression,
    generator,
    in_turn,
    integer,
    relative,
)

notebook = Notebook("notebook.ipynb", data=("track.csv",))

any_seed = integer(0, 999)


def near_an_end(low, high):
    """Return the draw of a number from the lowest or the highest tenth of a range, where the middle of the
    range in its place shows most.
    """

    def draw(rng):
        low_end = rng.uniform(low, low + (high - low) / 10)
        high_end = rng.uniform(high - (high - low) / 10, high)
        return rng.choice([low_end, high_end])

    return draw


def uneven_times(intervals):
    """Return the draw of times in s from 0, at intervals from 0.02 s to 2 s."""

    def draw(rng):
        lengths = np.exp(rng.uniform(log(0.02), log(2), intervals))
        return np.append(0, np.cumsum(lengths))

    return draw


def largest_correlation(numbers):
    """Return the largest correlation, of either sign, of two rows or of two columns of an array.

    Sums over a few walkers do not show that one of many repeats or mirrors another: this does. A constant row
    or column, which has no correlation, counts as repeated.
    """
    with np.errstate(invalid="ignore"):
        correlations = [np.corrcoef(rows) for rows in (numbers, numbers.T)]
    largest = np.max([np.abs(np.triu(one, 1)).max() for one in correlations])
    return 1.0 if np.isnan(largest) and np.isfinite(numbers).all() else largest


apart = absolute(
    0.85,
    because="a repeated or mirrored row has the correlation 1; of the 3160 pairs of independent rows, and as"
    " many of columns, of 80 numbers ±1 one reaches 0.85 in about one of 100,000,000,000 gradings, of normal"
    " numbers far more rarely",
)


@notebook.exercise("1")
def walk_with_a_bias(ask):
    """Walkers from 0, whose steps are +1 with probability p and otherwise -1."""
    steps = ask.samples(
        "walk", "bernoulli", parameters={"p": lambda p: p}, repetitions=160, label="steps of walk"
    )
    steps.case("25 walkers", walkers=25, steps=20, p=between(0.05, 0.95), rng=generator())

    @steps.observe
    def steps_to_the_right(walk, walkers, steps, p, rng):
        """1 for each step to the right and 0 for each to the left: 1 with probability p."""
        return (np.diff(walk(walkers, steps, p, rng)) + 1) / 2

    counted = "the steps to the right are counted: a step to the left is 0 instead of −1"
    steps.mistake("wrong-quantity", counted, change="1, -1) -> 1, 0)")
    steps.mistake("wrong-comparison", "p is the probability of a step to the left", change="< p -> > p")
    steps.mistake("missing-term", "both directions are equally likely, whatever p is", change="< p -> < 0.5")
    # one number for all steps of a walker
    steps.mistake(change="(rng.random((walkers, steps)) -> (rng.random((walkers, 1)) * np.ones(steps)")
    # not from the generator that is given
    steps.mistake(change="rng. -> np.random.default_rng().")

    sums = ask.estimate(
        "walk", sd=lambda p: sqrt(480 * p * (1 - p)), repetitions=1000, label="sums of places of walk"
    )
    sums.case("few walkers", p=near_an_end(0.05, 0.95), rng=generator())

    @sums.observe
    def sum_of_last_places(walk, p, rng):
        """The sum of the last places of 1, 2, 3 and 30 walkers with 30, 15, 10 and 1 steps."""
        return sum(np.sum(np.array(walk(n, 30 // n, p, rng))[:, -1]) for n in (1, 2, 3, 30))

    @sums.truth
    def of_120_steps(p):
        """The sum consists of 120 independent steps of the mean p - q and the variance 4pq."""
        return 120 * (2 * p - 1)

    sums.mistake("wrong-quantity", counted, change="1, -1) -> 1, 0)")

    @sums.mistake("off-by-one", "the first column is the place after the first step, ±1, instead of 0")
    def first_step_at_once(walkers, steps, p, rng):
        return np.cumsum(np.where(rng.random((walkers, steps + 1)) < p, 1, -1), axis=1)

    sums.mistake(
        "extra-term",
        "each walker is one place too far to the right",
        change="np.cumsum -> 1 + np.cumsum",
    )

    @sums.mistake()
    def as_many_steps_to_the_right_as_expected(walkers, steps, p, rng):
        """Deal a fixed number of steps to the right in random order. The mean is right, but the sum never
        varies.
        """
        count = walkers * steps
        dealt = rng.permutation((np.arange(count) + 0.5) / count).reshape(walkers, steps)
        step = np.where(dealt < p, 1, -1)
        return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])

    sums.mistake(
        "wrong-index",
        "one sequence of random numbers serves all walkers",
        change="rng.random((walkers, steps)) -> rng.random(steps) * np.ones((walkers, 1))",
    )

    pairs = ask.function("walk", label="walk: neither walkers nor steps repeat or mirror each other")
    pairs.case("80 walkers", public=1, hidden=2, p=between(0.45, 0.55), seed=any_seed)

    @pairs.observe
    def correlation_of_80_walkers(walk, p, seed):
        return largest_correlation(np.diff(walk(80, 80, p, np.random.default_rng(seed))))

    @pairs.truth(agree=apart)
    def no_correlation():
        return 0

    # walkers from the 65th on repeat
    pairs.mistake(
        change="rng.random((walkers, steps)) -> np.resize(rng.random((64, steps)), (walkers, steps))"
    )
    # np.resize fills row by row, so with 80 steps walkers from the 65th on repeat again
    pairs.mistake(
        change="rng.random((walkers, steps)) -> np.resize(rng.random((walkers, 64)), (walkers, steps))"
    )

    @pairs.mistake()
    def last_walker_mirrors_the_first(walkers, steps, p, rng):
        step = np.where(rng.random((walkers, steps)) < p, 1, -1)
        mirrored = np.vstack([step[:-1], -step[:1]])
        return np.hstack([np.zeros((walkers, 1)), np.cumsum(mirrored, axis=1)])

    far = ask.function("walk", label="walk: every step of a walk beyond 128 places is +1 or −1")
    far.case("300 steps", in_turn(mostly_to_the_left, mostly_to_the_right), public=2, hidden=2)

    @far.observe
    def largest_error_of_a_step(walk, p, seed):
        """How far the steps of long walks are from ±1. An int8 ends at −128 and 127, and then jumps."""
        places = np.array(walk(3, 300, p, np.random.default_rng(seed)), dtype=float)
        return np.abs(np.abs(np.diff(places)) - 1).max()

    @far.truth(agree=absolute(0, because="steps are integers"))
    def no_error():
        return 0

    far.mistake(
        "wrong-option",
        "the places are 8-bit integers, which end at −128 and 127",
        change="np.cumsum(step, axis=1) -> np.cumsum(step, axis=1, dtype=np.int8)",
    )


@notebook.draw
def mostly_to_the_left(draw):
    return {"p": draw(between(0.05, 0.1)), "seed": draw(any_seed)}


@notebook.draw
def mostly_to_the_right(draw):
    return {"p": draw(between(0.9, 0.95)), "seed": draw(any_seed)}


@notebook.draw
def tracks(draw):
    """Nine tracks of six positions in µm, which start at different places."""
    start = draw.rng.uniform(-5, 5, (9, 1, 2))
    return {"r": start + draw.rng.normal(size=(9, 6, 2)).cumsum(axis=1)}


@notebook.exercise("2")
def mean_squared_displacement(ask):
    """The mean squared displacement from the own start, over walkers, and its standard error."""
    mean_square = ask.function("mean_square", inputs=tracks, returns="msd error")

    @mean_square.truth(agree=relative(1e-12, because="a thousand rounding errors"))
    def by_moments(r):
        """With s = x² + y² the sample variance is N/(N - 1) times (mean of s² less square of the mean of s),
        and the error its root over √N.
        """
        x, y = np.moveaxis(r - r[:, :1], 2, 0)
        second = np.mean(x * x + y * y, axis=0)
        fourth = np.mean(x**4 + y**4 + 2 * x * x * y * y, axis=0)
        return second, np.sqrt((fourth - second**2) / (len(r) - 1))

    mean_square.mistake(
        "missing-term", "the start of each walker is not subtracted", change="(r - r[:, :1]) -> (r)"
    )
    mean_square.mistake(
        "missing-division",
        "the error is the spread of one walker, not of the mean",
        change=" / np.sqrt(len(r)) -> ",
    )
    mean_square.mistake(
        "missing-argument",
        "the variance divides by the number of walkers, not by one less",
        change=", ddof=1 -> ",
    )
    mean_square.mistake(
        "wrong-power",
        "the square root of the number of walkers is missing",
        change="np.sqrt(len(r)) -> len(r)",
    )


@notebook.exercise("3")
def brownian_motion(ask):
    """Particles whose coordinates change by normal numbers of the variance 2 D Δt in each interval."""
    steps = ask.samples("brownian", "norm", repetitions=160, label="steps of brownian")
    steps.case("25 particles", walkers=25, t=uneven_times(5), D=between(0.2, 2), rng=generator())

    @steps.observe
    def steps_in_their_spread(brownian, walkers, t, D, rng):
        """The steps (walkers, 2, intervals) in units of sqrt(2 D Δt): standard normal numbers."""
        return np.diff(np.swapaxes(brownian(walkers, t, D, rng), 1, 2)) / np.sqrt(2 * D * np.diff(t))

    steps.mistake(
        "constant-factor",
        "4Dt is the variance of x and y together, 2Dt that of one",
        change="2 * D -> 4 * D",
    )
    steps.mistake(
        "wrong-variable",
        "each step has the variance of the whole time",
        change="np.diff(t) -> t[1:]",
    )
    # normal numbers of the right variance at each time, but not of one path
    steps.mistake(
        change="np.cumsum(step, axis=1) -> np.sqrt(2 * D * t[1:])[:, None] * rng.normal(size=step.shape)"
    )
    steps.mistake(
        "wrong-function",
        "steps are uniformly distributed",
        change="rng.normal(size -> np.sqrt(3) * rng.uniform(-1, 1, size",
    )
    # not from the generator that is given
    steps.mistake(change="rng. -> np.random.default_rng().")

    sums = ask.estimate("brownian", sd=lambda t, D: sqrt(24 * D * t[-1]), label="sums of places of brownian")
    sums.case("few particles", t=uneven_times(2), D=between(0.2, 2), rng=generator())

    @sums.observe
    def sum_of_last_coordinates(brownian, t, D, rng):
        """The sum of x + y at the last time over 1, 2 and 3 particles: 12 coordinates."""
        return sum(np.sum(np.array(brownian(n, t, D, rng))[:, -1]) for n in (1, 2, 3))

    @sums.truth
    def at_the_origin():
        """Each coordinate has the mean 0 and the variance 2 D t, that of 12 is 24 D t."""
        return 0

    moved = "np.cumsum(step, axis=1)], axis=1) -> np.cumsum(step, axis=1)], axis=1) + 1"
    sums.mistake("extra-term", "all places are moved", change=moved)
    sums.mistake("wrong-index", "x and y take the same steps", change="1, 2)) * -> 1, 1)) * np.ones(2) *")
    # particles move as mirror images of each other
    sums.mistake(change="(step, axis=1) -> (step - step[::-1], axis=1) / np.sqrt(2)")

    pairs = ask.function("brownian", returns="start pairs")
    pairs.case("40 particles", public=1, hidden=2, t=uneven_times(80), D=between(0.2, 2), seed=any_seed)

    @pairs.observe
    def start_and_correlation(brownian, t, D, seed):
        """The largest coordinate at t = 0, and the correlation of 80 coordinates with 80 steps each."""
        r = np.array(brownian(40, t, D, np.random.default_rng(seed)))
        steps = np.diff(np.swapaxes(r, 1, 2)).reshape(80, 80)
        return np.abs(r[:, 0]).max(), largest_correlation(steps / np.sqrt(np.diff(t)))

    @pairs.truth
    def neither():
        return 0, 0

    pairs.agree(
        start=Value(
            absolute(0, because="the start is given"), label="brownian: all particles start at the origin"
        ),
        pairs=Value(
            apart,
            label="brownian: neither coordinates of particles nor steps repeat or mirror each other",
        ),
    )
    pairs.mistake("extra-term", "all places are moved", change=moved)
    # the second half of the particles repeats the first
    pairs.mistake(change="(step, axis=1) -> (np.resize(step[: walkers // 2], step.shape), axis=1)")

    many = ask.function("brownian", returns="kurtosis together", budget_s=20)
    many.case("250 particles", public=1, hidden=1, t=uneven_times(400), D=between(0.2, 2), seed=any_seed)

    @many.observe
    def kurtosis_and_correlation(brownian, t, D, seed):
        """The kurtosis of all 200,000 steps, each in its standard deviation; and the larger of the
        correlations of Δx with Δy and of Δx² with Δy², over all 100,000 pairs.
        """
        r = np.array(brownian(250, t, D, np.random.default_rng(seed)))
        steps = np.diff(r, axis=1) / np.sqrt(2 * D * np.diff(t))[:, None]
        x, y = steps.reshape(-1, 2).T
        kurtosis = np.mean(steps**4) / np.mean(steps**2) ** 2
        of_steps, of_squares = np.corrcoef(x, y)[0, 1], np.corrcoef(x**2, y**2)[0, 1]
        return kurtosis, max(abs(of_steps), abs(of_squares))

    @many.truth
    def of_independent_normal_numbers():
        """Normal numbers have the kurtosis 3: a fourth power has the mean 3 σ⁴. A sum of twelve uniform
        numbers has 2.9. Independent numbers have no correlation.
        """
        return 3, 0

    many.agree(
        kurtosis=Value(
            absolute(
                0.07,
                because="6.4 times the spread of the kurtosis of 200,000 numbers, 0.011: exceeded in fewer"
                " than one of 1,000,000,000 gradings",
            ),
            label="brownian: steps are as often far from their mean as normal numbers",
            statistic=True,
        ),
        together=Value(
            absolute(
                0.022,
                because="seven times the spread of a correlation of 100,000 pairs, 0.0032: exceeded in fewer"
                " than one of 1,000,000,000 gradings",
            ),
            label="brownian: Δx and Δy of a step are independent",
            statistic=True,
        ),
    )

    @many.mistake("wrong-function", "a sum of uniform numbers stands for a normal number")
    def sum_of_twelve_uniform_numbers(walkers, t, D, rng):
        normal = rng.random((12, walkers, len(t) - 1, 2)).sum(axis=0) - 6
        step = normal * np.sqrt(2 * D * np.diff(t))[:, None]
        return np.concatenate([np.zeros((walkers, 1, 2)), np.cumsum(step, axis=1)], axis=1)

    @many.mistake()
    def correlated_by_a_tenth(walkers, t, D, rng):
        x, z = rng.normal(size=(2, walkers, len(t) - 1))
        normal = np.stack([x, 0.1 * x + sqrt(0.99) * z], axis=2)
        step = normal * np.sqrt(2 * D * np.diff(t))[:, None]
        return np.concatenate([np.zeros((walkers, 1, 2)), np.cumsum(step, axis=1)], axis=1)


@notebook.exercise("4")
def anomalous_diffusion(ask):
    """The least-squares fit of 4 K t**alpha to data with errors, and the covariance of K and alpha."""

    def power_law(t, K, alpha):
        return 4 * K * t**alpha

    times = np.geomspace(0.1, 10, 15)
    near = at_most(
        0.05,
        because="of a standard deviation: four times what the least exact optimizer, Nelder-Mead, deviates",
    )
    fit = ask.fit(
        "fit_diffusion",
        power_law,
        x=times,
        sigma=0.12 * times,
        drawn={"K": between(0.6, 2), "alpha": near_an_end(0.5, 1.1)},
        parameters=near,
        covariance=near,
    )
    fit.mistake(
        "missing-term",
        "the errors of the data are not used",
        change=", sigma=sigma, absolute_sigma=True -> ",
    )
    fit.mistake(
        "wrong-option",
        "the covariance is scaled by χ²/(n − 2)",
        change="absolute_sigma=True -> absolute_sigma=False",
    )
    fit.mistake(
        "constant-factor",
        "the factor 4 of the model is missing",
        change="return 4 * K * t**alpha -> return K * t**alpha",
    )
    fit.mistake(
        "component-order",
        "the order is α, K instead of K, α",
        change="model(t, K, alpha) -> model(t, alpha, K)",
    )

    @fit.mistake()
    def straight_line_through_logarithms(t, msd, sigma):
        """Fit ln msd = ln 4K + alpha ln t."""
        line = lambda t, K, alpha: np.log(4 * K) + alpha * np.log(t)  # noqa: E731
        return curve_fit(line, t, np.log(msd), (1, 1), sigma / msd, absolute_sigma=True)


@notebook.exercise("5")
def monte_carlo_integration(ask):
    """The estimate of an integral over a cube from n uniform points, and its standard error."""

    def gaussian_cloud(k, L):
        """The integral of exp(-k r²) over the cube from 0 to L, which factorizes."""
        return (sqrt(pi / k) / 2 * erf(sqrt(k) * L)) ** 3

    def spread(k, L, n):
        """The standard deviation of an estimate. The variance of L³ f at one point is L³ ∫f² less the square
        of ∫f; f² is exp(-2k r²).
        """
        return sqrt((L**3 * gaussian_cloud(2 * k, L) - gaussian_cloud(k, L) ** 2) / n)

    integral = ask.estimate(
        "integrate",
        sd=spread,
        error=at_most(0.25, because="of the error itself: five times its spread, up to 5 %, with 400 points"),
        mean_error=at_most(
            0.08,
            because="of the mean of the error over 400 calls: errors from 20 batches of 20 points are 1.3 %"
            " too small, and their mean scatters by 0.8 %",
        ),
    )
    integral.case(
        "",
        f=expression("exp(-k * (x**2 + y**2 + z**2))", of="x y z", k=between(0.2, 0.5)),
        L=between(1, 2),
        n=400,
        rng=generator(),
    )
    integral.truth(gaussian_cloud)
    integral.mistake("missing-term", "the volume L³ is missing", change="L**3 *  -> ")
    integral.mistake(
        "missing-division",
        "the error is the spread of one point, not of the mean",
        change=" / np.sqrt(n) -> ",
    )
    # too large by more than 25 %
    integral.mistake(change="found.std(ddof=1) -> 1.5 * found.std(ddof=1)")
    # too small by less than 25 %, but in the mean by more than 8 %
    integral.mistake(change="found.std(ddof=1) -> 0.85 * found.std(ddof=1)")
    diagonal = "uniform(0, L, (3, n)) -> uniform(0, L, n) * np.ones((3, 1))"
    integral.mistake("wrong-index", "x, y and z are the same number", change=diagonal)
    integral.mistake(
        "wrong-function", "the median stands for the mean", change="found.mean() -> np.median(found)"
    )
    # not from the generator that is given
    integral.mistake(change="rng. -> np.random.default_rng().")

    uniform = ask.samples(
        "integrate",
        "uniform",
        parameters={"scale": lambda L: L},
        repetitions=100,
        label="points of integrate",
    )
    uniform.case("100 points", L=between(1, 2), n=100, rng=generator())

    @uniform.observe
    def coordinates(integrate, L, n, rng):
        """The coordinates (n, 3) of the points: uniform numbers from 0 to L."""
        return np.resize(points_of(integrate, L, n, rng), (n, 3))

    uniform.mistake("wrong-index", "x, y and z are the same number", change=diagonal)
    # the points of a grid
    uniform.mistake(
        change="uniform(0, L, (3, n)) -> integers(0, 10, (3, n)) * L / 10 + rng.uniform(0, 1e-9, (3, n))"
    )

    # 65 points are about one in each of the 64 layers of evenness
    integrate = ask.function("integrate", returns="number evenness", budget_s=20)
    integrate.case("400 calls", public=1, hidden=1, L=between(1, 2), n=65, seed=any_seed)

    @integrate.observe
    def number_and_evenness(integrate, L, n, seed):
        """How far the number of points is from n, and how evenly they lie, in 400 calls."""
        rng = np.random.default_rng(seed)
        calls = [points_of(integrate, L, n, rng) for _ in range(400)]
        number = max(abs(len(points) - n) for points in calls)
        return number, evenness(np.array([np.resize(points, (n, 3)) for points in calls]) / L)

    @integrate.truth
    def independent_points():
        return 0, 0

    integrate.agree(
        number=Value(
            absolute(0, because="the notebook asks for exactly n points"),
            label="integrate calls f at n different points",
        ),
        evenness=Value(
            absolute(
                0.5,
                because="points in equal layers have 1; independent ones exceed 0.5 in fewer than one of"
                " 1,000,000,000 gradings",
            ),
            label="integrate: the points are independent, not spread evenly",
            statistic=True,
        ),
    )
    integrate.mistake("off-by-one", "one point is missing", change="(3, n) -> (3, n - 1)")

    @integrate.mistake("wrong-quantity", "the error is that of n other points than those of the estimate")
    def other_points_for_the_error(f, L, n, rng):
        estimate, _ = integrate(f, L, n, rng)
        _, error = integrate(f, L, n, rng)
        return estimate, error

    @integrate.mistake()
    def in_layers(f, L, n, rng):
        """Draw one point in each of n layers of x."""
        x, y, z = rng.uniform(0, L, (3, n))
        found = L**3 * f((np.arange(n) + x / L) * L / n, y, z)
        return found.mean(), found.std(ddof=1) / np.sqrt(n)


def points_of(integrate, L, n, rng):
    """Return the points (x, y, z) at which integrate calls its integrand, each once: a right function may
    use it twice at each.
    """
    found = []

    # any function that is not constant
    def integrand(x, y, z):
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1).reshape(-1, 3)
        found.extend(map(tuple, points.tolist()))
        return np.add(x, np.multiply(y, z))

    integrate(integrand, L, n, rng)
    return list(dict.fromkeys(found))


def evenness(points):
    """Return how evenly points (calls, n, 3) in the unit cube fill 2, 4, … 64 layers: 1 if each layer has the
    same number in each call, and about 0, or negative, for independent points.

    Pearson's χ² of the numbers in s layers has the mean s - 1 for independent points.
    """
    n, ratios = points.shape[1], []
    for layers in (2, 4, 8, 16, 32, 64):
        layer = np.floor(points * layers)
        number = np.array([np.sum(layer == k, axis=1) for k in range(layers)])
        chi2 = np.sum((number - n / layers) ** 2, axis=0) * layers / n
        ratios.append(np.mean(chi2, axis=0).min() / (layers - 1))
    return 1 - min(ratios)


def ballot(steps, start, p):
    """Return the numbers T from 1 to steps + 1 and their probabilities (2, steps + 1).

    By the ballot theorem, a fraction start/T of all walks that are at 0 after T steps is there for the first
    time. The rest has the number steps + 1.
    """
    chance = np.zeros(steps + 2)
    for T in range(start, steps + 1, 2):
        right = (T - start) // 2
        chance[T] = start / T * comb(T, right) * p**right * (1 - p) ** (T - right)
    chance[steps + 1] = 1 - sum(chance)
    return [range(1, steps + 2), chance[1:]]


@notebook.exercise("6")
def first_arrival(ask):
    """The number of the step that first takes a walker from start to 0, or steps + 1."""
    passage = ask.samples("first_passage", "rv_discrete", parameters={"values": ballot}, repetitions=160)
    passage.case(
        "",
        walkers=25,
        steps=30,
        start=integer(1, 5),
        p=between(0.05, 0.7),
        rng=generator(),
    )
    passage.mistake(
        "off-by-one",
        "the first step has the number 0",
        change="there.argmax(axis=1) -> there.argmax(axis=1) - 1",
    )
    never = "walkers that do not arrive get the number steps"
    passage.mistake("off-by-one", never, change="axis=1), steps + 1) -> axis=1), steps)")
    passage.mistake("missing-term", "the walkers start at 0", change="start + walk -> walk")
    passage.mistake(
        "wrong-function",
        "the last passage stands for the first",
        change="there.argmax -> steps - there[:, ::-1].argmax",
    )
    reverse = "p is the probability of a step to the left"
    passage.mistake("wrong-comparison", reverse, change="start + walk -> start - walk")
    passage.mistake("wrong-comparison", reverse, change="p, rng) == -> 1 - p, rng) ==")
    # not from the generator that is given
    passage.mistake(change="p, rng) == -> p, np.random.default_rng()) ==")
    # each walker twice
    passage.mistake(
        change="walk(walkers, steps, p, rng)"
        " -> np.repeat(walk(walkers // 2 + 1, steps, p, rng), 2, axis=0)[:walkers]"
    )

    def spread(steps, p):
        """The standard deviation of the sum over 12 walkers."""
        return sqrt(12) * rv_discrete(values=ballot(steps, 2, p)).std()

    sums = ask.estimate(
        "first_passage", sd=spread, repetitions=800, label="sums of first_passage", mistakes_of=passage
    )
    sums.case("few walkers", steps=4, p=between(0.1, 0.5), rng=generator())

    @sums.observe
    def sum_of_arrivals(first_passage, steps, p, rng):
        """The sum of the arrivals of 1, 2, 3 and 6 walkers from the place 2."""
        return sum(np.sum(first_passage(n, steps, 2, p, rng)) for n in (1, 2, 3, 6))

    @sums.truth
    def of_12_walkers(steps, p):
        return 12 * rv_discrete(values=ballot(steps, 2, p)).mean()

    @sums.mistake("off-by-one", "walkers that arrive at the last step get steps + 1")
    def last_step_left_out(walkers, steps, start, p, rng):
        number = passage(walkers, steps, start, p, rng)
        return np.where(number == steps, steps + 1, number)

    # the second half of the walkers repeats the first
    sums.mistake(
        change="walk(walkers, steps, p, rng)"
        " -> np.resize(walk((walkers + 1) // 2, steps, p, rng), (walkers, steps + 1))"
    )

    too_few = ask.function(
        "first_passage", label="first_passage: no walker arrives in fewer steps than start"
    )
    too_few.case("1 to 3 steps", public=1, hidden=2, steps=integer(1, 3), p=between(0.1, 0.5), seed=any_seed)

    @too_few.observe
    def from_the_place_5(first_passage, steps, p, seed):
        return first_passage(2, steps, 5, p, np.random.default_rng(seed))

    @too_few.truth(agree=absolute(0, because="numbers of steps are integers"))
    def neither_arrives(steps):
        return [steps + 1, steps + 1]

    too_few.mistake("off-by-one", never, change="axis=1), steps + 1) -> axis=1), steps)")
    too_few.mistake(change="axis=1), steps + 1) -> axis=1), max(start, steps))")


@notebook.draw
def sphere(draw):
    """The track (300, 2) of a drifting sphere in µm, and what was measured with it: dt in s, T in K, eta in
    Pa s and a in µm.
    """
    drift = draw.rng.uniform(-0.5, 0.5, 2)
    return {
        "r": draw.rng.normal(drift, 0.7, (300, 2)).cumsum(axis=0),
        "dt": draw(between(0.1, 2)),
        "T": draw(between(275, 320)),
        "eta": draw(between(5e-4, 2e-3)),
        "a": draw(between(0.2, 2)),
    }


@notebook.exercise("7")
def boltzmanns_constant(ask):
    """Drift, diffusion constant with error, and Boltzmann's constant from the track of a sphere."""
    boltzmann = ask.function("boltzmann", inputs=sphere, returns="drift D D_error k_B")

    @boltzmann.truth(
        agree=close(rtol=1e-9, atol=0, because="ten thousand times the rounding errors of 299 steps")
    )
    def by_exact_sums(r, dt, T, eta, a):
        """Python's statistics module sums exactly. The sum of all displacements is the last position less the
        first. D has 2(N - 1) degrees of freedom, so its relative error is √(2/(2(N - 1))) = 1/√(N - 1).
        """
        dx, dy = np.diff(r, axis=0).T.tolist()
        D = (variance(dx) + variance(dy)) / (4 * dt)
        k_B = 6 * pi * eta * (a * 1e-6) * (D * 1e-12) / T
        return (r[-1] - r[0]) / (dt * len(dx)), D, D / sqrt(len(dx) - 1), k_B

    boltzmann.mistake(
        "missing-division",
        "the drift is that of a step, not of a second",
        change="step.mean(axis=0) / dt -> step.mean(axis=0)",
    )
    boltzmann.mistake(
        "missing-term",
        "the drift is not subtracted",
        change="step.var(axis=0, ddof=1) -> np.mean(step**2, axis=0)",
    )
    boltzmann.mistake(
        "missing-argument",
        "the variance divides by the number of steps, not by one less",
        change=", ddof=1 -> ",
    )
    boltzmann.mistake(
        "constant-factor",
        "the error divides by the root of 2N, not of N − 1",
        change="len(step) - 1 -> 2 * len(step)",
    )
    boltzmann.mistake("units", "D is in µm²/s, not in m²/s", change="1e-12 / T -> 1 / T")
    boltzmann.mistake(
        "units", "the temperature is in degrees Celsius, not in K", change="1e-12 / T -> 1e-12 / (T - 273.15)"
    )
    boltzmann.mistake("units", "the radius is in µm, not in m", change="a * 1e-6 -> a")
    boltzmann.mistake("constant-factor", "the diameter stands for the radius", change="a * 1e-6 -> 2e-6 * a")
