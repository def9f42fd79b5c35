"""Coupled oscillators: normal modes, degenerate ones too, beats, and the dispersion of a chain with a fit to
data.

dispersion.csv has ω at q = 1/8 … 3 for A = 47 and B = 4.6, with normal noise of numpy's default_rng(2300).
tests/exercises/test_coupled_oscillators.py compares each truth with 60-digit numbers of another method.
"""

from decimal import Context, Decimal
from pathlib import Path

import numpy as np
import scipy.linalg
from scipy.optimize import curve_fit

from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.values import other_inputs, values
from exercises.authoring.kinds.variables import variables
from exercises.authoring.questions.author import (
    Notebook,
    Tolerance,
    Value,
    integers,
    mistake,
    uniform,
    with_ends,
)

notebook = Notebook("Coupled oscillators", notebook="notebook.ipynb", data=("dispersion.csv",))
q_data, omega_data, sigma_data = np.loadtxt(
    Path(__file__).with_name("dispersion.csv"), delimiter=",", unpack=True
)
ROUNDING = Tolerance(limit=1e-12, reason="a thousand rounding errors of the largest number")


# 1. Truth: the incidence matrix of the springs.
def chain_stiffness(k):
    return np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)


def by_incidence(k):
    stretch = np.eye(len(k), len(k) - 1) - np.eye(len(k), len(k) - 1, -1)
    return stretch.T @ np.diag(k) @ stretch


wrong = [
    mistake(
        "- np.diag(k[1:-1], ",
        "+ np.diag(k[1:-1], ",
        "sign-flipped",
        "a spring pulls both of its ends the same way",
    ),
    mistake(
        "k[:-1] + k[1:]",
        "2 * k[1:]",
        "wrong-index",
        "both springs of a mass are taken as the one to its right",
    ),
    mistake("k[1:-1]", "k[2:]", "wrong-index", "the coupling is that of the spring behind the neighbour"),
]
two = values(chain_stiffness, {"k": uniform(0.5, 9, 3)}, ROUNDING, truth=by_incidence, mistakes=wrong)
call, ask = (
    "np.pad(chain_stiffness(k[: N + 1]), (0, 30 - N))",
    {"k": uniform(0.5, 9, 31), "N": integers(2, 30)},
)
notebook.exercise("1", "The stiffness matrix", two, other_inputs(two, call, "for 2 to 30 masses", **ask))


# 2. Truth: singular values of M^(-1/2) K M^(-1/2).
def normal_modes(m, K):
    squares, X = scipy.linalg.eigh(K, np.diag(m))
    return np.sqrt(squares), X


def by_singular_values(m, K):
    U, squares, _ = np.linalg.svd(K / np.sqrt(np.outer(m, m)))
    return np.sqrt(squares[::-1]), U[:, ::-1] / np.sqrt(m)[:, None]


# Four squares of ω are these numbers divided by 1 to 2, for masses from 1 to 2: they stay apart, as the
# ratios are at least 2.5.
def full(rng, N=4):
    axes, _ = np.linalg.qr(rng.normal(size=(N, N)))
    roots = axes * np.sqrt(np.geomspace(0.5, 13.5, N) * rng.uniform(1, 1.2, N))
    return roots @ roots.T


OMEGA = Tolerance(limit=1e-11, reason="ten thousand times the rounding errors of the eigenvalues")
MODES = Tolerance(
    limit=1e-9, reason="rounding errors over the smallest distance of two eigenvalues, 1 % of the largest"
)
system, agree = {"m": uniform(1, 2, 4), "K": full}, {"omega": OMEGA, "X": Value(MODES, up_to="column signs")}
larger = {"m": uniform(1, 2, 8), "K": lambda rng: full(rng, 8), "N": integers(2, 8)}
wrong = [
    mistake("np.sqrt(squares)", "squares", "wrong-power", "the squares of the frequencies are returned"),
    mistake(", np.diag(m))", ")", "missing-term", "the masses are missing"),
    mistake(
        "np.sqrt(squares), X", "np.sqrt(squares), X.T", "transposed", "the modes are rows instead of columns"
    ),
    mistake(
        ", X\n",
        ", X / np.linalg.norm(X, axis=0)\n",
        "normalised",
        "the columns have length 1, but XᵀMX is not 1",
    ),
    mistake(
        "np.sqrt(squares), X",
        "np.sqrt(squares)[::-1], X[:, ::-1]",
        "component-order",
        "the highest frequency comes first",
    ),
    mistake(
        "np.sqrt(squares)",
        "np.sqrt(squares) / (2 * np.pi)",
        "units",
        "the frequencies are in Hz instead of rad/s",
    ),
]
four = values(normal_modes, system, agree, truth=by_singular_values, mistakes=wrong)
call = "[np.pad(one, (0, 8 - N)) for one in normal_modes(m[:N], K[:N, :N])]"
notebook.exercise("2", "Normal modes", four, other_inputs(four, call, "for 2 to 8 masses", **larger))


# 3. Truth: the closed form. As a complex number, the displacement of the corner at the angle φ is constant
# (translations), ie^{iφ} (rotation), e^{−iφ} and ie^{−iφ} (the degenerate pair), or e^{iφ} (breathing).
def triangle_modes(m, k):
    angles = np.radians([90, 210, 330])
    corners = np.column_stack([np.cos(angles), np.sin(angles)])
    K = np.zeros((6, 6))
    for i, j in [(0, 1), (1, 2), (2, 0)]:
        stretch = np.zeros((3, 2))
        stretch[i] = (corners[i] - corners[j]) / np.sqrt(3)
        stretch[j] = -stretch[i]
        K += k * np.outer(stretch, stretch)
    squares, X = np.linalg.eigh(K / m)
    return np.sqrt(np.maximum(squares, 0)), X


def by_symmetry(m, k):
    turn = np.exp(1j * np.radians([90, 210, 330]))
    fields = np.array([turn**0, 1j * turn**0, 1j * turn, turn.conj(), 1j * turn.conj(), turn]) / np.sqrt(3)
    X = np.stack([fields.real, fields.imag], axis=-1).reshape(6, 6).T
    return np.sqrt(k / m * np.array([0, 0, 0, 1.5, 1.5, 3])), X[:, :3], X[:, 3:5], X[:, 5:]


ZERO = Tolerance(limit=1e-6, reason="a rounding error of 1e-15 in ω² = 0 is 3e-8 in ω")
agree = {
    "omega": Value(ZERO, "the frequencies of the triangle are right"),
    "rigid": Value(
        MODES, "columns 0 to 2 are an orthonormal basis of the motions without a force", up_to="span"
    ),
    "pair": Value(
        MODES, "columns 3 and 4 are an orthonormal basis of the vibrations of equal frequency", up_to="span"
    ),
    "breathing": Value(MODES, "column 5 is the breathing mode, of length 1", up_to="span"),
}
wrong = [
    mistake(
        "np.sqrt(np.maximum(squares, 0))",
        "squares",
        "wrong-power",
        "the squares of the frequencies are returned",
    ),
    mistake("K / m", "K", "missing-term", "the mass is missing"),
    mistake(
        "stretch[j] = -stretch[i]",
        "stretch[j] = stretch[i]",
        "sign-flipped",
        "both ends of a spring stretch it alike",
    ),
    mistake("(0, 1), (1, 2), (2, 0)", "(0, 1), (1, 2)", "missing-term", "the third spring is missing"),
    mistake(" / np.sqrt(3)", "", "constant-factor", "the direction of a spring is not a unit vector"),
    mistake(", 0)), X\n", ", 0)), X.T\n", "transposed", "the modes are rows instead of columns"),
    mistake("[90, 210, 330]", "[0, 120, 240]", "wrong-constant", "the corners are at 0°, 120° and 240°"),
    mistake(", X\n", ", X / np.sqrt(m)\n", "normalised", "the columns are divided by √m, but XᵀX is to be 1"),
]
columns = "[(w, array(X)[:, :3], array(X)[:, 3:5], array(X)[:, 5:]) for w, X in [triangle_modes(m, k)]][0]"
ask = {"m": uniform(0.5, 3), "k": uniform(1, 9)}
triangle = values(triangle_modes, ask, agree, truth=by_symmetry, call=columns, mistakes=wrong)
notebook.exercise("3", "Degenerate modes", triangle)


# 4. Truth: the matrix exponential of the equations of first order.
def motion(t, m, K, x0, v0):
    omega, X = normal_modes(m, K)
    a, b = X.T @ (m * x0), X.T @ (m * v0) / omega
    phase = np.outer(omega, t)
    return X @ (a[:, None] * np.cos(phase) + b[:, None] * np.sin(phase))


def by_exponential(t, m, K, x0, v0):
    rates = np.block([[0 * K, np.eye(len(m))], [-K / m[:, None], 0 * K]])
    return np.array([(scipy.linalg.expm(rates * at) @ [*x0, *v0])[: len(m)] for at in t]).T


def rising(rng):
    return np.append(0, np.cumsum(rng.uniform(0.5, 3, 7)))


ask = {"t": rising, **system, "x0": uniform(-1, 1, 4), "v0": uniform(-1, 1, 4)}
agree = Tolerance(limit=1e-7, reason="solvers at rtol 1e-10 deviate by up to 3e-9; the sum of modes by 1e-13")
wrong = [
    mistake(
        "X.T @ (m * v0) / omega", "X.T @ (m * v0)", "missing-division", "the velocities are not divided by ω"
    ),
    mistake(
        "X.T @ (m * x0), X.T @ (m * v0)",
        "X.T @ x0, X.T @ v0",
        "missing-term",
        "the modes are orthogonal with the masses",
    ),
    mistake(" + b[:, None] * np.sin(phase)", "", "missing-term", "the initial velocities have no effect"),
]
total = values(motion, ask, agree, truth=by_exponential, uses=[normal_modes], mistakes=wrong)
call = "np.pad(motion(t, m[:N], K[:N, :N], x0[:N], v0[:N]), ((0, 8 - N), (0, 0)))"
ask = {"t": rising, **larger, "x0": uniform(-1, 1, 8), "v0": uniform(-1, 1, 8)}
notebook.exercise(
    "4", "Motion as a sum of modes", total, other_inputs(total, call, "for 2 to 8 masses", **ask)
)


# 5. Truth: the difference of the two frequencies to 60 digits.
def beat_time(w0, kappa):
    return np.pi * (np.sqrt(w0**2 + 2 * kappa) + w0) / (2 * kappa)


def with_60_digits(w0, kappa):
    digits, w, c = Context(prec=60), Decimal(float(w0)), Decimal(float(kappa))
    difference = digits.subtract(digits.sqrt(digits.fma(w, w, 2 * c)), w)
    return float(digits.divide(Decimal("3.14159265358979323846264338327950288"), difference))


wrong = [
    mistake(
        "+ w0) / (2 * kappa)",
        "- w0) ** -1",
        "precision-loss",
        "the two frequencies cancel in their difference",
    ),
    mistake(
        "np.pi *",
        "2 * np.pi *",
        "constant-factor",
        "the energy is back at the first pendulum: twice the time",
    ),
    mistake(
        "w0**2 + 2 * kappa",
        "w0**2 + kappa",
        "constant-factor",
        "ω₂² is ω₀² + 2κ: the coupling stretches at both ends",
    ),
    mistake(
        "(np.sqrt(w0**2 + 2 * kappa) + w0)", "2 * w0", "missing-term", "this is the limit of weak coupling"
    ),
]
agree = Tolerance(
    rtol=1e-12, reason="a thousand rounding errors; the difference of the frequencies loses up to all digits"
)
ask = {"w0": with_ends(1, 10), "kappa": with_ends(1e-12, 1, log=True)}
notebook.exercise(
    "5", "Beats", values(beat_time, ask, agree, truth=with_60_digits, rows=(32, 96), mistakes=wrong)
)


# 6. Truths: a sum over neighbours; eigenvalues of the 2×2 matrix of a cell.
def chain_frequency(q, A, B):
    return 2 * np.sqrt(A * np.sin(q / 2) ** 2 + B * np.sin(q) ** 2)


def by_neighbours(q, A, B):
    return np.sqrt(sum(-c * (np.exp(1j * n * q) - 1).real for n, c in [(1, A), (-1, A), (2, B), (-2, B)]))


def branches(q, d, C, m, M):
    total = 1 / m + 1 / M
    root = np.sqrt(total**2 - 4 * np.sin(q * d) ** 2 / (m * M))
    return np.sqrt(C * (total - root)), np.sqrt(C * (total + root))


def by_cell(q, d, C, m, M):
    link = -2 * C * np.cos(q * d) / np.sqrt(m * M)
    return tuple(np.sqrt([np.linalg.eigvalsh([[2 * C / m, one], [one, 2 * C / M]]) for one in link]).T)


wrong = [
    mistake("np.sin(q)", "np.sin(q / 2)", "wrong-constant", "second neighbours are taken as first ones"),
    mistake("2 * np.sqrt", "np.sqrt", "constant-factor", "the frequencies are halved"),
]
ask = {"q": uniform(0.1, 6.2, 5), "A": uniform(30, 60), "B": uniform(1, 9)}
single = values(chain_frequency, ask, ROUNDING, truth=by_neighbours, mistakes=wrong)
swap = (
    "np.sqrt(C * (total - root)), np.sqrt(C * (total + root))",
    "np.sqrt(C * (total + root)), np.sqrt(C * (total - root))",
)
wrong = [
    mistake("q * d", "q * d / 2", "constant-factor", "d is taken as the length of the cell, which is 2d"),
    mistake(*swap, "component-order", "the optical branch comes first"),
    mistake("4 * np.sin", "np.sin", "constant-factor", "the factor 4 below the inner root is missing"),
]
BRANCH = Tolerance(
    limit=1e-10, reason="rounding errors of 1e-16 in ω², which the difference at small q makes 1e-13 in ω"
)
ask = {
    "q": uniform(0.05, 2, 5),
    "d": uniform(0.5, 1.5),
    "C": uniform(1, 9),
    "m": uniform(0.5, 2),
    "M": uniform(0.5, 2),
}
double = values(branches, ask, {"acoustic": BRANCH, "optical": BRANCH}, truth=by_cell, mistakes=wrong)
notebook.exercise("6", "Waves on a chain", single, double)


# 7. Truths: polhode's own fit, by another optimizer; for the file, numbers of Newton's method with 60 digits.
def fit_dispersion(q, omega, sigma):
    return curve_fit(chain_frequency, q, omega, sigma=sigma, absolute_sigma=True)


def measured():
    best, covariance = fit_dispersion(q_data, omega_data, sigma_data)
    chi2 = np.sum(((omega_data - chain_frequency(q_data, *best)) / sigma_data) ** 2)
    speed = np.sqrt(best[0] + 4 * best[1])
    slope = np.array([1, 4]) / (2 * speed)
    speed_error = np.sqrt(slope @ covariance @ slope)
    return best, chi2, speed, speed_error


NEAR = Tolerance(
    limit=1e-3, reason="of a standard deviation: ten times what a fit with default options deviates"
)
FOUND = Tolerance(rtol=1e-4, reason="a hundredth of the standard deviations")
wrong = [
    mistake("sigma=sigma, absolute_sigma=True", "", "missing-term", "the errors of the data are not used"),
    mistake("True", "False", "constant-factor", "the covariance is scaled by χ²/(n − p)"),
    mistake("sigma=sigma", "sigma=sigma**2", "wrong-power", "the weights are 1/σ⁴"),
    mistake(
        "chain_frequency,",
        "lambda q, A, B: chain_frequency(q, B, A),",
        "component-order",
        "the order is (B, A)",
    ),
]
# Neither the number of the data nor their errors are those of the file.
data, drawn = (
    {"x": np.linspace(0.1, 3.1, 40), "sigma": np.linspace(0.2, 0.05, 40)},
    {"A": uniform(30, 60), "B": uniform(2, 9)},
)
asked = {"agree": (NEAR, NEAR), "uses": [chain_frequency], "mistakes": wrong}
fitted = fit(fit_dispersion, by_neighbours, **data, drawn=drawn, **asked)
wrong = [
    mistake(
        "best[0] + 4 * best[1]",
        "best[0] + best[1]",
        "constant-factor",
        "second neighbours are two distances away",
    ),
    mistake(
        "slope @ covariance @ slope",
        "slope**2 @ np.diag(covariance)",
        "missing-term",
        "A and B are taken as independent",
    ),
    mistake(
        " / sigma_data) ** 2)", ") ** 2)", "missing-division", "the residuals are not divided by their errors"
    ),
    mistake(
        "_data) ** 2)",
        "_data) ** 2) / (len(q_data) - 2)",
        "wrong-quantity",
        "χ² is divided by the degrees of freedom",
    ),
    mistake("chi2 = ", "best = np.array([47.0, 4.6])\nchi2 = "),
]
numbers = {"best": np.array([47.2362308548995, 4.34999608744723]), "chi2": 22.8223017395236}
numbers |= {"speed": 8.03966511769542, "speed_error": 0.0544222058199531}
of_file = variables(
    measured,
    numbers,
    agree=dict.fromkeys(numbers, FOUND),
    uses=[fit_dispersion, chain_frequency],
    mistakes=wrong,
)
notebook.exercise("7", "A measured dispersion", fitted, of_file)
