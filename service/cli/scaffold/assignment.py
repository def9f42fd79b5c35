"""The right solution, the exact answers and the known mistakes of each exercise."""

import numpy as np
import scipy.linalg
import scipy.special

from exercises.author import Notebook, Tolerance, mistake, normal, uniform
from exercises.kinds.values import values

notebook = Notebook(
    "The pendulum",
    setup="import numpy as np\n",
)
ROUNDING = Tolerance(limit=1e-12, reason="two forms of the formula differ by a few roundings of 1e-15")


def period(l, g, amplitude):
    """Return the period in s: length l in m, g in m/s², amplitude, the largest angle, in rad."""
    a, b = 1.0, np.cos(amplitude / 2)
    for _ in range(6):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return 2 * np.pi * np.sqrt(l / g) / a


notebook.exercise(
    "1",
    "The period of a pendulum",
    values(
        period,
        ask={"l": uniform(0.1, 5), "g": uniform(1, 20), "amplitude": uniform(0.1, 3)},
        truth=lambda l, g, amplitude: 4 * (l / g) ** 0.5 * scipy.special.ellipk(np.sin(amplitude / 2) ** 2),
        agree=ROUNDING,
        mistakes=[
            mistake(" / a", "", "missing-term", "the period does not depend on the amplitude"),
            mistake("2 * np.pi", "np.pi", "constant-factor", "half of the period is returned"),
        ],
    ),
)


def displacement(t, start, gamma, omega0):
    """Return x(t) in m of x'' + 2 gamma x' + omega0² x = 0 with gamma < omega0, in 1/s, from (x, x')(0)."""
    x, v = start
    omega = np.sqrt(omega0**2 - gamma**2)
    return np.exp(-gamma * t) * (x * np.cos(omega * t) + (v + gamma * x) / omega * np.sin(omega * t))


def by_matrix(t, start, gamma, omega0):
    """Return x(t) by the matrix exponential of the equation written as two of first order."""
    return (scipy.linalg.expm(t * np.array([[0, 1], [-(omega0**2), -2 * gamma]])) @ start)[0]


notebook.exercise(
    "2",
    "The damped oscillator",
    values(
        displacement,
        ask={"t": uniform(0.5, 5), "start": normal(2), "gamma": uniform(0.1, 0.5), "omega0": uniform(1, 3)},
        truth=by_matrix,
        agree=Tolerance(atol=1e-12, reason="the matrix exponential is exact to 1e-14, |x| is below 6"),
        mistakes=[
            mistake("omega0**2 - gamma**2", "omega0**2", "missing-term", "damping lowers the frequency"),
            mistake("exp(-gamma", "exp(gamma", "sign-flipped", "the amplitude grows"),
            mistake("(v + gamma * x)", "v", "missing-term", "x' at t = 0 is not the given one"),
        ],
    ),
)
