"""One report, whatever is in it, told in every form and read back by others' readers: all verdicts and points
agree.
"""

import csv
import io
import json
import re

import junitparser
from hypothesis import given
from markdown_it import MarkdownIt

from exercises.authoring.assignments.catalogue import find
from polhode.judging.verdict import MARKS, Verdict
from service.formats import classroom50, github, gradebooks, grades, gradescope, junit
from service.formats.check_text import sanitize
from service.formats.grade_row import row
from tests.service.formats.test_classroom50 import ABOUT, Result
from tests.support.random_reports import graded_files
from tests.support.workflow_log import commands

RIGID = find("rigid-body")
OF_STATE = {"timeout": "unmeasured", "error": "unmeasured"}


def verdicts(report, *, counted=None):
    """Verdicts by check as the report has them; "skipped" for what does not count, or none of these."""
    kept = {o.id: o.verdict.value if o.counted else "skipped" for o in report.outcomes()}
    return {id: verdict for id, verdict in kept.items() if counted is None or verdict != "skipped"}


def agrees_in_text(file):
    told, report = file.report.text(), file.report
    at = 0
    for outcome in report.outcomes():
        # its detail names a cause that several lines have by its number
        detail = "   [" if outcome.detail else ""
        at = told.index(f"{MARKS[outcome.verdict]}  {outcome.label}{detail}", at)
    *_, summary = told.rstrip("\n").split("\n")
    assert summary.startswith(f"{report.score} of {report.total} points")


def agrees_in_junit(file):
    read = junitparser.JUnitXml.fromstring(junit.text([file], RIGID).encode())
    kinds = {junitparser.Failure: "fail", junitparser.Error: "unmeasured", junitparser.Skipped: "skipped"}
    found = {}
    for case in (case for suite in read for case in suite):
        results = [result for result in case if isinstance(result, junitparser.junitparser.FinalResult)]
        assert len(results) <= 1
        found[case.name.partition(":")[0]] = kinds[type(results[0])] if results else "pass"
    if not file.report.max_score:
        assert found.pop("at least one check was scored") == "unmeasured"
    assert found == verdicts(file.report)
    told = [{p.name: p.value for p in suite.properties()} for suite in read]
    sums = {
        "score": str(file.report.score),
        "max_score": str(file.report.max_score),
        "total": str(file.report.total),
    }
    assert all(properties.items() >= sums.items() for properties in told)
    assert (read.failures + read.errors == 0) is file.passed


def agrees_in_gradescope(file):
    for most in (None, 40.0):
        read = json.loads(
            json.dumps(gradescope.document(file, RIGID, max_score=most), allow_nan=False).encode("ascii")
        )
        tests = [test for test in read["tests"] if "id" in test.get("extra_data", {})]
        point = 1 if most is None else most / max(1, file.report.total)
        assert {
            test["extra_data"]["id"]: test["extra_data"]["verdict"] for test in tests if "score" in test
        } == verdicts(file.report, counted=True)
        assert all(
            (test["score"] == test["max_score"]) is (test["status"] == "passed")
            for test in tests
            if "score" in test
        )
        assert abs(read["score"] - file.report.score * point) < 1e-9
        assert abs(sum(test.get("score", 0) for test in read["tests"]) - read["score"]) < 1e-9
        assert abs(sum(test.get("max_score", 0) for test in read["tests"]) - file.report.total * point) < 1e-9
        complete = file.passed and not file.report.not_attempted
        assert any(test.get("status") == "failed" for test in read["tests"]) is not complete


def agrees_in_classroom50(file):
    told = classroom50.document(file, RIGID, ABOUT)
    read = Result.model_validate_json(json.dumps(told).encode("ascii"))
    tests = [test for test in told["tests"] if "id" in test]
    assert {test["id"]: test["verdict"] for test in tests} == verdicts(file.report, counted=True)
    assert (read.score, read.max_score) == (file.report.score, file.report.total)
    assert all(test.passed for test in read.tests) is (file.passed and not file.report.not_attempted)


def agrees_in_csv(file):
    told, report = row(file, RIGID), file.report
    ids = [outcome.id for outcome in report.outcomes()]
    (mine,) = read(grades.assignment_csv([told], ids).removeprefix("\ufeff"))
    assert {id: OF_STATE.get(mine[id], mine[id]) for id in ids} == {
        o.id: o.verdict.value for o in report.outcomes()
    }
    assert (int(mine["points"]), int(mine["score"]), int(mine["counted"])) == (
        report.score,
        report.score,
        report.max_score,
    )
    (nb,) = read(gradebooks.nbgrader_csv([told]))
    assert float(nb["score"]) == float(nb["raw_score"]) == report.score
    points, student = read(gradebooks.canvas_csv([told], RIGID.title, RIGID.max_points()))
    assert points["Student"].strip() == "Points Possible" and int(student[RIGID.title]) == report.score
    (moved,) = read(gradebooks.moodle_csv([told], RIGID.title))
    assert int(moved[RIGID.title]) == report.score


def read(text):
    return list(csv.DictReader(io.StringIO(text, newline="")))


def agrees_in_github(file):
    report, tokens = (
        file.report,
        MarkdownIt("commonmark").enable("table").parse(github.summary([file], RIGID)),
    )
    assert [token.type for token in tokens if token.level == 0 and token.nesting >= 0] == [
        "heading_open", "paragraph_open", "table_open",
        "html_block", "fence", *["bullet_list_open"] * bool(report.figures), "html_block",
    ]  # fmt: skip
    cells = [token.content for token in tokens if token.type == "inline" and token.level == 4][-4:]
    assert cells[1:3] == ["✓" if file.passed else "✗", f"{report.score} of {report.total}"]
    (fence,) = [token.content for token in tokens if token.type == "fence"]
    assert fence.rstrip("\n") == sanitize(report.text()).rstrip("\n")
    found = commands("\n".join(github.annotations([file], RIGID)))
    assert {name for name, _, _ in found} <= {"error"} and all(
        about["file"] == sanitize(str(file.file)) for _, about, _ in found
    )
    failed = [o for o in report.outcomes() if o.counted and o.verdict is not Verdict.PASS]
    assert sum(
        int(many[1]) if (many := re.search(r"\((\d+) checks\)$", about["title"])) else 1
        for _, about, _ in found
    ) == (len(failed) or not report.max_score)


FORMS = (
    agrees_in_text,
    agrees_in_junit,
    agrees_in_gradescope,
    agrees_in_classroom50,
    agrees_in_csv,
    agrees_in_github,
)


@given(graded_files())
def test_all_forms_agree(file):
    """Drawing a report takes longer than any form of it, so all forms share one."""
    for agrees in FORMS:
        agrees(file)
