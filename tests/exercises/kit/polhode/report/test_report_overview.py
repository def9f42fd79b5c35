"""What a report says first: each cause once, and the exercises that fail for it in one section."""

import re
from dataclasses import replace

from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, SceneEnd
from polhode.judging.verdict import RowsRight
from polhode.report.failure_causes import exercises_named, suspect_lines
from polhode.report.report_html import cause_block, html, outcome_item
from polhode.report.report_overview import overview
from polhode.report.student_line import StudentLine
from tests.support.reports import TRACEBACK, outcome, report

SIGN = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0, component=1)
ORDER = Diagnosis("cyclic-order", "ω̇₁ & ω̇₂ are swapped", 0.9)
STOPPED = Diagnosis("raises", "ValueError: no", 1.0)
NOTHING = overview([])


def failed(id, *diagnosis, **more):
    return outcome(id, "fail", f"label {id}", diagnosis=list(diagnosis), **more)


def unmeasured(id, cause, diagnosis=STOPPED, **more):
    return outcome(id, "unmeasured", cause=cause, diagnosis=[diagnosis], **more)


def test_the_causes_come_first_those_that_explain_most_before_others():
    first = [failed("a", ORDER), outcome("b"), failed("c", SIGN), failed("d", SIGN)]
    second = [failed("e", SIGN), unmeasured("f", STOPPED.sentence), failed("g")]
    top, *exercises = report(first, second).text().split("\n\n")
    assert top == (
        "Fix this first:\n"
        "1. ω̇₂ has the opposite sign\n"
        "     likely sign-flipped: 3 checks in exercises 1 and 2\n"
        "Then:\n"
        "2. ω̇₁ & ω̇₂ are swapped\n"
        "     likely cyclic-order: 1 check in exercise 1\n"
        "3. ValueError: no\n"
        "     raises: 1 check in exercise 2"
    )
    below = "\n".join(exercises)
    assert below.count("     cause 1") == 3 and below.count("     cause 2") == 1
    assert SIGN.sentence not in below and STOPPED.sentence not in below
    assert "–  f   [not measured: see cause 3]\n" in below and "     cause 3" not in below


def test_the_only_cause_is_not_named_again_at_any_line():
    text = report([outcome("a"), failed("b", SIGN)]).text()
    assert text == (
        "Fix this first:\n1. ω̇₂ has the opposite sign\n     likely sign-flipped: 1 check in exercise 1\n\n"
        "Exercise 1. Title 1\n✓  a   [got 1]\n✗  label b   [got 2 vs expected 1]\n\n"
        "1 of 2 points (public checks: 1 of 2)\n"
    )


def sections(*exercises):
    return [(s.heading, s.points) for s in report(*exercises).overview().sections]


def test_exercises_that_fail_for_causes_shown_before_are_one_section():
    wrong, right = [failed("a", SIGN), outcome("b")], [outcome("c")]
    assert sections(wrong, wrong, wrong, wrong) == [
        ("Exercise 1. Title 1", "1 of 2 points"),
        ("Exercises 2–4: the same cause, 3 checks", "3 of 6 points"),
    ]
    assert [heading for heading, _ in sections(wrong, right, wrong)] == [
        "Exercise 1. Title 1",
        "Exercise 2. Title 2",
        "Exercise 3. Title 3: the same cause, 1 check",
    ]


def test_an_exercise_with_another_cause_or_a_failure_without_any_stands_for_itself():
    both, one, other = [failed("a", SIGN), failed("b", ORDER)], [failed("c", SIGN)], [failed("d")]
    assert [heading for heading, _ in sections(one, both, both, other, [*one, *other])] == [
        "Exercise 1. Title 1",
        "Exercise 2. Title 2",
        "Exercise 3. Title 3: the same causes, 2 checks",
        "Exercise 4. Title 4",
        "Exercise 5. Title 5",
    ]


def test_the_lines_of_a_section_with_the_same_cause_have_no_notes():
    wrong = [failed("a", SIGN, where="t = 3 s")]
    told = report(wrong, wrong, wrong).text()
    assert told.count("worst at t = 3 s") == 1 and told.count("✗  label a") == 3
    assert "Exercises" not in report(wrong, wrong).text()


def test_a_check_of_several_exercises_says_why_it_counts_in_each():
    wrong = [failed("a", SIGN)]
    why = "counts in each of exercises 1–3, because each of them uses this function"
    assert report(wrong, wrong, wrong).text().count(why) == 1
    assert why in html(report(wrong, wrong, wrong))
    assert "counts in each" not in report([outcome("a")], [outcome("a")]).text()


def test_numbers_of_exercises_in_words():
    assert exercises_named(["2"]) == "exercise 2"
    assert exercises_named(["2", "3"]) == "exercises 2 and 3"
    assert exercises_named(["1", "2", "3", "5", "6", "A"]) == "exercises 1–3, 5, 6 and A"


def test_a_line_that_states_its_cause_refers_to_it_in_its_place():
    causes = ["f is not defined because ValueError: no", "g stopped with ValueError: no", "ValueError: no"]
    text = report([unmeasured(str(k), cause) for k, cause in enumerate(causes)]).text()
    assert text.startswith("Fix this first:\n1. ValueError: no\n     raises: 3 checks in exercise 1\n")
    assert text.count("ValueError: no") == 1 and "likely" not in text
    for line in ("f is not defined because of cause 1", "g stopped with cause 1", "see cause 1"):
        assert f"[not measured: {line}]\n" in text


def test_an_exception_is_said_once_with_its_line():
    end = SceneEnd("probes", Ended.RAISED, "ZeroDivisionError: division by zero", "raises", TRACEBACK)
    diagnosis = Diagnosis("raises", end.sentence, 1.0)
    ends = [end, replace(end, scene="torque-free"), replace(end, scene="quiet", traceback=None)]
    one = report([unmeasured("a", end.sentence, diagnosis)], scene_ends=ends)
    text, page = one.text(), html(one)
    assert "1. ZeroDivisionError: division by zero\n     ann.py, line 3: return w / 0\n" in text
    assert text.count("division by zero") == page.count("division by zero") == 1
    assert "<code><mark>return w / 0</mark></code>" in page and one.stops() == []


def test_a_traceback_of_several_lines_of_the_student_is_shown_once_without_the_exceptions_text():
    frames = f'  File "submission.py", line 9, in f\n    g(w)\n{TRACEBACK}'
    end = SceneEnd("probes", Ended.RAISED, "ZeroDivisionError: division by zero", "raises", frames)
    one = report([unmeasured("a", end.sentence, Diagnosis("raises", end.sentence, 1.0))], scene_ends=[end])
    assert 'Cause 1 in full:\n       File "submission.py", line 9, in f\n' in one.text()
    assert one.text().count("division by zero") == html(one).count("division by zero") == 1


def test_a_traceback_that_no_cause_states_is_shown_in_full():
    end = SceneEnd("cell 3", Ended.RAISED, "ZeroDivisionError: division by zero", "raises", TRACEBACK)
    one = report([outcome("a")], scene_ends=[end, replace(end, scene="cell 4")])
    assert one.stops() == [end]
    assert "cell 3: ZeroDivisionError: division by zero\n" in one.text() and "cell 4" not in one.text()


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
    assert text.startswith(f"Fix this first:\n1. {failure}\n     ann.py, line 3: return w / 0\n")
    assert text.count(failure) == 1


def test_a_component_has_the_line_that_computes_it():
    cells = [("cell 2", "def f(t, w, I):\n    return [w[0], -w[1], w[2]]\n")]
    exercises = [ExerciseReport("1", "T", [failed("a", SIGN), outcome("b", diagnosis=[SIGN])])]
    (line,) = suspect_lines(exercises, {"a": "f"}.__getitem__, {"f": cells}.__getitem__)
    assert line == StudentLine("cell 2", 2, "return [w[0], -w[1], w[2]]", 14, 19, SIGN.sentence)
    one = report(exercises=exercises, suspect_lines=[line])
    assert "1. ω̇₂ has the opposite sign\n     cell 2, line 2: return [w[0], -w[1], w[2]]\n" in one.text()
    assert "<code>return [w[0], <mark>-w[1]</mark>, w[2]]</code>" in html(one)


def test_nothing_is_grouped_without_a_diagnosis_of_a_check_that_counts():
    for one in (outcome("a"), failed("a"), failed("a", SIGN, counted=False), outcome("a", diagnosis=[SIGN])):
        assert report([one]).overview().causes == [] and report([one]).text().startswith("Exercise 1.")


def test_the_html_states_each_cause_once_and_escapes_it():
    page = html(report([failed("a", ORDER), failed("b", ORDER)], [failed("c", SIGN)]))
    assert page.count("ω̇₁ &amp; ω̇₂ are swapped") == page.count("Fix this first") == 1
    assert page.index("cyclic-order") < page.index("Exercise 1.")
    assert re.findall(r'<span class="badge">(.*?)</span>', page) == ["cause 1", "cause 1", "cause 2"]


def test_the_html_folds_what_passes_and_what_fails_for_a_cause_shown_before():
    page = html(report([outcome("a")], [failed("b", SIGN)], [failed("c", SIGN)], [failed("d")]))
    assert re.findall(r"<details( open)?><summary class=", page) == ["", " open", "", " open"]


def test_the_html_marks_what_a_line_is_worth():
    lines = [
        outcome("a", "fail", points=4, partial=RowsRight(1, 2)),
        outcome("b", counted=False),
        outcome("c", self_reported=True),
        outcome("d", bonus=True),
    ]
    page = html(report(lines))
    badges = re.findall(r'<span class="badge">(.*?)</span>', page)
    assert badges == ["2 of 4 points", "no points", "self-reported, no points", "bonus"]
    assert "hidden" not in page


def test_the_text_marks_lines_without_points_unless_the_heading_does():
    own = outcome("c", self_reported=True, counted=False)
    several = report([outcome("a"), outcome("b", counted=False), own]).text()
    assert several.count("no points") == 2
    assert re.search(r"✓  b .*\n     no points\n✓  c .*\n     self-reported, no points\n", several)
    alone = report([own]).text()
    assert alone.count("no points") == 1 and alone.startswith("Exercise 1. ")
    assert "no points" not in report([outcome("a", "unmeasured", counted=False)]).text()


def test_what_was_measured_and_what_is_allowed_are_columns():
    page = outcome_item(outcome("a", detail="max|Δ| = 0.5 (rtol=1e-06, atol=0)"), NOTHING)
    assert '<span class="got">max|Δ| = 0.5</span> <span class="allowed">rtol=1e-06, atol=0</span>' in page
    bound = outcome("a", detail="max|Δ|/scale ≤ 2 (limit 1), by f at 128 points")
    assert bound.measured_and_allowed() == ("max|Δ|/scale ≤ 2, by f at 128 points", "limit 1")
    assert outcome("a", detail="growth (of ω): min 1").measured_and_allowed()[1] == ""


def test_a_web_page_folds_the_checks_of_a_cause():
    (cause,) = report([failed(f"check {k}", SIGN) for k in range(4)]).overview().causes
    page = cause_block(cause, links=True)
    assert "<summary>4 checks in exercise 1</summary>" in page
    assert page.count('<a href="#check-check') == 4 and "<details" not in cause_block(cause)


def test_only_a_web_page_has_anchors_and_only_staff_see_what_is_hidden():
    one = failed("a<b>", SIGN, hidden=True)
    seen = report([one, failed("c", ORDER)]).overview()
    plain = cause_block(seen.causes[0]) + outcome_item(one, seen)
    assert "<a " not in plain and "id=" not in plain
    shown = outcome_item(one, seen, links=True, staff="allowed <1>")
    assert '<li class="fail" id="check-a&lt;b&gt;">' in shown and '<a href="#cause-1">cause 1</a>' in shown
    assert '<span class="badge">hidden</span>' in shown and "<p>allowed &lt;1&gt;</p></details>" in shown


def test_a_failure_that_nothing_explains_is_named_first():
    one = report([outcome("a"), failed("b", where="t = 3 s"), failed("c")])
    assert one.overview().unexplained is one.outcomes()[1]
    page = html(one)
    assert page.index("Look at this first") < page.index("✗ label b") < page.index("Exercise 1.")
    assert "Worst at t = 3 s. No known mistake gives these numbers." in page
    for other in (report([outcome("a")]), report([failed("b", SIGN), failed("c")])):
        assert other.overview().unexplained is None and "Look at this first" not in html(other)
