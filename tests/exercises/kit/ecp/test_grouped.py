"""Failures grouped by diagnosis: what is counted, in which order, and how lines refer to it."""

import re
from dataclasses import replace

import pytest

from ecp.judge import RowsRight
from ecp.outcome import Diagnosis, Ended, SceneEnd
from ecp.report_html import cause_list, html, outcome_item
from tests.support.reports import TRACEBACK, outcome, report

SIGN = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0)
ORDER = Diagnosis("cyclic-order", "ω̇₁ & ω̇₂ are swapped", 0.9)
STOPPED = Diagnosis("raises", "ValueError: no", 1.0)


def failed(id, *diagnosis, **more):
    return outcome(id, "fail", f"label {id}", diagnosis=list(diagnosis), **more)


def test_the_causes_come_first_those_that_explain_most_before_others():
    first = [failed("a", ORDER), outcome("b"), failed("c", SIGN), failed("d", SIGN)]
    second = [
        failed("e", SIGN),
        outcome("f", "unmeasured", cause=STOPPED.sentence, diagnosis=[STOPPED]),
        failed("g"),
    ]
    top, *exercises = report(first, second).text().split("\n\n")
    assert top == (
        "3 causes explain 4 failures and 1 check not measured:\n"
        "1. likely sign-flipped: ω̇₂ has the opposite sign\n"
        "     exercise 1: label c; label d\n"
        "     exercise 2: label e\n"
        "2. likely cyclic-order: ω̇₁ & ω̇₂ are swapped\n"
        "     exercise 1: label a\n"
        "3. raises: ValueError: no\n"
        "     exercise 2: f"
    )
    below = "\n".join(exercises)
    assert below.count("cause 1: sign-flipped") == 3 and below.count("cause 2: cyclic-order") == 1
    assert SIGN.sentence not in below and STOPPED.sentence not in below
    assert "–  f   [not measured: see cause 3]\n" in below


def test_a_single_failure_has_its_cause_first_and_no_header():
    text = report([outcome("a"), failed("b", SIGN)]).text()
    assert text.startswith(
        "1. likely sign-flipped: ω̇₂ has the opposite sign\n     exercise 1: label b\n\nExercise 1."
    )


def unmeasured(id, cause, diagnosis=STOPPED, **more):
    return outcome(id, "unmeasured", cause=cause, diagnosis=[diagnosis], **more)


def test_a_line_that_states_its_cause_refers_to_it_in_its_place():
    causes = ["f is not defined because ValueError: no", "g stopped with ValueError: no", "ValueError: no"]
    text = report([unmeasured(str(k), cause) for k, cause in enumerate(causes)]).text()
    assert text.startswith("One cause explains 3 checks not measured:\n1. raises: ValueError: no\n")
    assert text.count("ValueError: no") == 1 and "likely" not in text
    for line in ("f is not defined because of cause 1", "g stopped with cause 1", "see cause 1"):
        assert f"[not measured: {line}]\n" in text


def test_the_cause_has_the_line_that_raised_and_a_traceback_is_shown_once():
    end = SceneEnd("probes", Ended.RAISED, "ZeroDivisionError: division by zero", "raises", TRACEBACK)
    diagnosis = Diagnosis("raises", end.sentence, 1.0)
    ends = [end, replace(end, scene="torque-free"), replace(end, scene="quiet", traceback=None)]
    one = report([unmeasured("a", end.sentence, diagnosis)], scene_ends=ends)
    text, page = one.text(), html(one)
    assert (
        "1. raises: ZeroDivisionError: division by zero\n     submission.py, line 3: return w / 0\n" in text
    )
    assert text.count("Traceback") == 0 and text.count('File "submission.py"') == 1
    assert page.count("File &quot;submission.py&quot;") == 1
    assert "<code>submission.py, line 3: return w / 0</code>" in page
    assert page.count("division by zero") == 3  # the cause, the heading of the traceback, and its last line


def test_what_follows_from_a_failure_is_grouped_under_it():
    failure = "cell 2 stopped: NameError: name 'mass' is not defined"
    ends = [
        SceneEnd(
            name, Ended.MISSING, f"{name} is not defined because {failure}", "raises", TRACEBACK, failure
        )
        for name in ("energy", "speed")
    ]
    checks = [unmeasured(end.scene, end.sentence, Diagnosis("raises", end.cause, 1.0)) for end in ends]
    text = report(checks, scene_ends=ends).text()
    assert text.startswith(f"One cause explains 2 checks not measured:\n1. raises: {failure}\n")
    assert "     submission.py, line 3: return w / 0\n" in text
    assert text.count(failure) == 2  # once more at the traceback


@pytest.mark.parametrize(
    ("traceback", "place"),
    [
        (None, ""),
        ("ZeroDivisionError: division by zero\n", ""),
        (
            '  File "cell 3", line 2\n    return (\n           ^\nSyntaxError: no\n',
            "cell 3, line 2: return (",
        ),
        ('  File "a.py", line 1, in <module>\n  File "b.py", line 7, in f\nNo: x\n', "b.py, line 7"),
        (
            '  File "/tmp/ipykernel_7/12.py", line 4, in f\n    return 1 / x\nNo: x\n  File "x", line 9\n',
            "line 4: return 1 / x",
        ),
        ('  File "<ipython-input-3-ab>", line 5, in f\n    y\nNo\n', "line 5: y"),
    ],
)
def test_the_last_line_of_a_traceback_with_its_place(traceback, place):
    assert SceneEnd("f", Ended.RAISED, "No: x", "raises", traceback).raised_at() == place


def test_one_check_with_two_diagnoses_is_counted_once():
    assert (
        report([failed("a", SIGN, ORDER), failed("b", SIGN, ORDER)])
        .text()
        .startswith("2 causes explain 2 failures:\n")
    )


def test_nothing_is_grouped_without_a_diagnosis_of_a_check_that_counts():
    for one in (outcome("a"), failed("a"), failed("a", SIGN, counted=False), outcome("a", diagnosis=[SIGN])):
        assert report([one]).causes() == [] and report([one]).text().startswith("Exercise 1.")


def test_the_html_states_each_cause_once_and_escapes_it():
    page = html(report([failed("a", ORDER), failed("b", ORDER)]))
    assert page.count("One cause explains 2 failures:") == page.count("ω̇₁ &amp; ω̇₂ are swapped") == 1
    assert (
        page.index("cyclic-order") < page.index("Exercise 1.")
        and page.count("cause 1: <b>cyclic-order</b>") == 2
    )


def test_the_html_marks_what_a_line_is_worth():
    lines = [
        outcome("a", "fail", points=4, partial=RowsRight(1, 2)),
        outcome("b", counted=False),
        outcome("c", self_reported=True),
    ]
    page = html(report(lines))
    badges = re.findall(r'<span class="badge">(.*?)</span>', page)
    assert badges == ["2 of 4 points", "not counted", "self-reported, no points"] and "hidden" not in page


def test_a_web_page_folds_the_checks_of_a_cause_that_explains_many():
    page = cause_list(report([failed(f"check {k}", SIGN) for k in range(4)]).causes(), links=True)
    assert re.search(r"<details class=\"more\"><summary>exercise \d: 4 checks</summary>", page)
    assert page.count('<a href="#check-check') == 4
    assert "<details" not in cause_list(report([failed("a", SIGN)]).causes(), links=True)


def test_only_a_web_page_has_anchors_and_only_staff_see_what_is_hidden():
    one = failed("a<b>", SIGN, hidden=True)
    causes = report([one]).causes()
    plain = cause_list(causes) + outcome_item(one, {})
    assert "<a " not in plain and "id=" not in plain
    linked = cause_list(causes, links=True)
    assert '<li id="cause-1">' in linked and '<a href="#check-a&lt;b&gt;">' in linked
    shown = outcome_item(one, {SIGN.sentence: 1}, links=True, staff="allowed <1>")
    assert (
        '<li class="fail" id="check-a&lt;b&gt;">' in shown
        and '<a href="#cause-1">cause 1</a>: <b>sign-flipped</b>' in shown
    )
    assert '<span class="badge">hidden</span>' in shown and "<p>allowed &lt;1&gt;</p></details>" in shown
