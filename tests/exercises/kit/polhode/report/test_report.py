"""When a report passes, and what its points are."""

import pytest

from polhode.judging.outcome import SceneEnd
from polhode.judging.verdict import RowsRight
from polhode.report.dataclass_json import NotADocument, document, read
from polhode.report.report import Report
from tests.support.reports import outcome, report, report_of_verdicts


@pytest.mark.parametrize(
    ("verdicts", "points", "passed"),
    [
        ("++", (2, 2), True),
        ("+-", (1, 2), False),
        ("+?", (1, 2), False),
        ("++.", (2, 2), True),
        (".", (0, 0), False),
        ("", (0, 0), False),
    ],
)
def test_a_report_passes_if_there_is_a_check_and_every_one_is_passed(verdicts, points, passed):
    report = report_of_verdicts(verdicts)
    assert (report.score, report.max_score) == points and report.passed is passed


@pytest.mark.parametrize(
    ("more", "summary"),
    [
        ({"total": 2}, "1 of 2 points (public checks: 1 of 2)"),
        (
            {"total": 9, "not_attempted": ["6"]},
            "1 of 9 points (public checks: 1 of 2); not attempted: exercise 6",
        ),
        (
            {"total": 36, "not_attempted": ["1", "6"]},
            "1 of 36 points (public checks: 1 of 2); not attempted: exercises 1 and 6",
        ),
        (
            {"total": 40, "max_points": 36, "bonus_points": 6},
            "1 of 36, +0 of 6 bonus points (public checks: 1 of 2)",
        ),
        ({"total": 36, "max_points": 36, "bonus_points": 0}, "1 of 36 points (public checks: 1 of 2)"),
        ({"total": 9, "local": True, "weighted": True}, "1 of 9 points of the public checks"),
        (
            {"total": 7, "not_attempted": ["6"], "local": True},
            "1 of 7 public checks ✓; not attempted: exercise 6",
        ),
    ],
)
def test_the_summary_states_the_points_out_of_all_there_are(more, summary):
    assert report_of_verdicts("+-", **more).summary() == summary


def test_the_points_of_optional_functions_are_counted_apart():
    outcomes = [outcome("a", points=3), outcome("b", bonus=True, points=2), outcome("c", "fail", bonus=True)]
    one = report(outcomes, total=6, max_points=3, bonus_points=3)
    assert (one.score, one.bonus, one.points) == (5, 2, "3 of 3, +2 of 3 bonus")
    assert read(Report, document(one)).points == one.points


@pytest.mark.parametrize(
    ("verdict", "partial", "earned"),
    [
        ("pass", None, 4),
        ("fail", None, 0),
        ("fail", RowsRight(0, 16), 0),
        ("fail", RowsRight(11, 16), 2),
        ("fail", RowsRight(12, 16), 3),
        ("fail", RowsRight(16, 16), 3),
        ("unmeasured", RowsRight(12, 16), 0),
    ],
)
def test_a_check_earns_its_points_or_its_partial_credit_but_never_all_points_of_a_failure(
    verdict, partial, earned
):
    one = report([outcome("c1", verdict, points=4, partial=partial)])
    assert (one.score, one.max_score, one.outcomes()[0].earned) == (earned, 4, earned)
    assert read(Report, document(one)).outcomes() == one.outcomes()


def test_what_is_missing_in_a_document_is_named():
    with pytest.raises(NotADocument, match="lacks ended"):
        read(SceneEnd, {"scene": "torque-free", "sentence": "too slow"})
