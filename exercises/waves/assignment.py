"""Waves: the dispersion of water waves by a root finder, and a string on a grid with its stability limit and
its spectrum.

Each truth is another method than its solution; ``tests/exercises/test_waves.py`` compares the truths with a
third source: 60-digit roots, powers of matrices, and d'Alembert's solution.
"""

from math import inf, pi, sin, sinh, sqrt, tanh

import numpy as np
from scipy.fft import dst

from exercises.authoring.kinds.values import other_inputs, values
from exercises.authoring.questions.author import (
    Notebook,
    Tolerance,
    family,
    integers,
    mistake,
    normal,
    uniform,
    with_ends,
)

notebook = Notebook("Waves", notebook="notebook.ipynb")
ROUNDING = Tolerance(limit=1e-12, reason="a thousand times the rounding errors of a sum over the grid")
G = 9.81


def find_root(f, a, b, tol):
    fa, fb = f(a), f(b)
    while True:
        x = b - fb * (b - a) / (fb - fa)
        if abs(x - b) <= tol:
            return x
        fx = f(x)
        if fx * fb < 0:
            a, fa = b, fb
        else:
            fa /= 2
        b, fb = x, fx


def by_iteration(w, d):
    """Solve y tanh y = w² d / g for y = k d by Newton's method, from above."""
    c = w**2 * d / G
    y = c + sqrt(c)
    for _ in range(60):
        y -= (y * tanh(y) - c) / (tanh(y) + y * (1 - tanh(y) ** 2))
    return y / d


wrong = [
    mistake(
        "abs(x - b) <= tol",
        "abs(x - b) <= 1e-3",
        "precision-loss",
        "the search stops at 1e-3 whatever tol is",
    ),
    mistake("        x = b - fb * (b - a) / (fb - fa)", "        x = (a + b) / 2\n        f((a + b) / 2)"),
    mistake("            fa /= 2\n", "            pass\n"),
    mistake("fx * fb < 0", "fx * fb > 0", "wrong-comparison", "the search keeps the end with the same sign"),
]
f = family("9.81 * k * tanh(k * d) - w**2", "k", w=uniform(1, 6), d=with_ends(0.1, 10, log=True))
ask = {"f": f, "a": 0.0, "b": 20.0, "tol": 1e-10}
twice = Tolerance(atol=2e-10, reason="tol, twice")
budget = Tolerance(
    limit=30, reason="bisection needs 38, methods that converge faster than linearly at most 24"
)
waves = values(find_root, ask, twice, truth=by_iteration, calls=budget, mistakes=wrong)
text = "c * arctan(s * (x - a - p * l) / l) if 0 <= x - a <= 1.000001 * l else np.nan"
given = {"s": uniform(20, 100), "c": with_ends(1e-3, 1e3, log=True), "p": uniform(0.1, 0.9)}
steep = family(text, "x", "a", "l", **given)
ask = {"steep": steep, "a": uniform(-200, 200), "l": uniform(5, 100)}
call = "find_root(lambda x: steep(x, a, l), a, a + l, 1e-10)"
asked = {"calls": budget, "call": call, "label": "find_root is right for steep functions and other intervals"}
steep = values(find_root, ask, twice, truth=lambda a, l, p: a + p * l, **asked)
notebook.exercise("1", "A root finder", waves, steep)


def wave_number(w, d):
    return find_root(
        lambda k: 9.81 * k * np.tanh(k * d) - w**2, 0.0, w**2 / 9.81 + w / np.sqrt(9.81 * d), 1e-12
    )


def group_velocity(k, d):
    w = np.sqrt(9.81 * k * np.tanh(k * d))
    return 9.81 * (np.tanh(k * d) + k * d / np.cosh(k * d) ** 2) / (2 * w)


def by_phase_velocity(k, d):
    return sqrt(G * tanh(k * d) / k) / 2 * (1 + 2 * k * d / sinh(2 * k * d))


TO_8, TO_6 = (
    Tolerance(rtol=2 * precision, atol=0, reason="twice the precision that is asked for")
    for precision in (1e-8, 1e-6)
)
depth = with_ends(0.05, 32, log=True)
ask = {"w": with_ends(0.5, 6), "d": depth}
wrong = [
    mistake(" * np.tanh(k * d)", "", "missing-term", "the waves do not feel the bottom"),
    mistake("np.tanh(k * d)", "k * d", "missing-term", "the water is taken as shallow"),
    mistake("- w**2,", "- (2 * np.pi * w) ** 2,", "units", "w is taken as a frequency in Hz"),
]
number = values(wave_number, ask, TO_8, truth=by_iteration, uses=[find_root], mistakes=wrong, rows=(32, 96))
call, label = "wave_number(sqrt(9.81 * y / d * tanh(y)), d)", "between shallow and deep water"
between = other_inputs(number, call, label, y=uniform(0.4, 12), d=uniform(3.3, 5.9))
wrong = [
    mistake("(2 * w)", "w", "constant-factor", "the factor 1/2 is missing"),
    mistake(" + k * d / np.cosh(k * d) ** 2", "", "missing-term", "the derivative of tanh kd is missing"),
    mistake("    return ", "    return w / k\n    return ", "wrong-quantity", "this is the phase velocity"),
]
ask = {"k": with_ends(0.01, 10, log=True), "d": depth}
group = values(group_velocity, ask, TO_6, truth=by_phase_velocity, mistakes=wrong, rows=(32, 96))
groups = other_inputs(group, "group_velocity(y / d, d)", label, y=uniform(0.4, 12), d=uniform(1.2, 32))
notebook.exercise("2", "Waves on water", number, between, group, groups)


def string(rng, N=20):
    """Return displacements (N + 1,) that are 0 at both ends."""
    return np.pad(rng.normal(size=N - 1), 1)


def courant(rng):
    """Return r: 1 in a quarter of all cases, else from 0.1 to 1.5."""
    return rng.choice([1.0, *rng.uniform(0.1, 1.5, 3)])


def amplitudes(u):
    """Return the amplitudes (N - 1,) of the modes sin(mπj/N), by the discrete sine transform."""
    return dst(u[1:-1], type=1) / (len(u) - 1)


def shape(b, N):
    """Return the displacements (…, N + 1) with the amplitudes b (…, N - 1)."""
    return np.array(b) @ np.sin(pi / N * np.outer(np.arange(1, N), np.arange(N + 1)))


def sines(N):
    """Return sin(mπ/2N) (N - 1,) of the modes: the sine of half the phase of a step is r times that."""
    return np.sin(pi / 2 / N * np.arange(1, N))


def ragged(text):
    """Return the expression of all numbers of ``text`` with n = 2, N and 203 - N."""
    return f"np.concatenate([np.ravel({text}) for n in (2, N, 203 - N)])"


strings = {"u": normal(200), "r": courant, "N": integers(3, 200)}


def string_step(u, before, r):
    new = np.zeros(len(u))
    new[1:-1] = 2 * u[1:-1] - before[1:-1] + r**2 * (u[2:] - 2 * u[1:-1] + u[:-2])
    return new


def by_modes(u, before, r):
    N = len(u) - 1
    return shape((2 - 4 * r**2 * sines(N) ** 2) * amplitudes(u) - amplitudes(before), N)


ring = "2 * u - before + r**2 * (np.roll(u, 1) - 2 * u + np.roll(u, -1))"
wrong = [
    mistake("r**2", "r", "wrong-power", "r stands in place of r²"),
    mistake("- before[1:-1] ", "", "missing-term", "the displacement before u is missing"),
    mistake(
        "np.zeros(len(u))", "u + 0 * before\n    new[0] = new[-1] = u[1]", "wrong-constant", "the ends move"
    ),
    mistake(
        "return new",
        f"return {ring}",
        "wrong-index",
        "the ends move: np.roll makes each the neighbour of the other",
    ),
]
ask = {"u": string, "before": string, "r": courant}
step = values(string_step, ask, ROUNDING, truth=by_modes, mistakes=wrong)
call = ragged("string_step(np.pad(u[1:n], 1), np.pad(before[1:n], 1), r)")
other = other_inputs(step, call, "for other sizes", before=normal(200), **strings)
notebook.exercise("3", "A step of the string", step, other)


def vibrate(u, r, n):
    rows = [u, u + (string_step(u, u, r) - u) / 2]
    for _ in range(n - 1):
        rows.append(string_step(rows[-1], rows[-2], r))
    return np.array(rows)


def by_cosines(u, r, n):
    N = len(u) - 1
    return shape(amplitudes(u) * np.cos(2 * np.outer(np.arange(n + 1), np.arcsin(r * sines(N) + 0j))).real, N)


wrong = [
    mistake(
        "(string_step(u, u, r) - u) / 2",
        "(string_step(u, u, r) - u)",
        "constant-factor",
        "the first step is twice as large",
    ),
    mistake("u + (string_step(u, u, r) - u) / 2", "u", "wrong-start", "the first two rows are equal"),
    mistake(
        "rows[-1], rows[-2]", "rows[-2], rows[-1]", "swapped-arguments", "the two last rows are exchanged"
    ),
]
ask = {"u": string, "r": uniform(0.3, 1), "n": 60}
LONG = Tolerance(
    limit=1e-11, reason="a thousand times the rounding errors of 60 steps, ten times those of 200"
)
run = values(vibrate, ask, LONG, truth=by_cosines, uses=[string_step], mistakes=wrong)
call = ragged("np.append(vibrate(np.pad(u[1:n], 1), r, 3), vibrate(np.pad(u[1:7], 1), min(r, 1), n - 1))")
other = other_inputs(run, call, "for other sizes", **strings)
notebook.exercise("4", "A plucked string", run, other)


def stability_limit(step, N):
    def grows(r):
        pairs = np.eye(2 * N - 2).reshape(-1, 2, N - 1)
        columns = [np.concatenate([step(np.pad(u, 1), np.pad(before, 1), r)[1:-1], u]) for u, before in pairs]
        return np.abs(np.linalg.eigvals(np.array(columns))).max() > 1 + 1e-7

    stable, unstable = 0.1, 4.0
    while unstable - stable > 1e-7:
        r = (stable + unstable) / 2
        stable, unstable = (stable, r) if grows(r) else (r, unstable)
    return stable


def by_traces(N, p):
    """Take 2 - r² z + g (r²/L² - 1) and -1 - g (r²/L² - 1), the trace and minus the determinant of a mode's
    step.

    They make |λ| > 1 for r > L if g = 1, and where r² z > 4 + 2g (r²/L² - 1).
    """
    q, c, g, L = p
    z = 4 * sines(N) ** 2
    return min(
        [L if g else inf, *(sqrt((4 - 2 * g) / x) for x in c**2 * z * (1 - q * z) - 2 * g / L**2 if x > 0)]
    )


def scheme(rng):
    """Return q, c, g, L of a step with a limit from 0.1 to 4. For q > 1/8 the zigzag is not the first to
    grow; g = 1: complex λ.
    """
    q = rng.choice([rng.uniform(-0.2, 0.1), rng.uniform(0.18, 0.24)])
    return np.array(
        [
            q,
            sqrt(2 / (1 - 2 * q)) / rng.uniform(0.25, 3.9),
            rng.integers(2),
            with_ends(0.11, 3.9, log=True)(rng),
        ]
    )


text = "2 * u - before + (r * p[1]) ** 2 * np.pad(np.diff(u + p[0] * np.pad(np.diff(u, 2), 1), 2), 1)"
text += " + p[2] * ((r / p[3]) ** 2 - 1) * (u - before)"
ask = {
    "step": family(text, "u", "before", "r", p=scheme),
    "N": lambda rng: rng.choice([2, *rng.integers(3, 11, 4)]),
}
wrong = [
    mistake("> 1 + 1e-7", "> 1.1", "wrong-constant", "a growth of a tenth in each step counts as stable"),
    mistake("1), r)", "1), r**2)", "wrong-power", "step is called with r² in place of r"),
    mistake("[1:-1], u]", "[1:-1], before]"),
    mistake(
        "    return stable",
        "    return 1.0",
        "wrong-constant",
        "this is the limit of string_step on a fine grid",
    ),
]
near = Tolerance(atol=2e-6, reason="twice the precision that is asked for")
limit = values(stability_limit, ask, near, truth=by_traces, rows=(3, 8), mistakes=wrong)
notebook.exercise("5", "The limit of Courant, Friedrichs and Lewy", limit)


def modes(u):
    odd = np.concatenate([u, -u[-2:0:-1]])
    return -np.fft.rfft(odd).imag[1:-1] / (len(u) - 1)


def by_solving(u):
    N = len(u) - 1
    return np.linalg.solve(shape(np.eye(N - 1), N)[:, 1:-1].T, u[1:-1])


def spectrum(x, dt):
    found = np.abs(np.fft.rfft(x)) / len(x)
    found[1:-1] *= 2
    return np.fft.rfftfreq(len(x), dt), found


def by_sums(x, dt):
    n = len(x)
    k = np.arange(n // 2 + 1)
    angles = 2 * pi / n * np.outer(k, np.arange(n))
    factor = np.where((k == 0) | (k == n // 2), 1, 2) / n
    return k / (n * dt), factor * np.hypot(np.cos(angles) @ x, np.sin(angles) @ x)


def frequency_ratio(m, N, r):
    return 2 * np.arcsin(r * np.sin(m * np.pi / (2 * N))) / (r * m * np.pi / N)


def by_eigenvalue(m, N, r):
    """Take the phase of an eigenvalue of the step of one mode."""
    step = np.array([[2 - 4 * r**2 * sin(m * pi / 2 / N) ** 2, -1], [1, 0]], dtype=complex)
    return np.angle(np.linalg.eigvals(step)).max() / (r * m * pi / N)


wrong = [
    mistake(" / (len(u) - 1)", " / len(u)", "off-by-one", "the sum is divided by N + 1"),
    mistake("-np.fft", "np.fft", "sign-flipped", "the amplitudes have the opposite sign"),
]
amplitude = values(modes, {"u": string}, ROUNDING, truth=by_solving, mistakes=wrong)
others = other_inputs(amplitude, ragged("modes(np.pad(u[1:n], 1))"), "for other sizes", **strings)
wrong = [
    mistake("found[1:-1] *= 2", "found *= 2", "constant-factor", "the ends of the spectrum are doubled too"),
    mistake(
        "    found[1:-1] *= 2\n", "", "missing-term", "the amplitudes of the negative frequencies are missing"
    ),
    mistake(
        "found[1:-1] *= 2", "found[1:] *= 2", "off-by-one", "the amplitude of the last frequency is doubled"
    ),
    mistake(
        "    found[1:-1] *= 2\n",
        "    found[1:-1] *= 2\n    found = found**2\n",
        "wrong-power",
        "the amplitudes are squared",
    ),
    mistake("dt), found", "dt)[:-1], found[:-1]"),
    mistake(
        "np.fft.rfftfreq(len(x), dt)",
        "2 * np.pi * np.fft.rfftfreq(len(x), dt)",
        "units",
        "these are angular frequencies",
    ),
]
fourier = {"frequencies": ROUNDING, "amplitudes": ROUNDING}
ask = {"x": normal(48), "dt": uniform(0.001, 0.1)}
whole = values(spectrum, ask, fourier, truth=by_sums, mistakes=wrong)
call = "[np.concatenate(one) for one in zip(*[spectrum(x[: n // 2 * 2], dt) for n in (2, N, 203 - N)])]"
samples = other_inputs(
    whole, call, "for other sizes", x=normal(200), dt=uniform(0.001, 0.1), N=integers(3, 200)
)
wrong = [
    mistake("np.arcsin", "", "wrong-function", "arcsin is missing"),
    mistake("r * np.sin", "np.sin", "missing-term", "the time step is missing: the ratio is always 1"),
]
EIGEN = Tolerance(rtol=1e-7, atol=0, reason="the root of the rounding errors, where two eigenvalues meet")
ask = {"m": integers(1, 9), "N": integers(10, 200), "r": with_ends(0.02, 1)}
ratio = values(frequency_ratio, ask, EIGEN, truth=by_eigenvalue, mistakes=wrong)
call = ragged("[frequency_ratio(m, n, min(r, 1)) for m in (1, n // 2, n - 1)]")
ends = other_inputs(ratio, call, "for other sizes", r=courant, N=integers(3, 200))
notebook.exercise("6", "Spectrum and modes", amplitude, others, whole, samples, ratio, ends)
