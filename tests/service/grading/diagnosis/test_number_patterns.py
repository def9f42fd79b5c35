"""Readings of wrong numbers, without a question."""

import numpy as np
import pytest

from service.grading.diagnosis.number_patterns import (
    constant_factor,
    extra_term,
    factor_in_words,
    in_general,
    numbers_at,
    too_few_digits,
    unrepeatable,
)

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


def test_a_factor_is_said_in_words():
    assert factor_in_words(-1.0, "x", whole=True) == ("sign-reversed", "x has the opposite sign")
    assert factor_in_words(-1.0, "x", whole=False)[0] == "sign-flipped"
    assert factor_in_words(57.3, "x", whole=True)[0] == factor_in_words(3282.8, "x", whole=True)[0] == "units"
    code, sentence = factor_in_words(1 + 1e-9, "x", whole=True)
    assert code == "constant-factor" and "1.000000001 times" in sentence


def test_an_extra_term_is_found_with_any_coefficient_and_sign():
    rng = np.random.default_rng(1)
    want, term, unit = rng.normal(size=20), rng.normal(size=20), np.ones(20)
    assert extra_term(want - 0.013 * term, want, term, unit) == ("extra-term",)
    assert extra_term(-want + 7.0 * term, want, term, unit) == ("extra-term", "sign-flipped")
    assert extra_term(want + rng.normal(size=20), want, term, unit) == ()
    assert extra_term(want, want, term, unit) == () == extra_term(want * np.nan, want, term, unit)


QUESTION = {
    "kind": "ode",
    "function": "f",
    "time": "t",
    "drawn": ["t", "y"],
    "returns": [{"name": "v", "scaled": True, "tolerance": {"limit": 1e-13, "reason": "of a test"}}],
}


def answers(function, t, y):
    v = np.array([function(*row) for row in zip(t, y, strict=True)])
    return {"v": v, "at_t": np.array(t), "at_y": np.array(y)}


def test_what_repeated_inputs_show():
    t, y = [0.0, 0.0, 1.0], [[1.0, 2.0]] * 3
    rng, truth = np.random.default_rng(1), answers(lambda t, y: np.array(y), t, y)

    def codes(function):
        return [one.code for one in unrepeatable(QUESTION, answers(function, t, y), truth)]

    assert codes(lambda t, y: np.array(y) + rng.normal()) == ["not-deterministic"]
    assert codes(lambda t, y: np.array(y) + t) == ["time-dependent"]
    assert codes(lambda t, y: 2 * np.array(y)) == []


def test_what_unexplained_values_have_in_common():
    y = np.random.default_rng(2).normal(size=(20, 2))
    truth = {"v": y, "v_scale": np.ones_like(y)}

    def codes(v):
        return [one.code for one in in_general(QUESTION, {"v": v}, truth)]

    assert codes(y * (1 + 1e-6 * np.cos(y))) == ["nearly-right"]
    assert codes(np.where(y[:, :1] > 0, y, 5.0)) == ["partly-right"]
    assert codes(np.where(y[:, :1] > 0, y, np.nan)) == ["not-finite"]
    assert codes(y**2 + 3) == []
