"""Classroom 50's result.json by its schema and what its validators add, as result-v1.schema.json and
runner.py have them.
"""

import dataclasses
import json
from datetime import UTC, datetime, timedelta, timezone
from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, StrictBool, ValidationError, model_validator

from polhode.judging.verdict import RowsRight
from service.formats.check_text import NoVerdict
from service.formats.classroom50 import SubmissionInfo, document
from tests.support.reports import example, graded_file, outcome, report

NAME = Annotated[str, Field(min_length=1)]
POINTS = Annotated[int, Field(ge=0, strict=True)]
MOMENT = Annotated[str, Field(pattern=r"^\d{4}-\d{2}-\d{2}T([01]\d|2[0-3]):[0-5]\d:[0-5]\dZ$")]


class Scored(BaseModel):
    score: POINTS
    max_score: POINTS = Field(alias="max-score")

    @model_validator(mode="after")
    def no_more_than_there_are(self):
        assert self.score <= self.max_score
        return self


class Test(Scored):
    __test__ = False
    model_config = ConfigDict(extra="allow")
    test_name: NAME = Field(alias="test-name")
    passed: StrictBool


class Result(Scored):
    model_config = ConfigDict(extra="forbid")
    schema_: Literal["classroom50/result/v1"] = Field(alias="schema")
    classroom: NAME
    assignment: NAME
    assignment_type: Literal["individual", "group", "team"]
    owner: NAME
    submission: Annotated[str, Field(pattern="^submit/")]
    commit: NAME
    release: NAME
    review: NAME
    datetime: MOMENT
    graded_at: MOMENT | None = None
    tests: list[Test]


ABOUT = SubmissionInfo(
    classroom="physics-26", assignment="rigid-body", assignment_type="individual", owner="ann",
    submission="submit/2026-02-28T23-59-58Z-a1b2c3d", commit="https://git.example/c",
        release="https://git.example/r",
    review="https://git.example/d", submitted_at=datetime(2026, 3, 1, 0, 59, 58, 999999,
        timezone(timedelta(hours=1))),
    graded_at=datetime(2026, 3, 2, 8, tzinfo=UTC),
)  # fmt: skip


def test_a_report_is_a_result_that_both_validators_take(rigid_body):
    told = document(graded_file(example()), rigid_body, ABOUT)
    result = Result.model_validate_json(json.dumps(told))
    assert (result.score, result.max_score, result.datetime) == (1, 3, "2026-02-28T23:59:58Z")
    assert [(test.test_name, test.passed, test.score, test.max_score) for test in result.tests] == [
        ("1. principal moments match the analytic box result", True, 1, 1),
        ("2. euler_eqs agrees with Euler's equations", False, 0, 1),
        ("2. rotational energy conserved (torque-free)", False, 0, 1),
    ]
    assert "likely sign-flipped: ω̇₂ has the opposite sign" in told["tests"][1]["output"]
    assert told["tests"][2]["state"] == "error" and "ZeroDivisionError" in told["tests"][2]["output"]


def test_a_check_of_several_points_and_its_partial_credit_are_in_the_total(rigid_body):
    partly = outcome("1-box", "fail", points=4, partial=RowsRight(12, 16))
    file = graded_file(report([outcome("1-notebook", points=2), partly]))
    result = Result.model_validate_json(json.dumps(document(file, rigid_body, ABOUT)))
    assert (result.score, result.max_score) == (5, 6)
    assert [(test.passed, test.score, test.max_score) for test in result.tests] == [
        (True, 2, 2),
        (False, 3, 4),
    ]


def test_exercises_not_attempted_are_in_the_total(rigid_body):
    right = report([outcome("1-notebook"), outcome("1-box")], total=7, not_attempted=["2"])
    result = Result.model_validate_json(json.dumps(document(graded_file(right), rigid_body, ABOUT)))
    assert (result.score, result.max_score) == (2, 7)
    assert [(t.test_name, t.passed, t.max_score) for t in result.tests[2:]] == [
        ("exercise 2 was not attempted", False, 5)
    ]


def test_a_regrade_moves_nothing_but_when_it_was_graded(rigid_body):
    again = dataclasses.replace(ABOUT, graded_at=datetime(2027, 1, 1, tzinfo=UTC))
    one, two = (document(graded_file(example()), rigid_body, about) for about in (ABOUT, again))
    assert {key for key in one if one[key] != two[key]} == {"graded_at"}


def test_what_is_no_submission_is_a_zero_with_the_reason(rigid_body):
    told = document(graded_file(None, refused="mine.py is not a text file (UTF-8)"), rigid_body, ABOUT)
    result = Result.model_validate_json(json.dumps(told))
    assert (result.score, result.max_score) == (0, rigid_body.max_points())
    assert told["tests"][0]["output"] == "mine.py is not a text file (UTF-8)" and not result.tests[0].passed


def test_no_checks_are_no_success(rigid_body):
    """Without tests, Classroom 50 says success."""
    for nothing in (report(), report([outcome("2-drawn", "unmeasured", counted=False)])):
        result = Result.model_validate_json(json.dumps(document(graded_file(nothing), rigid_body, ABOUT)))
        assert (result.score, result.max_score) == (0, 0) and [test.passed for test in result.tests] == [
            False
        ]


def test_a_fault_is_no_verdict(rigid_body):
    with pytest.raises(NoVerdict, match="disk full"):
        document(graded_file(None, fault="disk full"), rigid_body, ABOUT)


@pytest.mark.parametrize(
    "change",
    [
        {"score": 4},
        {"score": 1.0},
        {"datetime": "2026-03-01 00:00:00"},
        {"submission": "main"},
        {"more": 1},
        {"owner": ""},
    ],
)
def test_the_rules_bite(rigid_body, change):
    told = document(graded_file(example()), rigid_body, ABOUT)
    with pytest.raises(ValidationError):
        Result.model_validate_json(json.dumps(told | change))
