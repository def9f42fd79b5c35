"""The bundled assignment lagrangian: its truths against mpmath's derivatives, integrals and motions, and
other right answers.
"""

import mpmath
import numpy as np
import pytest

from exercises.lagrangian import assignment
from tests.support.toolbox import failed, judged

NOTEBOOK = assignment.notebook


@pytest.fixture(autouse=True)
def thirty_digits():
    with mpmath.workdps(30):
        yield


def asked(id):
    return next(question for question in NOTEBOOK.questions() if question.id == id)


def exact(id, rows=3):
    """The drawn inputs of a question, and its exact values, row by row."""
    question = asked(id)
    drawn = question.draw(np.random.default_rng(23), rows)
    inputs = [dict(zip(drawn, row, strict=True)) for row in zip(*drawn.values(), strict=True)]
    found = question.exact(drawn)
    names = [value["name"] for value in question.document["returns"]]
    return zip(inputs, *(found[name] for name in names), strict=True)


def close(got, want, relative=1e-13):
    """Compare a number, or real and imaginary part, with a real number."""
    value, *imaginary = np.atleast_1d(got)
    assert not any(imaginary)
    assert abs(value - want) <= relative * max(1, abs(want))


def left_side(L, q, v, a):
    """d/dt ∂L/∂v − ∂L/∂q for L(q, v) along the path q(t) = q + v t + a t²/2, by derivatives in t."""
    path = (lambda t: q + v * t + a * t**2 / 2, lambda t: v + a * t)
    momentum = lambda t: mpmath.diff(lambda w: L(path[0](t), w), path[1](t))  # noqa: E731
    return mpmath.diff(momentum, 0) - mpmath.diff(lambda x: L(x, v), q)


def numbers(row):
    return {name: mpmath.mpf(float(value)) for name, value in row.items()}


def test_the_equations_of_motion_are_derivatives_along_a_path():
    for row, value in exact("1-1"):
        n = numbers(row)

        def L(q, v, n=n):
            return n["m"] * (1 + n["c"] * q**2) * v**2 / 2 - n["k"] * q**4 / 4 + n["b"] * q * v

        close(value, left_side(L, n["q"], n["v"], n["a"]))
    for row, value in exact("1-2"):
        n = numbers(row)
        close(
            value,
            left_side(
                lambda q, v, n=n: -n["m"] * mpmath.sqrt(1 - v**2) - n["k"] * q**2 / 2, n["q"], n["v"], n["a"]
            ),
        )
    for row, value in exact("1-3"):
        n = numbers(row)

        def of_all_powers(q, v, n=n):
            return n["m"] * q**2 * v**4 / 4 + n["c"] * q * v**3 / 3 - n["k"] * q**2 / 2 + n["b"] * q**2 * v

        close(value, left_side(of_all_powers, n["q"], n["v"], n["a"]))


def in_space(row, theta, phi):
    """The bead on the hoop that has turned by phi."""
    R = row["R"]
    return [
        R * mpmath.sin(theta) * mpmath.cos(phi),
        R * mpmath.sin(theta) * mpmath.sin(phi),
        -R * mpmath.cos(theta),
    ]


def lagrangian_of_hoop(n, theta, v):
    """T − V of the bead by its velocity in space."""
    velocity = [
        mpmath.diff(lambda t, k=k: in_space(n, theta + v * t, n["Omega"] * t)[k], 0) for k in range(3)
    ]
    return n["m"] / 2 * sum(one**2 for one in velocity) - n["m"] * n["g"] * in_space(n, theta, 0)[2]


def test_the_hoop_is_that_of_velocities_in_space():
    for row, L, acceleration in exact("2", 2):
        n = numbers(row)
        close(L, lagrangian_of_hoop(n, n["theta"], n["v"]))
        rest = left_side(
            lambda q, v, n=n: lagrangian_of_hoop(n, q, v),
            n["theta"],
            n["v"],
            mpmath.mpf(float(acceleration[0])),
        )
        assert abs(rest) < 1e-9  # in J, of terms of about 100
    for row, h in exact("4-hoop_conserved"):
        n = numbers(row)
        T = n["m"] / 2 * n["R"] ** 2 * (n["v"] ** 2 + n["Omega"] ** 2 * mpmath.sin(n["theta"]) ** 2)
        # Ω times the angular momentum
        power = n["m"] * n["R"] ** 2 * n["Omega"] ** 2 * mpmath.sin(n["theta"]) ** 2
        close(h, T - n["m"] * n["g"] * n["R"] * mpmath.cos(n["theta"]) - power)


def lagrangian_of_cart(n, v, theta, w):
    bob = mpmath.mpc(v + n["l"] * w * mpmath.cos(theta), n["l"] * w * mpmath.sin(theta))
    return n["M"] / 2 * v**2 + n["m"] / 2 * abs(bob) ** 2 + n["m"] * n["g"] * n["l"] * mpmath.cos(theta)


def sides_for_cart(n, X, A, v):
    """The rates of both momenta on a path with these accelerations,
    and the generalized force on the angle.
    """

    def velocities(t):
        return v + X * t, n["theta"] + n["w"] * t + A * t**2 / 2, n["w"] + A * t

    def p(t):
        u, theta, w = velocities(t)
        return mpmath.diff(lambda x: lagrangian_of_cart(n, x, theta, w), u)

    def J(t):
        u, theta, w = velocities(t)
        return mpmath.diff(lambda x: lagrangian_of_cart(n, u, theta, x), w)

    force = mpmath.diff(lambda q: lagrangian_of_cart(n, v, q, n["w"]), n["theta"])
    return mpmath.diff(p, 0), mpmath.diff(J, 0), force


def test_the_cart_solves_both_equations_of_lagrange():
    for row, X, A in exact("3", 2):
        p, J, force = sides_for_cart(
            numbers(row), *(mpmath.mpf(float(one[0])) for one in (X, A)), mpmath.mpf("0.7")
        )
        assert abs(p) < 1e-10
        assert abs(J - force) < 1e-10


def conserved_of_cart(n):
    px = mpmath.diff(lambda u: lagrangian_of_cart(n, u, n["theta"], n["w"]), n["v"])
    J = mpmath.diff(lambda u: lagrangian_of_cart(n, n["v"], n["theta"], u), n["w"])
    return px, px * n["v"] + J * n["w"] - lagrangian_of_cart(n, n["v"], n["theta"], n["w"])


def test_momentum_and_energy_of_the_cart_are_those_of_its_lagrangian():
    for row, p, E in exact("4-cart_conserved"):
        px, h = conserved_of_cart(numbers(row))
        close(p, px)
        close(E, h)


def rates(R, g, Omega):
    return lambda t, y: [y[1], (Omega**2 * mpmath.cos(y[0]) - g / R) * mpmath.sin(y[0])]


def test_the_rates_are_those_of_the_hoop():
    for row, value in exact("5"):
        n = {name: mpmath.mpf(float(row[name])) for name in ("R", "g", "Omega")}
        for got, want in zip(value, rates(**n)(0, [mpmath.mpf(float(one)) for one in row["y"]]), strict=True):
            assert abs(got - want) < 1e-13 * 50


@pytest.mark.parametrize("id", ["6-1", "6-2"])
def test_the_motion_is_that_of_a_taylor_series(id):
    ((row, theta),) = exact(id, 1)
    with mpmath.workdps(16):
        n = {name: mpmath.mpf(float(row[name])) for name in ("R", "g", "Omega")}
        motion = mpmath.odefun(rates(**n), 0, [float(one) for one in row["y0"]], tol=1e-13)
        for t, got in zip(asked(id).inputs["t"][:5], theta, strict=False):
            assert abs(motion(t)[0] - got) < 1e-11 * max(1, abs(got))


@pytest.mark.parametrize("id", ["7-1", "7-2", "7-3"])
def test_the_time_between_two_rests_is_the_integral_over_the_angle(id):
    for row, time in exact(id):
        n = numbers(row)
        start = n["theta0"]
        other = 2 * n["g"] / (n["R"] * n["Omega"] ** 2) - mpmath.cos(start)
        end = mpmath.acos(other) if other < 1 else -start

        def rate(theta, n=n, start=start):
            fall = mpmath.cos(theta) - mpmath.cos(start)
            centrifugal = n["Omega"] ** 2 * (mpmath.sin(theta) ** 2 - mpmath.sin(start) ** 2)
            return mpmath.sqrt(abs(2 * n["g"] / n["R"] * fall + centrifugal))

        # θ = middle + half cos ψ removes the roots of the velocity at both ends
        middle, half = (start + end) / 2, (start - end) / 2

        def integrand(x, middle=middle, half=half, rate=rate):
            return half * mpmath.sin(x) / rate(middle + half * mpmath.cos(x))

        exactly = mpmath.quad(integrand, [0, mpmath.pi / 2, mpmath.pi], method="gauss-legendre")
        assert abs(abs(exactly) - time) < 1e-12 * time


RIGHT = {
    "equation_of_motion, with functions of time": (
        """
import sympy as sp
def equation_of_motion(L, q, v, a):
    t, x = sp.Symbol("t"), sp.Function("x")
    at = L(x(t), x(t).diff(t))
    left = at.diff(x(t).diff(t)).diff(t) - at.diff(x(t))
    return left.subs(x(t).diff(t, 2), a).subs(x(t).diff(t), v).subs(x(t), q)
"""
    ),
    "hoop, expanded and with own symbols": (
        """
import sympy as sp
def hoop(theta, v, m, R, g, Omega):
    half = sp.Rational(1, 2)
    L = half*m*R**2*v**2 + half*m*R**2*Omega**2*(1 - sp.cos(2*theta))/2 + m*g*R*sp.cos(theta)
    return [L, sp.simplify(Omega**2*sp.sin(2*theta)/2 - g/R*sp.sin(theta))]
"""
    ),
    "cart, by a matrix with functions of time": (
        """
import sympy as sp
def cart(theta, w, M, m, l, g):
    t = sp.Symbol("t")
    x, f = sp.Function("x")(t), sp.Function("f")(t)
    bx, by = x + l * sp.sin(f), -l * sp.cos(f)
    L = M * x.diff(t)**2 / 2 + m * (bx.diff(t)**2 + by.diff(t)**2) / 2 - m * g * by
    equations = [sp.diff(L, c.diff(t)).diff(t) - sp.diff(L, c) for c in (x, f)]
    found = sp.solve(equations, [x.diff(t, 2), f.diff(t, 2)])
    return sp.Matrix([found[c.diff(t, 2)] for c in (x, f)]).subs(f.diff(t), w).subs(f, theta)
"""
    ),
    "hoop_conserved, as kinetic and effective potential energy": (
        """
import sympy as sp
def hoop_conserved(theta, v, m, R, g, Omega):
    return sp.factor(m*R**2*v**2/2 - m*R*(g*sp.cos(theta) + R*Omega**2*sp.sin(theta)**2/2))
"""
    ),
    "hoop_rates, a list": (
        """
from math import sin, cos
def hoop_rates(t, y, R, g, Omega):
    return [y[1], sin(y[0]) * (Omega**2 * cos(y[0]) - g / R)]
"""
    ),
    "hoop_motion, by steps of Runge and Kutta": (
        """
def hoop_motion(t, y0, R, g, Omega):
    f = lambda y: np.array([y[1], (Omega**2 * np.cos(y[0]) - g / R) * np.sin(y[0])])
    y, now, found = np.array(y0, float), 0.0, []
    for then in t:
        n = int(np.ceil((then - now) / 4e-3))
        h = (then - now) / n
        for _ in range(n):
            a = f(y); b = f(y + h / 2 * a); c = f(y + h / 2 * b); d = f(y + h * c)
            y = y + h / 6 * (a + 2 * b + 2 * c + d)
        now = then
        found.append(y[0])
    return found
"""
    ),
    "rest_time, by an integral": (
        """
from scipy.integrate import quad
from scipy.optimize import brentq
def rest_time(theta0, R, g, Omega):
    square = lambda x: 2*g/R*(np.cos(x) - np.cos(theta0)) + Omega**2*(np.sin(x)**2 - np.sin(theta0)**2)
    other = 2*g/(R*Omega**2) - np.cos(theta0)
    end = np.arccos(other) if other < 1 else -theta0
    mid, half = (theta0 + end) / 2, (theta0 - end) / 2
    inner = lambda p: half*np.cos(p) / np.sqrt(abs(square(mid + half*np.sin(p))))
    return abs(quad(inner, -np.pi/2, np.pi/2, epsrel=1e-9)[0])
"""
    ),
    "rest_time, by a dense solution": (
        """
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
def rest_time(theta0, R, g, Omega):
    f = lambda t, y: [y[1], (Omega**2 * np.cos(y[0]) - g / R) * np.sin(y[0])]
    options = {"method": "LSODA", "dense_output": True, "max_step": 0.05}
    run = solve_ivp(f, (0, 10), [theta0, 0], rtol=1e-9, atol=1e-10, **options)
    v, t = run.y[1], run.t
    k = next(k for k in range(2, len(v)) if v[k] * v[1] < 0)
    return brentq(lambda s: run.sol(s)[1], t[k - 1], t[k])
"""
    ),
}


SYMBOLIC = [pytest.param(name, marks=pytest.mark.slow) for name in RIGHT if "import sympy" in RIGHT[name]]


@pytest.mark.parametrize("name", [*SYMBOLIC, *(name for name in RIGHT if "import sympy" not in RIGHT[name])])
def test_other_right_answers_pass(name):
    for question in NOTEBOOK.questions():
        if question.function == name.split(",")[0]:
            assert not failed(judged(question, RIGHT[name], seed=5))


def test_every_bead_that_is_thrown_over_the_top_passes_it_in_time():
    d = {name: np.array(value) for name, value in asked("6-2").draw(np.random.default_rng(23), 200).items()}
    theta, w = d["y0"].T
    twice_energy = w**2 - 2 * d["g"] / d["R"] * np.cos(theta) - (d["Omega"] * np.sin(theta)) ** 2
    slowest = np.sqrt(twice_energy - 2 * d["g"] / d["R"])  # at the top
    assert (slowest * asked("6-2").inputs["t"][-1] > 2 * np.pi).all()


def test_an_angle_reduced_to_one_turn_is_wrong():
    def reduced(**row):
        angles = asked("6-1").student["hoop_motion"](asked("6-1").inputs["t"], **row)
        return (angles + np.pi) % (2 * np.pi) - np.pi

    for row, theta in exact("6-1", 1):
        assert np.abs(reduced(**row) - theta).max() < 1e-6
    for row, theta in exact("6-2", 1):
        assert np.abs(reduced(**row) - theta).max() > 1


def test_an_integration_of_two_seconds_ends_before_a_rest_in_public_and_in_every_grading():
    for rows, seeds in ((3, [0]), (16, range(1, 9))):
        for seed in seeds:
            drawn = asked("7-1").draw(np.random.default_rng(seed), rows)
            assert max(asked("7-1").exact(drawn)["value"]) > 2.2


def test_the_bead_on_a_medium_hoop_comes_to_rest_far_from_the_limit_between_both_cases():
    d = {name: np.array(value) for name, value in asked("7-2").draw(np.random.default_rng(23), 200).items()}
    other = 2 * d["g"] / (d["R"] * d["Omega"] ** 2) - np.cos(d["theta0"])
    assert np.abs(other - 1).min() > 0.15
    assert np.min(other) < 1 < np.max(other)
