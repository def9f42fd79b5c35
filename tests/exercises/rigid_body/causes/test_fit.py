"""A sum of terms is found with its weights, from points of ordinary size, and only if every point confirms
it.
"""

import numpy as np
import pytest

from exercises.rigid_body.causes.fit import LEAST_POINTS, sums


@pytest.fixture
def x():
    return np.random.default_rng(3).uniform(1.0, 2.0, 20)


def test_weights_are_plain_numbers_and_zero_where_a_term_is_absent(x):
    terms = {"powers": np.column_stack([x, x**2, x**3]), "roots": np.column_stack([x**0.5, x**0.25, x])}
    columns = np.column_stack([2 * x - 0.1 * x**3, x, np.sin(x)])
    assert sums(terms, columns, np.ones(20)) == [
        [("powers", [2.0, 0.0, -0.1])],
        [("powers", [1.0, 0.0, 0.0]), ("roots", [0.0, 0.0, 1.0])],
        [],
    ]


def test_a_point_that_is_not_fitted_must_confirm_the_sum(x):
    size = np.where(np.arange(20) == 7, np.inf, 1.0)
    terms, column = {"x": x[:, None]}, 3 * x
    assert sums(terms, column[:, None], size) == [[("x", [3.0])]]
    column[7] += 1e-6
    assert sums(terms, column[:, None], size) == [[]]
    assert sums(terms, column[:, None], size, slack=1e-5) == [[("x", [3.0])]]


def test_too_few_points_are_not_conclusive(x):
    size = np.where(np.arange(20) < LEAST_POINTS - 1, 1.0, np.inf)
    assert sums({"x": x[:, None]}, 3 * x[:, None], size) == [[]]
