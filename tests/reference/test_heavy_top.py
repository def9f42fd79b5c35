"""The heavy top's closed form against sixty-digit integration by other equations, against its invariants, and
at its limits.
"""

from pathlib import Path

import numpy as np
import pytest

from reference.heavy_top import HeavyTop, attitude, omega
from tests.reference.make_top_truth import ANY_SPIN_OR_SIZE, TOPS, rows

TRUTH = np.load(Path(__file__).parent / "top_truth.npz")
ALL = TOPS | ANY_SPIN_OR_SIZE
TOP = TOPS["nutating"]
VERTICAL = 1e-2  # rad: nearer to it φ and ψ are ill-conditioned, and only R is compared


def deviation(got, want):
    """Return the largest deviation of angles (n, 3) from others, φ and ψ modulo 2π."""
    d = got - want
    d[:, 1:] = (d[:, 1:] + np.pi) % (2 * np.pi) - np.pi
    return np.abs(d).max()


@pytest.mark.parametrize("name", ALL)
def test_against_sixty_digits_over_many_nutations(name):
    (row,) = np.flatnonzero(TRUTH["name"] == name)
    y0, I1, I3, mgl = ALL[name]
    assert np.all(TRUTH["y0"][row] == y0) and (TRUTH["I1"][row], TRUTH["I3"][row], TRUTH["mgl"][row]) == (
        I1,
        I3,
        mgl,
    )
    top, t = HeavyTop(y0, I1, I3, mgl), TRUTH["t"][row]
    assert t[-1] == pytest.approx((100 if name in TOPS else 10) * top.period)
    truth = TRUTH["angles"][row]
    assert np.abs(top.attitude(t) - attitude(truth.T)).max() < 1e-12
    assert np.abs(top.motion(t)[0] - truth[:, 0]).max() < 1e-12
    nearest, farthest = top.turning_points
    if min(nearest, np.pi - farthest) > VERTICAL:
        assert deviation(top.motion(t)[:3].T, truth) < 1e-12


def test_the_stored_digits_are_those_of_the_integration():
    assert deviation(rows(*TOP, TRUTH["t"][0, :2]), TRUTH["angles"][0, :2]) < 1e-15


@pytest.mark.parametrize("name", TOPS)
def test_start_invariants_and_continuity(name):
    y0, I1, I3, mgl = TOPS[name]
    top = HeavyTop(y0, I1, I3, mgl)
    np.testing.assert_allclose(top.motion([0.0])[:, 0], y0, rtol=1e-12, atol=1e-13)
    t = np.linspace(-1, 1, 2001) * 3 * top.period
    y = top.motion(t)
    theta, _, _, nod, swing, spin = y
    w3 = spin + swing * np.cos(theta)
    energy = I1 / 2 * (nod**2 + (swing * np.sin(theta)) ** 2) + I3 / 2 * w3**2 + mgl * np.cos(theta)
    for got, kept in ((energy, top.energy), (I3 * w3, top.L_3)):
        np.testing.assert_allclose(got, kept, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(
        I1 * swing * np.sin(theta) ** 2 + top.L_3 * np.cos(theta), top.L_z, rtol=1e-13, atol=1e-13
    )
    low, high = top.turning_points
    assert low * (1 - 1e-14) <= theta.min() and theta.max() <= high * (1 + 1e-14)
    middle = top.motion((t[1:] + t[:-1]) / 2)[3:]
    step = (y[3:, :-1] + 4 * middle + y[3:, 1:]) / 6 * np.diff(t)  # Simpson's rule
    assert np.abs(np.diff(y[:3]) - step).max() < 0.1  # no jump by π or 2π, also where φ̇ is large


def test_attitude_and_omega_obey_the_kinematic_relation():
    top, t, h = HeavyTop(*TOP), np.linspace(-2, 5, 50), 1e-5
    R, w = top.attitude(t), top.omega(t)
    np.testing.assert_allclose(R, attitude(top.motion(t)[:3]), rtol=0, atol=1e-13)
    np.testing.assert_allclose(w, omega(top.motion(t)), rtol=0, atol=1e-13)
    nothing = np.zeros_like(t)
    skew = np.moveaxis(
        np.array([[nothing, -w[2], w[1]], [w[2], nothing, -w[0]], [-w[1], w[0], nothing]]), 2, 0
    )
    np.testing.assert_allclose(
        (top.attitude(t + h) - top.attitude(t - h)) / (2 * h), R @ skew, rtol=0, atol=1e-6
    )
    momentum = (R @ (np.array([TOP[1], TOP[1], TOP[2]])[:, None] * w).T[:, :, None])[:, 2, 0]
    np.testing.assert_allclose(momentum, top.L_z, rtol=1e-13)


def test_steady_precession_has_no_nutation_and_the_rate_of_the_quadratic_equation():
    theta, w3, I1, I3, mgl = 0.7, 12.0, 1.0, 0.6, 10.0
    for rate in np.roots([I1 * np.cos(theta), -I3 * w3, mgl]):
        top = HeavyTop((theta, 0, 0, 0, rate, w3 - rate * np.cos(theta)), I1, I3, mgl)
        np.testing.assert_allclose(top.turning_points, theta, rtol=1e-13)
        np.testing.assert_allclose(top.motion([0.0, 7.0])[1], [0.0, 7.0 * rate], rtol=1e-13)


@pytest.mark.parametrize("y0", [(0.0, 0, 0, 1, 1, 1), (0.5, 0, 0, 0, 0, np.inf), (0.5, 0, 0)])
def test_a_start_that_is_none_is_refused(y0):
    with pytest.raises(ValueError, match="y0 is"):
        HeavyTop(y0, 1.0, 1.0, 1.0)


def test_no_torque_and_a_motion_through_the_pole_are_refused():
    with pytest.raises(ValueError, match="mgl must be positive"):
        HeavyTop((0.5, 0, 0, 0, 0, 1), 1.0, 1.0, 0.0)
    with pytest.raises(ValueError, match="passes through"):
        HeavyTop((0.5, 0, 0, 0, 0, 0), 1.0, 1.0, 1.0)
