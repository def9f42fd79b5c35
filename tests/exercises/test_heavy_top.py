"""The truths of the heavy top against a second source, and other right ways."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import reference
from exercises.heavy_top import assignment as top
from tests.support.toolbox import failed, judged

QUESTIONS = {question.function: question for question in top.notebook.questions()}
NOTEBOOK = QUESTIONS["gimbal_lock"].solution.names  # those of the Setup and of all solutions
TOP, SOLVER = NOTEBOOK["TOP"], NOTEBOOK["SOLVER"]


def inputs(name):
    """Return four inputs of a question."""
    columns = QUESTIONS[name].draw(np.random.default_rng(0), 4)
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def test_the_equations_are_the_slope_of_the_exact_motion():
    for given in inputs("top_eqs"):
        y, moments = given.pop("y"), given.values()
        h = 1e-3
        moved = reference.HeavyTop(y, *moments).motion(h * np.array([-3, -2, -1, 1, 2, 3]))
        slope = moved @ np.array([-1, 9, -45, 45, -9, 1]) / (60 * h)
        np.testing.assert_allclose(
            NOTEBOOK["top_eqs"](0.0, y, *moments), slope, rtol=0, atol=1e-6 * np.abs(slope).max()
        )


def test_nutation_against_roots_and_integrals_of_sixty_digits():
    with mp.workdps(60):
        for given in inputs("nutation"):
            E, L_z, L_3 = (mp.mpf(float(x)) for x in QUESTIONS["invariants"].truth(**given))
            I1, I3, mgl = (mp.mpf(given[name]) for name in ("I1", "I3", "mgl"))
            free = E - L_3**2 / (2 * I3)
            cubic = [
                2 * I1 * mgl,
                -2 * I1 * free - L_3**2,
                2 * L_z * L_3 - 2 * I1 * mgl,
                2 * I1 * free - L_z**2,
            ]
            low, high, far = sorted(mp.re(root) for root in mp.polyroots(cubic, maxsteps=200))
            time = mp.quad(
                lambda a, gap=high - low, width=far - low: 1 / mp.sqrt(width - gap * mp.sin(a) ** 2),
                [0, mp.pi / 2],
            )
            time *= 2 / mp.sqrt(mgl / (2 * I1))
            wanted = [float(mp.acos(high)), float(mp.acos(low)), float(time)]
            np.testing.assert_allclose(QUESTIONS["nutation"].truth(**given), wanted, rtol=1e-12)


def test_steady_rates_against_the_exact_motion_and_the_limit_against_eigenvalues_beside_it():
    for given in inputs("steady_precession"):
        theta, w3, moments = given["theta"], given["w3"], [given[name] for name in ("I1", "I3", "mgl")]
        rates = QUESTIONS["steady_precession"].truth(theta, given["ratio"], given["I1"], given["mgl"])
        for rate in rates:
            exact = reference.HeavyTop((theta, 0, 0, 0, rate, w3 - rate * np.cos(theta)), *moments)
            np.testing.assert_allclose(exact.turning_points, theta, rtol=1e-10)
    for given in inputs("sleeping_top"):
        limit, _ = QUESTIONS["sleeping_top"].truth(**given)
        (_, above), (_, below) = (
            QUESTIONS["sleeping_top"].truth(**given | {"w3": factor * limit})
            for factor in (1 + 1e-6, 1 - 1e-6)
        )
        assert above < 1e-6 and below > 1e-4


def test_the_start_and_the_top_are_those_of_the_setup():
    y, w, R = top.start(0.1, 14.0)
    for own, published in zip((y, np.append(w, R)), NOTEBOOK["start"](0.1, 14.0), strict=True):
        np.testing.assert_array_equal(own, published)
    right = NOTEBOOK["gimbal_lock"](0.1, 14.0)
    assert QUESTIONS["gimbal_lock"].truth(0.1, 14.0)[:2] == pytest.approx(right[:2], rel=0.1)


def test_the_tilt_at_the_end_against_an_integration():
    _, s = NOTEBOOK["start"](0.01, 14.0)
    run = solve_ivp(NOTEBOOK["matrix_eqs"], (0, 2), s, args=TOP, method="DOP853", rtol=1e-13, atol=1e-15)
    assert abs(np.arccos(run.y[11, -1]) - QUESTIONS["gimbal_lock"].truth(0.01, 14.0)[2]) < 1e-10


def euler_angle_rates(y, I1, I3, mgl):
    """Return dy/dt (6,): Lagrange's equations in Euler angles, singular at θ = 0 and π."""
    theta, _, _, nod, swing, spin = y
    c, s = np.cos(theta), np.sin(theta)
    torque = I3 * (spin + swing * c)
    tilting = (mgl + (I1 * swing * c - torque) * swing) * s / I1
    swinging = (torque - 2 * I1 * swing * c) * nod / (I1 * s)
    return np.array([nod, swing, spin, tilting, swinging, nod * swing * s - swinging * c])


def test_euler_angles_cost_ever_more_calls_near_the_vertical_and_the_matrix_the_same():
    truth = QUESTIONS["gimbal_lock"].truth
    euler, matrix, _ = np.array([truth(tilt, 14.0) for tilt in 10.0 ** -np.arange(5)]).T
    assert euler[-1] > 3 * euler[0] and matrix.max() < 1.2 * matrix.min()
    y = top.start(1e-3, 14.0)[0]
    other = solve_ivp(lambda t, y: euler_angle_rates(y, *TOP), (0, 2), y, **SOLVER)
    assert other.nfev == pytest.approx(euler[3], rel=0.1)


def test_periods_of_free_tops_are_times_between_zeros_of_the_exact_motion():
    for given in inputs("flip_period"):
        motion, period = reference.Exact(given["w"], given["I"]), NOTEBOOK["flip_period"](**given)
        t = np.linspace(0, 2.5 * period, 200)
        (at,) = np.nonzero(np.diff(np.sign(motion.omega(t)[1])))
        zeros = [
            brentq(lambda x, motion=motion: motion.omega([x])[1, 0], t[k], t[k + 1], xtol=1e-14) for k in at
        ]
        np.testing.assert_allclose(np.diff(zeros), period, rtol=1e-11)
    w = reference.Exact((0.1, 0.2, 3.0), (1.5, 1.5, 1.1)).omega(
        [0.0, NOTEBOOK["wobble_period"](3.0, 1.5, 1.1)]
    )
    np.testing.assert_allclose(w[:, 1], w[:, 0], rtol=1e-13)


def gradings(name):
    """Yield the inputs of the public checks of a question, and those of the hidden ones with eight seeds."""
    public, hidden = QUESTIONS[name].rows
    for rows, seeds in ((public, [0]), (hidden, range(1, 9))):
        yield from (QUESTIONS[name].draw(np.random.default_rng(seed), rows) for seed in seeds)


@pytest.mark.parametrize("name", ["top_eqs", "invariants", "nutation"])
def test_every_grading_asks_for_long_swings_hanging_tops_and_spins_of_either_sign_of_slow_and_fast_tops(name):
    for given in gradings(name):
        motions = [
            reference.HeavyTop(*row)
            for row in zip(*(given[name] for name in ("y", "I1", "I3", "mgl")), strict=True)
        ]
        assert max(1 - motion._kc**2 for motion in motions) > 0.85
        assert len({(abs(spin) > 5, spin > 0) for spin in given["y"][:, 5]}) == 4
        assert max(given["y"][:, 0]) > 1.7


def test_every_grading_asks_for_spins_near_the_limits_and_nearly_round_bodies():
    for given in gradings("sleeping_top"):
        ratios = given["w3"] * given["I3"] / 2 / np.sqrt(given["I1"] * given["mgl"])
        assert any(0.9 < ratio < 1 for ratio in ratios) and max(ratios) > 1
    for given in gradings("steady_precession"):
        assert min(given["ratio"]) < 1.05
    for given in gradings("wobble_period"):
        flat = given["I3"] / given["I1"] - 1
        assert min(abs(flat)) < 0.02 and min(flat) < 0 < max(flat)
    for given in gradings("gimbal_lock"):
        assert min(given["tilt"]) < 0.001 < 0.1 < max(given["tilt"])


def masses(t, y, I1, I3, mgl):
    """The mass matrix of the Lagrangian, solved; parts by products."""
    (s, c), (a, b, d) = (np.sin(y[0]), np.cos(y[0])), y[3:]
    spin = I3 * (d + b * c)
    M = [[I1, 0, 0], [0, I1 * s * s + I3 * c * c, I3 * c], [0, I3 * c, I3]]
    forces = [
        I1 * b * b * s * c - spin * b * s + mgl * s,
        -2 * I1 * a * b * s * c + spin * a * s + I3 * a * b * s * c,
        I3 * a * b * s,
    ]
    return [*y[3:], *np.linalg.solve(M, forces)]


def by_bisection(y, I1, I3, mgl):
    """Roots of the cubic between samples, and the period as an integral."""
    E, L_z, L_3 = NOTEBOOK["invariants"](y, I1, I3, mgl)

    def f(u):
        return (1 - u * u) * 2 * I1 * (E - L_3**2 / 2 / I3 - mgl * u) - (L_z - L_3 * u) ** 2

    now = np.cos(y[0])
    low, high = brentq(f, -1, now, xtol=1e-15), brentq(f, now, 1, xtol=1e-15)

    def slow(a):
        middle, half = (low + high) / 2, (high - low) / 2
        u = middle + half * np.sin(a)
        return half * np.cos(a) * I1 / np.sqrt(f(u)) if abs(np.cos(a)) > 1e-9 else 0.0

    a = (
        np.arange(400) + 0.5
    ) / 400 * np.pi - np.pi / 2  # the midpoint rule, exact to rounding for a periodic function
    return [np.arccos(high), np.arccos(low), 2 * np.mean([slow(x) for x in a]) * np.pi]


def by_quadratic(theta, w3, I1, I3, mgl):
    return np.sort(np.roots([I1 * np.cos(theta), -I3 * w3, mgl]))


def by_branches(w3, I1, I3, mgl):
    limit = (4 * I1 * mgl / I3**2) ** 0.5
    return (limit, 0) if w3 >= limit else (limit, I3 / (2 * I1) * np.sqrt(limit**2 - w3**2))


def by_inertia(t, s, I1, I3, mgl):
    w, R = np.array(s[:3]), np.array(s[3:]).reshape((3, 3))
    inertia = np.diag([I1, I1, I3])
    torque = np.cross([0, 0, 1], R.T @ [0, 0, -mgl])
    return [*np.linalg.solve(inertia, torque - np.cross(w, inertia @ w)), *np.cross(R, w).ravel()]


def by_steps(tilt, spin):
    """Count the calls of other equations, with output at many times; return a list."""
    y, s = NOTEBOOK["start"](tilt, spin)
    moved, t = solve_ivp(masses, (0, 2), y, args=TOP, **SOLVER, t_eval=np.linspace(0, 2, 400)), []
    run = solve_ivp(lambda at, s: t.append(at) or by_inertia(at, s, *TOP), (0, 2), s, **SOLVER)
    return [moved.nfev, len(t), np.arctan2(np.hypot(*run.y[[5, 8], -1]), run.y[11, -1])]


def by_rate(w3, I1, I3):
    return abs(2 * np.pi / ((I3 / I1 - 1) * w3))


def by_integration(w, I):
    def rates(t, w):
        return [
            (I[1] - I[2]) * w[1] * w[2] / I[0],
            (I[2] - I[0]) * w[2] * w[0] / I[1],
            (I[0] - I[1]) * w[0] * w[1] / I[2],
        ]

    def reversal(t, w):
        return w[1]

    run = solve_ivp(rates, (0, 30), w, method="DOP853", rtol=1e-12, atol=1e-14, events=reversal)
    return run.t_events[0][1] - run.t_events[0][0]


OTHER_WAYS = {
    "top_eqs": masses,
    "invariants": lambda y, I1, I3, mgl: list(QUESTIONS["invariants"].truth(y, I1, I3, mgl)),
    "nutation": by_bisection,
    "steady_precession": by_quadratic,
    "sleeping_top": by_branches,
    "matrix_eqs": by_inertia,
    "gimbal_lock": by_steps,
    "wobble_period": by_rate,
    "flip_period": by_integration,
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n == "flip_period" else n for n in OTHER_WAYS]
)
def test_other_right_ways_pass(name):
    outcomes = judged(QUESTIONS[name], OTHER_WAYS[name])
    assert failed(outcomes) == set(), [outcome.line for outcome in outcomes.values()]


FAKES = {
    "top_eqs": lambda t, y, I1, I3, mgl: [*y[3:], 0, 0, 0],
    "invariants": lambda y, I1, I3, mgl: (0.0, 0.0, 0.0),
    "nutation": lambda y, I1, I3, mgl: (y[0], y[0], 1.0),
    "sleeping_top": lambda w3, I1, I3, mgl: (2 * np.sqrt(I1 * mgl) / I3, 0.0),
    "matrix_eqs": lambda t, s, I1, I3, mgl: np.zeros(12),
    "gimbal_lock": lambda tilt, spin: (590, 590, tilt),
}


@pytest.mark.parametrize("name", FAKES)
def test_fakes_that_conserve_everything_fail(name):
    assert len(failed(judged(QUESTIONS[name], FAKES[name]))) >= 2
