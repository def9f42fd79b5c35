"""The Kepler problem: what is asked about kepler.ipynb, which holds text, Setup and solutions."""

from math import pi

from numpy import arctan2, array, column_stack, cos, exp, hypot, linspace, sin, sqrt
from scipy.optimize import brentq

from exercises.authoring import (
    Notebook,
    absolute,
    angle,
    array_of,
    at_most,
    between,
    close,
    expression,
    relative,
    with_ends,
)

notebook = Notebook("kepler.ipynb")


@notebook.draw
def orbit(draw):
    """Return an orbit: its elements, and the state at a drawn place. The solution takes y and mu only."""
    mu, a, e = draw(between(0.8, 1.5)), draw(between(0.7, 1.3)), draw(with_ends(0.05, 0.9))
    omega, anomaly, sense = draw(angle), draw(angle), draw.sign()
    p = a * (1 - e**2)
    direction = exp(1j * (omega + sense * anomaly))
    place = p / (1 + e * cos(anomaly)) * direction
    velocity = sqrt(mu / p) * (e * sin(anomaly) + 1j * sense * (1 + e * cos(anomaly))) * direction
    y = array([place.real, place.imag, velocity.real, velocity.imag])
    return {"y": y, "mu": mu, "a": a, "e": e, "omega": omega}


def solved(M, e):
    """Return E of E - e sin E = M: it lies within e of M, and the left side grows with E."""
    return brentq(lambda E: E - e * sin(E) - M, M - 1, M + 1, xtol=1e-14)


@notebook.exercise("1", points=6)
def equation_of_motion(ask):
    """The derivative of (x, y, vx, vy) under the force -mu r / |r|³, and the motion to t = 12."""
    kepler_eqs = ask.right_hand_side(
        "kepler_eqs",
        inputs=orbit,
        until=12,
        follow=relative(1e-5, because="ten times the error of the solver"),
    )

    @kepler_eqs.truth(agree=relative(1e-12, because="a thousand rounding errors"))
    def in_polar_form(y, mu):
        """The acceleration points to the origin and has the size mu / r²."""
        r, phi = hypot(y[0], y[1]), arctan2(y[1], y[0])
        return array([y[2], y[3], -mu / r**2 * cos(phi), -mu / r**2 * sin(phi)])

    @kepler_eqs.mistake("component-order", "the state is (x, y, vx, vy), not (x, vx, y, vy)")
    def interleaved(t, y, mu):
        vx, vy, ax, ay = kepler_eqs(t, y, mu)
        return array([vx, ax, vy, ay])

    kepler_eqs.mistake(
        "missing-term", "the force does not depend on mu", change="-mu * position -> -position"
    )


@notebook.exercise("2", points=4)
def orbital_elements(ask):
    """Semi-major axis, eccentricity and direction of the perihelion of a state."""
    elements = ask.function("orbital_elements", inputs=orbit, returns="a e omega")

    @elements.truth
    def as_drawn(a, e, omega):
        """The elements from which the state was made."""
        return a, e, omega

    elements.agree(
        a=relative(1e-11, because="rounding"),
        e=absolute(1e-11, because="rounding"),
        omega=angle.within(1e-9, because="rounding over e >= 0.05"),
    )
    elements.mistake(
        "constant-factor",
        "the energy v²/2 - mu/r is -mu/(2a), with the factor 2",
        change="1 / (2 / r -> 1 / (1 / r",
    )
    elements.mistake(
        "sign-flipped", "the unit vector r/|r| is subtracted", change=" - position / r -> + position / r"
    )

    @elements.mistake("sign-reversed", "omega points to the aphelion: the perihelion is opposite")
    def to_the_aphelion(y, mu):
        a, e, omega = elements(y, mu)
        return a, e, omega + pi


@notebook.exercise("3", points=8, partial=True)
def keplers_equation(ask):
    """E of E - e sin E = M, for numbers and arrays, up to e = 0.99."""
    anomaly = ask.function("eccentric_anomaly")
    anomaly.case("an array", M=array_of(9, between(-10, 10)), e=with_ends(0, 0.99))
    anomaly.case("a single number", M=between(-10, 10), e=with_ends(0, 0.99))

    @anomaly.truth(agree=absolute(1e-10, because="the notebook asks for it"), each="M")
    def by_bracketing(M, e):
        """The root between M - 1 and M + 1, without Newton's method."""
        return solved(M, e)

    @anomaly.mistake(
        "too-few-steps", "{steps} steps of Newton's method are too few for large e", steps=range(1, 5)
    )
    def stops_early(M, e, steps):
        E = M
        for _ in range(steps):
            E = E - (E - e * sin(E) - M) / (1 - e * cos(E))
        return E


@notebook.exercise("4", points=6)
def leapfrog(ask):
    """A kick-drift-kick step of second order, with two calls of acc."""
    step = ask.step(
        "leapfrog",
        state="x v",
        order=(2, absolute(0.2, because="the slope still bends at the largest steps")),
        stable_to=(2, close(rtol=1e-3, atol=0, because="the search ends at a millionth")),
        calls=at_most(2, because="the method needs no more"),
    )
    step.case(
        "an attractive centre",
        acc=expression("-k * x / hypot(*x)**3", of="x", k=between(0.5, 2)),
        x=array_of(2, between(0.6, 1.5)),
        v=array_of(2, between(-1, 1)),
        h=between(0.02, 0.2),
    )

    @step.truth(agree=relative(1e-13, because="a hundred rounding errors"))
    def velocity_verlet(acc, x, v, h):
        """The same method with the mean of both accelerations."""
        later = x + h * v + h**2 / 2 * acc(x)
        return later, v + h / 2 * (acc(x) + acc(later))

    @step.rates
    def rates(acc, x, v):
        return v, acc(x)

    @step.mistake("wrong-method", "drift-kick-drift: right, but the notebook asks for kick-drift-kick")
    def drift_kick_drift(acc, x, v, h):
        middle = x + h / 2 * v
        later = v + h * acc(middle)
        return middle + h / 2 * later, later

    @step.mistake("wrong-method", "position and velocity both change at the old slopes: this is Euler's step")
    def explicit_euler(acc, x, v, h):
        return x + h * v, v + h * acc(x)

    @step.mistake("off-by-one", "acc is called a third time, at a position where it is known")
    def third_call(acc, x, v, h):
        acc(x)
        return step(acc, x, v, h)


@notebook.exercise("5", points=4)
def perihelion(ask):
    """The advance of the perihelion per orbit under an additional force."""
    cell = ask.cell("precession", given="delta start")

    @cell.truth("precession", agree=absolute(1e-6, because="the notebook asks for it"))
    def by_radial_integral(delta, start):
        """The angle from one perihelion to the next, less one turn.

        The additional force -delta r / r⁴ has the potential -delta / (2 r²), which lowers L² in the radial
        equation to L² - delta: the angle is 2 pi / sqrt(1 - delta / L²) exactly.
        """
        spin = start[0] * start[3] - start[1] * start[2]
        return 2 * pi / sqrt(1 - delta / spin**2) - 2 * pi

    cell.mistake(
        "extra-term",
        "the full turn is not subtracted",
        change="first[0]) % (2 * np.pi) -> first[0]) + 2 * np.pi",
    )


@notebook.draw
def revolution(draw):
    """Return the times of one revolution on an ellipse with a = mu = 1, and the positions there."""
    e, omega = draw(between(0.2, 0.7)), draw(angle)
    t = linspace(0, 2 * pi, 61)
    E = array([solved(M, e) for M in t])
    place = (cos(E) - e + 1j * sqrt(1 - e**2) * sin(E)) * exp(1j * omega)
    return {"t": t, "planet": column_stack([place.real, place.imag])}


@notebook.exercise("6", points=2)
def animated_orbit(ask):
    """An animation in any style, in which something drawn follows the planet."""
    orbit = ask.animation(
        "animate_orbit",
        inputs=revolution,
        follows="planet",
        agree=relative(0.01, because="a hundredth of the ellipse is too little to see"),
    )
    orbit.mistake(
        "wrong-motion", "y is drawn in place of x", change="planet[k : k + 1, 0] -> planet[k : k + 1, 1]"
    )

    @orbit.mistake("static", "the planet stands still")
    def at_rest(t, planet):
        return orbit(t, planet[0] + 0 * planet)
