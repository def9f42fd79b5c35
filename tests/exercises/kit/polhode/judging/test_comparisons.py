"""The check words on pass, fail, NaN, wrong shape and broadcasting; details byte for byte as the notebook
prints them.
"""

import numpy as np
import pytest

from polhode.judging import comparisons
from polhode.judging.verdict import Verdict, line

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("text", "made"),
    [
        (
            (
                "✓  principal moments match the analytic box result   [max|Δ| = 3.88578e-16 (rtol=1e-10,"
                " atol=1e-09)]"
            ),
            (
                "principal moments match the analytic box result",
                comparisons.close([0.0, 3.885780586188048e-16], [0.0, 0.0], 1e-10, 1e-9),
            ),
        ),
        (
            "✓  rotational energy conserved (torque-free)   [max relative drift = 1.95399e-13 (limit 1e-06)]",
            (
                "rotational energy conserved (torque-free)",
                comparisons.conserved([1.0, 1.0, 1.0000000000001954], 1e-6),
            ),
        ),
        (
            "✓  free precession rate is (I₃−I₁)/I₁·ω₃   [got 1.8 vs expected 1.8 (rtol=0.001, atol=1e-09)]",
            ("free precession rate is (I₃−I₁)/I₁·ω₃", comparisons.close(1.8, 1.8, 1e-3, 1e-9)),
        ),
        (
            (
                "✓  spin is stable about the extreme axes, unstable about the intermediate axis   "
                "[growth: min 0.038, mid 1.136, max 0.029]"
            ),
            (
                "spin is stable about the extreme axes, unstable about the intermediate axis",
                comparisons.holds(True, "growth: min 0.038, mid 1.136, max 0.029"),
            ),
        ),
        ("✗  label   [got 2 vs expected 1 (rtol=0.1, atol=0)]", ("label", comparisons.close(2, 1, 0.1, 0))),
    ],
)
def test_lines_are_the_notebooks(text, made):
    label, judgement = made
    assert line(judgement.verdict, label, judgement.detail) == text


@pytest.mark.parametrize("bad", [NAN, INF, -INF])
def test_nothing_that_is_not_a_number_passes(bad):
    assert comparisons.close(bad, 1.0, 1.0, 1.0).verdict is Verdict.FAIL
    assert comparisons.close([1.0, bad], [1.0, 1.0], 1.0, 1.0).verdict is Verdict.FAIL
    assert comparisons.conserved([1.0, bad], 1.0).verdict is Verdict.FAIL
    assert comparisons.conserved([bad, 1.0], 1.0).verdict is Verdict.FAIL
    assert comparisons.close(1.0, bad, 1.0, 1.0).verdict is Verdict.FAIL
    assert comparisons.below([0.0, bad], 1.0).verdict is Verdict.FAIL
    assert comparisons.positive([1.0, bad]).verdict is Verdict.FAIL


def test_even_equal_infinities_do_not_agree():
    assert comparisons.close([INF], [INF], 1.0, 1.0).verdict is Verdict.FAIL


@pytest.mark.parametrize("got", [0.0, [0.0], [[0.0, 0.0, 0.0]], [0.0, 0.0], np.zeros((3, 1))])
def test_nothing_is_broadcast(got):
    judgement = comparisons.close(got, [0.0, 0.0, 0.0], 1.0, 1.0)
    assert judgement.verdict is Verdict.FAIL and "shape" in judgement.detail


def test_tolerance_is_atol_plus_rtol_times_expected_and_inclusive():
    assert comparisons.close([110.0], [100.0], 0.0, 10.0).verdict is Verdict.PASS
    assert comparisons.close([110.0], [100.0], 0.1, 0.0).verdict is Verdict.PASS
    assert comparisons.close([110.1], [100.0], 0.05, 5.0).verdict is Verdict.FAIL


def test_worst_value_and_margin_are_relative_to_what_is_allowed_there():
    judgement = comparisons.close([100.5, 0.3], [100.0, 0.0], 0.01, 0.1)
    assert judgement.where == (1,) and judgement.margin == pytest.approx(1 / 3)
    assert comparisons.close([1.0], [1.0], 0.0, 0.0).margin is None
    assert comparisons.close([1e300], [0.0], 0.0, 1e-11).margin == 0.0, (
        "a quotient that overflows is no warning"
    )


def test_within_holds_everywhere_by_the_scale_of_each_place():
    assert comparisons.within([1.0, 102.0], [1.0, 100.0], [1.0, 100.0], 0.02).verdict is Verdict.PASS
    far = comparisons.within([1.0, 103.0], [1.0, 100.0], [1.0, 100.0], 0.02)
    assert far.verdict is Verdict.FAIL and far.where == (1,) and far.margin == pytest.approx(2 / 3)
    for got in ([1.0, NAN], [NAN, NAN], [1.0], [[1.0, 1.0]]):
        assert comparisons.within(got, [1.0, 1.0], 1.0, 1e9).verdict is Verdict.FAIL
    assert comparisons.within([1e-300], [0.0], 0.0, 1e9).verdict is Verdict.FAIL, (
        "without a scale nothing may be off"
    )


def test_conserved():
    assert comparisons.conserved([2.0, 2.0 + 1e-6], 1e-6).verdict is Verdict.PASS
    assert comparisons.conserved([2.0, 2.0 + 4e-6], 1e-6).verdict is Verdict.FAIL
    assert comparisons.conserved([2.0, 2.1, 2.0], 1e-6).verdict is Verdict.FAIL, "all the way"
    assert comparisons.conserved([0.0, 0.0], 1e-6).verdict is Verdict.PASS
    assert comparisons.conserved([0.0, 1e-30], 1e-6).verdict is Verdict.FAIL
    assert comparisons.conserved([1.0], 1e-6).verdict is Verdict.FAIL
    assert comparisons.conserved(np.ones((3, 3)), 1e-6).verdict is Verdict.FAIL


def test_below_positive_and_holds():
    assert comparisons.below([1.0, 2.0], 2.0).verdict is Verdict.PASS
    assert comparisons.below([1.0, 2.1], 2.0).verdict is Verdict.FAIL and comparisons.below(
        [1.0, 2.1], 2.0
    ).where == (1,)
    assert comparisons.positive([1.0, 1e-300]).verdict is Verdict.PASS
    assert comparisons.positive([1.0, 0.0]).verdict is Verdict.FAIL
    assert comparisons.holds(np.bool_(True), "").verdict is Verdict.PASS
    for truthy in (1, "yes", np.array([True]), np.array([True, True])):
        assert comparisons.holds(truthy, "").verdict is Verdict.FAIL


@pytest.mark.parametrize("value", ["1.0", None, [object()]])
def test_only_numbers_are_compared(value):
    with pytest.raises(TypeError, match="real numbers"):
        comparisons.close(value, 1.0, 1.0, 1.0)
