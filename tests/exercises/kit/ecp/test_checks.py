import numpy as np

from ecp.checks import below, close, conserved, holds
from ecp.judge import Verdict

NAN = float("nan")
SEEN = [{"w": np.array([[1.0, 2.0], [3.0, 4.0]])}]


def test_close_reads_seen_and_truth_and_names_the_place():
    check = close(
        "id",
        "label",
        "scene",
        measured=lambda seen: seen["w"],
        expected=lambda truth: truth["w"],
        rtol=0.0,
        atol=0.1,
        reason="why",
        locate=lambda index, seen: f"row {index[0]} of {len(seen['w'])}",
    )
    good = check.judge(SEEN, SEEN)
    assert (good.verdict, good.line) == (Verdict.PASS, "✓  label   [max|Δ| = 0 (rtol=0, atol=0.1)]")
    bad = check.judge(SEEN, [{"w": SEEN[0]["w"] + [[0, 0], [0, 1]]}])
    assert bad.verdict is Verdict.FAIL and bad.where == "row 1 of 2" and bad.margin == 0.1
    assert bad.text().split("\n")[1:] == [
        "     worst at row 1 of 2",
        "     10 times the allowed difference",
        "     no known slip gives these numbers: perhaps the tolerance is merely too tight; it would pass at atol = 1",
    ]


def test_values_that_are_not_finite_fail_whatever_the_word():
    always = holds("id", "label", "scene", claim=lambda s: (True, "fine"), reason="why")
    for value in (NAN, float("inf"), -float("inf")):
        outcome = always.judge([{"w": np.array([[1.0, value], [3.0, 4.0]])}], [])
        assert outcome.verdict is Verdict.FAIL and "not finite" in outcome.detail


def test_conserved_below_holds():
    def first(seen):
        return seen["w"][0]

    assert conserved("a", "l", "s", series=first, limit=1.5, reason="r").judge(SEEN, []).verdict is Verdict.PASS
    assert conserved("a", "l", "s", series=first, limit=0.5, reason="r").judge(SEEN, []).verdict is Verdict.FAIL
    assert below("a", "l", "s", measured=first, limit=2.0, reason="r").judge(SEEN, []).verdict is Verdict.PASS
    assert below("a", "l", "s", measured=first, limit=1.0, reason="r").judge(SEEN, []).verdict is Verdict.FAIL
    assert holds("a", "l", "s", claim=lambda s: (False, "no"), reason="r").judge(SEEN, []).line == "✗  l   [no]"


def test_unmeasured_carries_its_cause():
    outcome = holds("a", "l", "s", claim=lambda s: (True, ""), reason="r").unmeasured("it did not finish")
    assert outcome.verdict is Verdict.UNMEASURED and outcome.cause == "it did not finish"
    assert outcome.line == "–  l   [not measured: it did not finish]"
