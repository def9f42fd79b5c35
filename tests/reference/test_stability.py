import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference import (
    Exact,
    box_moments,
    euler_rhs,
    free_precession_rate,
    motion,
    sensitivity,
    steady_spin_growth_rate,
)

BOOK = box_moments(1, 2, 1.4, 0.4)


def test_only_the_intermediate_axis_is_unstable():
    assert steady_spin_growth_rate(BOOK, 0, 6.0) == 0.0
    assert steady_spin_growth_rate(BOOK, 2, 6.0) == 0.0
    assert steady_spin_growth_rate(BOOK, 1, 6.0) > 0


def test_growth_rate_is_the_one_a_motion_shows():
    """While it is small, a nudge on the growing direction grows as exp(σt)."""
    i1, i2, i3 = BOOK
    sigma = steady_spin_growth_rate(BOOK, 1, 6.0)
    growing = np.array([1.0, 0.0, 6.0 * (i1 - i2) / (i3 * sigma)]) * 1e-6
    t = np.linspace(0, 1, 11)
    w = motion(growing + [0, 6.0, 0], BOOK, t).w
    np.testing.assert_allclose(np.log(w[0] / w[0, 0]), sigma * t, atol=1e-4)


def test_free_precession_of_the_notebook():
    assert free_precession_rate((1, 1, 1.6), 3.0) == pytest.approx(1.8, rel=1e-15)
    with pytest.raises(ValueError, match="I₁ = I₂"):
        free_precession_rate((1, 1.1, 1.6), 3.0)


SCENES = [
    ((1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 20.0),
    ((0.4, 0.0, 3.0), (1.0, 1.0, 1.6), 8.0),
    ((6.0, 0.12, 0.12), BOOK, 2.5),
    ((0.12, 6.0, 0.12), BOOK, 2.5),
    ((1e-4, 6.0, 0.7e-4), BOOK, 3.0),
]


@pytest.mark.parametrize(("w0", "I", "t_end"), SCENES)
def test_sensitivity_bounds_what_a_slip_does_and_not_by_far(w0, I, t_end):
    """Right-hand sides off by ε in one coefficient, integrated: the bound holds and the worst of them comes
    near it.
    """
    epsilon, t = 1e-7, np.linspace(0, t_end, 200)
    exact = motion(w0, I, t).w
    worst = 0.0
    for k in range(3):
        slip = np.ones(3)
        slip[k] += epsilon

        def rhs(_, w, slip=slip):
            return slip * euler_rhs(w, I)

        run = solve_ivp(rhs, (0, t_end), w0, method="DOP853", t_eval=t, rtol=1e-13, atol=1e-15)
        worst = max(worst, np.abs(run.y - exact).max() / epsilon / np.linalg.norm(w0))
    bound = sensitivity(w0, I, t_end)
    assert worst <= 1.05 * bound and bound <= 25 * worst


def test_sensitivity_over_one_period_grows_as_the_separatrix_nears():
    spins = [(6.0, 0.12, 0.12), (1e-2, 6.0, 0.7e-2), (1e-4, 6.0, 0.7e-4)]
    quiet, near, nearer = (sensitivity(w0, BOOK, Exact(w0, BOOK).period) for w0 in spins)
    assert quiet < 5 and near > 10 * quiet and nearer > 10 * near


@pytest.mark.parametrize("nudge", [1e-7, 1e-8, 1e-12])
def test_sensitivity_so_near_the_separatrix_that_double_precision_loses_the_motion(nudge):
    w0 = (6 * nudge, 6.0, 0.7 * 6 * nudge)
    kappa = sensitivity(w0, BOOK, 2.1 * Exact(w0, BOOK).period)
    assert np.isfinite(kappa) and kappa * 2.0**-53 > 1
