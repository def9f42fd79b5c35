"""Every entry of the atlas is a test: its numbers, measured here and now, bear its claim out."""

import numpy as np
import pytest

from reference import Exact
from reference.stability_atlas import ATLAS, BOOK, separatrix
from tests.reference.make_truth import truth

SEPARATRIX = next(e for e in ATLAS if e.measure is separatrix)


@pytest.mark.slow
@pytest.mark.parametrize("entry", ATLAS, ids=lambda e: e.name)
def test_entry(entry):
    rows = entry.measure()
    assert entry.holds(rows), rows


@pytest.fixture(scope="module")
def outermost():
    """Rows of the greatest and the least nudge, of which the entry's claim is."""
    return separatrix((1e-2, 1e-8))


@pytest.mark.slow
def test_the_wrong_side_of_the_separatrix_by_the_outermost_nudges(outermost):
    assert SEPARATRIX.holds(outermost), outermost


@pytest.mark.slow
def test_where_dop853_errs_by_more_than_one_the_exact_solution_errs_by_rounding(outermost):
    """The nudge of 1e-8, against sixty digits by other formulas."""
    worst = {r["setting"]: r["error"] for r in outermost if r["method"] == "DOP853" and r["nudge"] == 1e-8}
    assert worst[1e-13] > 1
    w0 = np.array([6e-8, 6.0, 0.7 * 6e-8])
    t, w, R = truth(np.array(BOOK), w0, np.linspace(0.1, 2.1, 9))
    sampled = Exact(w0, BOOK).sample(t, orientation=True)
    assert sampled.R is not None
    assert np.abs(sampled.w.T - w).max() <= 3e-15 * 6 and np.abs(sampled.R - R).max() <= 3e-15
