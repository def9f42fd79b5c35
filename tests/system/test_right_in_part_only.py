"""Functions that are right for a part of the calls of one child: each exercise that they drive has a ✗."""

import pytest

from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.right_in_part_only import IN_PART, POINTS, RIGHT, source

DRIVEN = ["2", "3", "4", "5", "6"]


@pytest.mark.parametrize("body", IN_PART.values(), ids=IN_PART.keys())
def test_each_exercise_has_a_failure(body, rigid_body, sandbox):
    report = grade(Submission(source(body)), rigid_body, sandbox, 3, DRIVEN).report
    for exercise in report.exercises:
        assert Verdict.FAIL in {outcome.verdict for outcome in exercise.outcomes}, report.text()


def test_the_formula_of_all_of_them_passes(rigid_body, sandbox):
    report = grade(Submission(source(f"return {RIGHT}")), rigid_body, sandbox, 3, ["2", "3"]).report
    assert report.passed, report.text()


def test_the_list_has_as_many_points_as_the_functions_assume(rigid_body):
    assert rigid_body.scene("probes").returns["wdot"].shape[0] == POINTS
