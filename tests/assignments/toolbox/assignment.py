"""Tools of computational physics: exercises of several kinds, as a course author would declare them."""

from math import pi, sqrt

import matplotlib.pyplot as plt
import numpy as np
import scipy.linalg
from matplotlib.animation import FuncAnimation

from exercises.author import Notebook, Tolerance, Value, family, mistake, uniform
from exercises.kinds.animation import animation
from exercises.kinds.values import values

ROUNDING = "a few rounding errors of the summed terms"

SETUP = """
import numpy as np
import scipy.linalg
import matplotlib.pyplot as plt
from math import pi, sqrt
from matplotlib.animation import FuncAnimation
"""
notebook = Notebook("Tools of computational physics", setup=SETUP)


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


def animate_pendulums(t, a, b):
    fig, ax = plt.subplots()
    ax.set(xlim=(-1.8, 1.8), ylim=(-1.2, 0.2), aspect="equal")
    (bobs,) = ax.plot([], [], "o")

    def update(k):
        bobs.set_data([a[k, 0], b[k, 0]], [a[k, 1], b[k, 1]])
        return (bobs,)

    plt.close(fig)
    return FuncAnimation(fig, update, frames=len(t), blit=True)


def swing(x, angle):
    """Return the positions (n, 2) of a pendulum of length 1 that hangs at x."""
    return np.column_stack([x + np.sin(angle), -np.cos(angle)])


TIMES = np.linspace(0, 6, 50)
TOGETHER, OPPOSED = 0.35 * np.cos(2 * TIMES), 0.35 * np.cos(2.7 * TIMES)

notebook.exercise(
    "20",
    "Two coupled pendulums",
    animation(
        animate_pendulums,
        ask={"t": TIMES, "a": swing(-0.7, TOGETHER + OPPOSED), "b": swing(0.7, TOGETHER - OPPOSED)},
        follow=("a", "b"),
        agree=Tolerance(limit=0.03, reason="linear interpolation between the samples deviates by a tenth of it"),
        mistakes=[
            mistake("b[k, 0]], [a[k, 1], b[k, 1]]", "a[k, 0]], [a[k, 1], a[k, 1]]", "wrong-motion", "a is drawn twice"),
            mistake("(k):\n", "(k):\n        k = k * k // len(t)\n", "wrong-frames", "the samples are not shown at an even rate"),
            mistake("b[k, 0]], [a[k, 1], b[k, 1]]", "b[0, 0]], [a[k, 1], b[0, 1]]", "wrong-motion", "b stays where it begins"),
        ],
    ),
)
