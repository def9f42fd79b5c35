"""Tools of computational physics: exercises of several kinds, as a course author would declare them."""

from math import pi, sqrt

import matplotlib.pyplot as plt
import numpy as np
import scipy.linalg
from matplotlib.animation import FuncAnimation

from exercises.author import Notebook, Tolerance, Value, family, mistake, uniform
from exercises.kinds.animation import animation
from exercises.kinds.ode import ode
from exercises.kinds.stepper import rk4, stepper
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


def oscillator(t, y, w, g):
    return [y[1], -(w**2) * y[0] - 2 * g * y[1]]


def damped(t, y, w, g):
    """Return position and velocity of the damped oscillator."""
    v = sqrt(w**2 - g**2)
    x = y[0] * np.cos(v * t) + (y[1] + g * y[0]) / v * np.sin(v * t)
    rate = y[1] * np.cos(v * t) - (w**2 * y[0] + g * y[1]) / v * np.sin(v * t)
    return np.exp(-g * t) * x, np.exp(-g * t) * rate


notebook.exercise(
    "4",
    "The damped oscillator",
    ode(
        oscillator,
        ask={"t": uniform(0, 9), "y": uniform(-2, 2, 2), "w": uniform(1, 4), "g": uniform(0.1, 0.9)},
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        motion=damped,
        t_end=10.0,
        follow=Tolerance(limit=1e-8, reason="a hundred times the error of the integration"),
        mistakes=[
            mistake("-(w**2)", "w**2", "sign-flipped", "the spring pushes away"),
            mistake("2 * g", "g", "constant-factor", "half of the damping"),
            mistake(" - 2 * g * y[1]", "", "missing-term", "there is no damping"),
        ],
    ),
)


def pendulum(t, y, g):
    return np.array([y[1], -g * np.sin(y[0])])


notebook.exercise(
    "5",
    "The pendulum",
    ode(
        pendulum,
        ask={"t": 0.0, "y": uniform(-2, 2, 2), "g": uniform(1, 9)},
        truth=lambda y, g: [y[1], -g * np.imag(np.exp(1j * y[0]))],
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        t_end=10.0,
        follow=Tolerance(limit=1e-7, reason="a hundred times the error of the integration"),
        conserved={"energy": ("y[1]**2 / 2 - g * cos(y[0])", Tolerance(limit=1e-8, reason="the error of the integration"))},
        mistakes=[
            mistake("np.sin(y[0])", "y[0]", "missing-term", "the angle is not small"),
            mistake("-g * np.sin(y[0])", "-g * np.sin(y[0]) - 1e-4 * y[1]", "wrong-quantity", "friction is added"),
        ],
    ),
)


def rk4_step(f, t, y, h):
    k1 = f(t, y)
    k2 = f(t + h / 2, y + h / 2 * k1)
    k3 = f(t + h / 2, y + h / 2 * k2)
    k4 = f(t + h, y + h * k3)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


ORDER = "the slope still bends at the first steps"
SEARCHED = "the published limit has four digits"

notebook.exercise(
    "6",
    "A step of Runge and Kutta",
    stepper(
        rk4_step,
        ask={
            "f": family("A @ y + b * cos(t) - c * y**3", "t", "y", A=uniform(-1, 1, 3, 3), b=uniform(-1, 1, 3), c=uniform(0, 1)),
            "t": uniform(0, 9),
            "y": uniform(-1, 1, 3),
            "h": uniform(0.1, 0.4),
        },
        truth=rk4,
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        calls=Tolerance(limit=4, reason="four stages"),
        order=(4, Tolerance(atol=0.3, reason=ORDER)),
        stability=(2.785, Tolerance(rtol=1e-3, atol=0, reason=SEARCHED)),
        mistakes=[
            mistake("h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)", "h * k1", "wrong-quantity", "this is Euler's step"),
            mistake("k1 + 2 * k2 + 2 * k3 + k4", "1.5 * (k1 + k2 + k3 + k4)", "constant-factor", "the slopes are weighted alike"),
            mistake("f(t + h / 2, y + h / 2 * k2)", "f(t, y + h / 2 * k2)", "missing-term", "the third slope is that of time t"),
            mistake("    k1 =", "    f(t, y)\n    k1 ="),
        ],
    ),
)


def verlet(force, x, v, h):
    half = v + h / 2 * force(x)
    x = x + h * half
    return x, half + h / 2 * force(x)


notebook.exercise(
    "7",
    "A step of Verlet",
    stepper(
        verlet,
        ask={
            "force": family("-k * x - sin(x)", "x", k=uniform(0.5, 2)),
            "x": uniform(-1, 1, 2),
            "v": uniform(-1, 1, 2),
            "h": uniform(0.05, 0.4),
        },
        rates=lambda force, x, v: (v, force(x)),
        truth=lambda force, x, v, h: (
            x + h * v + h**2 / 2 * force(x),
            v + h / 2 * (force(x) + force(x + h * v + h**2 / 2 * force(x))),
        ),
        agree={name: Tolerance(limit=1e-13, reason=ROUNDING) for name in ("x", "v")},
        order=(2, Tolerance(atol=0.2, reason=ORDER)),
        stability=(2, Tolerance(rtol=1e-3, atol=0, reason="the search ends at a millionth")),
        mistakes=[
            mistake("half + h / 2 * force(x)", "half", "missing-term", "the second half kick is missing"),
            mistake("x + h * half", "x + h * v", "wrong-quantity", "the drift uses the old velocity"),
        ],
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
