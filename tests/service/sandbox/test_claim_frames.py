"""Claims of a notebook's own checks as a stranger's bytes."""

import json

import numpy as np
import pytest

from polhode.judging.verdict import Verdict
from service.sandbox.claim_frames import Field, read, shape_of
from service.sandbox.guest.cells.claim_recorder import MOST_NUMBERS
from service.sandbox.untrusted_text import text

CLOSE = {
    **{"kind": "close", "label": "a", "detail": "", "unjudged": "", "cell": "cell 1", "left_out": ""},
    **{"numbers": {"rtol": 1e-6, "atol": 0.5}, "arrays": {"got": [2], "expected": []}},
}
RAW = np.array([1.0, 1.25, 1.0]).tobytes()


def judged(header, raw=RAW):
    cell, _, claim, _ = read(json.loads(json.dumps(header)), raw, {"cell 1"}, text)
    return claim.outcome(cell)


def test_the_host_judges_the_numbers_again():
    found = judged(CLOSE)
    assert found.line == "✓  a   [max|Δ| = 0.25 (rtol=1e-06, atol=0.5)]" and found.cell == "cell 1"
    assert judged(CLOSE, np.array([1.0, 1.75, 1.0]).tobytes()).verdict is Verdict.FAIL
    assert judged(CLOSE | {"detail": "max|Δ| = 0"}, np.array([1.0, np.nan, 1.0]).tobytes()).line == (
        "✗  a   [max|Δ| = nan (rtol=1e-06, atol=0.5)]"
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
        (
            {"unjudged": "too many", "arrays": {}, "said": True},
            "✓  a   [as your notebook reports it, not judged again: too many]",
        ),
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
        ({"kind": "not a word"}, RAW),
        ({"kind": "a" * 61}, RAW),
        ({"kind": "perfect"}, RAW),
        ({"said": "yes"}, RAW),
        ({"raised": 1}, RAW),
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


FIELD = {
    "kind": "close",
    "label": "a",
    "cell": "cell 1",
    "numbers": {"rtol": 1e-6, "atol": 0.5},
    "arrays": {"got": [2 * MOST_NUMBERS], "expected": []},
    "blocks": ["got"],
    "shape": [2, MOST_NUMBERS],
}


def field(changed, raw=RAW[:8], truth=None):
    header = FIELD | changed
    cell, place, claim, long = read(header, raw, {"cell 1"}, text)
    return Field(cell, place, claim, long, shape=shape_of(header, long), truth=truth)


@pytest.mark.parametrize(
    ("value", "truth", "line"),
    [
        (1.25, None, "✓  a   [max|Δ| = 0.25 (rtol=1e-06, atol=0.5)]"),
        (2.0, None, "✗  a   [max|Δ| = 1 (rtol=1e-06, atol=0.5)]"),
        (np.nan, None, "✗  a   [max|Δ| = nan (rtol=1e-06, atol=0.5)]"),
        (2.0, 1.75, "✓  a   [max|Δ| = 0.75 (rtol=1e-06, atol=0.5)]"),
        (1.0, np.ones(MOST_NUMBERS), "✓  a   [max|Δ| = 0 (rtol=1e-06, atol=0.5)]"),
        (1.0, np.ones(3), "✗  a"),
    ],
)
def test_a_field_is_judged_block_by_block(value, truth, line):
    made, numbers = field({}, truth=truth), np.ones(2 * MOST_NUMBERS)
    numbers[-1] = value
    if truth is not None and np.ndim(truth) == 0:
        numbers[:-1], made = 2.5, field({"numbers": {"rtol": 1e-6, "atol": 0.8}}, truth=truth)
        line = line.replace("atol=0.5", "atol=0.8")
    for first in range(0, len(numbers), MOST_NUMBERS):
        assert not made.complete
        made.add(numbers[first : first + MOST_NUMBERS].tobytes())
    assert made.complete and made.claim.outcome("cell 1").line.startswith(line)
    with pytest.raises(ValueError):
        made.add(numbers[:1].tobytes())


def test_a_long_series_is_compared_with_its_first_value():
    header = {"kind": "conserved", "numbers": {"rel_drift": 0.1}, "blocks": ["series"], "shape": [70_000]}
    made, series = field(header | {"arrays": {"series": [70_000]}}, b""), np.full(70_000, 2.0)
    series[60_000:] = 2.3
    made.add(series[:65_536].tobytes())
    made.add(series[65_536:].tobytes())
    assert made.claim.outcome("cell 1").line == "✗  a   [max relative drift = 0.15 (limit 0.1)]"


@pytest.mark.parametrize(
    "changed",
    [
        {"blocks": ["expected"]},
        {"blocks": ["no"]},
        {"blocks": "got"},
        {"shape": [3]},
        {"shape": [-2, -MOST_NUMBERS]},
        {"arrays": {"got": [10**7 + 1], "expected": []}, "shape": [10**7 + 1]},
        {"arrays": {"got": [10], "expected": []}, "shape": [10]},
    ],
)
def test_what_is_no_field_is_refused(changed):
    with pytest.raises(ValueError):
        field(changed)


@pytest.mark.parametrize("raw", [b"", bytes(7), bytes(8 * (2 * MOST_NUMBERS + 1))])
def test_what_is_no_block_is_refused(raw):
    with pytest.raises(ValueError):
        field({}).add(raw)
