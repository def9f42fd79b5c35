"""The validation words of our own course package, with the meaning that the course gives them."""

import doctest
import importlib
import sys

import numpy as np
import pytest

from tests.support.checkout import ROOT


@pytest.fixture
def validate(monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(ROOT / "exercises/rigid_body/course")])
    yield importlib.import_module("ecp.validate")
    for name in [name for name in sys.modules if name.partition(".")[0] == "ecp"]:
        del sys.modules[name]


def test_each_word_prints_one_line_and_returns_a_bool(validate, capsys):
    assert validate.close(1.0, 1.0, "a") is True
    assert validate.conserved([1.0, 2.0], "b", strict=False) is False
    assert validate.conserved([1.0, 1.1], "b", rel_drift=0.2) is True
    assert validate.conserved([0.0, 1e-5], "zero") is True
    assert validate.below(3.0, 4.0, "c") is True
    assert validate.below(3.0, 4.0, "c", "the error") is True
    assert validate.positive(-1.0, "d", strict=False) is False
    assert validate.check(5, "e") is True
    assert validate.check(np.array([1.0]) > 2, "e", f"growth: {1 / 3:.3f}", strict=False) is False
    assert validate.close([1.0, 2.0], 1.0, "f", rtol=0, atol=0.5, strict=False) is False
    assert validate.close(np.ones((3, 1)), np.ones(1), "g") is True
    assert validate.close(float("inf"), float("inf"), "h") is True
    assert validate.close(1 + 1j, 1 + 1j, "i") is True
    assert capsys.readouterr().out.split("\n") == [
        "✓  a   [got 1 vs expected 1 (rtol=1e-06, atol=1e-09)]",
        "✗  b   [max relative drift = 1 (limit 0.0001)]",
        "✓  b   [max relative drift = 0.1 (limit 0.2)]",
        "✓  zero   [max relative drift = 1e-05 (limit 0.0001)]",
        "✓  c   [3 < 4]",
        "✓  c   [the error [3 < 4]]",
        "✗  d   [value = -1]",
        "✓  e",
        "✗  e   [growth: 0.333]",
        "✗  f   [max|Δ| = 1 (rtol=0, atol=0.5)]",
        "✓  g   [max|Δ| = 0 (rtol=1e-06, atol=1e-09)]",
        "✓  h   [got inf vs expected inf (rtol=1e-06, atol=1e-09)]",
        "✓  i   [got (1+1j) vs expected (1+1j) (rtol=1e-06, atol=1e-09)]",
        "",
    ]


def test_a_strict_cross_raises_after_its_line(validate, capsys):
    with pytest.raises(AssertionError, match="a: got 1 vs expected 2"):
        validate.close(1.0, 2.0, "a")
    with pytest.raises(AssertionError, match="b"):
        validate.check(False, "b")
    assert capsys.readouterr().out.endswith("✗  b\n")


@pytest.mark.parametrize("value", [None, "one", [1.0, 2.0, 3.0], []])
def test_what_numpy_cannot_compare_raises(validate, value):
    with pytest.raises((TypeError, ValueError)):
        validate.close(value, [1.0, 2.0], "a")


def test_the_examples_are_what_it_prints(validate):
    results = doctest.testmod(validate)
    assert results.attempted >= 10 and results.failed == 0
