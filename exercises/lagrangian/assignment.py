"""Lagrangian mechanics with sympy: equations of motion, conserved quantities, and the motion of a bead on a
rotating hoop.

tests/exercises/test_lagrangian.py compares each truth with 30-digit derivatives, integrals and motions of
mpmath.
"""

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from exercises.authoring.kinds.expression import expression, symbol
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author import Notebook, Tolerance, family, mistake, uniform

notebook = Notebook("Lagrangian mechanics", notebook="notebook.ipynb", packages=("sympy",))
ROUNDING = Tolerance(limit=1e-11, reason="ten thousand rounding errors of the largest number")


# 1. Truths: the derivatives by hand.
def equation_of_motion(L, q, v, a):
    momentum = sp.diff(L(q, v), v)
    return sp.diff(momentum, v) * a + sp.diff(momentum, q) * v - sp.diff(L(q, v), q)


def of_varying_mass(q, v, a, m, c, k, b):
    return m * (1 + c * q**2) * a + m * c * q * v**2 + k * q**3


def relativistic(q, v, a, m, k):
    return m * a / np.sqrt(1 - v**2) ** 3 + k * q


def of_all_powers(q, v, a, m, c, k, b):
    return (3 * m * (q * v) ** 2 + 2 * c * q * v) * a + 3 * m * q * v**4 / 2 + 2 * c * v**3 / 3 + k * q


def equation(text, v, truth, label, *wrong, **drawn):
    ask = {"L": family(text, "q", "v", **drawn), "q": symbol(-2, 2), "v": symbol(-v, v), "a": symbol(-3, 3)}
    label = f"equation_of_motion is right for {label}"
    return expression(equation_of_motion, ask, truth, agree=ROUNDING, label=label, mistakes=wrong)


last = mistake(
    "- sp.diff(L(q, v), q)", "+ sp.diff(L(q, v), q)", "sign-flipped", "∂L/∂q has the opposite sign"
)
mixed = mistake(" + sp.diff(momentum, q) * v", "", "missing-term", "∂L/∂v depends on time also through q")
first = mistake("sp.diff(momentum, v) * a", "a", "missing-term", "∂²L/∂v² is missing before the acceleration")
mass = "m * (1 + c * q**2) * v**2 / 2 - k * q**4 / 4 + b * q * v"
drawn = {name: uniform(0.5, 2) for name in "mckb"}
varying = equation(mass, 2, of_varying_mass, "a mass that depends on q", last, mixed, first, **drawn)
text = "m * q**2 * v**4 / 4 + c * q * v**3 / 3 - k * q**2 / 2 + b * q**2 * v"
unnamed = equation(
    text, 2, of_all_powers, "a Lagrangian that the text does not name", last, mixed, first, **drawn
)
drawn = {name: uniform(0.5, 2) for name in "mk"}
text = "-m * (1 - v**2) ** 0.5 - k * q**2 / 2"
fast = equation(text, 0.8, relativistic, "a fast particle", last, first, **drawn)
notebook.exercise("1", "The equation of motion", varying, fast, unnamed)


# 2. Truth: the kinetic energy of two perpendicular velocities, and the force in the rotating frame.
def hoop(theta, v, m, R, g, Omega):
    L = m * R**2 * (v**2 + Omega**2 * sp.sin(theta) ** 2) / 2 + m * g * R * sp.cos(theta)
    return L, sp.diff(L, theta) / sp.diff(L, v, 2)


def in_the_rotating_frame(theta, v, m, R, g, Omega):
    along, across, x, y = R * v, R * Omega * np.sin(theta), R * np.sin(theta), -R * np.cos(theta)
    centrifugal, weight = Omega**2 * x, -g
    L = m / 2 * abs(complex(along, across)) ** 2 - m * g * y
    return L, (centrifugal * np.cos(theta) + weight * np.sin(theta)) / R


positive = {"m": symbol(0.5, 2, positive=True), "R": symbol(0.5, 2, positive=True)}
positive |= {"g": symbol(5, 15, positive=True), "Omega": symbol(1, 6, positive=True)}
ask = {"theta": symbol(-3, 3), "v": symbol(-3, 3), **positive}
agree = {"L": ROUNDING, "acceleration": ROUNDING}
wrong = [
    mistake(
        "m * g * R * sp.cos(theta)", "-m * g * R * sp.cos(theta)", "sign-flipped", "the weight points up"
    ),
    mistake(
        " + Omega**2 * sp.sin(theta) ** 2",
        "",
        "missing-term",
        "the velocity of the hoop is missing in the kinetic energy",
    ),
    mistake(
        "Omega**2 * sp.sin(theta) ** 2", "Omega**2", "missing-term", "the distance from the axis is R sin θ"
    ),
    mistake("sp.diff(L, theta) /", "-sp.diff(L, theta) /", "sign-flipped", "∂L/∂θ has the opposite sign"),
]
notebook.exercise(
    "2",
    "A bead on a rotating hoop",
    expression(hoop, ask, in_the_rotating_frame, agree=agree, mistakes=wrong),
)


# 3. Truth: Newton's equations with the tension of the rod.
def cart(theta, w, M, m, l, g):
    v, X, A = sp.symbols("v X A")
    L = (M + m) * v**2 / 2 + m * l * v * w * sp.cos(theta) + m * l**2 * w**2 / 2 + m * g * l * sp.cos(theta)
    rates = [
        sp.diff(p, v) * X + sp.diff(p, w) * A + sp.diff(p, theta) * w for p in (sp.diff(L, v), sp.diff(L, w))
    ]
    found = sp.solve([rates[0], rates[1] - sp.diff(L, theta)], [X, A])
    return found[X], found[A]


def by_newton(theta, w, M, m, l, g):
    s, c = np.sin(theta), np.cos(theta)
    rows = [[M, 0, -s], [m, m * l * c, s], [0, m * l * s, -c]]
    return tuple(np.linalg.solve(rows, [0, m * l * w**2 * s, -m * l * w**2 * c - m * g])[:2])


masses = {"M": symbol(0.5, 3, positive=True), "m": symbol(0.5, 2, positive=True)}
masses |= {"l": symbol(0.5, 2, positive=True), "g": symbol(5, 15, positive=True)}
angle = {"theta": symbol(-3, 3), "w": symbol(-3, 3)}
wrong = [
    mistake(
        "v * w * sp.cos(theta)",
        "v * w",
        "missing-term",
        "the velocities of cart and pendulum are not parallel",
    ),
    mistake("(M + m) * v**2", "M * v**2", "missing-term", "the bob moves with the cart too"),
    mistake(
        "+ m * g * l * sp.cos(theta)", "- m * g * l * sp.cos(theta)", "sign-flipped", "the weight points up"
    ),
    mistake(
        "found[X], found[A]",
        "found[A], found[X]",
        "component-order",
        "the acceleration of the angle comes first",
    ),
]
agree = {"X": ROUNDING, "A": ROUNDING}
notebook.exercise(
    "3", "A pendulum on a cart", expression(cart, angle | masses, by_newton, agree=agree, mistakes=wrong)
)


# 4. Truths: the energy in the rotating frame; momentum and energy of the velocities in Cartesian coordinates.
def hoop_conserved(theta, v, m, R, g, Omega):
    L = m * R**2 * (v**2 + Omega**2 * sp.sin(theta) ** 2) / 2 + m * g * R * sp.cos(theta)
    return v * sp.diff(L, v) - L


def with_centrifugal_potential(theta, v, m, R, g, Omega):
    x, y = R * np.sin(theta), -R * np.cos(theta)
    return m * ((R * v) ** 2 / 2 - (Omega * x) ** 2 / 2 + g * y)


def cart_conserved(v, theta, w, M, m, l, g):
    p = (M + m) * v + m * l * w * sp.cos(theta)
    E = (
        M * v**2 / 2
        + m * (v**2 + 2 * l * v * w * sp.cos(theta) + l**2 * w**2) / 2
        - m * g * l * sp.cos(theta)
    )
    return p, E


def by_velocities(v, theta, w, M, m, l, g):
    bob = v + l * w * np.exp(1j * theta)
    return M * v + m * bob.real, M * v**2 / 2 + m * abs(bob) ** 2 / 2 - m * g * l * np.cos(theta)


wrong = [
    mistake("- L", "+ L", "sign-flipped", "L has the opposite sign"),
    mistake(
        "v * sp.diff(L, v) -",
        "2 * L.subs(g, 0) -",
        "wrong-quantity",
        "T + V changes: a motor keeps Ω constant",
    ),
]
of_hoop = expression(hoop_conserved, ask, with_centrifugal_potential, agree=ROUNDING, mistakes=wrong)
wrong = [
    mistake(
        "m) * v + m * l * w * sp.cos(theta)",
        "m) * v",
        "missing-term",
        "the bob also moves relative to the cart",
    ),
    mistake(
        "2 * l * v * w",
        "l * v * w",
        "constant-factor",
        "the product of the two velocities is counted once, not twice",
    ),
    mistake(
        "- m * g * l",
        "+ m * g * l",
        "sign-flipped",
        "T − V, which is L: V is lowest when the pendulum hangs, and E = T + V",
    ),
]
asked = {"v": symbol(-3, 3), **angle, **masses}
of_cart = expression(
    cart_conserved, asked, by_velocities, agree={"p": ROUNDING, "E": ROUNDING}, mistakes=wrong
)
notebook.exercise("4", "Conserved quantities", of_hoop, of_cart)


# 5. Truth: the derivative of the effective potential by a complex step.
def hoop_rates(t, y, R, g, Omega):
    theta, w = y
    return np.array([w, (Omega**2 * np.cos(theta) - g / R) * np.sin(theta)])


def by_complex_step(y, R, g, Omega):
    z = y[0] + 1e-30j
    return [y[1], -np.imag(-g / R * np.cos(z) - Omega**2 * np.sin(z) ** 2 / 2) / 1e-30]


kept = "y[1] ** 2 / 2 - g / R * cos(y[0]) + Omega**2 * cos(y[0]) ** 2 / 2 + g / R"
wrong = [
    mistake("- g / R", "- g", "missing-division", "the weight is not divided by R"),
    mistake("Omega**2 * np.cos(theta) - ", "-", "missing-term", "the hoop does not rotate"),
    mistake("Omega**2", "Omega", "wrong-power", "Ω is not squared"),
]
slow = {"R": uniform(0.5, 1.5), "g": uniform(8, 12), "Omega": uniform(0.5, 2)}
states = lambda rng: rng.uniform([-3, -12], [3, 12])  # noqa: E731
turning = ode(
    hoop_rates,
    {"t": uniform(0, 20), "y": states, "R": uniform(0.3, 2.5), "g": uniform(5, 15), "Omega": uniform(1, 11)},
    Tolerance(limit=1e-12, reason="a thousand rounding errors"),
    truth=by_complex_step,
    t_end=5.0,
    follow=Tolerance(limit=1e-7, reason="a hundred times the error of the integration"),
    conserved={
        "the integral h": (kept, Tolerance(limit=1e-8, reason="a hundred times the error of the integration"))
    },
    mistakes=wrong,
)
notebook.exercise("5", "A function for the solver", turning)


# 6. Truth: the polynomial equations of s = sin θ, c = cos θ and w.
def hoop_motion(t, y0, R, g, Omega):
    run = solve_ivp(
        hoop_rates, (0, t[-1]), y0, t_eval=t, args=(R, g, Omega), method="DOP853", rtol=1e-10, atol=1e-10
    )
    return run.y[0]


def by_polynomials(t, y0, R, g, Omega):
    def rates(t, y):
        _, s, c, w = y
        return [w, c * w, -s * w, (Omega**2 * c - g / R) * s]

    start = [y0[0], np.sin(y0[0]), np.cos(y0[0]), y0[1]]
    return solve_ivp(rates, (0, t[-1]), start, "DOP853", t, rtol=1e-13, atol=1e-14).y[0]


NUMERIC = "a solver at rtol = 1e-10 is a hundred times better"
EXACTLY = ', method="DOP853", rtol=1e-10, atol=1e-10'
DEFAULT = "the default tolerances of solve_ivp give three digits"
wrong = [
    mistake("run.y[0]", "run.y[1]", "wrong-index", "the angular velocities are returned"),
    mistake(EXACTLY, "", "precision-loss", DEFAULT),
    mistake("(0, t[-1])", "(t[0], t[-1])", "wrong-times", "y0 is the state at the time 0, not at t[0]"),
]
agree = Tolerance(limit=1e-6, reason=f"of the largest angle; {NUMERIC}")
ask = {"t": np.linspace(0.1, 5, 9), "y0": uniform(-1.5, 1.5, 2), **slow}
shared = {"truth": by_polynomials, "uses": [hoop_rates], "mistakes": wrong}
back = values(hoop_motion, ask, agree, label="hoop_motion is right for a bead that swings", **shared)
ask = ask | {"y0": lambda rng: [rng.uniform(-1.5, 1.5), rng.choice([-1, 1]) * rng.uniform(11, 14)]}
over = values(
    hoop_motion, ask, agree, label="hoop_motion is right for a bead that goes over the top", **shared
)
notebook.exercise("6", "The motion of the bead", back, over)


# 7. Truth: the conserved integral gives the time as an integral over θ, which is smooth in another variable.
def rest_time(theta0, R, g, Omega):
    def rest(t, y, *_):
        return y[1]

    start = np.array([theta0, 0.0])
    rest.terminal, rest.direction = True, -np.sign(hoop_rates(0.0, start, R, g, Omega)[1])
    run = solve_ivp(
        hoop_rates, (0, 10), start, events=rest, args=(R, g, Omega), method="DOP853", rtol=1e-10, atol=1e-10
    )
    return run.t_events[0][0]


def by_quadrature(theta0, R, g, Omega):
    angle, start = np.pi * (np.arange(400) + 0.5) / 400, np.cos(theta0)
    other = 2 * g / (R * Omega**2) - start
    if other < 1:  # the bead turns where cos θ has this value
        cosine = (start + other) / 2 + (start - other) / 2 * np.cos(angle)
        return np.pi / Omega * np.mean((1 - cosine**2) ** -0.5)
    sine = np.sin(theta0 / 2) * np.sin(angle)
    rest = 2 * g / R - Omega**2 * (1 - 2 * sine**2 + start)
    return np.pi * np.sqrt(2) * np.mean(((1 - sine**2) * rest) ** -0.5)


def either(low, high):
    return lambda rng: rng.choice([rng.uniform(*low), rng.uniform(*high)])


wrong = [
    mistake("-np.sign(", "np.sign(", "returns-zero", "this is the rest at the start: the next one is asked"),
    mistake(
        "return run.t_events[0][0]",
        "return 2 * run.t_events[0][0]",
        "constant-factor",
        "this is the whole period",
    ),
    mistake(EXACTLY, "", "precision-loss", DEFAULT),
]
fast = {"R": uniform(0.8, 1.2), "g": uniform(5, 12), "Omega": uniform(8, 11)}
# both far from the limit between the cases
medium = {
    "R": uniform(0.9, 1.1),
    "g": uniform(9, 10.5),
    "Omega": uniform(4, 5),
}
agree = Tolerance(rtol=1e-6, reason=NUMERIC)
each = {
    "slow": {"theta0": uniform(0.3, 2), **slow},
    "medium": {"theta0": either((0.3, 0.5), (2.2, 2.8)), **medium},
    "fast": {"theta0": either((0.3, 0.9), (1.7, 2)), **fast},
}
falls = "the direction of the event is right only if θ first falls"
rising = mistake("-np.sign(hoop_rates(0.0, start, R, g, Omega)[1])", "1", "wrong-option", falls)
shared = {"truth": by_quadrature, "agree": agree, "uses": [hoop_rates]}
for name, ask in each.items():
    label, known = f"rest_time is right on a {name} hoop", wrong if name == "slow" else [*wrong, rising]
    each[name] = values(rest_time, ask, label=label, **shared, mistakes=known)
notebook.exercise("7", "The time between two rests", *each.values())
