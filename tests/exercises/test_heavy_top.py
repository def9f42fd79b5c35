"""The truths of the heavy top against a second source, and the notebook's Setup against the names that the truths use."""

import json

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import reference
from exercises.heavy_top import assignment as top
from tests.support.checkout import ROOT


def drawn(**ask):
    """Return one draw of each argument from each of four seeds."""
    generators = [np.random.default_rng(seed) for seed in range(4)]
    return [{name: draw(rng) for name, draw in ask.items()} for rng in generators]


def test_the_equations_are_the_slope_of_the_exact_motion():
    for given in drawn(**top.OF_STATE):
        y, moments = given.pop("y"), given.values()
        h = 1e-3
        moved = reference.HeavyTop(y, *moments).motion(h * np.array([-3, -2, -1, 1, 2, 3]))
        slope = moved @ np.array([-1, 9, -45, 45, -9, 1]) / (60 * h)
        np.testing.assert_allclose(top.top_eqs(0.0, y, *moments), slope, rtol=0, atol=1e-6 * np.abs(slope).max())


def test_nutation_against_roots_and_integrals_of_sixty_digits():
    with mp.workdps(60):
        for given in drawn(**top.OF_STATE):
            E, L_z, L_3 = (mp.mpf(float(x)) for x in top.by_vectors(**given))
            I1, I3, mgl = (mp.mpf(given[name]) for name in ("I1", "I3", "mgl"))
            free = E - L_3**2 / (2 * I3)
            cubic = [2 * I1 * mgl, -2 * I1 * free - L_3**2, 2 * L_z * L_3 - 2 * I1 * mgl, 2 * I1 * free - L_z**2]
            low, high, far = sorted(mp.re(root) for root in mp.polyroots(cubic, maxsteps=200))
            time = mp.quad(lambda a, gap=high - low, width=far - low: 1 / mp.sqrt(width - gap * mp.sin(a) ** 2), [0, mp.pi / 2])
            time *= 2 / mp.sqrt(mgl / (2 * I1))
            wanted = [float(mp.acos(high)), float(mp.acos(low)), float(time)]
            np.testing.assert_allclose(top.by_theory(**given), wanted, rtol=1e-12)


def test_steady_rates_against_the_exact_motion_and_the_limit_against_eigenvalues_beside_it():
    for given in drawn(theta=lambda rng: rng.uniform(0.3, 1.3), w3=lambda rng: rng.uniform(20, 40), **top.DRAWN):
        rates, theta, w3 = top.by_search(**given), given.pop("theta"), given.pop("w3")
        for rate in rates:
            exact = reference.HeavyTop((theta, 0, 0, 0, rate, w3 - rate * np.cos(theta)), *given.values())
            np.testing.assert_allclose(exact.turning_points, theta, rtol=1e-10)
        limit, _ = top.by_eigenvalues(w3, **given)
        (_, above), (_, below) = (top.by_eigenvalues(limit * factor, **given) for factor in (1 + 1e-6, 1 - 1e-6))
        assert above < 1e-6 and below > 1e-4


@pytest.mark.parametrize("tilt", [1.0, 0.01])
def test_the_tilt_at_the_end_against_an_integration(tilt):
    y, s = top.start(tilt)
    run = solve_ivp(top.matrix_eqs, (0, 2), s, args=top.TOP, method="DOP853", rtol=1e-13, atol=1e-15)
    (end,) = reference.HeavyTop(y, *top.TOP).motion([2.0])[0]
    assert abs(np.arccos(run.y[11, -1]) - end) < 1e-10


def test_periods_of_free_tops_are_times_between_zeros_of_the_exact_motion():
    for given in drawn(w=top.tumbling, I=top.book):
        motion, period = reference.Exact(given["w"], given["I"]), top.flip_period(**given)
        t = np.linspace(0, 2.5 * period, 200)
        (at,) = np.nonzero(np.diff(np.sign(motion.omega(t)[1])))
        zeros = [brentq(lambda x, motion=motion: motion.omega([x])[1, 0], t[k], t[k + 1], xtol=1e-14) for k in at]
        np.testing.assert_allclose(np.diff(zeros), period, rtol=1e-11)
    w = reference.Exact((0.1, 0.2, 3.0), (1.5, 1.5, 1.1)).omega([0.0, top.wobble_period(3.0, 1.5, 1.1)])
    np.testing.assert_allclose(w[:, 1], w[:, 0], rtol=1e-13)


def test_the_setup_of_the_notebook_defines_what_the_truths_use():
    cells = json.loads((ROOT / "exercises/heavy_top/notebook.ipynb").read_text())["cells"]
    (setup,) = ("".join(cell["source"]) for cell in cells if "def start(" in "".join(cell["source"]))
    names: dict = {}
    exec(setup, names)
    assert names["TOP"] == top.TOP and names["SOLVER"] == top.SOLVER
    np.testing.assert_array_equal(names["TILTS"], top.TILTS)
    for own, published in zip(top.start(0.1), names["start"](0.1), strict=True):
        np.testing.assert_array_equal(own, published)
