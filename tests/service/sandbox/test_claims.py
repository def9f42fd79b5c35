"""Claims of a notebook's own checks as a stranger's bytes."""

import json

import numpy as np
import pytest

from polhode.judging.judge import Verdict
from service.sandbox.claims import read
from service.sandbox.guest.claims import MOST_NUMBERS
from service.sandbox.untrusted_text import text

CLOSE = {
    **{"kind": "close", "label": "a", "detail": "", "unfit": "", "cell": "cell 1", "left_out": ""},
    **{"numbers": {"rtol": 1e-6, "atol": 0.5}, "arrays": {"got": [2], "expected": []}},
}
RAW = np.array([1.0, 1.25, 1.0]).tobytes()


def judged(header, raw=RAW):
    cell, _, claim = read(json.loads(json.dumps(header)), raw, {"cell 1"}, text)
    return claim.outcome(cell)


def test_the_host_judges_the_numbers_again():
    found = judged(CLOSE)
    assert found.line == "✓  a   [max|Δ| = 0.25 (rtol=1e-06, atol=0.5)]" and found.cell == "cell 1"
    assert judged(CLOSE, np.array([1.0, 1.75, 1.0]).tobytes()).verdict is Verdict.FAIL
    assert judged(CLOSE | {"detail": "max|Δ| = 0"}, np.array([1.0, np.nan, 1.0]).tobytes()).line == (
        "✗  a   [got holds values that are not finite numbers]"
    )


def test_complex_numbers_are_compared_by_their_distance():
    header = CLOSE | {"complex": ["got"], "numbers": {"rtol": 0.1, "atol": 0.0}}
    raw = np.array([3.0 + 0.29j, 3.0 + 0.31j]).tobytes() + np.array([3.0]).tobytes()
    line = "✗  a   [max|Δ| = 0.31 (rtol=0.1, atol=0)]"
    assert judged(header, raw).line == line
    assert (
        judged(header | {"arrays": {"got": [], "expected": []}}, raw[:16] + raw[-8:]).verdict is Verdict.PASS
    )


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"left_out": "too many", "arrays": {}}, "–  a   [not measured: too many]"),
        ({"unfit": "got is None", "arrays": {}}, "✗  a   [got is None]"),
    ],
)
def test_what_has_no_arrays_says_why(changed, line):
    assert judged(CLOSE | changed, b"").line == line


def test_texts_are_made_harmless():
    label = "a\n✓  forged\x1b[2J\u202e" + "x" * 1000
    line = judged(CLOSE | {"label": label}).line
    assert "\n" not in line and "\x1b" not in line and "\u202e" not in line and len(line) < 400


@pytest.mark.parametrize(
    ("changed", "raw"),
    [
        ({"kind": "perfect"}, RAW),
        ({"kind": ["close"]}, RAW),
        ({"complex": ["got"]}, RAW),
        (
            {
                "kind": "conserved",
                "numbers": {"rel_drift": 1.0},
                "arrays": {"series": [3]},
                "complex": ["series"],
            },
            RAW + RAW,
        ),
        ({"cell": "cell 2"}, RAW),
        ({"place": [1]}, RAW),
        ({"place": [1, -1]}, RAW),
        ({"place": "1, 2"}, RAW),
        ({"numbers": {"rtol": 1e-6}}, RAW),
        ({"numbers": {"rtol": 1, "atol": 0.5}}, RAW),
        ({"numbers": {"rtol": None, "atol": 0.5}}, RAW),
        ({"numbers": []}, RAW),
        ({"arrays": {"got": [2]}}, RAW),
        ({"arrays": None}, RAW),
        ({"arrays": {"got": [2], "expected": [-1]}}, RAW),
        ({"arrays": {"got": [True], "expected": [2]}}, RAW),
        ({"arrays": {"got": [1] * 9, "expected": [2]}}, RAW),
        ({"arrays": {"got": [0, 1 << 40], "expected": [3]}}, RAW),
        ({"arrays": {"got": [MOST_NUMBERS + 1], "expected": []}}, bytes(8 * (MOST_NUMBERS + 2))),
        ({}, RAW[:-1]),
        ({}, RAW + b"\0"),
        ({"left_out": "why"}, RAW),
    ],
)
def test_what_is_no_claim_is_refused(changed, raw):
    with pytest.raises(ValueError):
        judged(CLOSE | changed, raw)


@pytest.mark.parametrize("kind", ["close", "conserved", "positive", "below", "check"])
@pytest.mark.parametrize("values", [[], [0.0], [1e308, -1e308], [5e-324, 1e308], [np.inf, 0.0]])
@pytest.mark.parametrize("number", [0.0, -1.0, 1e308, float("inf"), float("nan")])
def test_no_numbers_break_the_judgement(kind, values, number):
    from polhode.judging.claims import KINDS

    raw = np.array(values * len(KINDS[kind].arrays)).tobytes()
    header = CLOSE | {"kind": kind, "numbers": dict.fromkeys(KINDS[kind].numbers, number)}
    header |= {"arrays": {name: [len(values)] for name in KINDS[kind].arrays}}
    assert isinstance(judged(header, raw).verdict, Verdict)
