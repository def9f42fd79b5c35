"""Values of functions at points: in the sandbox, and the same lines in the students' kit."""

import json
from dataclasses import replace

import numpy as np
import pytest

from ecp.judge import RowsRight, Verdict
from ecp.kinds.values import compare, credited
from ecp.outcome import Tolerance
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.toolbox import check_locally, failed, judged, mistaken, question_of, right


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3, 4))])
def test_the_right_solutions_pass_with_every_seed(toolbox, sandbox, seed):
    report = grade(Submission(right(toolbox)), toolbox.assignment, sandbox, seed).report
    assert report.passed, report.text()


@pytest.mark.parametrize(
    ("function", "number", "ids"),
    [
        ("find_root", 0, ["1-value"]),
        ("find_root", 1, ["1-value"]),
        ("find_root", 2, ["1-calls"]),
        ("normal_modes", 0, ["2-omega"]),
        ("normal_modes", 1, ["2-omega", "2-X"]),
        ("normal_modes", 2, ["2-X"]),
        ("Pendulum", 0, ["3-value"]),
    ],
)
def test_a_mistake_fails_its_checks_with_public_and_with_new_inputs(toolbox, sandbox, function, number, ids):
    report = grade(Submission(mistaken(toolbox, function, number)), toolbox.assignment, sandbox, 1).report
    found = {outcome.id for outcome in report.outcomes() if outcome.verdict is Verdict.FAIL}
    assert found == {id for name in ids for id in (name, name.replace("-", "-new-"))}


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("def find_root(f, a, b, tol): f(a)", "find_root returned None"),
        ("def find_root(f, a, b, tol): return [1.0, 2.0]", "find_root must return shape ()"),
        ("def find_root(f, a, b, tol): return float('nan')", "find_root returned a value that is not finite"),
        ("def find_root(f, a): return 1.0", "the checks call `find_root(f, a, b, tol)`"),
        ("def find_root(f, a, b, tol):\n    while True: f(a)", "it called f more than 600 times"),
        ("def normal_modes(M, K): return 1.0", "normal_modes must return 2 values (omega, X); it returned a float"),
        ("def normal_modes(M, K): return M", "normal_modes must return 2 values (omega, X); it returned 3 values"),
        ("def normal_modes(M, K):\n    M[0, 0] = 0\n    return M[0], M", "normal_modes changes its argument M"),
        ("def normal_modes(M, K): return np.ones((3, 1)), M", "normal_modes (omega) must return shape (3,)"),
    ],
)
def test_a_wrong_answer_is_unmeasured_with_its_reason(toolbox, sandbox, source, sentence):
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    assert {outcome.verdict for outcome in report.outcomes()} == {Verdict.UNMEASURED}
    assert all(sentence in outcome.line for outcome in report.outcomes()), report.text()


PARTLY = """
def find_root(f, a, b, tol):
    while b - a > tol:
        m = (a + b) / 2
        a, b = (m, b) if f(m) < 0 else (a, m)
    return a if a < 2 else a + 1e-3
"""


def test_partial_credit_is_the_share_of_right_inputs_on_the_server_and_in_the_kit(toolbox, sandbox, tmp_path):
    report = grade(Submission(PARTLY), toolbox.assignment, sandbox, 1).report
    found = {outcome.id: outcome for outcome in report.outcomes()}
    public, hidden = found["1-value"], found["1-new-value"]
    assert 0 < public.partial.right < public.partial.rows == 3 and 0 < hidden.partial.right < hidden.partial.rows == 16
    for outcome in (public, hidden):
        right, rows = outcome.partial.right, outcome.partial.rows
        assert outcome.verdict is Verdict.FAIL and outcome.earned == 4 * right // rows
        assert outcome.notes()[-1] == f"{right} of {rows} inputs are right: {outcome.earned} of 4 points"
    assert report.score == public.earned + hidden.earned + 2 and report.max_score == 10
    of = "[outcome.line, outcome.earned, outcome.points, outcome.notes()], report.summary()"
    local, summaries = zip(*json.loads(check_locally("toolbox", PARTLY, tmp_path, f"[{of}]")), strict=True)
    assert summaries[0].startswith(f"{public.earned + 1} of ") and "points of the public checks" in summaries[0]
    assert list(local) == [[o.line, o.earned, o.points, o.notes()] for o in report.outcomes() if not o.hidden]


def test_a_row_is_right_for_partial_credit_if_the_whole_check_would_accept_it():
    """A limit is relative to the largest number of all rows, also for a row that is judged alone."""
    want, limit = np.array([1e-3, 1.0, 0.5]), Tolerance(limit=1e-3, reason="rounding")
    got = np.array([1.5e-3, 2.0, 0.5])
    found = credited({"partial": True}, lambda given: compare(given, want, limit), got, want)
    assert found.partial == RowsRight(2, 3) and credited({}, lambda given: compare(given, want, limit), got, want).partial is None


def test_answers_that_differ_between_runs_earn_no_partial_credit(toolbox, sandbox):
    unsteady = "import random\n" + PARTLY.replace("a + 1e-3", "a + random.random()")
    scenes = tuple(replace(scene, twice=scene.name == "1-hidden") for scene in toolbox.assignment.scenes)
    report = grade(Submission(unsteady), replace(toolbox.assignment, scenes=scenes), sandbox, 1).report
    assert [(o.earned, o.diagnosis[0].code) for o in report.outcomes() if o.id == "1-new-value"] == [(0, "not-deterministic")]


WRONG = [("normal_modes", 1), ("oscillator", 1), ("pendulum", 1), ("rk4_step", 1), ("verlet", 0)]


@pytest.mark.parametrize("wrong", [[], pytest.param(WRONG, marks=pytest.mark.slow)], ids=["right", "wrong"])
def test_the_kit_prints_the_lines_of_the_server(toolbox, sandbox, tmp_path, wrong):
    source = "\n\n".join(mistaken(toolbox, function, number) for function, number in wrong) or right(toolbox)
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    served = [outcome.line for outcome in report.outcomes() if not outcome.hidden]
    local = json.loads(check_locally("toolbox", source, tmp_path))
    unseeded = "end_point"  # draws other numbers each time
    assert [line for line in local if unseeded not in line] == [line for line in served if unseeded not in line]


def test_several_values_may_come_in_one_array(toolbox):
    right_answer = question_of(toolbox, "verlet").solution
    assert failed(judged(question_of(toolbox, "verlet"), lambda force, x, v, h: np.array(right_answer(force, x, v, h)))) == set()


@pytest.mark.parametrize("exact", [[[1.0, 2.0], [1e-9, 0.0]], [[0.0, 0.0], [0.0, 0.0]]], ids=["one row cancels", "all are zero"])
def test_rounding_errors_are_relative_to_the_largest_number(exact):
    tolerance = Tolerance(limit=1e-13, reason="rounding")
    want = np.array(exact)
    assert compare(want + 1e-16, want, tolerance).verdict is Verdict.PASS
    assert compare(want + 1e-12, want, tolerance).verdict is Verdict.FAIL
