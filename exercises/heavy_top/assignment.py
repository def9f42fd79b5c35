"""The heavy symmetric top: what is asked about notebook.ipynb, which holds text, Setup and solutions.

Motions are those by elliptic functions, ``reference.HeavyTop`` of a top and ``reference.Exact`` of a free
body, which tests/reference compares with 60-digit integrations. Other truths use vectors and matrices in
place of Euler angles, roots, and eigenvalues. Each has a further source in tests/exercises/test_heavy_top.py.

In a mistake, ``change`` replaces one place of the notebook's solution, and a question is called as its right
solution. A mistake without words must fail, and gives no hint. ``public`` and ``hidden`` are numbers of
inputs: of fixed ones, which students have too, and of ones that are drawn for each grading.

Moments I1 and I3 are in kg m², mgl in N m, angles in rad, rates in rad/s. A state y (6,) is θ, φ, ψ, θ̇, φ̇, ψ̇.
"""

from math import cos, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp

from exercises.authoring import (
    Notebook,
    absolute,
    at_most,
    between,
    close,
    in_turn,
    relative,
)
from reference import Exact, HeavyTop, heavy_top

notebook = Notebook("notebook.ipynb")

rounding = relative(1e-11, because="rounding errors are 1e-15 of the largest term; ten thousand times that")
integrated = at_most(1e-8, because="a hundred times the error of the integration")
of_their_size = close(
    rtol=1e-7,
    atol=0,
    because="differences of nearly equal numbers lose up to four of sixteen digits: 100,000 times that",
)
not_k = "scipy's ellipk takes m = k², not k"
no_precession = "ω₃ lacks the part φ̇ cos θ of the precession"


# Tops: slow ones with k² (the parameter of the elliptic functions) near 0.9, which swing far down, and fast
# ones. The precession and the spin of the slow ones, and the spin of the fast ones, keep the axis away from
# the vertical.


def any_top(draw):
    """Return the moments and mgl of a top."""
    return {"I1": draw(between(0.8, 2)), "I3": draw(between(0.5, 1.5)), "mgl": draw(between(2, 10))}


def slow_top(sense):
    """Return the draw of a slow top that turns in this sense, +1 or -1."""

    @notebook.draw
    def slow(draw):
        angles = draw.rng.uniform((0.5, -3, -3), (0.7, 3, 3))
        rates = draw.rng.uniform((-0.5, 1, 0.6), (0.5, 1.5, 1.5))
        return {"y": np.append(angles, sense * rates), **any_top(draw)}

    return slow


def fast_top(sense, lowest=0.5):
    """Return the draw of a fast top that spins in this sense, +1 or -1, with θ from ``lowest`` to 2.6."""

    @notebook.draw
    def fast(draw):
        angles = draw.rng.uniform((lowest, -3, -3), (2.6, 3, 3))
        nod, swing = draw.rng.uniform(-1.5, 1.5, 2)
        return {"y": np.array([*angles, nod, swing, sense * draw(between(8, 16))]), **any_top(draw)}

    return fast


def hanging_top(sense):
    """Return the draw of a fast top whose axis points below the horizontal."""
    return fast_top(sense, lowest=1.7)


tops = in_turn(
    slow_top(+1),
    slow_top(-1),
    hanging_top(+1),
    hanging_top(-1),
    slow_top(+1),
    slow_top(-1),
    fast_top(+1),
    fast_top(-1),
)


@notebook.exercise("1")
def equations_of_motion(ask):
    """Lagrange's equations in Euler angles: dy/dt at states, and the motion for 4 s."""
    top_eqs = ask.right_hand_side(
        "top_eqs",
        until=4.0,
        follow=integrated,
        scale=(1, 1, 9, 1, 1, 9),  # ψ and ψ̇ of fast tops are about nine times the others
        conserved={
            "E": (
                "I1/2*(y[3]**2 + (y[4]*sin(y[0]))**2) + I3/2*(y[5] + y[4]*cos(y[0]))**2 + mgl*cos(y[0])",
                integrated,
            ),
            "L_z": ("I1*y[4]*sin(y[0])**2 + I3*(y[5] + y[4]*cos(y[0]))*cos(y[0])", integrated),
            "L_3": ("I3*(y[5] + y[4]*cos(y[0]))", integrated),
        },
    )
    top_eqs.case("any top", tops, public=4, hidden=16, t=0.0)
    top_eqs.agree(rounding)

    @top_eqs.motion
    def by_elliptic_functions(t, y, I1, I3, mgl):
        """The exact motion from y. No other equations follow it, so it certifies the notebook's solution,
        whose rates are then the exact ones.
        """
        return HeavyTop(y, I1, I3, mgl).motion(t)

    top_eqs.mistake("sign-flipped", "gravity pulls the axis upwards", change="+ mgl) -> - mgl)")
    top_eqs.mistake("missing-term", no_precession, change="w3 = spin + swing * c -> w3 = spin")
    top_eqs.mistake(
        "constant-factor",
        "the term 2 I₁ φ̇ θ̇ cos θ has lost its factor 2",
        change="2 * I1 * swing -> I1 * swing",
    )
    top_eqs.mistake("missing-term", "ψ̈ lacks the term −φ̈ cos θ", change=" - swinging * c -> ")

    @top_eqs.mistake("component-order", "the accelerations come before the rates; dy/dt begins with θ̇, φ̇, ψ̇")
    def accelerations_first(t, y, I1, I3, mgl):
        rates = top_eqs(t, y, I1, I3, mgl)
        return np.concatenate([rates[3:], rates[:3]])


@notebook.exercise("2")
def conserved_quantities(ask):
    """The energy in J, and the components L_z and L_3 of the angular momentum in kg m²/s, of a state."""
    invariants = ask.function("invariants", returns="E L_z L_3")
    invariants.case("any top", tops, public=4, hidden=16)

    @invariants.truth(agree=rounding)
    def by_vectors(y, I1, I3, mgl):
        """With L = (I₁ω₁, I₁ω₂, I₃ω₃) in body axes the energy is L·ω/2 + mgl cos θ. The last row of the
        rotation matrix is the vertical in body axes, and its last number cos θ.
        """
        # attitude is (1, 3, 3) here: its last row
        vertical, w = heavy_top.attitude(y[:3, None])[0][2], heavy_top.omega(y)
        L = np.array([I1, I1, I3]) * w
        return L @ w / 2 + mgl * vertical[2], vertical @ L, L[2]

    invariants.mistake("wrong-power", "sin θ stands for sin²θ in L_z", change="swing * s**2 -> swing * s")
    invariants.mistake(
        "missing-term", "L_z lacks the part I₁ φ̇ sin²θ", change="I1 * swing * s**2 + L_3 * c -> L_3 * c"
    )
    invariants.mistake("missing-term", no_precession, change="I3 * (spin + swing * c) -> I3 * spin")
    invariants.mistake(
        "sign-flipped", "the potential energy has the wrong sign", change="+ mgl * c -> - mgl * c"
    )


@notebook.exercise("3")
def nodding(ask):
    """The smallest and the largest θ of a motion, and its period in s."""
    nutation = ask.function("nutation", returns="theta_min theta_max period", budget_s=10)
    nutation.case("any top", tops, public=4, hidden=16)

    @nutation.truth(
        agree=absolute(
            1e-7, because="roots are exact to 1e-13, turning points of a careful integration to 1e-8"
        )
    )
    def of_the_exact_motion(y, I1, I3, mgl):
        """Where the motion by elliptic functions turns, and its period."""
        motion = HeavyTop(y, I1, I3, mgl)
        return *motion.turning_points, motion.period

    nutation.mistake(
        "component-order",
        "θ falls as cos θ rises",
        change="np.arccos(high), np.arccos(low) -> np.arccos(low), np.arccos(high)",
    )
    nutation.mistake("wrong-power", not_k, change="ellipk(m) -> ellipk(m**0.5)")
    nutation.mistake("constant-factor", "sn² has the period 2K, not 4K", change="2 * ellipk -> 4 * ellipk")
    nutation.mistake(
        "missing-term",
        "the energy of the spin, L₃²/2I₃, is not subtracted",
        change="E - L_3**2 / (2 * I3) -> E",
    )


def steady_top(excess):
    """Return the draw of a tilt, and of a spin of ``ratio`` times the least with which the top can precess
    without nodding; ``excess`` draws the logarithm of ratio - 1.
    """

    @notebook.draw
    def steady(draw):
        top, theta, ratio = any_top(draw), draw(between(0.3, 1.3)), 1 + 10 ** draw(excess)
        w3 = ratio * 2 * sqrt(top["I1"] * top["mgl"] * cos(theta)) / top["I3"]
        return {"theta": theta, "w3": w3, "ratio": ratio, **top}

    return steady


def upright_top(ratio, top):
    """Return an upright top with a spin of ``ratio`` times the least with which it is stable."""
    return {"w3": ratio * 2 * sqrt(top["I1"] * top["mgl"]) / top["I3"], **top}


@notebook.draw
def unstable_top(draw):
    return upright_top(1 - 10 ** draw(between(-3, -0.1)), any_top(draw))


@notebook.draw
def stable_top(draw):
    return upright_top(1 + 10 ** draw(between(-3, -0.1)), any_top(draw))


@notebook.exercise("4")
def precession_without_nodding(ask):
    """The two rates of steady precession, and the least spin with which an upright top sleeps."""
    barely, surely = steady_top(between(-3, -1.5)), steady_top(between(-1.5, 0.6))
    steady_precession = ask.function("steady_precession", in_turn(barely, surely), returns="slow fast")

    @steady_precession.truth(agree=of_their_size)
    def by_the_roots_of_a_polynomial(theta, ratio, I1, mgl):
        """The rates solve a φ̇² - I₃ω₃ φ̇ + mgl = 0 with a = I₁ cos θ. They meet where I₃ω₃ is
        2 sqrt(a mgl), and here it is ``ratio`` times that. numpy finds them as eigenvalues of a matrix.
        """
        a = I1 * cos(theta)
        return tuple(np.sort(np.roots([a, -2 * ratio * sqrt(a * mgl), mgl])))

    steady_precession.mistake(
        "constant-factor", "I₃ω₃ stands in place of its half", change="I3 * w3 / 2 -> I3 * w3"
    )

    @steady_precession.mistake("missing-term", "the rates are not divided by cos θ")
    def divided_by_I1_only(theta, w3, I1, I3, mgl):
        slow, fast = steady_precession(theta, w3, I1, I3, mgl)
        return slow * np.cos(theta), fast * np.cos(theta)

    sleeping_top = ask.function("sleeping_top", in_turn(unstable_top, stable_top), returns="w3_min growth")

    @sleeping_top.truth(agree=absolute(1e-7, because="eigenvalues are exact to 1e-13; a million times that"))
    def by_eigenvalues(w3, I1, I3, mgl):
        """Near the vertical ω₁, ω₂ and the vertical's components e₁, e₂ in body axes obey linear equations:
        ω₁' = k ω₂ + mgl/I₁ e₂ and ω₂' = -k ω₁ - mgl/I₁ e₁ with k = (I₁ - I₃)/I₁ ω₃, and e' = e × ω with
        e₃ = 1. The growth rate is the largest real part of the eigenvalues, which is 0 from the limit on.
        """
        k, fall = (I1 - I3) / I1 * w3, mgl / I1
        rates = [[0, k, 0, fall], [-k, 0, -fall, 0], [0, -1, 0, w3], [1, 0, -w3, 0]]
        return sqrt(4 * mgl * I1 / I3**2), max(np.linalg.eigvals(rates).real)

    sleeping_top.mistake(
        "constant-factor",
        "the limit is ω₃² = 4 I₁ m g ℓ / I₃²",
        change="2 * np.sqrt(I1 * mgl) -> np.sqrt(I1 * mgl)",
    )
    sleeping_top.mistake(
        "wrong-power",
        "σ², the square of the growth rate, is returned",
        change="np.sqrt(max(0.0, mgl / I1 - (I3 * w3 / (2 * I1)) ** 2))"
        " -> mgl / I1 - (I3 * w3 / (2 * I1)) ** 2",
    )
    sleeping_top.mistake(
        "constant-factor", "L₃/I₁ is squared, not L₃/2I₁", change="(2 * I1)) ** 2 -> I1) ** 2"
    )


# Exercise 5: the same tops by rotation matrices


def as_matrix(top, near_vertical=False):
    """Return the draw of a top's state s (12,): ω in body axes, then the rotation matrix row by row.
    ``near_vertical`` is with θ from 0.001 to 1 instead.
    """

    @notebook.draw
    def state_with_matrix(draw):
        drawn = top(draw.rng)
        y = drawn.pop("y")
        if near_vertical:
            y[0] = 10 ** draw(between(-3, 0))
        return {"s": np.append(heavy_top.omega(y), heavy_top.attitude(y[:3, None])), **drawn}

    return state_with_matrix


tops_with_matrices = in_turn(
    as_matrix(slow_top(+1), near_vertical=True),
    as_matrix(slow_top(-1)),
    as_matrix(hanging_top(+1)),
    as_matrix(fast_top(-1), near_vertical=True),
    as_matrix(slow_top(+1)),
    as_matrix(slow_top(-1), near_vertical=True),
    as_matrix(fast_top(+1)),
    as_matrix(hanging_top(-1)),
)


def start(tilt, spin):
    """Return the start of the notebook's Setup, θ = tilt, φ = ψ = 0 and ω = (0, 0.6, spin) rad/s: the state
    y (6,), then ω (3,) and the rotation matrix (3, 3).
    """
    c, s = cos(tilt), sin(tilt)
    y = np.array([tilt, 0, 0, 0, 0.6 / s, spin - 0.6 * c / s])
    return y, np.array([0, 0.6, spin]), np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def tilted_by(largest):
    """Return the draw of a start whose tilt is between a tenth of the largest and the largest."""

    @notebook.draw
    def tilted(draw):
        return {"tilt": largest * 10 ** -draw(between(0, 1)), "spin": draw(between(12, 20))}

    return tilted


@notebook.exercise("5")
def gimbal_lock(ask):
    """The equations of motion of a rotation matrix, and the calls of either description near the vertical."""
    matrix_eqs = ask.right_hand_side(
        "matrix_eqs",
        until=2.0,
        follow=integrated,
        state="s",
        scale=(9.0,) * 3 + (1.0,) * 9,  # ω of fast tops is about nine times the numbers of the matrix
        conserved={"L_z": ("I1*(s[9]*s[0] + s[10]*s[1]) + I3*s[11]*s[2]", integrated)},
    )
    matrix_eqs.case("any top", tops_with_matrices, public=4, hidden=16, t=0.0)
    matrix_eqs.agree(rounding)

    @matrix_eqs.motion
    def by_elliptic_functions(t, s, I1, I3, mgl):
        """ω and the rotation matrix of the exact motion from s."""
        top = HeavyTop(heavy_top.euler_state(s[:3], s[3:].reshape(3, 3)), I1, I3, mgl)
        return [*top.omega(t), *top.attitude(t).reshape(-1, 9).T]

    matrix_eqs.mistake(
        "sign-flipped",
        "gravity pulls the axis upwards",
        change="[R[2, 1], -R[2, 0], 0] -> [-R[2, 1], R[2, 0], 0]",
    )
    matrix_eqs.mistake(
        "transposed",
        "the vertical in body axes is R's last row",
        change="[R[2, 1], -R[2, 0], 0] -> [R[1, 2], -R[0, 2], 0]",
    )

    @matrix_eqs.mistake("transposed", "R is read and ravelled by columns; the state holds its rows")
    def by_columns(t, s, I1, I3, mgl):
        w, R = s[:3], s[3:].reshape(3, 3)
        rates = matrix_eqs(t, np.append(w, R.T), I1, I3, mgl)
        return np.append(rates[:3], rates[3:].reshape(3, 3).T)

    matrix_eqs.mistake(
        "wrong-operator",
        "[ω]× acts on body components: R [ω]×",
        change="R @ turning -> turning @ R",
    )
    matrix_eqs.mistake("sign-flipped", "ω × L has the opposite sign", change="torque - np -> torque + np")

    I1, I3, mgl = 1.0, 0.6, 10.0  # the top of the notebook's Setup

    starts = in_turn(tilted_by(1), tilted_by(0.1), tilted_by(0.01), tilted_by(0.001))
    lock = ask.function("gimbal_lock", returns="calls_euler calls_matrix tilt_end")
    lock.case("any start", starts, public=4, hidden=4)

    @lock.truth
    def with_other_forms_of_the_equations(tilt, spin):
        """The calls are those of the Lagrangian's mass matrix, and of torque and angular momentum as vectors,
        with the solver of the Setup: but for rounding, nfev does not depend on the form of the equations. The
        tilt at the end is that of the exact motion.
        """

        def euler_rates(t, y):
            (theta, _, _), (nod, swing, turn) = y[:3], y[3:]  # turn is ψ̇; spin is ω₃ at the start
            s, c = sin(theta), cos(theta)
            L_3 = I3 * (turn + swing * c)
            masses = [[I1, 0, 0], [0, I1 * s * s + I3 * c * c, I3 * c], [0, I3 * c, I3]]
            forces = [
                I1 * swing**2 * s * c - L_3 * swing * s + mgl * s,
                -2 * I1 * nod * swing * s * c + L_3 * nod * s + I3 * nod * swing * s * c,
                I3 * nod * swing * s,
            ]
            return [nod, swing, turn, *np.linalg.solve(masses, forces)]

        def matrix_rates(t, state):
            w, R = state[:3], state[3:].reshape(3, 3)
            inertia = np.diag([I1, I1, I3])
            torque = np.cross([0, 0, 1], R.T @ [0, 0, -mgl])
            # rows of R [ω]× are rows of R × ω
            return [*np.linalg.solve(inertia, torque - np.cross(w, inertia @ w)), *np.cross(R, w).ravel()]

        y, w, R = start(tilt, spin)
        solver = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-10}
        calls_euler = solve_ivp(euler_rates, (0, 2), y, **solver).nfev
        calls_matrix = solve_ivp(matrix_rates, (0, 2), np.append(w, R), **solver).nfev
        return calls_euler, calls_matrix, HeavyTop(y, I1, I3, mgl).motion([2.0])[0, 0]

    similar = close(rtol=0.4, atol=0, because="output at more times costs a quarter more calls")
    lock.agree(
        calls_euler=similar,
        calls_matrix=similar,
        tilt_end=absolute(1e-6, because="a thousand times the error of the integration"),
    )
    lock.mistake(
        "wrong-index",
        "this is the tilt at the start",
        change="matrix.y[11, -1] -> matrix.y[11, 0]",
    )
    lock.mistake(
        "component-order",
        "the calls with the matrix come first",
        change="euler.nfev, matrix.nfev -> matrix.nfev, euler.nfev",
    )
    lock.mistake(
        "wrong-quantity",
        "the steps are counted, not the calls: nfev",
        change="euler.nfev, matrix.nfev -> len(euler.t) - 1, len(matrix.t) - 1",
    )
    lock.mistake(
        "precision-loss",
        "the tolerances of the Setup, **SOLVER, are forgotten for the matrix",
        change="s, args=TOP, **SOLVER -> s, args=TOP",
    )


# Exercise 6: free tops


@notebook.draw
def flat_top(draw):
    """A body with I3 > I1."""
    I1 = draw(between(1, 1.8))
    return {"w3": draw(between(0.5, 9)), "I1": I1, "I3": I1 * (1 + 10 ** draw(between(-2.5, -0.2)))}


@notebook.draw
def long_top(draw):
    """A body with I3 < I1."""
    I1 = draw(between(1, 1.8))
    return {"w3": draw(between(0.5, 9)), "I1": I1, "I3": I1 * (1 - 10 ** draw(between(-2.5, -0.2)))}


@notebook.draw
def tumbling_book(draw):
    """A book, whose edges are far from equal: each moment is the sum of two squares of them.
    I₁ < I₂ < I₃, so ω₂ is that about the unstable axis.
    """
    squares = draw.rng.uniform((2.6, 1.0, 0.1), (4.8, 1.7, 0.4))
    return {"w": draw.rng.uniform(-5, 5, 3), "I": squares.sum() - squares}


@notebook.exercise("6")
def free_tops(ask):
    """The period of the wobble of a symmetric body, and the time between two flips of any body, in s."""
    wobble_period = ask.function("wobble_period", in_turn(flat_top, long_top))

    @wobble_period.truth(agree=of_their_size)
    def of_the_exact_motion(w3, I1, I3):
        """The period of the exact motion of ω in body axes. That of a symmetric body does not depend on ω₁
        and ω₂.
        """
        return Exact((0.1, 0.2, w3), (I1, I1, I3)).period

    wobble_period.mistake(
        "wrong-variable",
        "the rate is (I₃ − I₁)/I₁ ω₃, not (I₃ − I₁)/I₃ ω₃",
        change="np.pi * I1 -> np.pi * I3",
    )
    wobble_period.mistake("constant-factor", "the period is 2π over the rate", change="2 * np.pi * I1 -> I1")

    flip_period = ask.function("flip_period", tumbling_book)

    @flip_period.truth(agree=of_their_size)
    def half_of_the_exact_period(w, I):
        """In one period ω₂ reverses twice."""
        return Exact(w, I).period / 2

    flip_period.mistake(
        "constant-factor", "the whole period: ω₂ has reversed twice", change="2 * ellipk -> 4 * ellipk"
    )
    flip_period.mistake(
        "wrong-variable",
        "I₃ − I₁ stands for I₃ − I₂",
        change="rate2 = (third - second) -> rate2 = (third - first)",
    )
    flip_period.mistake("wrong-power", not_k, change="ellipk(m) -> ellipk(m**0.5)")


@notebook.exercise("7")
def the_axis(ask):
    """An animation of the nodding axis."""
    t = np.linspace(0, 1.5, 46)
    axis = HeavyTop((0.9, 0, 0, 0, 0, 14), 1.0, 0.6, 10.0).attitude(t)[:, :, 2]
    animate_axis = ask.animation(
        "animate_axis",
        follows="axis",
        agree=at_most(
            0.03,
            because="of the extent of the motion; linear interpolation between the samples deviates by less"
            " than a tenth of it",
        ),
    )
    animate_axis.case("", t=t, axis=axis)

    @animate_axis.mistake("mirrored", "the components are in reverse order")
    def reverse_components(t, axis):
        return animate_axis(t, axis[:, ::-1])

    animate_axis.mistake("static", "every frame shows the first sample", change="axis[k]]).T -> axis[0]]).T")

    @animate_axis.mistake("wrong-frames", "the rate is uneven")
    def slow_at_first(t, axis):
        k = np.arange(len(t))
        return animate_axis(t, axis[k * k // len(t)])
