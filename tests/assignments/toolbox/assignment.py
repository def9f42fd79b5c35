"""Tools of computational physics: exercises of several kinds, as a course author would declare them."""

from math import pi, sqrt

import numpy as np
import scipy.linalg

from exercises.author import Notebook, Tolerance, Value, family, mistake, uniform
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
