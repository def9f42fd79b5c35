"""The heavy symmetric top: equations with and without Euler angles, nutation, precession, sleep, and two free
tops.

The truths are motions by elliptic functions, which tests/reference compares with 60-digit integrations,
vectors in place of Euler angles, a root search, and eigenvalues. tests/exercises/test_heavy_top.py compares
each with a further source.
"""

from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from exercises.authoring.kinds.animation import animation
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author import Notebook, Tolerance, mistake, uniform
from reference import Exact, HeavyTop, heavy_top

if TYPE_CHECKING:  # the solution runs in the sandbox only; importing these takes the server 0.4 s
    import matplotlib.pyplot as plt
    from matplotlib.animation import FuncAnimation

notebook = Notebook("The heavy symmetric top", notebook="notebook.ipynb")
ROUNDING = Tolerance(
    limit=1e-11, reason="rounding errors are 1e-15 of the largest term; ten thousand times that"
)
MOTION = Tolerance(limit=1e-8, reason="a hundred times the error of the integration")
WITHIN = Tolerance(
    atol=1e-7, reason="roots are exact to 1e-13, turning points of a careful integration to 1e-8"
)
TILT = Tolerance(atol=1e-6, reason="a thousand times the error of the integration")
CALLS = Tolerance(rtol=0.4, reason="output at more times costs a quarter more calls")
RELATIVE = Tolerance(
    rtol=1e-7, reason="differences of nearly equal numbers lose up to eight of sixteen digits"
)
FRAMES = Tolerance(limit=0.03, reason="linear interpolation between the samples deviates by a tenth of it")
NOT_K = "scipy's ellipk takes m = k², not k"
LATE = "the accelerations come before the rates; dy/dt begins with θ̇, φ̇, ψ̇"
NO_W3 = "ω₃ lacks the part φ̇ cos θ of the precession"


# in turn slow tops, with k² near 0.9, and fast ones; φ̇ and ψ̇ keep the axis away from the vertical
def state(rng, row):
    sign = (-1) ** row
    if row % 4 < 2:
        return np.append(
            rng.uniform((0.5, -3, -3), (0.7, 3, 3)), sign * rng.uniform((-0.5, 1, 0.6), (0.5, 1.5, 1.5))
        )
    hanging = 1.2 * (row < 4)
    return rng.uniform((0.5 + hanging, -3, -3, -1.5, -1.5, 8), (2.6, 3, 3, 1.5, 1.5, 16)) * (
        1,
        1,
        1,
        1,
        1,
        sign,
    )


DRAWN = {"I1": uniform(0.8, 2), "I3": uniform(0.5, 1.5), "mgl": uniform(2, 10)}
OF_STATE = {"y": state, **DRAWN}
ROWS = (4, 16)  # four public ones: a slow and a fast top with a spin of either sign


def top_eqs(t, y, I1, I3, mgl):
    """Return dy/dt (6,) of the heavy top in Euler angles, y = (θ, φ, ψ, θ̇, φ̇, ψ̇)."""
    theta, _, _, nod, swing, spin = y
    s, c = np.sin(theta), np.cos(theta)
    w3 = spin + swing * c
    tilting = (I1 * swing**2 * c - I3 * w3 * swing + mgl) * s / I1
    swinging = (I3 * w3 - 2 * I1 * swing * c) * nod / (I1 * s)
    spinning = nod * swing * s - swinging * c
    return np.array([nod, swing, spin, tilting, swinging, spinning])


energy = "I1/2*(y[3]**2 + (y[4]*sin(y[0]))**2) + I3/2*(y[5] + y[4]*cos(y[0]))**2 + mgl*cos(y[0])"
upward = "I1*y[4]*sin(y[0])**2 + I3*(y[5] + y[4]*cos(y[0]))*cos(y[0])"
kept = {"E": (energy, MOTION), "L_z": (upward, MOTION), "L_3": ("I3*(y[5] + y[4]*cos(y[0]))", MOTION)}
drive = {
    "motion": lambda t, y, I1, I3, mgl: HeavyTop(y, I1, I3, mgl).motion(t),
    "t_end": 4.0,
    "follow": MOTION,
}
wrong = [
    mistake("+ mgl)", "- mgl)", "sign-flipped", "gravity pulls the axis upwards"),
    mistake("w3 = spin + swing * c", "w3 = spin", "missing-term", NO_W3),
    mistake(
        "2 * I1 * swing", "I1 * swing", "constant-factor", "the term 2 I₁ φ̇ θ̇ cos θ has lost its factor 2"
    ),
    mistake(" - swinging * c", "", "missing-term", "ψ̈ lacks the term −φ̈ cos θ"),
    mistake(
        "[nod, swing, spin, tilting, swinging, spinning]",
        "[tilting, swinging, spinning, *y[3:]]",
        "component-order",
        LATE,
    ),
]
drive |= {"conserved": kept, "scale": (1, 1, 9, 1, 1, 9)}
notebook.exercise(
    "1",
    "Equations of motion",
    ode(top_eqs, {"t": 0.0, **OF_STATE}, ROUNDING, **drive, rows=ROWS, mistakes=wrong),
)


def invariants(y, I1, I3, mgl):
    """Return the energy E in J, and L_z and L_3 in kg m²/s, of the state y (6,)."""
    theta, _, _, nod, swing, spin = y
    s, c = np.sin(theta), np.cos(theta)
    L_3 = I3 * (spin + swing * c)
    L_z = I1 * swing * s**2 + L_3 * c
    return I1 / 2 * (nod**2 + (swing * s) ** 2) + L_3**2 / (2 * I3) + mgl * c, L_z, L_3


def by_vectors(y, I1, I3, mgl):
    R, w = heavy_top.attitude(y[:3, None])[0], heavy_top.omega(y)
    L = np.array([I1, I1, I3]) * w
    return L @ w / 2 + mgl * R[2, 2], R[2] @ L, L[2]


wrong = [
    mistake("swing * s**2", "swing * s", "wrong-power", "sin θ stands for sin²θ in L_z"),
    mistake("I1 * swing * s**2 + L_3 * c", "L_3 * c", "missing-term", "L_z lacks the part I₁ φ̇ sin²θ"),
    mistake("I3 * (spin + swing * c)", "I3 * spin", "missing-term", NO_W3),
    mistake("+ mgl * c", "- mgl * c", "sign-flipped", "the potential energy has the wrong sign"),
]
agree = dict.fromkeys(("E", "L_z", "L_3"), ROUNDING)
three = values(invariants, OF_STATE, agree, truth=by_vectors, rows=ROWS, mistakes=wrong)
notebook.exercise("2", "Three conserved quantities", three)


def nutation(y, I1, I3, mgl):
    """Return the smallest and the largest θ in rad of the motion from y (6,), and the period in s of θ."""
    E, L_z, L_3 = invariants(y, I1, I3, mgl)
    nodding = np.polymul([-1, 0, 1], [-mgl, E - L_3**2 / (2 * I3)])
    low, high, far = np.sort(
        np.roots(np.polysub(2 * I1 * nodding, np.polymul([-L_3, L_z], [-L_3, L_z]))).real
    )
    m, rate = (high - low) / (far - low), np.sqrt(mgl * (far - low) / (2 * I1))
    return np.arccos(high), np.arccos(low), 2 * ellipk(m) / rate


wrong = [
    mistake(
        "np.arccos(high), np.arccos(low)",
        "np.arccos(low), np.arccos(high)",
        "component-order",
        "θ falls as cos θ rises",
    ),
    mistake("ellipk(m)", "ellipk(m**0.5)", "wrong-power", NOT_K),
    mistake("2 * ellipk", "4 * ellipk", "constant-factor", "sn² has the period 2K, not 4K"),
    mistake(
        "E - L_3**2 / (2 * I3)", "E", "missing-term", "the energy of the spin, L₃²/2I₃, is not subtracted"
    ),
]
agree = dict.fromkeys(("theta_min", "theta_max", "period"), WITHIN)
exact = {"truth": lambda y, I1, I3, mgl: (*(top := HeavyTop(y, I1, I3, mgl)).turning_points, top.period)}
nodding = values(
    nutation, OF_STATE, agree, **exact, uses=[invariants], rows=ROWS, budget_s=10.0, mistakes=wrong
)
notebook.exercise("3", "Nutation", nodding)


def steady_precession(theta, w3, I1, I3, mgl):
    """Return the slow and the fast rate φ̇ in rad/s of precession without nutation."""
    half = I3 * w3 / 2
    root = np.sqrt(half**2 - I1 * mgl * np.cos(theta))
    return (half - root) / (I1 * np.cos(theta)), (half + root) / (I1 * np.cos(theta))


wrong = [
    mistake("I3 * w3 / 2", "I3 * w3", "constant-factor", "half of I₃ω₃ is squared under the root"),
    mistake("(I1 * np.cos(theta))", "I1", "missing-term", "the rates are not divided by cos θ"),
]
ask = {"theta": uniform(0.3, 1.3), "ratio": lambda rng: 1 + 10 ** rng.uniform(-3, 0.6), **DRAWN}
agree = {"slow": RELATIVE, "fast": RELATIVE}
exact = {
    "truth": lambda theta, ratio, I1, mgl: np.sort(
        np.roots([a := I1 * np.cos(theta), -2 * ratio * (a * mgl) ** 0.5, mgl])
    )
}
least = "steady_precession(theta, ratio * 2 * sqrt(I1 * mgl * cos(theta)) / I3, I1, I3, mgl)"
steady = values(steady_precession, ask, agree, call=least, **exact, mistakes=wrong)


def sleeping_top(w3, I1, I3, mgl):
    """Return the least ω₃ > 0 in rad/s of a stable upright top, and the growth rate in 1/s of a small tilt at
    w3.
    """
    return 2 * np.sqrt(I1 * mgl) / I3, np.sqrt(max(0.0, mgl / I1 - (I3 * w3 / (2 * I1)) ** 2))


def by_eigenvalues(ratio, I1, I3, mgl):
    w3 = 2 * ratio * (I1 * mgl) ** 0.5 / I3
    # of ω₁, ω₂ and the vertical's first two components in body axes, linearized
    k, g = (
        (I1 - I3) / I1 * w3,
        mgl / I1,
    )
    rates = [[0, k, 0, g], [-k, 0, -g, 0], [0, -1, 0, w3], [1, 0, -w3, 0]]
    return (4 * mgl * I1 / I3**2) ** 0.5, max(np.linalg.eigvals(rates).real)


wrong = [
    mistake(
        "2 * np.sqrt(I1 * mgl)", "np.sqrt(I1 * mgl)", "constant-factor", "the limit is ω₃² = 4 I₁ m g ℓ / I₃²"
    ),
    mistake(
        "np.sqrt(max(0.0, mgl / I1 - (I3 * w3 / (2 * I1)) ** 2))",
        "mgl / I1 - (I3 * w3 / (2 * I1)) ** 2",
        "wrong-power",
        "σ²",
    ),
    mistake("(2 * I1)) ** 2", "I1) ** 2", "constant-factor", "L₃/2I₁ is squared, not L₃/I₁"),
]
ask = {"ratio": lambda rng, row: 1 - 10 ** rng.uniform(-3, -0.1) * (-1) ** row, **DRAWN}
agree = {"w3_min": WITHIN, "growth": WITHIN}
least = "sleeping_top(ratio * 2 * sqrt(I1 * mgl) / I3, I1, I3, mgl)"
asleep = values(sleeping_top, ask, agree, call=least, truth=by_eigenvalues, mistakes=wrong)
notebook.exercise("4", "Slow, fast and sleeping tops", steady, asleep)


def matrix_eqs(t, s, I1, I3, mgl):
    """Return ds/dt (12,) of the heavy top's state s: w (3,), then R (3, 3) row by row."""
    w, R, I = s[:3], np.reshape(s[3:], (3, 3), "C"), np.array([I1, I1, I3])
    torque = mgl * np.array([R[2, 1], -R[2, 0], 0])
    turning = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    return np.concatenate([(torque - np.cross(w, I * w)) / I, np.ravel(R @ turning, "C")])


def near_vertical(rng, row):
    y = state(rng, row)
    y[0] = 10 ** rng.uniform(-3, 0) if row % 3 == 0 else y[0]
    return np.append(heavy_top.omega(y), heavy_top.attitude(y[:3, None]))


def exact_state(t, s, I1, I3, mgl):
    top = HeavyTop(heavy_top.euler_state(s[:3], s[3:].reshape(3, 3)), I1, I3, mgl)
    return [*top.omega(t), *top.attitude(t).reshape(-1, 9).T]


wrong = [
    mistake(
        "[R[2, 1], -R[2, 0], 0]", "[-R[2, 1], R[2, 0], 0]", "sign-flipped", "gravity pulls the axis upwards"
    ),
    mistake(
        "[R[2, 1], -R[2, 0], 0]",
        "[R[1, 2], -R[0, 2], 0]",
        "transposed",
        "the vertical in body axes is R's last row",
    ),
    mistake('"C"', '"F"', "transposed", "R is ravelled by columns; the state holds its rows"),
    mistake("R @ turning", "turning @ R", "wrong-operator", "[ω]× acts on body components: R [ω]×"),
    mistake("torque - np", "torque + np", "sign-flipped", "ω × L has the opposite sign"),
]
kept = {"L_z": ("I1*(s[9]*s[0] + s[10]*s[1]) + I3*s[11]*s[2]", MOTION)}
drive = {
    "motion": exact_state,
    "t_end": 2.0,
    "follow": MOTION,
    "conserved": kept,
    "state": "s",
    "scale": (9.0,) * 3 + (1.0,) * 9,
}
by_matrix = ode(
    matrix_eqs, {"t": 0.0, "s": near_vertical, **DRAWN}, ROUNDING, **drive, rows=ROWS, mistakes=wrong
)


TOP = (1.0, 0.6, 10.0)  # as in the notebook's Setup, like SOLVER and start
SOLVER = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-10}


def start(tilt, spin):
    """Return one start as y (6,) and as s (12,), w and the rows of R: θ = tilt, φ = ψ = 0, w = (0, 0.6, spin)
    rad/s.
    """
    c, s = np.cos(tilt), np.sin(tilt)
    return np.array([tilt, 0, 0, 0, 0.6 / s, spin - 0.6 * c / s]), np.array(
        [0, 0.6, spin, 1, 0, 0, 0, c, -s, 0, s, c]
    )


def gimbal_lock(tilt, spin):
    """Return the calls for 2 s from start(tilt, spin) with Euler angles and with the matrix, and the angle θ
    in rad at the end.
    """
    y, s = start(tilt, spin)
    euler = solve_ivp(top_eqs, (0, 2), y, args=TOP, **SOLVER)
    matrix = solve_ivp(matrix_eqs, (0, 2), s, args=TOP, **SOLVER)
    return euler.nfev, matrix.nfev, np.arccos(matrix.y[11, -1])


wrong = [
    mistake("matrix.y[11, -1]", "matrix.y[11, 0]", "wrong-index", "this is the tilt at the start"),
    mistake(
        "euler.nfev, matrix.nfev",
        "matrix.nfev, euler.nfev",
        "component-order",
        "the calls with Euler angles come first",
    ),
]
ask = {"tilt": lambda rng, row: 10 ** -(row % 4 + rng.uniform(0, 1)), "spin": uniform(12, 20)}
agree = {"calls_euler": CALLS, "calls_matrix": CALLS, "tilt_end": TILT}
exact = {
    "truth": lambda tilt, spin: (
        *gimbal_lock(tilt, spin)[:2],
        HeavyTop(start(tilt, spin)[0], *TOP).motion([2.0])[0, 0],
    )
}
lock = values(gimbal_lock, ask, agree, **exact, uses=[top_eqs, matrix_eqs], rows=(4, 4), mistakes=wrong)
notebook.exercise("5", "Gimbal lock", by_matrix, lock)


def wobble_period(w3, I1, I3):
    """Return the period in s in which ω turns about the axis of a free symmetric top, in body axes."""
    return 2 * np.pi * I1 / abs((I3 - I1) * w3)


wrong = [
    mistake("np.pi * I1", "np.pi * I3", "wrong-variable", "the rate is (I₃ − I₁)/I₁ ω₃, not (I₃ − I₁)/I₃ ω₃"),
    mistake("2 * np.pi * I1", "I1", "constant-factor", "the period is 2π over the rate"),
]
ask = {
    "w3": uniform(0.5, 9),
    "I1": uniform(1, 1.8),
    "flat": lambda rng, row: (-1) ** row * 10 ** rng.uniform(-2.5, -0.2),
}
exact = {"truth": lambda w3, I1, flat: Exact((0.1, 0.2, w3), (I1, I1, I1 * (1 + flat))).period}
wobble = values(
    wobble_period, ask, RELATIVE, call="wobble_period(w3, I1, I1 * (1 + flat))", **exact, mistakes=wrong
)


def flip_period(w, I):
    """Return the time in s between two reversals of ω₂ of a free body with I₁ < I₂ < I₃ that starts with w
    (3,).
    """
    first, second, third = I
    L2, twice = np.sum((I * w) ** 2), np.sum(I * w**2)
    if twice * second > L2:
        first, third = third, first
    rate2 = (third - second) * (L2 - twice * first) / (first * second * third)
    m = (second - first) * (twice * third - L2) / (first * second * third * rate2)
    return 2 * ellipk(m) / np.sqrt(rate2)


wrong = [
    mistake("2 * ellipk", "4 * ellipk", "constant-factor", "ω₂ returns after two reversals"),
    mistake(
        "rate2 = (third - second)", "rate2 = (third - first)", "wrong-variable", "I₃ − I₁ stands for I₃ − I₂"
    ),
    mistake("ellipk(m)", "ellipk(m**0.5)", "wrong-power", NOT_K),
]
# a book
ask = {
    "w": uniform(-5, 5, 3),
    "I": lambda rng: (edges2 := rng.uniform((2.6, 1.0, 0.1), (4.8, 1.7, 0.4))).sum() - edges2,
}
flip = values(flip_period, ask, RELATIVE, truth=lambda w, I: Exact(w, I).period / 2, mistakes=wrong)
notebook.exercise("6", "Wobble and flip of free tops", wobble, flip)


def animate_axis(t, axis):
    """Return an animation of the top's axis (n, 3), unit vectors in space, at the times t (n,)."""
    fig = plt.figure()
    ax = fig.add_subplot(
        projection="3d", xlim=(-1, 1), ylim=(-1, 1), zlim=(0, 1), xlabel="x", ylabel="y", zlabel="z"
    )
    (line,) = ax.plot([], [], [], lw=3)

    def update(k):
        line.set_data_3d(*np.array([[0, 0, 0], axis[k]]).T)
        return (line,)

    plt.close(fig)
    return FuncAnimation(fig, update, frames=len(t))


wrong = [
    mistake(
        "[[0, 0, 0], axis[k]]",
        "[[0, 0, 0], axis[k, ::-1]]",
        "mirrored",
        "the components are in reverse order",
    ),
    mistake("axis[k]]).T", "axis[0]]).T", "static", "every frame shows the first sample"),
    mistake(
        "    def update(k):\n",
        "    def update(k):\n        k = k * k // len(t)\n",
        "wrong-frames",
        "the rate is uneven",
    ),
]
SECONDS = np.linspace(0, 1.5, 46)
AXIS = HeavyTop((0.9, 0, 0, 0, 0, 14), 1.0, 0.6, 10.0).attitude(SECONDS)[:, :, 2]
drawn = animation(animate_axis, {"t": SECONDS, "axis": AXIS}, ("axis",), FRAMES, mistakes=wrong)
notebook.exercise("7", "The nutating axis", drawn)
