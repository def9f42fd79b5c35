import numpy as np
import pytest

from reference import box_moments, free_precession_rate, motion, steady_spin_growth_rate

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
