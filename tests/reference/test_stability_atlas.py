"""Every entry of the atlas is a test: its numbers, measured here and now, bear its claim out."""

import pytest

from reference import Exact
from reference.stability_atlas import ATLAS, BOOK, separatrix
from tests.reference.make_truth import truth


@pytest.mark.parametrize("entry", ATLAS, ids=[e.name for e in ATLAS])
def test_entry(entry):
    rows = entry.measure()
    assert entry.holds(rows), rows


def test_where_dop853_errs_by_more_than_one_the_exact_solution_errs_by_rounding():
    """The nudge of 1e-8, against sixty digits by other formulas."""
    import numpy as np

    worst = {r["setting"]: r["error"] for r in separatrix((1e-8,)) if r["method"] == "DOP853"}
    assert worst[1e-13] > 1
    w0 = np.array([6e-8, 6.0, 0.7 * 6e-8])
    t, w, R = truth(np.array(BOOK), w0, np.linspace(0.1, 2.1, 9))
    sampled = Exact(w0, BOOK).sample(t, orientation=True)
    assert sampled.R is not None
    assert np.abs(sampled.w.T - w).max() <= 3e-15 * 6 and np.abs(sampled.R - R).max() <= 3e-15
