"""Claims are judged by the meaning that the course's package gives its words."""

import numpy as np
import pytest

from polhode.judging.claims import Claim, one_line
from polhode.judging.verdict import Verdict

INF, NAN = float("inf"), float("nan")


def close(got, expected, rtol=1e-6, atol=1e-9, **more):
    arrays = {"got": np.asarray(got), "expected": np.asarray(expected)}
    return Claim("close", "a", arrays, {"rtol": rtol, "atol": atol}, **more).judged()


@pytest.mark.parametrize(
    ("got", "expected"),
    [
        (1.0, 1.0),
        (np.ones((3, 1)), np.ones(1)),
        (np.ones((3, 1)), np.ones(2)),
        (INF, INF),
        ([INF, 1.0], [INF, 1.0]),
        ([1 + 1j, 2], [1 + 1j, 2]),
        (0.0, 1e-10),
        ([], []),
    ],
)
def test_what_numpy_finds_close_is_close(got, expected):
    assert close(got, expected).verdict is Verdict.PASS
    assert np.allclose(got, expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("got", "expected", "detail"),
    [
        (1.0, 2.0, "got 1 vs expected 2 (rtol=1e-06, atol=1e-09)"),
        (INF, -INF, "got inf vs expected -inf (rtol=1e-06, atol=1e-09)"),
        (NAN, NAN, "got nan vs expected nan (rtol=1e-06, atol=1e-09)"),
        ([1.0], [1.5], "got 1 vs expected 1.5 (rtol=1e-06, atol=1e-09)"),
        ([1.0, 2.0], 1.0, "max|Δ| = 1 (rtol=1e-06, atol=1e-09)"),
        (1j, 1.0, "max|Δ| = 1.41421 (rtol=1e-06, atol=1e-09)"),
        ([1.0, 2.0], [1.0, 2.0, 3.0], "shape (2,) vs expected shape (3,) (rtol=1e-06, atol=1e-09)"),
        ([], 1.0, "shape (0,) vs expected shape () (rtol=1e-06, atol=1e-09)"),
    ],
)
def test_what_is_not_close_says_how_far_it_is(got, expected, detail):
    found = close(got, expected)
    assert (found.verdict, found.detail) == (Verdict.FAIL, detail)


@pytest.mark.parametrize(
    ("kind", "arrays", "numbers", "verdict", "detail"),
    [
        ("conserved", {"series": [2.0, 2.1]}, {"rel_drift": 0.1}, "pass", "drift = 0.05 (limit 0.1)"),
        ("conserved", {"series": [2.0, 2.5]}, {"rel_drift": 0.1}, "fail", "drift = 0.25 (limit 0.1)"),
        ("conserved", {"series": [0.0, 0.05]}, {"rel_drift": 0.1}, "pass", "drift = 0.05 (limit 0.1)"),
        ("conserved", {"series": [0.0, 0.0]}, {"rel_drift": 0.0}, "fail", "drift = 0 (limit 0)"),
        ("conserved", {"series": [2.0]}, {"rel_drift": 0.1}, "pass", "drift = 0 (limit 0.1)"),
        ("conserved", {"series": []}, {"rel_drift": 0.1}, "fail", "drift = nan (limit 0.1)"),
        ("conserved", {"series": [1.0, NAN]}, {"rel_drift": 0.1}, "fail", "drift = nan (limit 0.1)"),
        ("conserved", {"series": [[2.0], [2.1]]}, {"rel_drift": 0.1}, "pass", "drift = 0.05 (limit 0.1)"),
        ("positive", {"value": [2.0, INF]}, {}, "pass", "value = 2"),
        ("positive", {"value": [2.0, 0.0]}, {}, "fail", "value = 0"),
        ("positive", {"value": NAN}, {}, "fail", "value = nan"),
        ("below", {"value": 0.1}, {"limit": 0.2}, "pass", "0.1 < 0.2"),
        ("below", {"value": 0.2}, {"limit": 0.2}, "fail", "0.2 < 0.2"),
        ("check", {"passed": 1.0}, {}, "pass", ""),
        ("check", {"passed": 0.0}, {}, "fail", ""),
        ("converges", {"passed": 1.0}, {}, "pass", ""),
    ],
)
def test_the_other_words(kind, arrays, numbers, verdict, detail):
    found = Claim(kind, "a", {name: np.array(value) for name, value in arrays.items()}, numbers).judged()
    assert found.verdict == verdict and found.detail.removeprefix("max relative ") == detail


def test_the_printed_detail_is_shown_if_its_mark_is_the_verdict():
    assert close(1.0, 1.0, detail="printed", mark="✓").detail == "printed"
    assert (
        close(1.0, 2.0, detail="printed", mark="✓").detail == "got 1 vs expected 2 (rtol=1e-06, atol=1e-09)"
    )
    assert close(1.0, 2.0, detail="", mark="✗").detail == ""
    check = Claim("check", "a", {"passed": np.array(0.0)}, detail="forged", mark="✓", own="sum 3")
    assert check.outcome("cell 1").line == "✗  a   [sum 3]"


@pytest.mark.parametrize("said", [True, False])
def test_what_is_not_judged_counts_as_the_package_says(said):
    claim = Claim("close", "a", detail="max|Δ| = 0", mark="✓", said=said, unjudged="too many numbers")
    line = "a   [max|Δ| = 0; as your notebook reports it, not judged again: too many numbers]"
    assert claim.outcome("cell 1").line == f"{'✓' if said else '✗'}  {line}"
    left_out = Claim("close", "a", said=said, left_out="too many checks")
    assert left_out.outcome("cell 1").line == "–  a   [not measured: too many checks]"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("normal 6.9e-03  vs  SVD 2.2e-10", "normal 6.9e-03  vs  SVD 2.2e-10"),
        ("[[1 2]\n [3 4]]\r\n", "[[1 2] [3 4]]"),
        ("a\u2028b\x0bc", "a b c"),
        ("x" * 20, "x" * 10),
    ],
)
def test_a_text_on_one_line_keeps_its_blanks(text, shown):
    assert one_line(text, 10 if text[0] == "x" else 99) == shown
