"""Rigid-body rotation and the spinning top (notebook 2.6): what is asked about notebook.ipynb, which holds
text, Setup and solutions.

One function drives everything: ``euler_eqs`` of exercise 2. Its values at points are compared with the vector
equation; its motions with the exact ones, which reference computes from Jacobi's elliptic functions. The
notebook's own nine lines come first in each exercise. They accept what conserves energy and |L|, such as
motion backwards in time; the lines after them do not.
"""

import numpy as np

import reference
from exercises.authoring import Notebook, Sensitivity, Value, at_most, close, relative
from exercises.rigid_body import draws, mistakes, shown
from exercises.rigid_body.shown import BODY, BOX, NUDGE, SPIN, SPIN_TIME, SYMMETRIC, TORQUE_FREE

NOTEBOOK = "the notebook's own tolerance"
ROUNDING = "correct formulas differ only by rounding at these magnitudes"
BOOK = reference.box_moments(*BOX)
HALF_BOOK = np.array(BOX[1:]) / 2
DRIVE = "the integrator, at rtol 1e-11, stays within 1e-9 of the exact motion"

notebook = Notebook("notebook.ipynb", title="2.6 Rigid-Body Rotation and the Spinning Top")


@notebook.exercise("1", "Principal moments of a box")
def moments_of_a_box(ask):
    """The moments of a uniform box from its edges, and of any tensor as its eigenvalues."""
    box = ask.function("box_moments", returns="moments")
    box.case("any box", notebook.draw(draws.boxes))

    @box.truth
    def by_integration(m, a, b, c):
        """∫ρ(y² + z²)dV over the box is m/12 (b² + c²), and cyclically."""
        return reference.box_moments(m, a, b, c)

    @box.scale
    def largest_of_the_box(moments):
        """Rounding is that of the body's largest moment."""
        return moments.max()

    box.agree(
        Value(
            relative(1e-12, because=f"of the body's largest moment: {ROUNDING}"),
            label="box_moments is m/12 (b² + c²) and cyclically, for any box",
            check="boxes",
        )
    )
    mistakes.of_box_moments(box)

    tensors = notebook.draw(draws.tensors)
    principal = ask.function("principal_moments", returns="moments")
    tilt = draws.rotation(np.random.default_rng(7))
    principal.case(
        "the tilted book",
        tensor=reference.box_tensor(*BOX, tilt),
        agree=Value(
            close(rtol=1e-10, atol=1e-9, because=NOTEBOOK),
            label="principal moments match the analytic box result",
            up_to="order",
            check="notebook",
        ),
    )
    principal.case(
        "any tilted box",
        tensors,
        agree=Value(
            relative(
                1e-9,
                because="of the largest moment, or of 1 kg m²: eigenvalues are exact to rounding, roots of a"
                " polynomial lose a few digits",
            ),
            label="principal_moments finds the moments of any tilted box",
            up_to="order",
            check="tensors",
        ),
    )
    principal.case(
        "the trace",
        tensors,
        call="np.sum(principal_moments(tensor))",
        agree=Value(
            close(rtol=1e-12, atol=0.0, because=ROUNDING),
            label="the sum of the moments is the trace of the tensor",
            check="trace",
        ),
    )
    principal.case(
        "the determinant",
        tensors,
        call="np.prod(principal_moments(tensor))",
        agree=Value(
            close(
                rtol=1e-9,
                atol=1e-12,
                because="a small moment is exact to rounding of the largest one, so the product loses a few"
                " digits",
            ),
            label="the product of the moments is the determinant of the tensor",
            check="determinant",
        ),
    )

    @principal.truth
    def eigenvalues(tensor):
        """In principal axes the tensor is diagonal: its eigenvalues do not depend on the frame."""
        return reference.principal_moments(tensor)

    @principal.scale
    def largest_of_the_body(moments):
        """A polynomial's roots lose digits of the largest one."""
        return max(np.max(moments), 1.0)

    mistakes.of_principal_moments(principal)
    principal.figure(
        "box",
        "The box and its principal moments",
        "A translucent box with its axes ê₁ amber, ê₂ blue, ê₃ red, and bars comparing your principal moments"
        " with the exact ones.",
        shown.draw_moments,
        shown,
    )


@notebook.exercise("2", "Euler's equations")
def eulers_equations(ask):
    """dω/dt of a body without torque, and the motion of an asymmetric top for 20 s."""
    euler_eqs = ask.dynamics(
        "euler_eqs",
        notebook.draw(draws.points),
        returns="wdot",
        state="w",
        shown=shown,
        points="probes",
        budget_s=2.0,
    )
    euler_eqs.agree(
        Value(
            relative(
                1e-13,
                because="of the largest Iω² over each moment: far above the rounding error of any correct"
                " formula",
            ),
            label="euler_eqs agrees with Euler's equations point by point",
            check="pointwise",
            components=("ω̇₁", "ω̇₂", "ω̇₃"),
        )
    )

    @euler_eqs.truth(together=True)
    def without_torque(w, I):
        """In body axes 0 = dL/dt + ω × L with L = Iω, and I is diagonal."""
        return np.cross(I * w, w) / I

    @euler_eqs.scale
    def products(w, I):
        """Each formula rounds products Iω² and divides them by a moment. At rest it rounds nothing."""
        largest = I.max(axis=-1, keepdims=True) * np.abs(w).max(axis=-1, keepdims=True) ** 2
        return np.maximum(largest / I, 1e-20)

    @euler_eqs.exact_motion
    def jacobi(t, w, I, attitude):
        """ω(t) in elliptic functions, and the attitude from its constant L and one more integral."""
        if not attitude:
            return reference.Exact(w, I).omega(t)
        exact = reference.motion(w, I, t, need="orientation")
        return exact.w, exact.R

    @euler_eqs.sensitivity
    def by_neighbours(w, I, until):
        """How far motions that start side by side come apart: along the separatrix exponentially."""
        kappa, duration = reference.sensitivities(tuple(w), tuple(I), until, 60)
        return Sensitivity(kappa, duration, float(np.linalg.norm(w)) * until)

    mistakes.of_euler_eqs(euler_eqs)

    top = euler_eqs.drives(
        "torque-free", w=TORQUE_FREE, I=BODY, until=20.0, samples=3100, attitude=True, charted="exercise 2"
    )
    limit = at_most(1e-6, because=NOTEBOOK)
    top.conserves("energy", "rotational energy conserved (torque-free)", shown.energy_of_the_top, limit)
    top.conserves("momentum", "|L| conserved (torque-free)", shown.momentum_of_the_top, limit)
    top.follows_exactly("motion", "ω(t) follows the exact motion")
    euler_eqs.hidden_motion(
        "secret",
        "ω(t) of a new random body follows the exact motion for sixty radians",
        notebook.draw(draws.long),
    )
    euler_eqs.shows(
        "omega",
        "Angular velocity, and T and |L|, which stay constant",
        "Left: the components of your ω against time, the exact motion dotted. Right: your T and |L| against"
        " time, the exact dotted.",
        shown.draw_omega,
        "torque-free",
    )
    euler_eqs.shows(
        "omega-residual",
        "Distance from the exact motion",
        "Absolute difference between your ω and the exact ω against time on a log axis, with the tolerance as"
        " a dashed line.",
        shown.draw_residual,
        "torque-free",
    )
    top.plays(
        "torque-free",
        "The body in space, turned by your equations",
        "Two boxes turning side by side, yours and the exact one, with the angular momentum and the path of"
        " body axis ê₃.",
        half=half_edges(BODY),
        axis=2,
    )


@notebook.exercise("3", "Polhodes")
def polhodes(ask):
    """ω(t) stays on both ellipsoids, and runs on each side of the separatrix as the exact motion does."""
    euler_eqs = ask.again("euler_eqs")
    top, tolerance = euler_eqs.of("torque-free"), close(rtol=1e-6, atol=1e-9, because=NOTEBOOK)

    def first_energy(t, w):
        return np.full_like(t, shown.energy_of_the_top(w)[0])

    def first_momentum(t, w):
        return np.full_like(t, shown.momentum_of_the_top(w)[0])

    top.agrees(
        "energy",
        "ω stays on the energy ellipsoid (T constant)",
        shown.energy_of_the_top,
        tolerance,
        exact=first_energy,
    )
    top.agrees(
        "momentum",
        "ω stays on the angular-momentum ellipsoid (|L| constant)",
        shown.momentum_of_the_top,
        tolerance,
        exact=first_momentum,
    )
    for axis, direction in ((3, (0.2, 0.3, 1.1)), (1, (1.1, 0.3, 0.2))):
        euler_eqs.drives(
            f"polhode-{axis}", w=with_the_energy_of_the_top(direction), I=BODY, until=20.0, samples=1000
        ).follows_exactly(
            f"about-{axis}", f"ω(t) on the polhode about ê{'₁₂₃'[axis - 1]} follows the exact motion"
        )
    euler_eqs.hidden_motion(
        "secret-greatest",
        "ω(t) of a new random body about its axis of the greatest moment",
        notebook.draw(draws.greatest),
    )
    euler_eqs.hidden_motion(
        "secret-least",
        "ω(t) of a new random body about its axis of the least moment",
        notebook.draw(draws.least),
    )
    euler_eqs.shows(
        "polhode",
        "Polhodes on the energy ellipsoid",
        "Three-dimensional curves of your ω on the translucent energy ellipsoid, the exact polhodes dotted"
        " over them.",
        shown.draw_polhodes,
        "torque-free",
        "polhode-3",
        "polhode-1",
    )


@notebook.exercise("4", "Free precession of a symmetric top")
def free_precession(ask):
    """The transverse ω of a symmetric top turns at (I₃ − I₁)/I₁ ω₃; ``precession_rate`` measures the rate."""
    euler_eqs = ask.again("euler_eqs")
    top = euler_eqs.drives("symmetric", w=(0.4, 0.0, 3.0), I=SYMMETRIC, until=8.0, samples=800)
    top.agrees(
        "rate",
        "free precession rate is (I₃−I₁)/I₁·ω₃",
        shown.turning_rate,
        close(rtol=1e-3, atol=1e-9, because=NOTEBOOK),
        exact=shown.SYMMETRIC_RATE,
    )
    top.agrees(
        "constant",
        "ω₃ is constant for the symmetric top",
        shown.variation,
        close(rtol=1e-6, atol=1e-9, because=NOTEBOOK),
        exact=0.0,
    )
    top.follows_exactly("motion", "ω(t) of the symmetric top follows the exact motion")
    euler_eqs.hidden_motion(
        "secret",
        "ω(t) of a new random symmetric top follows the exact motion",
        notebook.draw(draws.symmetric_top),
    )
    euler_eqs.hidden_motion(
        "sphere", "ω of a body with three equal moments stays constant", notebook.draw(draws.sphere)
    )
    euler_eqs.shows(
        "precession",
        "Free precession in the body",
        "Left: ω₁ blue, ω₂ orange and ω₃ red against time, the exact motion dotted. Right: the circle of ω₁"
        " and ω₂, yours and exact.",
        shown.draw_precession,
        "symmetric",
    )

    rate = ask.function("precession_rate", returns="rate", optional=True)
    for name, label in (
        ("function", "precession_rate finds Ω in a given motion"),
        ("retrograde", "precession_rate is negative if (ω₁, ω₂) turns backwards"),
        ("coarse", "precession_rate finds Ω with samples up to 0.47 of a turn apart"),
        ("short", "precession_rate finds Ω in less than one turn"),
    ):
        because = "the notebook's own tolerance: every correct way to compute a mean rate agrees to rounding"
        rate.case(
            name,
            notebook.draw(draws.PRECESSIONS[name]),
            public=0,
            hidden=3,
            agree=Value(close(rtol=1e-3, atol=0.0, because=because), label=label, check=name),
        )

    @rate.truth
    def by_the_phase(t, w):
        """The angle of ω₁ + iω₂, followed from sample to sample, over the time."""
        return reference.precession_rate(t, w)

    mistakes.of_precession_rate(rate)


@notebook.exercise("5", "The intermediate axis")
def intermediate_axis(ask):
    """The book spun about each axis with a small nudge: about ê₂ it tumbles, about the others it wobbles."""
    euler_eqs = ask.again("euler_eqs")
    for axis, name in enumerate(("spin-min", "spin-mid", "spin-max")):
        euler_eqs.drives(name, w=nudged(axis), I=BOOK, until=SPIN_TIME, samples=1500, attitude=True)
    spins = euler_eqs.of("spin-min", "spin-mid", "spin-max")
    spins.holds(
        "notebook",
        "spin is stable about the extreme axes, unstable about the intermediate axis",
        shown.is_stable_about_the_extreme_axes,
        because="steady: growth under 5 times the nudge; unstable: over 50 times",
    )

    def largest_growth():
        return [exact_growth(axis) for axis in range(3)]

    spins.agrees(
        "growth",
        "transverse growth about each axis matches the exact motion",
        shown.growth,
        close(
            rtol=1e-4,
            atol=0.0,
            because="the largest of 1500 samples misses a maximum between two of them by less than 1e-4 of"
            " it",
        ),
        exact=largest_growth,
    )
    euler_eqs.of("spin-mid").follows_exactly(
        "motion", "the tumble about the intermediate axis follows the exact motion"
    )
    euler_eqs.hidden_motion(
        "secret", "a new random body turns over at the right times", notebook.draw(draws.tumble)
    )
    euler_eqs.shows(
        "growth",
        "Growth of the transverse spin",
        "Transverse angular velocity over the spin for spins about the three axes, on a log axis; only the"
        " intermediate one grows.",
        shown.draw_growth,
        "spin-min",
        "spin-mid",
        "spin-max",
    )
    euler_eqs.shows(
        "tumble",
        "Stills of the tumbling box",
        "Three rows of six stills of the box, spun about its first, second and third axis by your equations;"
        " the second row tumbles.",
        shown.draw_tumble,
        "spin-min",
        "spin-mid",
        "spin-max",
    )
    for axis, (name, title, path) in enumerate(
        (
            ("spin-least", "the axis of the least moment: stable", "stays near the angular momentum"),
            ("tumble", "the intermediate axis: it tumbles", "turns over and back again"),
            ("spin-greatest", "the axis of the greatest moment: stable", "stays near the angular momentum"),
        )
    ):
        about = f"ê{'₁₂₃'[axis]}"
        euler_eqs.of(("spin-min", "spin-mid", "spin-max")[axis]).plays(
            name,
            f"The book spun about {about}, {title}",
            f"Two books side by side, yours and the exact one, spun about body axis {about}, which {path}.",
            half=HALF_BOOK,
            axis=axis,
        )
    t, R = filmed((0.1, 3.0, 0.15), BOOK)
    ask.body_animation(
        "animate_tumble",
        t=t,
        R=R,
        half=HALF_BOOK,
        box="half",
        title="of the tumbling box",
        sheet="tumble-yours",
        scene="tumble-film",
        optional=True,
    )


@notebook.exercise("6", "Animating the free precession")
def attitude_in_space(ask):
    """The attitude R(t) that follows from ω(t), and an animation of ê₃ going round L in space."""
    euler_eqs = ask.again("euler_eqs", prerequisite=True)
    top = euler_eqs.drives("precession", w=(0.2, 0.3, 3.0), I=SYMMETRIC, until=8.0, samples=80, attitude=True)
    top.agrees(
        "orthonormal",
        "the integrated orientation stays a proper rotation (RᵀR=I)",
        shown.skewness,
        close(rtol=1e-6, atol=1e-6, because=NOTEBOOK),
        exact=0.0,
    )
    top.follows_exactly("attitude", "R(t) follows the exact attitude", attitude=True)
    top.stays_below("momentum", "L stays fixed in space", shown.wander, at_most(1e-8, because=DRIVE))
    euler_eqs.hidden_motion(
        "secret",
        "R(t) of a new random body follows the exact attitude",
        notebook.draw(draws.attitude),
        attitude=True,
    )
    euler_eqs.shows(
        "cone",
        "The symmetry axis around L",
        "Your body axis ê₃, red, and its path in space, a grey circle around the vertical L in black; the"
        " exact path dotted.",
        shown.draw_cone,
        "precession",
    )
    top.plays(
        "precession",
        "The free precession",
        "Two symmetric boxes side by side, yours and the exact one; body axis ê₃ goes round the vertical"
        " angular momentum on a cone.",
        half=half_edges(SYMMETRIC),
        axis=2,
    )
    spin, moments = (2.2, 0.0, 0.5), (1.25, 1.25, 2.0)
    t, R = filmed(spin, moments)
    ask.body_animation(
        "animate_precession",
        t=t,
        R=R,
        L=TILT @ reference.angular_momentum(spin, moments),
        momentum="L",
        axis=2,
        moments=SYMMETRIC,
        title="of the free precession",
        sheet="precession",
        scene="film",
    )


def with_the_energy_of_the_top(direction):
    """Return ω(0) along ``direction`` with the energy of the torque-free motion, so that its polhode lies on
    the same ellipsoid.
    """
    energies = [float(reference.kinetic_energy(w, BODY)) for w in (TORQUE_FREE, direction)]
    return tuple(float(x) for x in np.asarray(direction) * np.sqrt(energies[0] / energies[1]))


def nudged(axis):
    """Return ω(0) of the book spun about one axis, nudged off it."""
    return tuple(SPIN if i == axis else NUDGE * SPIN for i in range(3))


def exact_growth(axis):
    """Return the largest transverse |ω| over the spin about ``axis``, over all times and not only at
    samples.
    """
    from scipy.optimize import minimize_scalar

    exact, times = reference.Exact(nudged(axis), BOOK), np.linspace(0.0, SPIN_TIME, 400)

    def transverse(t):
        return reference.transverse_growth(exact.omega([t]), axis, SPIN)

    at, step = times[np.argmax([transverse(t) for t in times])], times[1]
    most = minimize_scalar(
        lambda t: -transverse(t), bounds=(at - step, at + step), method="bounded", options={"xatol": 1e-9}
    )
    return float(-most.fun)


def half_edges(moments):
    """Return half edges (3,) of a uniform box whose moments have these ratios, the longest 1."""
    edges = np.sqrt(np.sum(moments) / 2 - np.array(moments))
    return edges / edges.max()


ANGLE = 5**0.5
CROSS = np.cross(np.eye(3), np.array([-2.0, 1.0, 0.0]) / ANGLE)  # times v: axis × v
TILT = np.eye(3) + np.sin(ANGLE) * CROSS + (1 - np.cos(ANGLE)) * CROSS @ CROSS
"""The first attitude of animations: it keeps L and ê₃ off every coordinate axis and plane, where mistakes
would look alike; the cone of ê₃ crosses each of the planes."""


def filmed(spin, moments):
    """Return times (n,) and attitudes (n, 3, 3) to draw: a motion that is not graded elsewhere, whose |L|
    differs from the rate at which ê₃ goes round L.
    """
    times = np.linspace(0.0, 4.0, 96)
    return times, TILT @ reference.motion(spin, moments, times, need="orientation").R
