import doctest

import numpy as np
import pytest

from polhode.judging import checks
from polhode.judging.author_errors import AuthorError
from polhode.judging.checks import below, close, conserved, holds, shows, within
from polhode.judging.verdict import Verdict

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
    assert bad.text().split("\n")[1:] == ["     worst at row 1 of 2"]


@pytest.mark.parametrize(
    ("error", "would_pass"),
    [
        (2e-9, "rtol = 1e-09, atol = 1e-09"),
        (9e-8, "rtol = 4.5e-08, atol = 4.5e-08"),
        (3e-7, None),
        (1.0, None),
    ],
)
def test_a_larger_tolerance_is_named_only_where_a_few_roundings_are_missing(error, would_pass):
    check = close(
        "id",
        "label",
        "s",
        measured=lambda s: s["x"] + error,
        expected=1.0,
        rtol=5e-10,
        atol=5e-10,
        reason="why",
    )
    notes = check.judge([{"x": np.array(1.0)}], []).notes()
    named = [f"no known mistake gives these numbers; it would pass at {would_pass}"] if would_pass else []
    assert [note for note in notes if "would pass" in note] == named


@pytest.mark.parametrize(("tolerance", "error"), [(1e-3, 2e-3), (60.0, 61.0), (1e-7, 5e-6)])
def test_no_larger_tolerance_is_named_for_counts_and_gross_errors(tolerance, error):
    check = below("id", "label", "s", measured=lambda s: error, limit=tolerance, reason="why")
    assert not any("would pass" in note for note in check.judge([{}], []).notes())


def test_values_that_are_not_finite_fail_whatever_the_word():
    always = holds("id", "label", "scene", claim=lambda s: (True, "fine"), reason="why")
    for value in (NAN, float("inf"), -float("inf")):
        outcome = always.judge([{"w": np.array([[1.0, value], [3.0, 4.0]])}], [])
        assert outcome.verdict is Verdict.FAIL and "not finite" in outcome.detail


def test_conserved_below_holds():
    def first(seen):
        return seen["w"][0]

    assert (
        conserved("a", "l", "s", series=first, limit=1.5, reason="r").judge(SEEN, []).verdict is Verdict.PASS
    )
    assert (
        conserved("a", "l", "s", series=first, limit=0.5, reason="r").judge(SEEN, []).verdict is Verdict.FAIL
    )
    assert below("a", "l", "s", measured=first, limit=2.0, reason="r").judge(SEEN, []).verdict is Verdict.PASS
    assert below("a", "l", "s", measured=first, limit=1.0, reason="r").judge(SEEN, []).verdict is Verdict.FAIL
    assert (
        holds("a", "l", "s", claim=lambda s: (False, "no"), reason="r").judge(SEEN, []).line == "✗  l   [no]"
    )


def judged(measured, seen, truth, expected=lambda truth: truth["x"]):
    check = close("id", "label", "s", measured=measured, expected=expected, rtol=0.0, atol=1.0, reason="why")
    return check.judge([{"x": np.asarray(seen, float)}], truth)


def overflows(seen):
    if np.abs(seen["x"]).max() > 1e200:
        raise OverflowError("too large")
    return seen["x"]


EXACT = [{"x": np.ones(2)}]


@pytest.mark.parametrize("truth", [EXACT, [{"y": np.ones(2)}]], ids=["known", "unknown"])
def test_numbers_too_large_to_compare_are_unmeasured(truth):
    outcome = judged(overflows, [1e300, 1.0], truth, expected=lambda truth: np.ones(2))
    assert (
        outcome.verdict is Verdict.UNMEASURED
        and "too large or too small to compare (too large)" in outcome.detail
    )


@pytest.mark.parametrize(
    "measured",
    [
        lambda seen: seen["z"],
        lambda seen: seen["x"].missing,
        lambda seen: undefined,  # noqa: F821
        lambda seen: seen["x"] + "text",
        lambda seen: seen["x"][7],
        lambda seen: np.linalg.inv(seen["x"]),
        lambda seen: int("one"),
        lambda seen: 1 // 0,
        lambda seen: seen["x"][:1],
        lambda seen: 1 / 0 if len(seen["x"]) else 0,
    ],
)
def test_a_check_that_fails_for_the_exact_numbers_too_is_an_error_of_the_author(measured):
    with pytest.raises(AuthorError, match=r"^check id: test_checks\.py line \d+: \w+Error: "):
        judged(measured, [1.0, 2.0], EXACT)


def test_an_error_that_no_number_explains_is_one_of_the_author_even_if_the_exact_numbers_pass():
    with pytest.raises(AuthorError, match=r"^check id: test_checks\.py line \d+: KeyError: "):
        judged(lambda seen: seen["x" if seen["x"][0] == 1 else "z"], [2.0, 1.0], EXACT)


def test_a_wrong_length_of_the_student_fails_and_one_of_the_author_is_an_error():
    assert judged(lambda seen: seen["x"], [1.0], EXACT).detail.startswith("shape (1,) vs expected shape (2,)")
    with pytest.raises(
        AuthorError, match=r"test_checks\.py line \d+: ValueError: shape \(2,\) vs expected shape \(3,\)"
    ):
        judged(lambda seen: seen["x"], [1.0, 2.0], EXACT, expected=lambda truth: np.ones(3))


def test_an_index_beyond_what_the_student_returned_is_unmeasured():
    assert (
        judged(lambda seen: seen["x"][1], [1.0], EXACT, expected=lambda truth: 1.0).verdict
        is Verdict.UNMEASURED
    )


def test_a_claim_and_a_scaled_comparison_read_several_scenes_with_their_truths():
    seen, truth = [{"n": np.array(1.0)}, {"n": np.array(2.0)}], [{"n": np.array(3.0)}, {"n": np.array(4.0)}]
    numbers = shows(
        "a", "l", "s", "t", claim=lambda *all: (True, " ".join(f"{one['n']:g}" for one in all)), reason="r"
    )
    assert numbers.judge(seen, truth).line == "✓  l   [1 2 3 4]"
    both = {
        "measured": lambda a, b: a["n"] + b["n"],
        "expected": lambda a, b: a["n"] + b["n"] - 4.0,
        "scale": lambda a, b: b["n"],
    }
    assert (
        within("a", "l", "s", "t", **both, limit=1e-9, reason="r").judge(seen, truth).verdict is Verdict.PASS
    )
    assert (
        within("a", "l", "s", "t", **both, limit=1e-9, reason="r").judge(seen, seen).verdict is Verdict.FAIL
    )


def test_unmeasured_carries_its_cause():
    outcome = holds("a", "l", "s", claim=lambda s: (True, ""), reason="r").unmeasured("it did not finish")
    assert outcome.verdict is Verdict.UNMEASURED and outcome.cause == "it did not finish"
    assert outcome.line == "–  l   [not measured: it did not finish]"


def test_the_examples_of_the_check_words_are_what_they_print():
    examples = {
        test.name.rpartition(".")[2] for test in doctest.DocTestFinder().find(checks) if test.examples
    }
    results = doctest.testmod(checks)
    assert examples == {"close", "within", "conserved", "below", "holds", "shows"}
    assert results.attempted > 0 and results.failed == 0
