"""Before the details of hidden checks are released, nothing shows what only hidden points revealed."""

import pytest

from exercises.authoring.assignments.catalogue import find
from polhode.judging.outcome import Diagnosis, Ended
from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission
from service.grading.withholding import LATER, without_details
from tests.support.reports import outcome, report

SEED = 7
RIGHT_IN_ONE_ORDER = """
def euler_eqs(t, w, I):
    if I[0] < I[1] < I[2]:
        return -np.cross(w, I * w) / I + 1
    return -np.cross(w, I * w) / I
"""
SAYS_ITS_INPUTS = """
def euler_eqs(t, w, I):
    raise ValueError(f"secret {w[0]:.17g}")
"""
MISSES_A_TERM = "def mean_square(r):\n    square = np.sum(r**2, axis=2)\n"
MISSES_A_TERM += "    return square.mean(axis=0), square.std(axis=0, ddof=1) / np.sqrt(len(r))\n"


def both(assignment, source, sandbox, exercise):
    whole = grade(Submission(source), assignment, sandbox, SEED, [exercise]).report
    return whole, without_details(whole, assignment)


def public(report):
    return [one for one in report.outcomes() if not one.hidden]


def test_where_a_function_is_right_is_withheld_with_the_hidden_points_that_show_it(rigid_body, sandbox):
    whole, shown = both(rigid_body, RIGHT_IN_ONE_ORDER, sandbox, "2")
    assert any("is right for" in d.sentence for o in public(whole) for d in o.diagnosis), whole.text()
    assert "is right for" not in shown.text()
    assert Verdict.FAIL in {o.verdict for o in public(shown)}


def test_what_a_hidden_scene_raised_is_withheld_from_the_public_checks_after_it(rigid_body, sandbox):
    whole, shown = both(rigid_body, SAYS_ITS_INPUTS, sandbox, "2")
    assert any("secret" in o.line for o in public(whole)), whole.text()
    assert "secret" not in repr(shown)
    assert all(LATER in o.remarks for o in shown.outcomes())


def test_a_missing_function_is_named_whatever_is_withheld(rigid_body, sandbox):
    _, shown = both(rigid_body, "x = 1", sandbox, "2")
    assert all("euler_eqs is not defined" in o.line for o in public(shown)), shown.text()


def test_a_cause_that_the_public_checks_show_alone_is_not_withheld(sandbox):
    whole, shown = both(find("random-walks"), MISSES_A_TERM, sandbox, "2")
    causes = [[d.code for d in o.diagnosis] for o in public(shown)]
    assert causes == [[d.code for d in o.diagnosis] for o in public(whole)] == [["missing-term"]] * 2
    assert not any(o.diagnosis for o in shown.outcomes() if o.hidden)


@pytest.mark.parametrize("scenes", [(), ("unknown",)])
def test_a_cause_of_unknown_scenes_is_withheld(rigid_body, scenes):
    likely = [Diagnosis("sign-flipped", "a sign", 1.0, scenes)]
    shown = without_details(report([outcome("2-energy", "fail", diagnosis=likely)]), rigid_body)
    assert [o.diagnosis for o in shown.outcomes()] == [[]]


def test_every_diagnosis_of_a_grading_records_its_scenes(rigid_body, sandbox):
    whole, _ = both(rigid_body, RIGHT_IN_ONE_ORDER.replace("+ 1", "* 2"), sandbox, "2")
    found = [d for o in whole.outcomes() for d in o.diagnosis]
    assert found and all(d.scenes for d in found)
    ended, _ = both(rigid_body, "def euler_eqs(t, w, I):\n    while True: pass\n", sandbox, "2")
    assert {e.ended for e in ended.scene_ends} >= {Ended.TIMED_OUT}
    assert all(d.scenes for o in ended.outcomes() for d in o.diagnosis)
