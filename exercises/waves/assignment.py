"""Waves: what is asked about notebook.ipynb, which holds text, Setup and solutions.

Exercises 1 and 2 find roots of functions of which the root is known otherwise. Exercises 3 to 6 follow a
string of N intervals on a grid, whose displacements (N + 1,) are 0 at both ends; r = cΔt/Δx is the number of
intervals that a wave moves in a step. Its modes sin(mπj/N) are
eigenvectors of the second difference: a step multiplies each by a number, so a truth needs no neighbours.

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

Every truth has a third source in tests/exercises/test_waves.py: 60-digit roots, powers of matrices, and
d'Alembert's solution.
"""

from math import pi, sin, sinh, sqrt, tanh

import numpy as np
from scipy.fft import dst

from exercises.authoring import (
    Notebook,
    absolute,
    array_of,
    at_most,
    between,
    close,
    expression,
    function,
    in_turn,
    integer,
    normal,
    one_of,
    relative,
    with_ends,
)

notebook = Notebook("notebook.ipynb")

g = 9.81  # m/s²


# Exercise 1: roots


def arctan_between(x, a, b, size, steepness, part):
    """A function of the given size that rises from a to b, steeply at its root, a ``part`` of the way. It is
    nan outside, but for rounding errors of x.
    """
    from_a = (x - a) / (b - a)
    is_inside = -1e-6 <= from_a <= 1 + 1e-6
    return size * np.arctan(steepness * (from_a - part)) if is_inside else np.nan


def function_of_size(size):
    """Return the draw of an interval and of such a function."""

    @notebook.draw
    def steep_function(draw):
        a = draw(between(-200, 200))
        return {
            "a": a,
            "b": a + draw(between(5, 100)),
            "size": draw(size),
            "steepness": draw(between(20, 100)),
            "part": draw(between(0.1, 0.9)),
        }

    return steep_function


@notebook.exercise("1")
def a_root_finder(ask):
    """The root of a rising function, to 1e-10 with at most 30 calls: the Illinois method, or a better one."""
    few_calls = at_most(
        30, because="bisection needs 38, methods that converge faster than linearly at most 24"
    )
    twice = absolute(2e-10, because="twice tol")

    find_root = ask.function("find_root", calls=few_calls)
    find_root.case(
        "waves on water",
        f=expression(
            "9.81 * k * tanh(k * d) - w**2", of="k", w=between(1, 6), d=with_ends(0.1, 10, log=True)
        ),
        a=0.0,
        b=20.0,
        tol=1e-10,
    )
    find_root.truth(wave_number_by_newton, agree=twice)
    find_root.mistake(
        "precision-loss",
        "the search stops at 1e-3 whatever tol is",
        change="abs(x - b) <= tol -> abs(x - b) <= 1e-3",
    )

    @find_root.mistake("wrong-method", "bisection uses the signs of f only, and needs 38 calls")
    def bisection(f, a, b, tol):
        while b - a > tol:
            middle = (a + b) / 2
            a, b = (middle, b) if f(middle) < 0 else (a, middle)
        return (a + b) / 2

    @find_root.mistake("wrong-method", "the method of false position keeps one end, and converges slowly")
    def false_position(f, a, b, tol):
        fa, fb, x = f(a), f(b), a
        while True:
            x, before = b - fb * (b - a) / (fb - fa), x
            if abs(x - before) <= tol:
                return x
            fx = f(x)
            a, fa, b, fb = (a, fa, x, fx) if fx > 0 else (x, fx, b, fb)

    find_root.mistake(
        "wrong-comparison",
        "the search keeps the end with the same sign",
        change="fx * fb < 0 -> fx * fb > 0",
    )

    @find_root.mistake("wrong-comparison", "the search stops where |f| is small, instead of the interval")
    def stops_at_small_values(f, a, b, tol):
        fa, fb = f(a), f(b)
        while True:
            x = b - fb * (b - a) / (fb - fa)
            fx = f(x)
            if abs(fx) <= tol:
                return x
            if fx * fb < 0:
                a, fa = b, fb
            else:
                fa /= 2
            b, fb = x, fx

    functions = in_turn(
        function_of_size(one_of(1e-6)),
        function_of_size(one_of(1e3)),
        function_of_size(with_ends(1e-6, 1e3, log=True)),
    )
    steep = ask.function(
        "find_root",
        calls=few_calls,
        label="find_root is right for steep functions and other intervals",
        mistakes_of=find_root,
    )
    steep.case(
        "steep functions",
        functions,
        public=6,
        hidden=16,
        steep=function(
            arctan_between,
            size=functions["size"],
            steepness=functions["steepness"],
            part=functions["part"],
        ),
    )

    @steep.observe
    def root_between(find_root, steep, a, b):
        return find_root(lambda x: steep(x, a, b), a, b, 1e-10)

    @steep.truth(agree=twice)
    def where_the_arctan_is_0(a, b, part):
        return a + part * (b - a)


# Exercise 2: the dispersion relation w² = g k tanh(kd)


def wave_number_by_newton(w, d):
    """Solve y tanh y = w² d / g for y = k d by Newton's method, from a start above the root."""
    c = w**2 * d / g
    y = c + sqrt(c)
    for _ in range(60):
        y -= (y * tanh(y) - c) / (tanh(y) + y * (1 - tanh(y) ** 2))
    return y / d


@notebook.draw
def wave_of_middle_depth(draw):
    """A wave with k d from 0.4 to 12, from nearly shallow to deep: with these depths in m w is 0.5 to 6
    rad/s, the range that is asked.
    """
    y, d = draw(between(0.4, 12)), draw(between(3.3, 5.9))
    return {"w": sqrt(g * y / d * tanh(y)), "d": d}


@notebook.draw
def wave_number_of_middle_depth(draw):
    """The same for the wave number k."""
    y, d = draw(between(0.4, 12)), draw(between(1.2, 32))
    return {"k": y / d, "d": d}


@notebook.exercise("2")
def waves_on_water(ask):
    """The wave number k in 1/m of a frequency w in rad/s on water of the depth d in m, and the velocity of a
    group of waves in m/s.
    """
    any_depth = with_ends(0.05, 32, log=True)
    middle = "water between shallow and deep"

    wave_number = ask.function("wave_number")
    wave_number.case("", public=32, hidden=96, w=with_ends(0.5, 6), d=any_depth)
    wave_number.case(middle, wave_of_middle_depth, public=32, hidden=96)
    wave_number.truth(
        wave_number_by_newton,
        agree=close(rtol=2e-8, atol=0, because="twice the precision that is asked for"),
    )
    wave_number.mistake("missing-term", "the waves do not feel the bottom", change=" * np.tanh(k * d) -> ")
    wave_number.mistake("missing-term", "the water is taken as shallow", change="np.tanh(k * d) -> k * d")
    wave_number.mistake(
        "units", "w is taken as a frequency in Hz", change="- w**2, -> - (2 * np.pi * w) ** 2,"
    )

    group_velocity = ask.function("group_velocity")
    group_velocity.case("", public=32, hidden=96, k=with_ends(0.01, 10, log=True), d=any_depth)
    group_velocity.case(middle, wave_number_of_middle_depth, public=32, hidden=96)

    @group_velocity.truth(agree=close(rtol=2e-6, atol=0, because="twice the precision that is asked for"))
    def by_phase_velocity(k, d):
        """The derivative of ln w² = ln(g k tanh kd) by k is (1 + 2kd / sinh 2kd) / k, so dw/dk is w/2 times
        that. The phase velocity is w/k = sqrt(g tanh(kd) / k).
        """
        return sqrt(g * tanh(k * d) / k) / 2 * (1 + 2 * k * d / sinh(2 * k * d))

    group_velocity.mistake("constant-factor", "the factor 1/2 is missing", change="(2 * w) -> w")
    group_velocity.mistake(
        "missing-term",
        "the derivative of tanh kd is missing",
        change=" + k * d / np.cosh(k * d) ** 2 -> ",
    )

    @group_velocity.mistake("wrong-quantity", "this is the phase velocity")
    def phase_velocity(k, d):
        return np.sqrt(9.81 * np.tanh(k * d) / k)


# Exercises 3 and 4: steps of the string, mode by mode


def amplitudes(u):
    """Return the amplitudes (N - 1,) of the modes sin(mπj/N), by scipy's sine transform with its factor 2."""
    return dst(u[1:-1], type=1) / (len(u) - 1)


def sum_of_modes(b, N):
    """Return the displacements (…, N + 1) with the amplitudes b (…, N - 1)."""
    return np.array(b) @ np.sin(pi / N * np.outer(np.arange(1, N), np.arange(N + 1)))


def half_sines(N):
    """Return sin(mπ/2N) (N - 1,) for all modes: the second difference of mode m is -4 sin²(mπ/2N) of it."""
    return np.sin(pi / 2 / N * np.arange(1, N))


def courant(rng):
    """Draw r: 1 in a quarter of all cases, else from 0.1 to 1.5."""
    return rng.choice([1.0, *rng.uniform(0.1, 1.5, 3)])


@notebook.draw
def string_of_20(draw):
    """Displacements of 20 intervals, now and a step before, and r."""
    u, before = draw.rng.normal(size=(2, 19))
    return {"u": np.pad(u, 1), "before": np.pad(before, 1), "r": draw(courant)}


@notebook.draw
def string_up_to_200(draw):
    """Numbers for the displacements of strings of 2, N and 203 - N intervals, and r: of N and 203 - N, both 3
    to 200, one is even and one odd.
    """
    u, before = draw.rng.normal(size=(2, 200))
    return {"u": u, "before": before, "r": draw(courant), "N": draw(integer(3, 200))}


@notebook.exercise("3")
def a_step_of_the_string(ask):
    """The displacements after a step, from those now and those a step before."""
    string_step = ask.function("string_step")
    string_step.case("", string_of_20)

    def of_three_sizes(string_step, u, before, r, N):
        """The displacements after a step of strings of 2, N and 203 - N intervals, padded with zeros so that
        every N gives the same shape.
        """
        found = []
        for n in (2, N, 203 - N):
            after = string_step(np.pad(u[1:n], 1), np.pad(before[1:n], 1), r)
            found.append(np.pad(after, (0, 200 - n)))
        return found

    string_step.case("other sizes", string_up_to_200, call=of_three_sizes)

    @string_step.truth(
        agree=relative(1e-12, because="a thousand times the rounding errors of a sum over the grid")
    )
    def mode_by_mode(u, before, r):
        """In place of the second difference, mode m has the factor -4 sin²(mπ/2N)."""
        N = len(u) - 1
        return sum_of_modes((2 - 4 * r**2 * half_sines(N) ** 2) * amplitudes(u) - amplitudes(before), N)

    string_step.mistake("wrong-power", "r stands in place of r²", change="r**2 -> r")
    string_step.mistake("missing-term", "the displacement before u is missing", change="- before[1:-1]  -> ")

    @string_step.mistake("wrong-constant", "the ends move")
    def ends_follow_their_neighbours(u, before, r):
        new = string_step(u, before, r)
        new[0] = new[-1] = u[1]
        return new

    @string_step.mistake("wrong-index", "the ends move: np.roll makes each the neighbour of the other")
    def ring(u, before, r):
        return 2 * u - before + r**2 * (np.roll(u, 1) - 2 * u + np.roll(u, -1))

    @string_step.mistake(
        "wrong-variable", "the left neighbour is already moved: write the new displacements to another array"
    )
    def updated_in_place(u, before, r):
        new = u.copy()
        for j in range(1, len(u) - 1):
            new[j] = 2 * new[j] - before[j] + r**2 * (new[j + 1] - 2 * new[j] + new[j - 1])
        return new


@notebook.draw
def plucked_string(draw):
    """A string of 20 intervals that is released at rest; with r up to 1 its 60 steps stay bounded."""
    return {"u": np.pad(draw(array_of(19, normal)), 1), "r": draw(between(0.3, 1)), "n": 60}


@notebook.exercise("4")
def a_plucked_string(ask):
    """The displacements after 0, 1, … n steps of a string that is released at rest."""
    vibrate = ask.function("vibrate")
    vibrate.case("", plucked_string)

    def of_other_sizes(vibrate, u, r, N):
        """Three steps of strings of 2, N and 203 - N intervals; and 1, N - 1 and 202 - N steps of one of 7
        intervals, with r at most 1, since it would grow. Both are padded with zeros.
        """
        found = []
        for n in (2, N, 203 - N):
            few_steps = vibrate(np.pad(u[1:n], 1), r, 3)
            many_steps = vibrate(np.pad(u[1:7], 1), min(r, 1), n - 1)
            found += [
                *np.pad(few_steps, ((0, 0), (0, 200 - n))).ravel(),
                *np.pad(many_steps, ((0, 200 - n), (0, 0))).ravel(),
            ]
        return found

    vibrate.case("other sizes", string_up_to_200, call=of_other_sizes)

    @vibrate.truth(
        agree=relative(
            1e-11,
            because="a thousand times the rounding errors of 60 steps, ten times those of 200",
        )
    )
    def by_cosines(u, r, n):
        """Mode m has the amplitude b cos(kθ) after k steps, with sin(θ/2) = r sin(mπ/2N): this solves the
        step, and is the same for k and -k, as at rest the motion is the same forwards and backwards. If r
        sin(mπ/2N) > 1, θ is complex and the mode grows.
        """
        N = len(u) - 1
        theta = 2 * np.arcsin(r * half_sines(N) + 0j)
        return sum_of_modes((amplitudes(u) * np.cos(np.outer(np.arange(n + 1), theta))).real, N)

    vibrate.mistake(
        "constant-factor",
        "the first step is twice as large",
        change="(string_step(u, u, r) - u) / 2 -> (string_step(u, u, r) - u)",
    )
    vibrate.mistake(
        "wrong-start",
        "the first two rows are equal",
        change="u + (string_step(u, u, r) - u) / 2 -> u",
    )
    vibrate.mistake(
        "swapped-arguments",
        "the two last rows are exchanged",
        change="rows[-1], rows[-2] -> rows[-2], rows[-1]",
    )


# Exercise 5: steps that are made for a limit


def second_difference(u):
    """Return the differences u_(j+1) - 2 u_j + u_(j-1), which are 0 at both ends."""
    found = np.zeros(len(u))
    found[1:-1] = u[2:] - 2 * u[1:-1] + u[:-2]
    return found


def step_of_any_string(u, before, r, q, c, damped, L):
    """A step in which waves move c r intervals, and points two intervals away have the weight q. With damping
    the last change, u - before, counts (r/L)² times.
    """
    kept = (r / L) ** 2 if damped else 1.0
    pull = second_difference(u + q * second_difference(u))
    return u + kept * (u - before) + (c * r) ** 2 * pull


# x below is largest for the zigzag, m = N - 1, if q < 1/8, and for a longer wave if q is larger and N large
# enough; with q > 1/4 and a large N x < 0 for the zigzag, which then grows with every r
zigzag_first, longer_wave_first = between(-0.2, 0.1), between(0.18, 0.24)


def largest_factor(N, q):
    """Return the largest z (1 - qz) of all modes, with z = 4 sin²(mπ/2N).

    A step of mode m has the eigenvalues λ² - (1 + kept - x) λ + kept = 0 with x = (c r)² z (1 - qz). For
    kept <= 1 the first |λ| passes 1 where λ = -1: where the largest x is 2 + 2 kept. For q < 1/8 that is the
    x of the zigzag, m = N - 1, for larger q and large enough N that of a longer wave.
    """
    z = 4 * half_sines(N) ** 2
    return (z * (1 - q * z)).max()


def string_with_limit(limit, size, weight):
    """Return the draw of a step without damping: at its limit r the largest x is 4."""

    @notebook.draw
    def undamped_string(draw):
        N, q, r = draw(size), draw(weight), draw(limit)
        c = 2 / r / sqrt(largest_factor(N, q))
        return {"N": N, "q": q, "c": c, "damped": False, "L": 1.0}

    return undamped_string


@notebook.draw
def damped_string(draw):
    """A step with damping up to r = L, and its limit below: there the largest x is 2 + 2 (r/L)²."""
    N, q, r = draw(integer(4, 7)), draw(longer_wave_first), draw(between(0.3, 3))
    L = r * draw(between(1.1, 3))
    c = sqrt((2 + 2 * (r / L) ** 2) / largest_factor(N, q)) / r
    return {"N": N, "q": q, "c": c, "damped": True, "L": L}


@notebook.draw
def string_with_complex_eigenvalues(draw):
    """A step with damping up to its limit r = L, where no x is 4 yet: beyond it the product of the two
    eigenvalues of each mode, kept, is above 1.
    """
    N, q, L = draw(integer(3, 6)), draw(longer_wave_first), draw(between(0.15, 3.9))
    c = draw(between(0.3, 0.9)) * 2 / L / sqrt(largest_factor(N, q))
    return {"N": N, "q": q, "c": c, "damped": True, "L": L}


@notebook.exercise("5")
def stability(ask):
    """The largest r between 0.1 and 4 with which no mode grows, of any linear step, to 1e-6."""
    strings = in_turn(
        string_with_limit(between(0.3, 3.9), one_of(2), zigzag_first),
        string_with_limit(between(0.11, 0.2), integer(3, 5), zigzag_first),
        # here a scan from 0.1 in steps of 0.0025 takes 1160 · 18 calls or more; the notebook allows 20 000
        string_with_limit(between(3, 3.9), one_of(10), longer_wave_first),
        string_with_limit(between(0.3, 3), integer(4, 8), longer_wave_first),
        damped_string,
        string_with_complex_eigenvalues,
    )
    stability_limit = ask.function("stability_limit", budget_s=20)
    stability_limit.case(
        "any step",
        strings,
        public=6,
        hidden=8,
        step=function(
            step_of_any_string,
            q=strings["q"],
            c=strings["c"],
            damped=strings["damped"],
            L=strings["L"],
        ),
    )

    @stability_limit.truth(agree=absolute(2e-6, because="twice the precision that is asked for"))
    def where_the_first_mode_grows(N, q, c, damped, L):
        """The largest x is 2 + 2 kept, or kept is 1: see ``largest_factor``."""
        x = c**2 * largest_factor(N, q)  # for r = 1; it grows as r²
        if not damped:
            return 2 / sqrt(x)
        return min(L, sqrt(2 / (x - 2 / L**2))) if x > 2 / L**2 else L

    stability_limit.mistake(
        "wrong-constant",
        "a growth of a tenth in each step counts as stable",
        change="> 1 + 1e-7 -> > 1.1",
    )
    stability_limit.mistake(
        "missing-term",
        "rounding errors count as growth: the margin of 1e-7 is missing",
        change="> 1 + 1e-7 -> > 1",
    )
    stability_limit.mistake(
        "precision-loss",
        "the search ends when the interval is 1e-5 long",
        change="unstable - stable > 1e-7 -> unstable - stable > 1e-5",
    )
    stability_limit.mistake(
        "wrong-power", "step is called with r² in place of r", change="1), r) -> 1), r**2)"
    )
    # the matrix keeps before, not u
    stability_limit.mistake(change="[1:-1], u] -> [1:-1], before]")
    stability_limit.mistake(
        "wrong-constant",
        "this is the limit of string_step on a fine grid",
        change="return stable -> return 1.0",
    )

    @stability_limit.mistake("wrong-constant", "B, the factor of before, is taken as -1, as for string_step")
    def minus_one(step, N):
        return stability_limit(lambda u, before, r: step(u, 0 * before, r) - before, N)

    @stability_limit.mistake()
    def scan(step, N):
        """Search the first of 4000 values of r with which a mode grows, and then in between."""
        unit = np.eye(2 * N - 2).reshape(-1, 2, N - 1)
        for r in np.linspace(0.1, 4, 4000):
            after = [step(np.pad(u, 1), np.pad(before, 1), r)[1:-1] for u, before in unit]
            matrix = [np.concatenate([new, u]) for new, (u, _) in zip(after, unit, strict=True)]
            if np.abs(np.linalg.eigvals(matrix)).max() > 1 + 1e-7:
                break
        return stability_limit(step, N)


# Exercise 6: spectra by their definitions


@notebook.draw
def samples(draw):
    """48 samples and their interval in s."""
    return {"x": draw(array_of(48, normal)), "dt": draw(between(0.001, 0.1))}


@notebook.draw
def up_to_200_samples(draw):
    """Numbers for 2, N and 203 - N samples, or one less if that is odd, as one of the last two is; and their
    interval in s.
    """
    return {
        "x": draw(array_of(200, normal)),
        "dt": draw(between(0.001, 0.1)),
        "N": draw(integer(3, 200)),
    }


@notebook.exercise("6")
def spectrum_and_modes(ask):
    """The amplitudes of the modes of a shape, the spectrum of samples, and the frequencies of the grid."""
    rounding = relative(1e-12, because="a thousand times the rounding errors of a sum over the grid")

    modes = ask.function("modes")
    modes.case("", string_of_20)

    def of_three_strings(modes, u, N):
        """The amplitudes of strings of 2, N and 203 - N intervals, a row each. Zeros fill each row up to 199
        numbers, as rows have one length, and the answer to every input has one shape.
        """
        found = []
        for n in (2, N, 203 - N):
            found.append(np.pad(modes(np.pad(u[1:n], 1)), (0, 200 - n)))
        return found

    modes.case("other sizes", string_up_to_200, call=of_three_strings)

    @modes.truth(agree=rounding)
    def by_solving(u):
        """The displacements are linear in the amplitudes: solve N - 1 equations."""
        N = len(u) - 1
        each_mode = sum_of_modes(np.eye(N - 1), N)
        return np.linalg.solve(each_mode[:, 1:-1].T, u[1:-1])

    modes.mistake("off-by-one", "the sum is divided by N + 1", change=" / (len(u) - 1) -> / len(u)")
    modes.mistake("sign-flipped", "the amplitudes have the opposite sign", change="-np.fft -> np.fft")

    spectrum = ask.function("spectrum", returns="frequencies amplitudes")
    spectrum.case("", samples)

    def of_three_lengths(spectrum, x, dt, N):
        """Both values for 2, N and 203 - N samples, a row each. Zeros fill each row up to 101 numbers, as
        rows have one length, and the answer to every input has one shape.
        """
        frequencies, amplitudes = [], []
        for n in (2, N, 203 - N):
            of_n = spectrum(x[: n // 2 * 2], dt)
            frequencies.append(np.pad(of_n[0], (0, 100 - n // 2)))
            amplitudes.append(np.pad(of_n[1], (0, 100 - n // 2)))
        return frequencies, amplitudes

    spectrum.case("other sizes", up_to_200_samples, call=of_three_lengths)

    @spectrum.truth(agree=rounding)
    def by_sums(x, dt):
        """For x = a cos(angle + φ) the sums with cos and sin are (n a/2)(cos φ, -sin φ); for k = 0 and n/2,
        where all sines are 0, the first is n a cos φ.
        """
        n = len(x)
        k = np.arange(n // 2 + 1)
        angles = 2 * pi / n * np.outer(k, np.arange(n))
        factor = np.where((k == 0) | (k == n // 2), 1, 2) / n
        return k / (n * dt), factor * np.hypot(np.cos(angles) @ x, np.sin(angles) @ x)

    spectrum.mistake(
        "constant-factor",
        "the ends of the spectrum are doubled too",
        change="found[1:-1] *= 2 -> found *= 2",
    )
    spectrum.mistake(
        "missing-term",
        "the amplitudes of the negative frequencies are missing",
        change="found[1:-1] *= 2 -> pass",
    )
    spectrum.mistake(
        "off-by-one",
        "the amplitude of the last frequency is doubled",
        change="found[1:-1] *= 2 -> found[1:] *= 2",
    )

    @spectrum.mistake("wrong-power", "the amplitudes are squared")
    def squared(x, dt):
        frequencies, found = spectrum(x, dt)
        return frequencies, found**2

    # both arrays end before n/2
    spectrum.mistake(change="dt), found -> dt)[:-1], found[:-1]")
    spectrum.mistake(
        "units",
        "these are angular frequencies",
        change="np.fft.rfftfreq(len(x), dt) -> 2 * np.pi * np.fft.rfftfreq(len(x), dt)",
    )
    spectrum.mistake(
        "sign-flipped",
        "the last frequency is negative: fftfreq counts n/2 as -n/2, rfftfreq does not",
        change="np.fft.rfftfreq(len(x), dt) -> np.fft.fftfreq(len(x), dt)[: len(x) // 2 + 1]",
    )

    frequency_ratio = ask.function("frequency_ratio")
    frequency_ratio.case("", m=integer(1, 9), N=integer(10, 200), r=with_ends(0.02, 1))

    def of_low_middle_and_high_modes(frequency_ratio, N, r):
        """The ratios of modes 1, n/2 and n - 1 for n = 2, N and 203 - N intervals."""
        return [[frequency_ratio(m, n, min(r, 1)) for m in (1, n // 2, n - 1)] for n in (2, N, 203 - N)]

    frequency_ratio.case("other sizes", call=of_low_middle_and_high_modes, N=integer(3, 200), r=courant)

    @frequency_ratio.truth(
        agree=close(rtol=1e-7, atol=0, because="the root of the rounding errors, where two eigenvalues meet")
    )
    def by_eigenvalue(m, N, r):
        """A step multiplies mode m, now and before, by a matrix with the eigenvalues exp(±iθ). The exact
        string turns by r m π/N in a step: the ratio is θ over that.
        """
        step = np.array([[2 - 4 * r**2 * sin(m * pi / 2 / N) ** 2, -1], [1, 0]], dtype=complex)
        return np.angle(np.linalg.eigvals(step)).max() / (r * m * pi / N)

    frequency_ratio.mistake("wrong-function", "arcsin is missing", change="np.arcsin -> ")
    frequency_ratio.mistake(
        "missing-term",
        "the time step is missing: the ratio is always 1/r",
        change="r * np.sin -> np.sin",
    )
