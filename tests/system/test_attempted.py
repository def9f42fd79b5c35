"""Which exercises a submission attempts, and what it says of those that a failure prevents."""

import json
from datetime import UTC, datetime
from pathlib import Path
from xml.etree import ElementTree

import pytest

from polhode.judging.outcome import Ended
from polhode.judging.verdict import Verdict
from service.formats import classroom50, github, gradescope, junit
from service.grading.grade import grade
from service.grading.graded_file import GradedFile
from service.grading.submission import Submission
from tests.support.course_notebook import as_ipynb

EULER = "import numpy as np\ndef euler_eqs(t, w, I):\n    return np.cross(I * np.asarray(w), w) / I\n"
RATE = "def precession_rate(t, w):\n    return np.polyfit(t, np.unwrap(np.arctan2(w[1], w[0])), 1)[0]\n"
MOMENTS = "def principal_moments(tensor):\n    return np.linalg.eigvalsh(tensor)\n"
BOX = "def box_moments(m, a, b, c):\n    return m / 12 * np.array([b*b + c*c, a*a + c*c, a*a + b*b])\n"
IMPORT = "cell 2 stopped: ModuleNotFoundError: No module named 'seaborn' (the sandbox has numpy "
ABOUT = classroom50.SubmissionInfo(
    classroom="physics",
    assignment="rigid-body",
    assignment_type="individual",
    owner="ann",
    submission="submit/1",
    commit="https://git.example/c",
    release="https://git.example/r",
    review="https://git.example/d",
    submitted_at=datetime(2026, 3, 1, tzinfo=UTC),
)


@pytest.fixture(scope="module")
def report_of(rigid_body, sandbox):
    def graded(*cells, numbers=None):
        source = cells[0].encode() if len(cells) == 1 else as_ipynb(cells)
        name = "mine.py" if len(cells) == 1 else "mine.ipynb"
        return grade(Submission.from_bytes(source, name), rigid_body, sandbox, 5, numbers).report

    return graded


@pytest.fixture(scope="module")
def prevented(report_of):
    """A report of a notebook of which one cell's failure prevents exercise 1 and the rate of exercise 4."""
    names = "principal_moments = seaborn.moments\nbox_moments = seaborn.box\nprecession_rate = seaborn.rate"
    return report_of(EULER, f"import seaborn\n{names}", "1 / 0")


def test_an_exercise_that_a_failure_prevents_is_attempted_and_names_the_failure(prevented):
    assert [e.number for e in prevented.exercises] == ["1", "2", "3", "4", "5"]
    assert prevented.not_attempted == ["6"] and not prevented.passed
    first = prevented.exercises[0].outcomes
    assert {o.verdict for o in first} == {Verdict.UNMEASURED} and not sum(o.earned for o in first)
    assert all(f" is not defined because {IMPORT}" in o.cause for o in first)
    assert all(o.verdict is Verdict.PASS for o in prevented.exercises[1].outcomes)


def test_the_failure_is_the_named_cause_of_all_that_follow_from_it(prevented):
    (cause,) = prevented.overview().causes
    assert cause.diagnosis.sentence.startswith(IMPORT) and set(cause.explains) == {"1", "4"}
    assert str(cause.line) == "cell 2, line 1: import seaborn"
    text = prevented.text()
    assert text.startswith("Fix this first:\n1. ")
    assert text.count("No module named 'seaborn'") == 1
    assert "precession_rate is not defined because of cause 1" in text
    assert "division by zero" not in text.split("\n\n")[0]  # another cell, on which nothing depends


def test_other_systems_show_the_exercise_as_failed_with_the_cause(prevented, rigid_body):
    file = GradedFile(file=Path("mine.ipynb"), source="", report=prevented, seconds=1.0)
    suites = ElementTree.fromstring(junit.text([file], rigid_body))
    (first,) = [s for s in suites if "Exercise 1." in s.get("name")]
    assert int(first.get("errors")) == len(first.findall("testcase")) > 0
    assert all("seaborn" in case.find("error").text for case in first.findall("testcase"))
    told = gradescope.document(file, rigid_body)
    assert told["output"].startswith("Fix this first:\n1. ") and "import seaborn" in told["output"]
    tests = [t for t in told["tests"] if t.get("number", "").startswith("1.")]
    assert tests and all(t["status"] == "failed" and "seaborn" in t["output"] for t in tests)
    assert [t["name"] for t in told["tests"] if "not attempted" in t["name"]] == [
        "exercise 6 was not attempted"
    ]
    for test in classroom50.document(file, rigid_body, ABOUT)["tests"]:
        assert not test["test-name"].startswith("1. ") or ("seaborn" in test["output"] and not test["passed"])
    assert "Fix this first" in github.summary([file], rigid_body)
    assert "seaborn" in next(iter(github.annotations([file], rigid_body)))


def test_gradescope_gets_no_causes_of_checks_that_it_hides(prevented, rigid_body):
    file = GradedFile(file=Path("mine.ipynb"), source="", report=prevented, seconds=1.0)
    hidden = [o.label for o in prevented.outcomes() if o.hidden and o.verdict is not Verdict.PASS]
    told = gradescope.document(file, rigid_body, hidden="hidden")["output"]
    assert hidden and "cell 2 stopped: " in told and not any(label in told for label in hidden)


def test_an_exercise_that_fails_for_itself_blames_no_other_cell(report_of):
    report = report_of("import numpy as np\nimport seaborn", EULER.replace("np.cross", "cross"), MOMENTS)
    sentences = {cause.diagnosis.sentence for cause in report.overview().causes}
    assert "NameError: name 'cross' is not defined" in sentences
    assert not any("seaborn" in sentence for sentence in sentences)


def test_a_name_error_in_a_function_names_the_cell_that_was_to_define_it(report_of):
    report = report_of(
        "import seaborn as sb\nfactor = 1.0\n", EULER.replace("/ I", "/ I * factor"), numbers=["2"]
    )
    (cause,) = report.overview().causes
    assert cause.diagnosis.sentence.startswith("cell 1 stopped: ModuleNotFoundError: No module named 'sea")
    assert str(cause.line).startswith("cell 2, line ") and len(cause.outcomes()) == 5
    ends = [end for end in report.scene_ends if end.because]
    assert ends and all(end.sentence == f"`factor` is missing because {end.because}" for end in ends)


@pytest.mark.parametrize(
    "body",
    ["...", "pass", '"""Angles."""', "raise NotImplementedError", "raise NotImplementedError('exercise 1')"],
)
def test_an_empty_function_attempts_nothing(report_of, body):
    report = report_of(f"{EULER}{RATE}def principal_moments(tensor):\n    {body}\n")
    assert report.not_attempted == ["1", "6"] and report.passed


def test_a_failure_elsewhere_makes_no_empty_function_attempted(report_of):
    report = report_of(EULER, RATE, "def principal_moments(tensor):\n    ...", "principal_moments(1) + 1")
    assert report.not_attempted == ["1", "6"] and report.passed


def test_what_python_cannot_compile_is_the_cause_too(report_of):
    report = report_of("import numpy as np", "def euler_eqs(t, w, I):\n    return w\n    *I\n", numbers=["2"])
    (cause,) = report.overview().causes
    assert cause.diagnosis.sentence.startswith("cell 2 stopped: SyntaxError: can't use starred expression")
    assert str(cause.line) == "cell 2, line 3: *I"


def test_a_python_file_that_cannot_be_read_has_one_cause(report_of):
    report = report_of(f"{EULER}{RATE}{MOMENTS}{BOX}x = (1\n")
    (cause,) = report.overview().causes
    assert cause.diagnosis.sentence.startswith("mine.py stopped: SyntaxError: '(' was never closed")
    assert str(cause.line) == "mine.py, line 10: x = (1" and cause.diagnosis.code == "syntax-error"
    assert report.not_attempted == ["6"] and len(cause.outcomes()) == len(report.outcomes())
    assert {end.ended for end in report.scene_ends[1:]} <= {Ended.MISSING, Ended.NOT_PLAYED}


def test_the_report_says_once_where_every_scene_raised(report_of):
    report = report_of(EULER.replace("np.cross(", "np.cross(0 * undefined, "), numbers=["3"])
    text = report.text()
    assert "     mine.py, line 3: return np.cross(0 * undefined, " in text.split("\n\n")[0]
    assert text.count("NameError: name 'undefined' is not defined") == 1
    assert json.loads(json.dumps(text)) == text
