"""When a report passes, and what its points are."""

import pytest

from tests.support.reports import report_of_verdicts


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
def test_a_report_passes_if_every_check_that_counts_does_and_there_is_one(verdicts, points, passed):
    report = report_of_verdicts(verdicts)
    assert (report.score, report.max_score) == points and report.passed is passed
