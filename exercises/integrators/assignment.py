"""Integrators: what is asked about notebook.ipynb, which holds text, Setup and solutions.

The notebook asks for four steps ``step(acc, x, v, h)`` of x'' = acc(x), and for functions that take any such
step. These get steps of this file, which are linear on an oscillator: then energy, growth and error follow
from powers of a matrix or of a complex number.

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

Every truth has a third source in tests/exercises/test_integrators.py: 60-digit arithmetic, fractions,
Störmer's rule.
"""

from math import log2, sqrt

import numpy as np

from exercises.authoring import (
    Notebook,
    absolute,
    array_of,
    at_most,
    between,
    close,
    euler,
    expression,
    function,
    in_turn,
    integer,
    one_of,
    relative,
    rk4,
)

notebook = Notebook("notebook.ipynb")

rounding = relative(1e-12, because="a hundred times what two forms of a step differ by")
searched = close(
    rtol=1e-3,
    atol=0,
    because="the search takes a growth of a millionth in one step as rounding, which moves the limit by at"
    " most 4e-7: thousands of times that",
)
exactly = absolute(0, because="integers are exact")


# Exercises 1 to 3: the four steps


@notebook.draw
def planet(draw):
    """A planet near (1, 0) with a velocity near (0, 1), from where its orbit is the unit circle if mu = 1,
    and a step.
    """
    return {
        "x": draw.rng.uniform((0.9, -0.1), (1.1, 0.1)),
        "v": draw.rng.uniform((-0.2, 0.9), (0.2, 1.1)),
        "h": draw(between(0.02, 0.1)),
    }


def ask_for_steps_of_a_planet(ask, name, *, order, stable_to, calls):
    """Ask for single steps of a planet, for their order of convergence, for the largest step with which the
    oscillator does not grow, and for the chart of speed against accuracy to t = 20, about three years of 2π.
    """
    step = ask.step(
        name,
        planet,
        state="x v",
        order=(order, absolute(0.2, because="four times what the slope bends at the largest steps")),
        stable_to=stable_to,
        calls=at_most(calls, because="the method needs no more"),
        chart=20.0,
    )
    step.case("a planet", acc=expression("-mu * x / (x @ x) ** 1.5", of="x", mu=between(0.9, 1.1)))
    step.agree(rounding)

    @step.rates
    def of_place_and_velocity(acc, x, v):
        return v, acc(x)

    return step


def ask_for_other_forces(ask, name, step, truth):
    """Ask for large steps of two other forces, one after the other, with the mistakes of the question
    ``step``.
    """
    label = f"{name} is right for large steps and other forces"
    other_forces = ask.function(name, label=label, mistakes_of=step)
    other_forces.case(
        "other forces",
        call=one_force_after_another,
        acc=expression("-sin(k * x)", of="x", k=between(1, 3)),
        other=expression("cos(x) - x", of="x"),
        x=array_of(2, between(-1, 1)),
        v=array_of(2, between(-1, 1)),
        h=between(0.1, 1.5),
    )
    other_forces.truth(truth, agree=rounding)


def one_force_after_another(step, acc, other, x, v, h):
    """Three steps: one of ``acc``; from its end one of the other force; and one of the other force from the
    beginning. A step that keeps an acceleration for the next call is wrong in one of the last two.
    """
    first = np.array(step(acc, x, v, h))
    return [first, step(other, *first, h), step(other, x, v, h)]


@notebook.exercise("1")
def euler_and_a_small_change(ask):
    """Euler's step, and the symplectic one, which moves with the new velocity."""
    euler_step = ask_for_steps_of_a_planet(
        ask,
        "euler_step",
        order=1,
        stable_to=(
            0,
            absolute(
                5e-3,
                because="the search takes a growth of a millionth in one step as rounding:"
                " sqrt(1 + h²) reaches it at h = 0.0014",
            ),
        ),
        calls=1,
    )

    @euler_step.truth
    def of_first_order(acc, x, v, h):
        """Euler's step of y = (x, v), whose derivative is (v, acc(x))."""
        return tuple(euler(lambda t, y: np.array([y[1], acc(y[0])]), 0.0, np.array([x, v]), h))

    euler_step.mistake(
        "wrong-variable",
        "the place moves with the new velocity",
        change="x + h * v, -> x + h * (v + h * acc(x)),",
    )
    euler_step.mistake("wrong-variable", "acc is that of the new place", change="acc(x) -> acc(x + h * v)")
    euler_step.mistake(
        "sign-flipped", "the acceleration is subtracted", change="+ h * acc(x) -> - h * acc(x)"
    )
    ask_for_other_forces(ask, "euler_step", euler_step, of_first_order)

    # at h = 2 an eigenvalue of the oscillator is -1
    symplectic_step = ask_for_steps_of_a_planet(
        ask, "symplectic_step", order=1, stable_to=(2, searched), calls=1
    )

    @symplectic_step.truth
    def by_places(acc, x, v, h):
        """The place moves by h times the new velocity, v + h acc(x)."""
        new = x + h * v + h**2 * acc(x)
        return new, (new - x) / h

    @symplectic_step.mistake("wrong-variable", "the position moves with the old velocity")
    def euler_instead(acc, x, v, h):
        return x + h * v, v + h * acc(x)

    symplectic_step.mistake(
        "constant-factor",
        "the position moves with the mean velocity",
        change="x + h * v, v -> x + h * (v - h / 2 * acc(x)), v",
    )

    @symplectic_step.mistake("component-order", "the position moves before the velocity, and twice")
    def moved_twice(acc, x, v, h):
        x = x + h * v
        v = v + h * acc(x)
        return x + h * v, v

    ask_for_other_forces(ask, "symplectic_step", symplectic_step, by_places)


@notebook.exercise("2")
def velocity_verlet(ask):
    """The velocity changes in two halves, by the accelerations at the old and at the new place."""
    # at h = 2 an eigenvalue of the oscillator is -1
    verlet_step = ask_for_steps_of_a_planet(ask, "verlet_step", order=2, stable_to=(2, searched), calls=2)

    @verlet_step.truth
    def by_mean_acceleration(acc, x, v, h):
        """The place moves with v + h/2 acc(x), and both halves together are h times the mean acceleration."""
        new = x + h * v + h**2 / 2 * acc(x)
        return new, v + h * (acc(x) + acc(new)) / 2

    verlet_step.mistake(
        "wrong-variable",
        "the position moves with the old velocity",
        change="x = x + h * half -> x = x + h * v",
    )
    # right, with one call of acc too many
    verlet_step.mistake(change="x + h * half -> x + h * v + h**2 / 2 * acc(x)")

    @verlet_step.mistake("wrong-variable", "both accelerations are the old one")
    def old_acceleration_twice(acc, x, v, h):
        half = v + h / 2 * acc(x)
        return x + h * half, half + h / 2 * acc(x)

    ask_for_other_forces(ask, "verlet_step", verlet_step, by_mean_acceleration)


@notebook.exercise("3")
def runge_and_kutta(ask):
    """The classical Runge–Kutta step of fourth order, with four calls of acc."""
    # |1 - ih - h²/2 + ih³/6 + h⁴/24|² = 1 - h⁶/72 + h⁸/576 passes 1 at h = √8
    rk4_step = ask_for_steps_of_a_planet(ask, "rk4_step", order=4, stable_to=(sqrt(8), searched), calls=4)

    @rk4_step.truth
    def by_tableau(acc, x, v, h):
        """The step of y = (x, v), whose derivative is (v, acc(x)), by the method's Butcher tableau."""
        return tuple(rk4(lambda t, y: np.array([y[1], acc(y[0])]), 0.0, np.array([x, v]), h))

    # right, with one call of acc too many
    rk4_step.mistake(change="v + h / 2 * a1 -> v + h / 2 * acc(x)")
    rk4_step.mistake(
        "constant-factor",
        "the last slopes are those of h/2",
        change="h * a3, acc(x + h * v3) -> h / 2 * a3, acc(x + h / 2 * v3)",
    )
    rk4_step.mistake(
        "missing-term",
        "the weights 2 of the middle slopes of x are missing",
        change="+ 2 * v2 + 2 * v3 -> + v2 + v3",
    )
    rk4_step.mistake(
        "wrong-variable",
        "the third slopes follow from the first ones, not from the second ones",
        change="v + h / 2 * a2, acc(x + h / 2 * v2) -> v + h / 2 * a1, acc(x + h / 2 * v1)",
    )
    ask_for_other_forces(ask, "rk4_step", rk4_step, by_tableau)


# Exercises 4 and 5: steps of an oscillator as matrices


def partly_updated(acc, x, v, h, b):
    """A step in which the place moves with the velocity after a part b of its change: Euler's step for b = 0,
    the symplectic one for b = 1.
    """
    change = h * acc(x)
    return x + h * (v + b * change), v + change


def matrix_of_a_step(h, b):
    """The matrix by which that step multiplies (x, v) of the oscillator x'' = -x; complex, as its
    eigenvalues are.
    """
    return np.array([[1 - b * h**2, h], [-h, 1]], dtype=complex)


def run_with(b):
    """Return the draw of a run with a part b: up to 300 steps."""

    @notebook.draw
    def run(draw):
        return {"b": b, "h": draw(between(0.05, 0.3)), "n": draw(integer(1, 300))}

    return run


@notebook.exercise("4")
def energy(ask):
    """The largest relative error of the energy in n steps of the oscillator."""
    # the energy grows for b < 1, oscillates for b = 1, and falls for b > 1
    euler_grows, between_both, symplectic, beyond = run_with(0.0), run_with(0.5), run_with(1.0), run_with(1.2)
    runs = in_turn(euler_grows, between_both, symplectic, beyond)
    energy_error = ask.function("energy_error")
    energy_error.case("any step", runs, public=5, hidden=16, step=function(partly_updated, b=runs["b"]))

    @energy_error.truth(
        agree=close(rtol=1e-10, atol=1e-11, because="a hundred times the rounding errors of 300 steps")
    )
    def by_eigenvalues(h, n, b):
        """The matrix is modes · diag(factors) · modes⁻¹, so its j-th power has factors^j; column 0 is the
        state from (1, 0). E(0) = 1/2, so the relative error of the energy is x² + v² - 1.
        """
        factors, modes = np.linalg.eig(matrix_of_a_step(h, b))
        powers = (modes * factors ** np.arange(n + 1)[:, None, None]) @ np.linalg.inv(modes)
        x, v = powers[:, :, 0].real.T
        return np.abs(x**2 + v**2 - 1).max()

    energy_error.mistake(
        "missing-term",
        "the error is that of the last step",
        change="max(worst, abs(x**2 + v**2 - 1)) -> abs(x**2 + v**2 - 1)",
    )
    energy_error.mistake(
        "wrong-function",
        "a loss of energy does not count",
        change="abs(x**2 + v**2 - 1) -> x**2 + v**2 - 1",
    )
    energy_error.mistake(
        "constant-factor",
        "the error is not relative to E(0) = 1/2",
        change="abs(x**2 + v**2 - 1) -> abs(x**2 + v**2 - 1) / 2",
    )


def partly_updated_at_rate(acc, x, v, h, b, k, place_first):
    """``partly_updated`` of the size kh; with ``place_first`` the place moves first, and the acceleration is
    that of the place after a part b of its move. Trace and determinant on the oscillator are the same.
    """
    if place_first:
        change = k * h * v
        return x + change, v + k * h * acc(x + b * change)
    return partly_updated(acc, x, v, k * h, b)


@notebook.draw
def always_growing(draw):
    """The determinant of the matrix is above 1."""
    return {"b": 0.5, "k": 2 / draw(between(1, 4)), "place_first": draw(one_of(False, True))}


@notebook.draw
def hardly_growing(draw):
    """The determinant is above 1 by only 1e-6 (kh)²: with h = 0.1, where the search begins, growth is
    1 + 1e-9 to 1 + 2e-8. For b = 1 the limit would be 2/k.
    """
    return {"b": 1 - 1e-6, "k": 2 / draw(between(1, 4)), "place_first": draw(one_of(False, True))}


@notebook.draw
def limit_below_the_range(draw):
    """For b = 1 the limit is 2/k: the oscillator grows already with h = 0.1."""
    return {"b": 1.0, "k": 2 / draw(between(0.05, 0.09)), "place_first": draw(one_of(False, True))}


@notebook.draw
def limit_near_the_low_end(draw):
    return {"b": 1.0, "k": 2 / draw(between(0.105, 0.15)), "place_first": draw(one_of(False, True))}


@notebook.draw
def limit_in_the_middle(draw):
    """The determinant is below 1, and the limit 2/k/sqrt(2b - 1)."""
    k = 2 / draw(between(1, 3))
    return {"b": draw(between(1.05, 2.5)), "k": k, "place_first": draw(one_of(False, True))}


@notebook.draw
def limit_near_the_high_end(draw):
    return {"b": 1.0, "k": 2 / draw(between(3.3, 3.95)), "place_first": draw(one_of(False, True))}


@notebook.exercise("5")
def where_a_method_fails(ask):
    """The largest |eigenvalue| of a step of the oscillator, and the largest h from 0.1 to 4, to 1e-6, with
    which it is not above 1, or 0 if there is none.
    """
    growth = ask.function("growth")
    growth.case(
        "any step",
        public=6,
        hidden=16,
        step=function(
            partly_updated_at_rate, b=between(0, 2.5), k=between(0.5, 2), place_first=one_of(False, True)
        ),
        h=between(0.3, 3),
    )

    @growth.truth(agree=absolute(1e-7, because="the root of the rounding errors, where two eigenvalues meet"))
    def by_trace_and_determinant(h, b, k):
        """The eigenvalues solve λ² - (2 - b (kh)²) λ + 1 + (1 - b)(kh)² = 0; complex ones are conjugate:
        |λ|² is the determinant.
        """
        half, determinant = 1 - b * (k * h) ** 2 / 2, 1 + (1 - b) * (k * h) ** 2
        is_complex = half**2 < determinant
        return sqrt(determinant) if is_complex else abs(half) + sqrt(half**2 - determinant)

    growth.mistake(
        "wrong-start",
        "the second column is the step from (1, 1)",
        change="(1.0, 0.0), (0.0, 1.0) -> (1.0, 0.0), (1.0, 1.0)",
    )
    growth.mistake(
        "wrong-function",
        "the real parts of the eigenvalues stand for their absolute values",
        change="np.abs(np.linalg.eigvals(np.array(columns).T))"
        " -> np.linalg.eigvals(np.array(columns).T).real",
    )
    growth.mistake(
        "wrong-quantity",
        "the norm of the matrix, not its largest |eigenvalue|",
        change="np.abs(np.linalg.eigvals(np.array(columns).T)).max() -> np.linalg.norm(columns, 2)",
    )

    steps = in_turn(
        always_growing,
        limit_below_the_range,
        limit_near_the_low_end,
        limit_in_the_middle,
        limit_near_the_high_end,
        hardly_growing,
        limit_below_the_range,
        limit_near_the_low_end,
        limit_in_the_middle,
        limit_near_the_high_end,
    )
    stability_limit = ask.function("stability_limit")
    stability_limit.case(
        "any step",
        public=10,
        hidden=15,
        step=function(partly_updated_at_rate, b=steps["b"], k=steps["k"], place_first=steps["place_first"]),
    )

    @stability_limit.truth(agree=absolute(2e-6, because="twice the precision that is asked for"))
    def where_an_eigenvalue_is_minus_1(b, k):
        """For b >= 1 that is at (2b - 1) (kh)² = 4; for b < 1 the determinant is above 1 with every h."""
        limit = 2 / sqrt(2 * b - 1) / k if b >= 1 else 0.0
        return limit if limit > 0.1 else 0.0

    stability_limit.mistake(
        "wrong-constant",
        "a growth of a hundredth in each step counts as stable",
        change="> 1 + 1e-9 else -> > 1.01 else",
    )
    stability_limit.mistake(
        "missing-term",
        "the limit of a method that always grows is 0, not 0.1",
        change="return 0.0 -> return stable",
    )
    # methods that always grow get 0.1
    stability_limit.mistake(change="if growth(step, stable) > 1 + 1e-9: -> if False:")

    @stability_limit.mistake("wrong-constant", "rounding errors count as growth")
    def without_a_margin(step):
        stable, unstable = 0.1, 4.0
        if growth(step, stable) > 1:
            return 0.0
        while unstable - stable > 1e-7:
            h = (stable + unstable) / 2
            stable, unstable = (stable, h) if growth(step, h) > 1 else (h, unstable)
        return stable


# Exercise 6: the error at t = 5 as a complex power


def nearly_midpoint(acc, x, v, h, c):
    """Euler's step for c = 0, the midpoint step for c = 1.

    On x'' = -x it multiplies z = x + iv, which is exp(-it) from x = 1, v = 0, by 1 - ih - c h²/2.
    """
    return x + h * (v + c * h / 2 * acc(x)), v + h * acc(x + c * h / 2 * v)


def often_called(acc, x, v, h, c):
    """The same step with a third call of acc where x < 0, so that calls are not 2n."""
    if x < 0:
        acc(x)
    return nearly_midpoint(acc, x, v, h, c)


def far_off(acc, x, v, h):
    """A step that ends at x = 2⁶⁰ h. Beside it cos 5 and sin 5 are nothing: the error of n steps to t = 5 is
    5 · 2⁶⁰/n exactly.
    """
    return 2.0**60 * h + 0 * x, 0 * acc(x)


def distance_by_powers(n, c, k=1.0):
    """The distance of n steps from (cos 5, -sin 5) with acc(x) = -k x: with w² = k, each step multiplies
    x + iv/w by 1 - iwh - c k h²/2. That point is the end of the motion for k = 1 only; other k show whether
    final_error uses its acc.
    """
    w, h = sqrt(k), 5 / n
    z = (1 - 1j * w * h - c * k * h**2 / 2) ** n
    return abs(z.real + 1j * w * z.imag - np.exp(-5j))


@notebook.draw
def one_step(draw):
    return {"n": 1, "c": draw(one_of(0.0, 1.0))}


@notebook.draw
def steps_of_euler(draw):
    return {"n": draw(integer(2, 400)), "c": 0.0}


@notebook.draw
def midpoint_steps(draw):
    return {"n": draw(integer(2, 400)), "c": 1.0}


@notebook.draw
def doubled_steps_of_euler(draw):
    return {"n": draw(integer(50, 200)), "c": 0.0}


@notebook.draw
def doubled_midpoint_steps(draw):
    return {"n": draw(integer(50, 200)), "c": 1.0}


def tolerance_between(low, high):
    """Return the draw of a step and of a tolerance, uniform in its logarithm."""

    @notebook.draw
    def tolerance(draw):
        return {"tol": low * (high / low) ** draw(between(0, 1)), "c": draw(between(0.8, 1.2))}

    return tolerance


@notebook.draw
def tolerance_of_2048_steps(draw):
    """The error is about 25 |1 - c| / 2n = 2.5/n: 0.0024 with 1024 steps, 0.0012 with 2048."""
    return {"tol": draw(between(1.3e-3, 2.2e-3)), "c": 0.8}


@notebook.draw
def error_that_equals_the_tolerance(draw):
    return {"tol": 5 * 2.0**60 / draw(one_of(8, 16))}


@notebook.draw
def error_just_above_the_tolerance(draw):
    return {"tol": (1 - 2.0**-20) * 5 * 2.0**60 / draw(one_of(64, 512))}


@notebook.draw
def error_far_below_the_tolerance(draw):
    return {"tol": 5 * 2.0**60 / draw(one_of(1, 2))}


@notebook.exercise("6")
def speed_against_accuracy(ask):
    """The error of n steps to t = 5, the order that it shows, and the calls that an accuracy costs."""
    lengths = in_turn(one_step, steps_of_euler, midpoint_steps)
    final_error = ask.function("final_error")
    final_error.case(
        "any step",
        lengths,
        step=function(nearly_midpoint, c=lengths["c"]),
        acc=expression("-k * x", of="x", k=between(0.5, 2)),
    )
    final_error.truth(
        distance_by_powers, agree=relative(1e-10, because="a hundred times the rounding errors of 400 steps")
    )
    final_error.mistake(
        "missing-term",
        "the error of v is missing",
        change="np.hypot(x - np.cos(5), v + np.sin(5)) -> abs(x - np.cos(5))",
    )

    doubled = in_turn(doubled_steps_of_euler, doubled_midpoint_steps)
    observed_order = ask.function("observed_order")
    observed_order.case("any step", doubled, step=function(nearly_midpoint, c=doubled["c"]))

    @observed_order.truth(
        agree=absolute(
            1e-7,
            because="hundreds of times the rounding errors of 400 steps, 4e-14, over the smallest error,"
            " 1e-4",
        )
    )
    def of_both_powers(n, c):
        return log2(distance_by_powers(n, c) / distance_by_powers(2 * n, c))

    observed_order.mistake(
        "wrong-function",
        "the natural logarithm stands for that of base 2",
        change="np.log2 -> np.log",
    )

    costs = in_turn(
        tolerance_between(0.4, 2),
        tolerance_between(0.08, 0.4),
        tolerance_between(0.016, 0.08),
        tolerance_between(0.0032, 0.016),
        tolerance_between(6.3e-4, 0.0032),
        tolerance_of_2048_steps,
    )
    # a student's wrong final_error is replaced by the right one, which runs in another process: then each
    # step takes a tenth of a millisecond
    calls_needed = ask.function("calls_needed", budget_s=10)
    calls_needed.case("any step", costs, public=6, hidden=12, step=function(often_called, c=costs["c"]))

    @calls_needed.truth(agree=exactly)
    def by_signs(tol, c):
        """Two calls for each step, and a third for each that begins at x < 0."""
        n = next(8 * 2**k for k in range(30) if distance_by_powers(8 * 2**k, c) <= tol)
        z = (1 - 5j / n - c * (5 / n) ** 2 / 2) ** np.arange(n)
        return 2 * n + int(np.sum(z.real < 0))

    # the first run has 16 steps
    calls_needed.mistake(change="n, calls = 8 -> n, calls = 16")
    calls_needed.mistake(
        "missing-term", "the calls of the coarser runs count too", change="calls.clear() -> pass"
    )
    calls_needed.mistake(
        "wrong-variable",
        "the number of steps is returned, not that of the calls",
        change="len(calls) -> n",
    )
    calls_needed.mistake(
        "too-few-steps",
        "runs of more than 1024 steps are not tried",
        change="acc, n) > tol: -> acc, n) > tol and n < 1024:",
    )

    at_the_tolerance = ask.function(
        "calls_needed", label="calls_needed takes an error that equals tol, and none above it"
    )
    at_the_tolerance.case(
        "a step far off",
        in_turn(
            error_that_equals_the_tolerance, error_just_above_the_tolerance, error_far_below_the_tolerance
        ),
        public=3,
        hidden=6,
        step=function(far_off),
    )

    @at_the_tolerance.truth(agree=exactly)
    def first_of_the_runs(tol):
        """One call for each step of the first run with an error 5 · 2⁶⁰/n of at most tol."""
        return next(n for n in 8 * 2.0 ** np.arange(20) if 5 * 2.0**60 / n <= tol)
