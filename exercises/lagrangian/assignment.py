"""Lagrangian mechanics: what is asked about notebook.ipynb, which holds text, Setup and solutions.

Exercises 1 to 4 ask for expressions of sympy. Their values at random points are compared with numbers that
were found without a computer's derivatives: by hand, or with Newton's laws and Cartesian velocities.
Exercises 5 to 7 are numeric. Quantities are in SI units, angles in rad.

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

tests/exercises/test_lagrangian.py compares each truth with 30-digit derivatives, integrals and motions of
mpmath.
"""

from math import cos, pi

import numpy as np
from scipy.integrate import solve_ivp

from exercises.authoring import (
    Notebook,
    array_of,
    at_most,
    between,
    close,
    expression,
    in_turn,
    relative,
    symbol,
)

notebook = Notebook("notebook.ipynb", packages=("sympy",), cpu_s=85)  # SymPy takes most of 17 s

rounding = relative(1e-11, because="ten thousand rounding errors of the largest number")


@notebook.exercise("1")
def the_equation_of_motion(ask):
    """The left side d/dt ∂L/∂v - ∂L/∂q of Lagrange's equation, of three Lagrangians L(q, v)."""
    q, a = symbol(-2, 2), symbol(-3, 3)
    drawn = between(0.5, 2)

    varying_mass = ask.symbolic(
        "equation_of_motion", label="equation_of_motion is right for a mass that depends on q"
    )
    varying_mass.case(
        "L = m(1 + cq²)v²/2 - kq⁴/4 + bqv",
        L=expression(
            "m * (1 + c * q**2) * v**2 / 2 - k * q**4 / 4 + b * q * v",
            of="q v",
            m=drawn,
            c=drawn,
            k=drawn,
            b=drawn,
        ),
        q=q,
        v=symbol(-2, 2),
        a=a,
    )

    @varying_mass.truth(agree=rounding)
    def of_varying_mass(q, v, a, m, c, k):
        """∂L/∂v = m(1 + cq²)v + bq and ∂L/∂q = mcqv² - kq³ + bv: b drops out."""
        return m * (1 + c * q**2) * a + m * c * q * v**2 + k * q**3

    varying_mass.mistake(
        "sign-flipped",
        "∂L/∂q has the opposite sign",
        change="- sp.diff(L(q, v), q) -> + sp.diff(L(q, v), q)",
    )
    varying_mass.mistake(
        "missing-term",
        "∂²L/∂v∂q · v is missing: ∂L/∂v depends on time also through q",
        change=" + sp.diff(momentum, q) * v -> ",
    )
    varying_mass.mistake(
        "missing-term",
        "∂²L/∂v² is missing before the acceleration",
        change="sp.diff(momentum, v) * a -> a",
    )

    @varying_mass.mistake("wrong-quantity", "this is the acceleration, not the left side of the equation")
    def solved_for_the_acceleration(L, q, v, a):
        left = varying_mass(L, q, v, a)  # is linear in a
        return a - left / left.diff(a)

    fast_particle = ask.symbolic(
        "equation_of_motion",
        label="equation_of_motion is right for a fast particle",
        mistakes_of=varying_mass,
    )
    fast_particle.case(
        "L = -m √(1 - v²) - kq²/2",
        L=expression("-m * (1 - v**2) ** 0.5 - k * q**2 / 2", of="q v", m=drawn, k=drawn),
        q=q,
        v=symbol(-0.8, 0.8),
        a=a,
    )

    @fast_particle.truth(agree=rounding)
    def relativistic(q, v, a, m, k):
        """∂L/∂v = mv / √(1 - v²), whose rate is ma / (1 - v²)^(3/2)."""
        return m * a / np.sqrt(1 - v**2) ** 3 + k * q

    polynomial = ask.symbolic(
        "equation_of_motion",
        label="equation_of_motion is right for a Lagrangian that the text does not name",
        mistakes_of=varying_mass,
    )
    polynomial.case(
        "L = mq²v⁴/4 + cqv³/3 - kq²/2 + bq²v",
        L=expression(
            "m * q**2 * v**4 / 4 + c * q * v**3 / 3 - k * q**2 / 2 + b * q**2 * v",
            of="q v",
            m=drawn,
            c=drawn,
            k=drawn,
            b=drawn,
        ),
        q=q,
        v=symbol(-2, 2),
        a=a,
    )

    @polynomial.truth(agree=rounding)
    def of_all_powers(q, v, a, m, c, k):
        """∂L/∂v = mq²v³ + cqv² + bq² and ∂L/∂q = mqv⁴/2 + cv³/3 - kq + 2bqv: b drops out."""
        return (3 * m * (q * v) ** 2 + 2 * c * q * v) * a + 3 * m * q * v**4 / 2 + 2 * c * v**3 / 3 + k * q


# Exercises 2 to 4: symbols of the bead on the hoop, and of the pendulum on the cart
# of the bead v is θ̇; of the pendulum w is θ̇, and v the velocity of the cart in m/s

bead = {
    "theta": symbol(-3, 3),
    "v": symbol(-3, 3),
    "m": symbol(0.5, 2, positive=True),
    "R": symbol(0.5, 2, positive=True),
    "g": symbol(5, 15, positive=True),
    "Omega": symbol(1, 6, positive=True),
}
pendulum = {
    "theta": symbol(-3, 3),
    "w": symbol(-3, 3),
    "M": symbol(0.5, 3, positive=True),
    "m": symbol(0.5, 2, positive=True),
    "l": symbol(0.5, 2, positive=True),
    "g": symbol(5, 15, positive=True),
}


@notebook.exercise("2")
def a_bead_on_a_rotating_hoop(ask):
    """The Lagrangian in J of a bead on a rotating hoop, and its angular acceleration in rad/s²."""
    hoop = ask.symbolic("hoop", returns="L acceleration")
    hoop.case("", **bead)

    @hoop.truth(agree=rounding)
    def in_the_rotating_frame(theta, v, m, R, g, Omega):
        """The velocities along the hoop and of the hoop are perpendicular. In the frame of the hoop, weight
        and centrifugal force drive the bead along it.
        """
        along, across = R * v, R * Omega * np.sin(theta)
        x, y = R * np.sin(theta), -R * np.cos(theta)
        force = m * Omega**2 * x * np.cos(theta) - m * g * np.sin(theta)
        return m / 2 * (along**2 + across**2) - m * g * y, force / (m * R)

    hoop.mistake(
        "sign-flipped",
        "the weight points up",
        change="m * g * R * sp.cos(theta) -> -m * g * R * sp.cos(theta)",
    )
    hoop.mistake(
        "wrong-constant",
        "V is 0 at the lowest point, not at the height of the centre",
        change="+ m * g * R * sp.cos(theta) -> - m * g * R * (1 - sp.cos(theta))",
    )
    hoop.mistake(
        "missing-term",
        "the velocity of the hoop is missing in the kinetic energy",
        change=" + Omega**2 * sp.sin(theta) ** 2 -> ",
    )
    hoop.mistake(
        "missing-term",
        "the distance from the axis is R sin θ",
        change="Omega**2 * sp.sin(theta) ** 2 -> Omega**2",
    )
    hoop.mistake(
        "sign-flipped",
        "∂L/∂θ has the opposite sign",
        change="sp.diff(L, theta) / -> -sp.diff(L, theta) /",
    )


@notebook.exercise("3")
def a_pendulum_on_a_cart(ask):
    """The accelerations of the cart in m/s², X, and of the pendulum's angle in rad/s², A."""
    cart = ask.symbolic("cart", returns="X A")
    cart.case("", **pendulum)

    @cart.truth(agree=rounding)
    def by_newton(theta, w, M, m, l, g):
        """Newton's laws with the tension F of the rod: M X = F sin θ for the cart, and m times the
        acceleration of the bob at (x + l sin θ, -l cos θ) is (-F sin θ, F cos θ - mg). These are three linear
        equations for X, A and F.
        """
        s, c = np.sin(theta), np.cos(theta)
        equations = [[M, 0, -s], [m, m * l * c, s], [0, m * l * s, -c]]
        X, A, _ = np.linalg.solve(equations, [0, m * l * w**2 * s, -m * l * w**2 * c - m * g])
        return X, A

    cart.mistake(
        "missing-term",
        "the velocities of cart and pendulum are not parallel",
        change="v * w * sp.cos(theta) -> v * w",
    )
    cart.mistake("missing-term", "the bob moves with the cart too", change="(M + m) * v**2 -> M * v**2")
    cart.mistake(
        "sign-flipped",
        "the weight points up",
        change="+ m * g * l * sp.cos(theta) -> - m * g * l * sp.cos(theta)",
    )
    cart.mistake(
        "component-order",
        "the acceleration of the angle comes first",
        change="found[X], found[A] -> found[A], found[X]",
    )


@notebook.exercise("4")
def conserved_quantities(ask):
    """h = v ∂L/∂v - L of the bead in J, and momentum and energy of cart and pendulum in kg m/s and J."""
    hoop_conserved = ask.symbolic("hoop_conserved")
    hoop_conserved.case("", **bead)

    @hoop_conserved.truth(agree=rounding)
    def with_centrifugal_potential(theta, v, m, R, g, Omega):
        """h is the energy in the rotating frame, where the centrifugal force has the potential energy
        -mΩ²x²/2.
        """
        x, y = R * np.sin(theta), -R * np.cos(theta)
        return m * ((R * v) ** 2 / 2 - (Omega * x) ** 2 / 2 + g * y)

    hoop_conserved.mistake("sign-flipped", "L has the opposite sign", change="- L -> + L")
    # 2T - L = T + V, where T is L without g
    hoop_conserved.mistake(
        "wrong-quantity",
        "T + V changes: a motor keeps Ω constant",
        change="v * sp.diff(L, v) - -> 2 * L.subs(g, 0) -",
    )
    hoop_conserved.mistake(
        "wrong-constant",
        "V is 0 at the lowest point, not at the height of the centre",
        change="+ m * g * R * sp.cos(theta) -> - m * g * R * (1 - sp.cos(theta))",
    )

    cart_conserved = ask.symbolic("cart_conserved", returns="p E")
    cart_conserved.case("", v=symbol(-3, 3), **pendulum)

    @cart_conserved.truth(agree=rounding)
    def by_velocities(v, theta, w, M, m, l, g):
        """The bob's velocity is that of the cart plus lw along (cos θ, sin θ), here a complex number."""
        bob = v + l * w * np.exp(1j * theta)
        return M * v + m * bob.real, M * v**2 / 2 + m * abs(bob) ** 2 / 2 - m * g * l * np.cos(theta)

    cart_conserved.mistake(
        "missing-term",
        "the bob also moves relative to the cart",
        change="m) * v + m * l * w * sp.cos(theta) -> m) * v",
    )
    cart_conserved.mistake(
        "constant-factor",
        "the product of the two velocities is counted once, not twice",
        change="2 * l * v * w -> l * v * w",
    )
    cart_conserved.mistake(
        "sign-flipped",
        "T − V, which is L: V is lowest when the pendulum hangs, and E = T + V",
        change="- m * g * l -> + m * g * l",
    )
    cart_conserved.mistake(
        "wrong-constant",
        "V is 0 at the lowest point of the pendulum, not at the height of the pivot",
        change="- m * g * l * sp.cos(theta) -> + m * g * l * (1 - sp.cos(theta))",
    )


# Exercises 5 to 7: the bead on the hoop in numbers


@notebook.draw
def any_bead(draw):
    """A time in s, a state (θ, θ̇), and a hoop."""
    return {
        "t": draw(between(0, 20)),
        "y": draw.rng.uniform((-3, -12), (3, 12)),
        "R": draw(between(0.3, 2.5)),
        "g": draw(between(5, 15)),
        "Omega": draw(between(1, 11)),
    }


@notebook.exercise("5")
def a_function_for_the_solver(ask):
    """The rates of (θ, θ̇), and the motion for 5 s, on which h is constant. Compared is h/(mR²) plus
    g/R + Ω²/2, which keeps it from 0.
    """
    hoop_rates = ask.right_hand_side(
        "hoop_rates",
        any_bead,
        until=5.0,
        follow=at_most(1e-7, because="a hundred times the error of the integration"),
        conserved={
            "the integral h": (
                "y[1] ** 2 / 2 - g / R * cos(y[0]) + Omega**2 * cos(y[0]) ** 2 / 2 + g / R",
                at_most(1e-8, because="a hundred times the error of the integration"),
            )
        },
    )

    @hoop_rates.truth(agree=relative(1e-12, because="a thousand rounding errors"))
    def by_complex_step(y, R, g, Omega):
        """θ̈ is minus the derivative of the effective potential over mR², -g/R cos θ - Ω² sin²θ/2. For small
        ε the derivative is the imaginary part at θ + iε over ε, without a difference.
        """
        z = y[0] + 1e-30j
        potential = -g / R * np.cos(z) - Omega**2 * np.sin(z) ** 2 / 2
        return [y[1], -np.imag(potential) / 1e-30]

    hoop_rates.mistake("missing-division", "the weight is not divided by R", change="- g / R -> - g")
    hoop_rates.mistake("missing-term", "the hoop does not rotate", change="Omega**2 * np.cos(theta) -  -> -")
    hoop_rates.mistake("wrong-power", "Ω is not squared", change="Omega**2 -> Omega")


slow_hoop = {"R": between(0.5, 1.5), "g": between(8, 12), "Omega": between(0.5, 2)}


def thrown_over_the_top(rng):
    """Draw a state whose θ̇, 11 to 14 rad/s of either sign, suffices for the top of every slow hoop."""
    return np.array([rng.uniform(-1.5, 1.5), rng.choice([-1, 1]) * rng.uniform(11, 14)])


@notebook.exercise("6")
def the_motion_of_the_bead(ask):
    """The angles at given times, from the state at the time 0, without full turns taken off."""
    hoop_motion = ask.function("hoop_motion")
    times = np.linspace(0.1, 5, 9)
    hoop_motion.case("a bead that swings", t=times, y0=array_of(2, between(-1.5, 1.5)), **slow_hoop)
    hoop_motion.case("a bead that goes over the top", t=times, y0=thrown_over_the_top, **slow_hoop)

    @hoop_motion.truth(
        agree=relative(
            1e-6, because="of the largest angle; a solver at rtol = 1e-10 is a hundred times better"
        )
    )
    def by_polynomials(t, y0, R, g, Omega):
        """With s = sin θ and c = cos θ as two more variables the equations are polynomials. They are
        integrated a thousand times more precisely than asked.
        """

        def rates(t, y):
            _, s, c, w = y
            return [w, c * w, -s * w, (Omega**2 * c - g / R) * s]

        start = [y0[0], np.sin(y0[0]), np.cos(y0[0]), y0[1]]
        return solve_ivp(rates, (0, t[-1]), start, "DOP853", t, rtol=1e-13, atol=1e-14).y[0]

    hoop_motion.mistake("wrong-index", "the angular velocities are returned", change="run.y[0] -> run.y[1]")
    hoop_motion.mistake(
        "precision-loss",
        "the default tolerances of solve_ivp give three digits",
        change='"DOP853", t, args=(R, g, Omega), rtol=1e-10, atol=1e-10 -> t_eval=t, args=(R, g, Omega)',
    )
    hoop_motion.mistake(
        "wrong-times",
        "y0 is the state at the time 0, not at t[0]",
        change="(0, t[-1]) -> (t[0], t[-1])",
    )
    hoop_motion.mistake(
        "not-unwrapped",
        "the angle is reduced to one turn",
        change="run.y[0] -> (run.y[0] + np.pi) % (2 * np.pi) - np.pi",
    )


@notebook.draw
def long_swing(draw):
    """A slow hoop on which the bead takes 2.2 s to 2.6 s: R and Ω are large, g and θ₀ small."""
    return {
        "theta0": draw(between(0.3, 0.4)),
        "R": draw(between(1.45, 1.5)),
        "g": draw(between(8, 8.2)),
        "Omega": draw(between(1.95, 2)),
    }


@notebook.draw
def any_slow_swing(draw):
    return {"theta0": draw(between(0.3, 2)), **{name: draw(one) for name, one in slow_hoop.items()}}


def medium_hoop(low, high):
    """Return the draw of a release between two angles on a hoop where these decide on which side of the
    bottom the bead ends.
    """

    @notebook.draw
    def release(draw):
        return {
            "theta0": draw(between(low, high)),
            "R": draw(between(0.9, 1.1)),
            "g": draw(between(9, 10.5)),
            "Omega": draw(between(4, 5)),
        }

    return release


def fast_hoop(low, high):
    """Return the draw of a release between two angles on a hoop where the bead stays on its side."""

    @notebook.draw
    def release(draw):
        return {
            "theta0": draw(between(low, high)),
            "R": draw(between(0.8, 1.2)),
            "g": draw(between(5, 12)),
            "Omega": draw(between(8, 11)),
        }

    return release


climbs, crosses_the_bottom = medium_hoop(0.3, 0.5), medium_hoop(2.2, 2.8)
climbs_fast, slides_down = fast_hoop(0.3, 0.9), fast_hoop(1.7, 2)


@notebook.exercise("7")
def the_time_between_two_rests(ask):
    """The time in s from the release at rest to the next rest."""
    rest_time = ask.function("rest_time")
    rest_time.case("a slow hoop", in_turn(long_swing, any_slow_swing, any_slow_swing))
    rest_time.case("a medium hoop", in_turn(climbs, crosses_the_bottom))
    rest_time.case("a fast hoop", in_turn(climbs_fast, slides_down))

    @rest_time.truth(
        agree=close(rtol=1e-6, atol=0, because="a solver at rtol = 1e-10 is a hundred times better")
    )
    def by_quadrature(theta0, R, g, Omega):
        """h is constant, so θ̇² is Ω²(cos θ₀ - cos θ)(cos θ - other) with other = 2g/(RΩ²) - cos θ₀, and the
        time is the integral of dθ/θ̇ from rest to rest. With an angle φ from 0 to π in place of θ the
        integrand is smooth and periodic, and the mean of 400 values is exact to rounding.
        """
        phi, start = pi * (np.arange(400) + 0.5) / 400, cos(theta0)
        other = 2 * g / (R * Omega**2) - start
        if other < 1:  # the bead turns where cos θ is this: cos θ = middle + half cos φ
            cosine = (start + other) / 2 + (start - other) / 2 * np.cos(phi)
            return pi / Omega * np.mean((1 - cosine**2) ** -0.5)
        # it turns at -θ₀: sin θ/2 = sin θ₀/2 sin φ; φ from 0 to π is up from the bottom and back on one side,
        # which takes as long as across
        sine = np.sin(theta0 / 2) * np.sin(phi)
        factor = 2 * g / R - Omega**2 * (1 - 2 * sine**2 + start)
        return pi * np.sqrt(2) * np.mean(((1 - sine**2) * factor) ** -0.5)

    rest_time.mistake(
        "returns-zero",
        "this is the rest at the start: the next one is asked",
        change="-np.sign( -> np.sign(",
    )
    rest_time.mistake(
        "constant-factor",
        "this is the whole period",
        change="return run.t_events[0][0] -> return 2 * run.t_events[0][0]",
    )
    rest_time.mistake(
        "precision-loss", "the default tolerances of solve_ivp give three digits", change=", **precise -> "
    )
    rest_time.mistake(
        "wrong-option",
        "the direction of the event is right only if θ first falls",
        change="-np.sign(hoop_rates(0.0, start, R, g, Omega)[1]) -> 1",
    )
    # no event before the end: the bead takes longer
    rest_time.mistake(change="(0, 10) -> (0, 2)")
