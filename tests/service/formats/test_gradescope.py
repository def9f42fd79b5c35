"""Gradescope's results.json by its specification, written down from gradescope/autograder_samples,
docs/specs.md.
"""

import base64
import html.parser
import json
from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from polhode.judging.outcome import Diagnosis, Picture
from polhode.judging.verdict import RowsRight
from service.formats.check_text import NoVerdict
from service.formats.gradescope import MOST_PICTURES, VISIBILITIES, document
from tests.support.reports import example, graded_file, outcome, report

Visibility = Literal["hidden", "after_due_date", "after_published", "visible"]
Format = Literal["text", "html", "simple_format", "md", "ansi"]
Number = Annotated[float, Field(ge=0, allow_inf_nan=False)]
PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(200))


class Test(BaseModel):
    __test__ = False
    model_config = ConfigDict(extra="forbid")
    score: Number | None = None
    max_score: Number | None = None
    status: Literal["passed", "failed"] | None = None
    name: str | None = None
    name_format: Format | None = None
    number: str | None = None
    output: str | None = None
    output_format: Format | None = None
    tags: list[str] | None = None
    visibility: Visibility | None = None
    extra_data: dict | None = None


class Results(BaseModel):
    model_config = ConfigDict(extra="forbid")
    score: Number
    execution_time: Number
    output: str
    output_format: Format
    visibility: Visibility | None = None
    stdout_visibility: Visibility
    extra_data: dict | None = None
    tests: list[Test]


def told(rigid_body, file, **more):
    return Results.model_validate_json(
        json.dumps(document(file, rigid_body, **more), allow_nan=False), strict=True
    )


def test_a_report(rigid_body):
    results = told(rigid_body, graded_file(example(), seconds=1.23456))
    assert (results.score, results.execution_time) == (1, 1.235)
    assert results.output.startswith("Fix this first:\n1. ")
    assert results.output.endswith("\n\n1 of 3 points (public checks: 1 of 2)")
    assert [(t.number, t.name, t.score, t.max_score, t.status, t.visibility) for t in results.tests] == [
        ("1.1", "principal moments match the analytic box result", 1, 1, "passed", "visible"),
        ("2.1", "euler_eqs agrees with Euler's equations", 0, 1, "failed", "visible"),
        ("2.2", "rotational energy conserved (torque-free)", 0, 1, "failed", "visible"),
        ("2.3", "what is drawn moves", None, None, None, "visible"),
    ]
    tags = [
        ["exercise 1"],
        ["exercise 2", "hidden", "sign-flipped"],
        ["exercise 2", "raises"],
        ["exercise 2", "no points"],
    ]
    assert [test.tags for test in results.tests] == tags
    line = "✗  euler_eqs agrees with Euler's equations   [got 2 vs expected 1]"
    assert results.tests[1].output.startswith(f"{line}\n     worst at ω̇₂ at question 3\n")
    # nothing of a student's is rendered
    assert {t.output_format for t in results.tests} == {results.output_format} == {"text"}


@pytest.mark.parametrize("hidden", VISIBILITIES)
def test_what_is_drawn_for_an_attempt_is_as_visible_as_one_asks_for(rigid_body, hidden):
    tests = told(rigid_body, graded_file(example()), hidden=hidden).tests
    assert [test.visibility for test in tests] == ["visible", hidden, "visible", "visible"]


def test_a_visible_check_shows_no_cause_that_only_hidden_ones_show(rigid_body):
    hidden = next(scene.name for scene in rigid_body.scenes if callable(scene.inputs))
    secret = Diagnosis("partly-right", "right only where I₁ < I₂", 1.0, (hidden,))
    file = graded_file(report([outcome("2-energy", "fail", diagnosis=[secret])]))
    for visibility in VISIBILITIES:
        shown = told(rigid_body, file, hidden=visibility).model_dump_json()
        assert ("I₁ < I₂" in shown) == ("partly-right" in shown) == (visibility == "visible")


def test_other_visibilities_there_are_none(rigid_body):
    assert set(VISIBILITIES) == set(TypeAdapter(Visibility).json_schema()["enum"])
    with pytest.raises(ValueError, match="after_lunch"):
        document(graded_file(example()), rigid_body, hidden="after_lunch")


def test_points_of_the_assignment_are_shared_by_the_checks(rigid_body):
    results = told(rigid_body, graded_file(example()), max_score=12.0)
    assert results.score == 4.0 and [test.max_score for test in results.tests] == [4.0, 4.0, 4.0, None]


def test_a_check_of_several_points_and_its_partial_credit_are_in_the_total(rigid_body):
    partly = outcome("1-box", "fail", points=4, partial=RowsRight(12, 16))
    file = graded_file(report([outcome("1-notebook", points=2), partly]))
    for most in (None, 12.0):
        results, share = told(rigid_body, file, max_score=most), 1 if most is None else 2
        assert results.score == 5 * share == sum(test.score for test in results.tests)
        assert [(test.score, test.max_score, test.status) for test in results.tests] == [
            (2 * share, 2 * share, "passed"), (3 * share, 4 * share, "failed"),
        ]  # fmt: skip
    assert "12 of 16 inputs are right: 3 of 4 points" in results.tests[1].output


def test_exercises_not_attempted_are_in_the_total(rigid_body):
    right = report([outcome("1-notebook"), outcome("1-box")], total=5, not_attempted=["2"])
    for most in (None, 14.0):
        results = told(rigid_body, graded_file(right), max_score=most)
        share = 1 if most is None else most / 7
        tests = [(test.name, test.score, test.max_score) for test in results.tests[2:]]
        assert results.score == 2 * share and tests == [("exercise 2 was not attempted", 0, 5 * share)]


def test_what_is_no_submission_is_a_zero_with_the_reason(rigid_body):
    results = told(rigid_body, graded_file(None, refused="mine.py contains no code\x00"))
    assert results.score == 0 and results.output == "mine.py contains no code\ufffd"
    assert [(test.status, test.score, test.max_score) for test in results.tests] == [
        ("failed", 0, rigid_body.max_points())
    ]


def test_no_checks_are_no_success(rigid_body):
    for nothing in (report(), report([outcome("2-drawn", "unmeasured", counted=False)])):
        results = told(rigid_body, graded_file(nothing), max_score=10.0)
        assert results.score == 0 and [test.status for test in results.tests if test.status] == ["failed"]


def test_a_fault_is_no_verdict(rigid_body):
    with pytest.raises(NoVerdict, match="disk full"):
        document(graded_file(None, fault="disk full"), rigid_body)


class Images(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags, self.shown, self.told = set(), {}, ""

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        if tag == "img":
            self.shown[dict(attrs)["alt"]] = base64.b64decode(
                dict(attrs)["src"].removeprefix("data:image/png;base64,")
            )

    def handle_data(self, data):
        self.told += data


def figures(rigid_body, pictures, **drawn):
    one = report([outcome("2-energy")], figures=pictures, animations=[])
    *_, test = told(rigid_body, graded_file(one, pictures=drawn)).tests
    page = Images()
    page.feed(test.output)
    return test, page


def test_pictures_are_in_the_document_with_what_they_show(rigid_body):
    pictures = [
        Picture("omega", "2", 'ω "and" <b>', "ω₁ & ω₂"),
        Picture("cone", "2", "the cone", "not drawn"),
    ]
    test, page = figures(rigid_body, pictures, **{"omega.png": PNG, "omega.svg": b"<svg/>"})
    assert (test.name, test.output_format, test.score, test.status) == ("Figures", "html", None, None)
    assert page.tags == {"figure", "img", "figcaption", "p"} and page.shown == {"ω₁ & ω₂": PNG}
    assert 'ω "and" <b>' in page.told and "not drawn" in page.told


def test_there_is_an_end_to_pictures(rigid_body):
    pictures = [Picture(name, "2", name, f"what {name} shows") for name in "abc"]
    _, page = figures(rigid_body, pictures, **{"a.png": PNG * 10000, "b.png": PNG * 15000, "c.png": PNG})
    assert (
        list(page.shown) == ["what a shows", "what c shows"]
        and sum(map(len, page.shown.values())) <= MOST_PICTURES
    )
    assert "what b shows" in page.told


def test_without_pictures_there_is_no_test_of_them(rigid_body):
    assert len(told(rigid_body, graded_file(example())).tests) == 4
