"""Every claim of the page, from numbers measured here and now; and that a claim fails when its numbers do."""

from itertools import chain

import numpy as np
import pytest

from reference import Exact
from reference.charts.failures import PICTURES, unfailing
from reference.charts.scenes import BOOK
from tests.reference.make_truth import truth


@pytest.mark.slow
@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.title)
def test_fresh_numbers_support_the_claims(picture):
    curves = {curve.name: curve for curve in picture.measure()}
    claims = [*picture.claims(curves)]
    assert claims and all(claim.holds for claim in claims), claims
    assert len(curves) <= 7


@pytest.mark.parametrize("title", ["Near the vertical", "A matrix that is no rotation"])
def test_numbers_that_are_alike_support_no_claim(title):
    """Every method as good as every other: then none of them fails."""
    (picture,) = (one for one in PICTURES if one.title == title)
    alike = {
        curve.name: curve._replace(x=[1e-9] * len(curve.x), y=[1e-9] * len(curve.y))
        for curve in picture.measure()
    }
    assert not any(claim.holds for claim in picture.claims(alike))


@pytest.mark.slow
def test_what_does_not_fail():
    claims = [*unfailing()]
    assert len(claims) == 3 and all(claim.holds for claim in claims), claims


@pytest.mark.slow
def test_where_steppers_err_by_more_than_one_the_closed_form_errs_by_rounding():
    """The least nudge of the picture, against sixty digits by other formulas."""
    (picture,) = (one for one in PICTURES if one.title == "Near the separatrix")
    _, *steppers = picture.measure()
    nudge = min(chain.from_iterable(curve.x for curve in steppers))
    assert all(curve.y[curve.x.index(nudge)] > 1 for curve in steppers)
    w0 = np.array([6 * nudge, 6.0, 0.7 * 6 * nudge])
    t, w, R = truth(np.array(BOOK), w0, np.linspace(0.1, 2.1, 9))
    sampled = Exact(w0, BOOK).sample(t, orientation=True)
    assert np.abs(sampled.w.T - w).max() <= 3e-15 * 6 and np.abs(sampled.R - R).max() <= 3e-15
