"""JUnit XML by the rules of Jenkins' schema junit-10, and as GitLab and the actions for GitHub read it."""

import re
from pathlib import Path
from xml.etree import ElementTree

import junitparser
import pytest
from hypothesis import given

from exercises.authoring.assignments.catalogue import find
from service.formats import junit
from tests.support.random_reports import graded_files
from tests.support.reports import example, graded_file, outcome, report

GOLDEN = Path(__file__).parent / "golden" / "junit.xml"
RIGID = find("rigid-body")
REFUSED = graded_file(None, "samples/ben.py", source="\x00", refused="ben.py is not a text file (UTF-8)")
FAULT = graded_file(None, "samples/cho.ipynb", fault="the disk is full")

# Of each element: what may be in it, attributes it must have, and others it may. ``file`` and ``line`` of a
# case are not in the schema; pytest has written them for years and readers take them.
RULES = {
    "testsuites": ({"testsuite"}, set(), {"name", "time", "tests", "failures", "errors"}),
    "testsuite": (
        {"properties", "testcase"},
        {"name", "tests", "failures", "errors"},
        {"time", "skipped", "file"},
    ),
    "properties": ({"property"}, set(), set()),
    "property": (set(), {"name", "value"}, set()),
    "testcase": ({"skipped", "error", "failure"}, {"name"}, {"time", "classname", "file", "line"}),
    **dict.fromkeys(("skipped", "error", "failure"), (set(), set(), {"type", "message"})),
}
TIME = re.compile(r"\d*\.\d{3}")
LEGAL = re.compile(r"[\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]*")
RAILS_TYPES = {  # in which GitLab would read the text, or refuse to
    "symbol", "date", "datetime", "dateTime", "duration", "integer", "float", "decimal", "double", "boolean",
    "string", "yaml",
    "base64Binary", "hexBinary", "file", "array",
}  # fmt: skip


def valid(text):
    """The root, after every rule was looked at."""
    root = ElementTree.fromstring(text.encode())
    for element in root.iter():
        children, required, more = RULES[element.tag]
        assert {child.tag for child in element} <= children and required <= set(
            element.attrib
        ) <= required | more
        assert TIME.fullmatch(element.get("time", "0.000")) and LEGAL.fullmatch(
            "".join([element.text or "", *element.attrib.values()])
        )
    for parent in (root, *root):
        cases = list(parent.iter("testcase"))
        assert int(parent.get("tests")) == len(cases)
        for kind, count in {"failure": "failures", "error": "errors", "skipped": "skipped"}.items():
            found = sum(case.find(kind) is not None for case in cases)
            assert int(parent.get(count, found)) == found
    return root


def test_the_golden_file():
    text = junit.text([graded_file(example(), seconds=1.5), REFUSED, FAULT], RIGID)
    assert text == GOLDEN.read_text()
    valid(text)


@given(graded_files())
def test_whatever_is_in_a_report_the_document_is_valid_and_no_two_cases_are_one(file):
    root = valid(junit.text([file, REFUSED], RIGID))
    names = [(suite.get("name"), case.get("name")) for suite in root for case in suite.iter("testcase")]
    # GitLab reads the first of equal ones only
    assert len(set(names)) == len(names) and all(case for _, case in names)
    assert not root.findall(".//system-out")  # where it looks for paths of attachments
    kinds = {told.get("type") for case in root.iter("testcase") for told in case}
    assert not kinds & RAILS_TYPES


def test_text_comes_back_as_it_was_but_for_what_is_no_character():
    evil = outcome("2-energy", "fail", "a < b & c", detail=']]> "\x00\x1b[31m\ufffe\ud800 </failure>')
    (case,) = valid(junit.text([graded_file(report([evil]))], RIGID)).iter("testcase")
    assert case.find("failure").text.startswith(
        '✗  a < b & c   []]> "\ufffd\ufffd[31m\ufffd\ufffd </failure>]\n'
    )


def test_times_are_the_files_shared_out():
    root = valid(
        junit.text([graded_file(example(), seconds=2.0), graded_file(example(), "b.py", seconds=0.4)], RIGID)
    )
    assert (
        float(root.get("time"))
        == pytest.approx(2.4)
        == pytest.approx(sum(float(case.get("time")) for case in root.iter("testcase")))
    )
    assert [float(suite.get("time")) for suite in root] == [0.5, 1.5, 0.1, 0.3]


def test_a_file_that_was_not_graded_is_an_error_and_tells_whose():
    refused, fault = junitparser.JUnitXml.fromstring(junit.text([REFUSED, FAULT], RIGID).encode())
    assert [(r.type, r.message, r.text) for case in refused for r in case] == [
        ("refused", REFUSED.refused, REFUSED.refused)
    ]
    assert [(r.type, r.message) for case in fault for r in case] == [
        ("fault", "system fault: the disk is full")
    ]


@pytest.mark.parametrize(
    "nothing", [report(), report([]), report([outcome("5-moves", "unmeasured", counted=False)])]
)
def test_nothing_checked_is_no_success(nothing):
    root = valid(junit.text([graded_file(nothing)], RIGID))
    assert root.get("errors") == "1" and root.find(".//error").get("message") == "no check could be scored"


def test_a_passed_check_without_points_is_skipped():
    root = valid(junit.text([graded_file(report([outcome("a"), outcome("b", counted=False)]))], RIGID))
    assert [case.find("skipped") is not None for case in root.iter("testcase")] == [False, True]


def test_a_case_stands_at_the_students_line():
    source = "import numpy as np\n\n\ndef euler_eqs(t, w, I):\n    return w / 0\n"
    root = valid(junit.text([graded_file(example(), source=source)], RIGID))
    lines = {case.get("name").partition(":")[0]: case.get("line") for case in root.iter("testcase")}
    assert lines == {"1-notebook": None, "2-pointwise": "4", "2-energy": "3", "2-drawn": None}
    assert {case.get("file") for case in root.iter("testcase")} == {"samples/ann.py"}
