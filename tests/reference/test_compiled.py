"""The compiled twin against the truth and against reference.Exact, in every regime."""

import numpy as np
import pytest

from reference import Exact
from reference.compiled import compiled_motion
from tests.reference.test_exact import BOOK, FAMILIES, OCTANTS, TRUTH

pytestmark = pytest.mark.slow  # numba compiles for ten seconds; no grading uses the compiled motion


@pytest.mark.parametrize("family", range(6), ids=FAMILIES)
def test_against_sixty_digits(family):
    for i in np.random.default_rng().choice(np.flatnonzero(TRUTH["family"] == family), 100, replace=False):
        w, R = compiled_motion(TRUTH["w0"][i], TRUTH["I"][i], TRUTH["t"][i])
        assert R is not None
        assert (
            np.abs(w.T - TRUTH["w"][i]).max() <= 2e-15 * np.linalg.norm(TRUTH["w0"][i])
            and np.abs(R - TRUTH["R"][i]).max() <= 3e-15
        )


@pytest.mark.parametrize("signs", OCTANTS.tolist())
@pytest.mark.parametrize(
    ("w0", "I"),
    [
        ((1, 0.6, 0.8), (2, 3, 4)),
        ((0.2, 0.3, 1.1), (4, 2, 3)),
        ((0.2, 0.3, 3), (1, 1, 1.6)),
        ((0.2, 0.3, 3), (1.6, 1, 1)),
        ((2, 1, 1), (3, 4, 6)),
        ((0, 2, 0), (2, 3, 4)),
        ((1, 2, 3), (2, 2, 2)),
        ((0, 0, 0), (2, 3, 4)),
        ((1e-9, 6, 1e-9), BOOK),
    ],
)
def test_same_as_exact(w0, I, signs):
    spin, t = np.array(w0) * signs, np.linspace(-7, 30, 77)
    exact = Exact(spin, I).sample(t, orientation=True)
    w, R = compiled_motion(spin, I, t)
    assert R is not None and exact.R is not None
    assert (
        np.abs(w - exact.w).max() <= 4e-15 * max(1, np.abs(spin).max()) and np.abs(R - exact.R).max() <= 5e-15
    )
    alone, none = compiled_motion(spin, I, t, orientation=False)
    assert none is None and (alone == w).all()


def test_same_errors():
    for w0, I in (((1, 2), (2, 3, 4)), ((1, 2, np.nan), (2, 3, 4)), ((1, 2, 3), (1, 1, 3))):
        with pytest.raises(ValueError, match=r"w0|triangle"):
            compiled_motion(w0, I, [0.0])
