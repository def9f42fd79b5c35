"""Tools of computational physics: exercises of several kinds, as a course author would declare them."""

from math import pi, sqrt

import matplotlib.pyplot as plt
import numpy as np
import scipy.linalg
from matplotlib.animation import FuncAnimation
from scipy.optimize import curve_fit

from exercises.authoring.kinds.animation import animation
from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.random import estimate, generator, samples
from exercises.authoring.kinds.stepper import rk4, stepper
from exercises.authoring.kinds.values import values
from exercises.authoring.kinds.variables import claim, variables
from exercises.authoring.questions.author import (
    Notebook,
    Tolerance,
    Value,
    family,
    integers,
    mistake,
    uniform,
)

ROUNDING = "a few rounding errors of the summed terms"

SETUP = """
import matplotlib.pyplot as plt
import numpy as np
import scipy.linalg
from math import pi, sqrt
from matplotlib.animation import FuncAnimation
from scipy.optimize import curve_fit
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
        ask={
            "f": family("E - e*sin(E) - M", "E", M=uniform(0.01, 3.1), e=uniform(0, 0.99)),
            "a": 0.0,
            "b": pi,
            "tol": 1e-12,
        },
        truth=kepler,
        agree=Tolerance(atol=2e-12, reason="tol, twice"),
        points=4,
        partial=True,
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
        conserved={
            "energy": (
                "y[1]**2 / 2 - g * cos(y[0])",
                Tolerance(limit=1e-8, reason="the error of the integration"),
            )
        },
        mistakes=[
            mistake("np.sin(y[0])", "y[0]", "missing-term", "the angle is not small"),
            mistake(
                "-g * np.sin(y[0])", "-g * np.sin(y[0]) - 1e-4 * y[1]", "wrong-quantity", "friction is added"
            ),
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
            "f": family(
                "A @ y + b * cos(t) - c * y**3",
                "t",
                "y",
                A=uniform(-1, 1, 3, 3),
                b=uniform(-1, 1, 3),
                c=uniform(0, 1),
            ),
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
            mistake(
                "h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)", "h * k1", "wrong-quantity", "this is Euler's step"
            ),
            mistake(
                "k1 + 2 * k2 + 2 * k3 + k4",
                "1.5 * (k1 + k2 + k3 + k4)",
                "constant-factor",
                "the slopes are weighted alike",
            ),
            mistake(
                "f(t + h / 2, y + h / 2 * k2)",
                "f(t, y + h / 2 * k2)",
                "missing-term",
                "the third slope is that of time t",
            ),
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


def energies(x, v, k, m):
    return {"kinetic": m * v**2 / 2, "potential": k * x**2 / 2}


def jacobi(A, b, steps):
    x, history = np.zeros(len(b)), []
    for _ in range(steps):
        x = (b - A @ x + np.diag(A) * x) / np.diag(A)
        history.append(x)
    return history


def dominant(rng):
    return rng.uniform(-1, 1, (3, 3)) + 4 * np.eye(3)


def powers(A, b, steps):
    """Return the partial sums of the Neumann series of the splitting A = D (1 - G)."""
    D = np.diag(1 / np.diag(A))
    G = np.eye(3) - D @ A
    return np.cumsum([np.linalg.matrix_power(G, k) @ D @ b for k in range(steps)], axis=0)


notebook.exercise(
    "8",
    "Structured results",
    values(
        energies,
        ask={"x": uniform(-1, 1), "v": uniform(-2, 2), "k": uniform(1, 9), "m": uniform(1, 3)},
        truth=lambda x, v, k, m: {"kinetic": 0.5 * m * v * v, "potential": 0.5 * k * x * x},
        agree={
            "kinetic": Tolerance(rtol=1e-13, reason=ROUNDING),
            "potential": Tolerance(rtol=1e-13, reason=ROUNDING),
        },
        keys=True,
        mistakes=[mistake("v**2 / 2", "v**2", "constant-factor", "the kinetic energy lacks its factor 1/2")],
    ),
    values(
        jacobi,
        ask={"A": dominant, "b": uniform(-1, 1, 3), "steps": 8},
        truth=powers,
        agree=Tolerance(limit=1e-12, reason=ROUNDING),
        label="every iterate of the history is right",
        mistakes=[
            mistake("np.zeros(len(b))", "np.ones(len(b))", "wrong-start", "it starts at 1, not at 0"),
            mistake("return history", "return [x] * steps"),
        ],
    ),
)


def decay_times(n, tau, rng):
    return -tau * np.log(1 - rng.random(n))


def end_point(steps):
    return 2 * np.sum(np.random.default_rng().random(steps) < 0.5) - steps


def pi_estimate(n):
    x, y = np.random.random((2, n))
    hits = 4.0 * (x**2 + y**2 < 1)
    return hits.mean(), hits.std() / sqrt(n)


notebook.exercise(
    "9",
    "Random numbers",
    samples(
        decay_times,
        ask={"n": 5000, "tau": uniform(0.5, 3), "rng": generator()},
        distribution="expon",
        scale=lambda tau: tau,
        mistakes=[
            mistake("-tau *", "-", "missing-term", "the decay time is missing"),
            mistake("-tau *", "-1.05 * tau *"),
            mistake("rng.random(n)", "np.repeat(rng.random(n // 2), 2)"),
            mistake(
                "rng.random(n)",
                "np.random.default_rng(1).random(n)",
                "ignores-argument",
                "the generator is not used",
            ),
            mistake("rng.random(n)", "np.random.random(n)"),
        ],
    ),
    samples(
        end_point,
        ask={"steps": integers(10, 40)},
        distribution="binom",
        call="(end_point(steps) + steps) / 2",
        repetitions=1500,
        n=lambda steps: steps,
        p=0.5,
        mistakes=[
            mistake("0.5", "0.6"),
            mistake("- steps", "- steps + 1"),
            mistake("default_rng()", "default_rng(1)"),
        ],
    ),
    estimate(
        pi_estimate,
        ask={"n": 2000},
        truth=pi,
        sd=lambda n: sqrt(pi * (4 - pi) / n),
        error=Tolerance(limit=0.12, reason="five times the spread of the error of 2000 points"),
        mistakes=[
            mistake(" / sqrt(n)", "", "missing-term", "the error is that of a point, not of the mean"),
            mistake("hits.std()", "10 * hits.std()"),
            mistake("hits.mean()", "hits.mean() + 0.02"),
            mistake(
                "random((2, n))", "random((2, n // 2))", "missing-term", "only half of the points are drawn"
            ),
            mistake(
                "np.random.random(",
                "np.random.default_rng(5).random(",
                "fixed-seed",
                "every call starts with the same seed",
            ),
        ],
    ),
)


def fit_decay(t, counts, sigma):
    def model(t, A, k):
        return A * np.exp(-k * t)

    p, C = curve_fit(model, t, counts, p0=(1, 1), sigma=sigma, absolute_sigma=True, xtol=1e-12, ftol=1e-12)
    return p, C


def decay(t, A, k):
    return A * np.exp(-k * t)


TIMES = np.linspace(0, 3, 25)
notebook.exercise(
    "10",
    "A fit",
    fit(
        fit_decay,
        decay,
        x=TIMES,
        sigma=0.02 + 0.02 * TIMES,
        drawn={"A": uniform(1, 4), "k": uniform(0.5, 2)},
        agree=(
            Tolerance(limit=1e-4, reason="of its standard deviation"),
            Tolerance(limit=1e-4, reason="of two standard deviations"),
        ),
        mistakes=[
            mistake(
                "sigma=sigma, absolute_sigma=True, ",
                "",
                "missing-term",
                "the errors of the data are not used",
            ),
            mistake("sigma=sigma", "sigma=sigma**2"),
            mistake(
                "absolute_sigma=True",
                "absolute_sigma=False",
                "constant-factor",
                "the covariance is scaled by χ²/(n − p)",
            ),
            mistake(
                "return p, C", "return p, np.diag(np.diag(C))", "missing-term", "the covariances are missing"
            ),
            mistake("return p, C", "return p, np.sqrt(abs(C))"),
        ],
    ),
)


def spins():
    moments = np.array([1.0, 2.0, 3.0])
    nudge = 1e-3
    first, second, third = moments
    rate = np.sqrt((second - first) * (third - second) / (first * third))
    growth_middle = nudge * np.cosh(4 * rate)
    growth_extreme = nudge * np.sqrt(2)
    axes = np.array([first, second, third]) / moments.sum()
    return rate, growth_middle, growth_extreme, axes


notebook.exercise(
    "11",
    "Numbers computed in a cell",
    variables(
        spins,
        truth={"rate": 3**-0.5, "axes": lambda: [1 / 6, 1 / 3, 1 / 2]},
        agree={
            "rate": Tolerance(rtol=1e-12, reason=ROUNDING),
            "axes": Value(
                Tolerance(rtol=1e-12, reason=ROUNDING), label="the moments are fractions of their sum"
            ),
        },
        claims=[
            claim(
                "growth_extreme < 0.003 < growth_middle",
                "spin is stable about the extreme axes, unstable about the middle axis",
                reason="three times the nudge",
            )
        ],
        mistakes=[
            mistake(
                "(first * third)", "(first * second)", "wrong-index", "the second moment stands for the third"
            ),
            mistake(
                "np.cosh(4 * rate)", "np.cos(4 * rate)", "missing-term", "it oscillates instead of growing"
            ),
            mistake(" / moments.sum()", " / moments"),
        ],
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


def halved_step():
    halved = heun_step(lambda t, y: -y, 0.0, 1.0, 0.5)
    return halved


DECAY = family("-k * y", "t", "y", k=uniform(0.5, 2))
CHAINED = {"y": uniform(-1, 1, 2), "T": uniform(0.5, 2), "n": integers(4, 9)}
notebook.exercise(
    "12",
    "An integration of several steps",
    values(
        heun_step,
        ask={"f": DECAY, "t": 0.0, "y": uniform(-1, 1, 2), "h": uniform(0.05, 0.2)},
        truth=lambda k, y, h: y * growth(-k * h),
        agree=Tolerance(limit=1e-13, reason=ROUNDING),
        mistakes=[
            mistake(
                "h / 2 * (slope + f(t + h, y + h * slope))",
                "h * slope",
                "wrong-quantity",
                "this is Euler's step",
            )
        ],
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
    variables(
        halved_step,
        truth={"halved": 0.625},
        agree={"halved": Tolerance(rtol=1e-12, reason=ROUNDING)},
        uses=[heun_step],
        mistakes=[mistake("0.5)", "0.25)", "constant-factor", "the step is half as long")],
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


SECONDS = np.linspace(0, 6, 50)
TOGETHER, OPPOSED = 0.35 * np.cos(2 * SECONDS), 0.35 * np.cos(2.7 * SECONDS)

notebook.exercise(
    "13",
    "Two coupled pendulums",
    animation(
        animate_pendulums,
        ask={"t": SECONDS, "a": swing(-0.7, TOGETHER + OPPOSED), "b": swing(0.7, TOGETHER - OPPOSED)},
        follow=("a", "b"),
        agree=Tolerance(
            limit=0.03, reason="linear interpolation between the samples deviates by a tenth of it"
        ),
        mistakes=[
            mistake(
                "b[k, 0]], [a[k, 1], b[k, 1]]",
                "a[k, 0]], [a[k, 1], a[k, 1]]",
                "wrong-motion",
                "a is drawn twice",
            ),
            mistake(
                "(k):\n",
                "(k):\n        k = k * k // len(t)\n",
                "wrong-frames",
                "the samples are not shown at an even rate",
            ),
            mistake(
                "b[k, 0]], [a[k, 1], b[k, 1]]",
                "b[0, 0]], [a[k, 1], b[0, 1]]",
                "wrong-motion",
                "b stays where it begins",
            ),
        ],
    ),
)
