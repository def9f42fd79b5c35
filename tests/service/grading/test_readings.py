"""Readings of wrong numbers, without a question."""

import numpy as np
import pytest

from service.grading.readings import constant_factor, numbers_at, too_few_digits

T = np.linspace(0.5, 2.0, 9)


def test_a_constant_factor_of_different_values():
    assert constant_factor(2.5 * T, T) == pytest.approx(2.5, rel=1e-12)


@pytest.mark.parametrize(
    ("got", "want"),
    [(T**2, T), (2 * np.ones(9), np.ones(9)), (T, np.zeros(9)), (T * (1 + 1e-7), T)],
    ids=["another function", "one value", "zeros", "nearly one"],
)
def test_no_factor(got, want):
    assert constant_factor(got, want) == 0.0


def test_rounded_values_tell_their_digits_and_exact_ones_do_not():
    assert too_few_digits(np.round(np.sin(T), 4), np.sin(T)) == "is rounded to 4 decimals"
    assert "float32" in too_few_digits(np.sin(T).astype("f4").astype(float), np.sin(T))
    assert too_few_digits(np.sin(T), np.sin(T)) == ""


def test_arguments_that_are_no_numbers_or_too_short_have_none():
    assert numbers_at(np.array(["a"]), None) is None and numbers_at(None, None) is None
    assert numbers_at(np.ones((3, 2)), 2) is None and numbers_at(np.ones((3, 2)), 1).shape == (3,)
