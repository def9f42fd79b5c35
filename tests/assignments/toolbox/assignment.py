"""Tools of computational physics: exercises of several kinds, as a course author would declare them."""

from math import pi, sqrt

import numpy as np
import scipy.linalg

from exercises.author import Notebook, Tolerance, Value, family, integers, mistake, uniform
from exercises.kinds.values import values

ROUNDING = "a few rounding errors of the summed terms"

notebook = Notebook("Tools of computational physics", setup="import numpy as np\nimport scipy.linalg\nfrom math import pi, sqrt\n")


def find_root(f, a, b, tol):
    while b - a > tol:
        m = (a + b) / 2
        a, b = (m, b) if f(m) < 0 else (a, m)
    return (a + b) / 2


def kepler(M, e):
    """Return the root of Kepler's equation by Newton's method."""
    E = pi
    for _ in range(80):
        E -= (E - e * np.sin(E) - M) / (1 - e * np.cos(E))
    return E


notebook.exercise(
    "1",
    "A root finder",
    values(
        find_root,
        ask={"f": family("E - e*sin(E) - M", "E", M=uniform(0.01, 3.1), e=uniform(0, 0.99)), "a": 0.0, "b": pi, "tol": 1e-12},
        truth=kepler,
        agree=Tolerance(atol=2e-12, reason="tol, twice"),
        calls=Tolerance(limit=60, reason="bisection needs 42"),
        mistakes=[
            mistake("f(m) < 0", "f(m) > 0", "sign-flipped", "the search keeps the half without the root"),
            mistake("> tol", "> 1e-6", "precision-loss", "the search stops at 1e-6 whatever tol is"),
            mistake("    while", "    for v in np.linspace(a, b, 61): f(v)\n    while"),
        ],
    ),
)


def normal_modes(M, K):
    w2, X = scipy.linalg.eigh(K, M)
    return np.sqrt(w2), X


def masses(rng):
    return np.diag(rng.uniform(0.5, 3, 3))


def springs(rng):
    B = rng.normal(size=(3, 3))
    return B @ B.T + np.diag([0.2, 1, 2])


def modes(M, K):
    """Return frequencies and modes from the eigenvectors of M^(-1/2) K M^(-1/2)."""
    root = np.diag(np.diag(M) ** -0.5)
    w2, U = np.linalg.eigh(root @ K @ root)
    return np.sqrt(w2), root @ U


notebook.exercise(
    "2",
    "Normal modes",
    values(
        normal_modes,
        ask={"M": masses, "K": springs},
        truth=modes,
        agree={
            "omega": Tolerance(limit=1e-10, reason=ROUNDING),
            "X": Value(Tolerance(limit=1e-9, reason=ROUNDING), up_to="column signs"),
        },
        mistakes=[
            mistake("np.sqrt(w2)", "w2", "missing-term", "the square root of the eigenvalues is missing"),
            mistake("eigh(K, M)", "eigh(K)", "missing-term", "the masses are missing"),
            mistake("(w2), X", "(w2), X.T", "transposed-rotation", "the modes are rows instead of columns"),
        ],
    ),
)


class Pendulum:
    def __init__(self, l, g):
        self.l, self.g = l, g

    def period(self):
        return 2 * pi * sqrt(self.l / self.g)


notebook.exercise(
    "3",
    "A class",
    values(
        Pendulum,
        ask={"l": uniform(0.1, 9), "g": uniform(1, 20)},
        call="Pendulum(l, g).period()",
        truth=lambda l, g: 2 * np.pi * (l / g) ** 0.5,
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        mistakes=[mistake("2 * pi", "pi", "constant-factor", "half of the period is returned")],
    ),
)


def heun_step(f, t, y, h):
    slope = f(t, y)
    return y + h / 2 * (slope + f(t + h, y + h * slope))


def integrate(f, y, T, n):
    h = T / n
    for k in range(n):
        y = heun_step(f, k * h, y, h)
    return y


def error_estimate(f, y, T, n):
    return (integrate(f, y, T, 2 * n) - integrate(f, y, T, n)) / 3


def growth(z):
    """Return the factor by which a step of Heun's method for y' = λy changes y, with z = λh."""
    return 1 + z + z**2 / 2


DECAY = family("-k * y", "t", "y", k=uniform(0.5, 2))
CHAINED = {"y": uniform(-1, 1, 2), "T": uniform(0.5, 2), "n": integers(4, 9)}
notebook.exercise(
    "chain",
    "An integration of several steps",
    values(
        heun_step,
        ask={"f": DECAY, "t": 0.0, "y": uniform(-1, 1, 2), "h": uniform(0.05, 0.2)},
        truth=lambda k, y, h: y * growth(-k * h),
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        mistakes=[mistake("h / 2 * (slope + f(t + h, y + h * slope))", "h * slope", "wrong-quantity", "this is Euler's step")],
    ),
    values(
        integrate,
        ask={"f": DECAY, **CHAINED},
        truth=lambda k, y, T, n: y * growth(-k * T / n) ** n,
        agree=Tolerance(limit=1e-12, reason=ROUNDING),
        uses=[heun_step],
        mistakes=[mistake("range(n)", "range(n - 1)", "off-by-one", "the last step is missing")],
    ),
    values(
        error_estimate,
        ask={"f": DECAY, **CHAINED},
        truth=lambda k, y, T, n: y * (growth(-k * T / n / 2) ** (2 * n) - growth(-k * T / n) ** n) / 3,
        agree=Tolerance(atol=1e-12, reason=ROUNDING),
        uses=[integrate],
        mistakes=[mistake("/ 3", "/ 4", "constant-factor", "the error is divided by 4")],
    ),
)
