"""Questions that use functions of earlier ones: graded with the student's own, or with the reference where
that is wrong.
"""

import json

import pytest

from polhode.judging.verdict import Verdict
from polhode.report.dataclass_json import document, read
from polhode.report.report import Report
from polhode.report.report_html import html
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.author_notebooks import declared
from tests.support.toolbox import FOLDER, check_locally

STEP = """
def heun_step(f, t, y, h):
    slope = f(t, y)
    return y + h / 2 * (slope + f(t + h, y + h * slope))
"""
EULER = "\ndef heun_step(f, t, y, h):\n    return y + h * f(t, y)\n"
INTEGRATE = """
def integrate(f, y, T, n):
    h = T / n
    for k in range(n):
        y = heun_step(f, k * h, y, h)
    return y
"""
ESTIMATE = (
    "\ndef error_estimate(f, y, T, n):\n    return (integrate(f, y, T, 2 * n) - integrate(f, y, T, n)) / 3\n"
)
HALVED = "halved = heun_step(lambda t, y: -y, 0.0, 1.0, 0.5)\n"
REMARK = "used the reference {}, because yours does not pass its checks"


@pytest.fixture(scope="module")
def chain():
    with known(FOLDER) as catalogue:
        assert not catalogue.invalid
        yield catalogue.valid["toolbox"]


@pytest.fixture
def graded(chain, sandbox):
    def graded(*sources):
        return grade(Submission("\n".join(sources)), chain, sandbox, 1, [number(chain)]).report

    return graded


def number(chain):
    return next(exercise.number for exercise in chain.exercises if "heun_step" in exercise.functions)


def used(report):
    """What the questions used, by function."""
    return {id.partition("-")[2]: text for id, text in report.provenance.chains.items()}


def passed(report):
    """The functions whose checks all pass."""
    found = {}
    for outcome in report.outcomes():
        name = outcome.label.split()[0]
        found[name] = found.get(name, True) and outcome.verdict is Verdict.PASS
    return {name for name, right in found.items() if right}


def remarks(report):
    return {outcome.label.split()[0]: outcome.remarks for outcome in report.outcomes() if outcome.remarks}


def test_right_functions_of_the_student_are_used(graded):
    report = graded(STEP, INTEGRATE, ESTIMATE, HALVED)
    assert report.passed and not remarks(report), report.text()
    step = "the submission's heun_step"
    assert used(report) == {"integrate": step, "error_estimate": "the submission's integrate", "halved": step}


def test_a_wrong_earlier_function_does_not_cost_the_later_ones(graded):
    report = graded(EULER, INTEGRATE, ESTIMATE)
    assert passed(report) == {"integrate", "error_estimate"}, report.text()
    assert remarks(report) == {name: [REMARK.format("heun_step")] for name in ("integrate", "error_estimate")}
    assert (
        "✓  integrate is right   [max|Δ|" in report.text()
        and f"\n     {REMARK.format('heun_step')}\n" in report.text()
    )
    assert used(report)["integrate"] == "the reference heun_step"
    assert used(report)["error_estimate"] == "the submission's integrate, the reference heun_step"


def test_a_missing_earlier_function_does_not_cost_the_later_one(graded):
    for source in (INTEGRATE, "def heun_step(f, t, y, h):\n    '''Return the next state.'''\n" + INTEGRATE):
        report = graded(source)
        assert passed(report) == {"integrate"}, report.text()
        assert remarks(report)["integrate"] == [
            "used the reference heun_step, because you have not written it"
        ]


def test_a_later_function_of_its_own_is_diagnosed_where_both_are_wrong(graded):
    report = graded(EULER, INTEGRATE.replace("range(n)", "range(n - 1)"))
    diagnosed = {
        outcome.label.split()[0]: [d.code for d in outcome.diagnosis] for outcome in report.outcomes()
    }
    assert passed(report) == set()
    assert diagnosed["heun_step"] == ["wrong-quantity"] and diagnosed["integrate"] == ["off-by-one"], (
        report.text()
    )
    assert remarks(report)["integrate"] == [REMARK.format("heun_step")]


def test_a_later_function_that_is_right_on_its_own_is_not_played_again(graded):
    own = INTEGRATE.replace(
        "y = heun_step(f, k * h, y, h)", "y = y + h * (f(k * h, y) + f(k * h + h, y + h * f(k * h, y))) / 2"
    )
    report = graded(EULER, own)
    assert passed(report) == {"integrate"} and not remarks(report), report.text()
    assert used(report)["integrate"] == "the submission's heun_step"


def test_a_wrong_later_function_is_judged_with_the_students_own_right_one(graded):
    report = graded(STEP, INTEGRATE.replace("range(n)", "range(n - 1)"), ESTIMATE)
    assert passed(report) == {"heun_step", "error_estimate"}, report.text()
    assert remarks(report) == {"error_estimate": [REMARK.format("integrate")]}


def test_values_computed_in_a_cell_come_from_the_reference(graded):
    computed = f"\ndef kept(y: Unknown): ...\n{HALVED}assert halved == 0.625\n"
    report = graded("from __future__ import annotations\n", EULER, computed, INTEGRATE)
    assert passed(report) == {"integrate", "halved"}, report.text()
    assert passed(graded(EULER, HALVED)) == {"halved"}


def test_a_result_with_more_checks_passed_stays(graded):
    """A later function that agrees with the student's own step is not judged worse with the reference."""
    swapped = (
        "\ndef heun_step(y, t, f, h):\n    slope = f(t, y)\n"
        "    return y + h / 2 * (slope + f(t + h, y + h * slope))\n"
    )
    later = INTEGRATE.replace("heun_step(f, k * h, y, h)", "heun_step(y, k * h, f, h)").replace(
        "return y", "return y if n > 4 else -y"
    )
    report = graded(swapped, later)
    assert report.score == 1 and not remarks(report), report.text()


def test_the_kit_uses_the_students_function_and_says_what_the_server_does(chain, tmp_path):
    told = json.loads(check_locally("toolbox", EULER + INTEGRATE, tmp_path, "outcome.remarks"))
    assert (
        told
        == [
            [],
            [
                "checked with your own heun_step: where that is wrong or missing, the server uses the"
                " reference"
            ],
        ]
        + [[]] * 2
    )


def test_only_the_asked_exercises_are_reported(chain, sandbox):
    report = grade(Submission(INTEGRATE), chain, sandbox, 1).report
    assert [exercise.number for exercise in report.exercises] == [number(chain)]


def test_reports_keep_the_remarks(graded):
    report = graded(EULER, INTEGRATE)
    assert remarks(read(Report, document(report))) == remarks(report)
    assert f"<p>{REMARK.format('heun_step')}</p>" in html(report)


@pytest.mark.parametrize(
    ("wrong", "used"),
    [
        ("namedtuple('Elements', 'a e omega')(a, 2 * e, omega)", "el.a, el.e, el.omega"),
        ("{'a': a, 'e': 2 * e, 'omega': omega}", "el['a'], el['e'], el['omega']"),
        ("np.array([a, 2 * e, omega])", "el.tolist()"),
        ("[a, 2 * e, omega]", "el.copy()"),
    ],
)
def test_the_reference_returns_its_values_in_the_students_form(sandbox, tmp_path, wrong, used):
    with known(orbits(tmp_path)) as catalogue:
        assert not catalogue.invalid, catalogue.invalid
        report = grade(
            Submission(ELEMENTS.format(wrong=wrong, used=used)), catalogue.valid["orbits"], sandbox, 3
        ).report
    assert passed(report) == {"perihelion"}, report.text()
    assert remarks(report) == {"perihelion": [REMARK.format("elements")]}


def test_a_variable_comes_from_the_reference_in_the_students_form(sandbox, tmp_path):
    with known(orbits(tmp_path, CELL)) as catalogue:
        assert not catalogue.invalid, catalogue.invalid
        wrong = "namedtuple('Elements', 'a e omega')(a, 2 * e, omega)"
        source = ELEMENTS.format(wrong=wrong, used="el") + "ratio = elements(np.array([1.0, 2.0])).e\n"
        report = grade(Submission(source), catalogue.valid["orbits"], sandbox, 3).report
    assert "ratio" in passed(report), report.text()


def test_a_later_function_that_only_the_reference_stops_keeps_its_own_result(sandbox, tmp_path):
    class_ = "type('Elements', (), {'a': a, 'e': 2 * e, 'omega': omega})()"
    with known(orbits(tmp_path)) as catalogue:
        source = ELEMENTS.format(wrong=class_, used="el.a, el.e, el.omega")
        report = grade(Submission(source), catalogue.valid["orbits"], sandbox, 3).report
    assert not remarks(report), report.text()
    assert {o.verdict for o in report.outcomes() if o.label.startswith("perihelion")} == {Verdict.FAIL}


ELEMENTS = """
from collections import namedtuple

def elements(y):
    a, e, omega = y[0] + y[1], y[0] / y[1], y[0] * y[1]
    return {wrong}

def perihelion(y):
    el = elements(y)
    a, e, omega = {used}
    return a * (1 - e) * np.cos(omega)
"""


def orbits(tmp_path, cell=""):
    """An assignment whose second function uses the three values of the first."""
    return declared(tmp_path / "orbits", DECLARED + cell, RIGHT_ELEMENTS, PERIHELION, *[RATIO] * bool(cell))


DECLARED = """
import numpy as np
from exercises.authoring import Notebook, array_of, between, relative

notebook = Notebook("notebook.ipynb")
rounding = relative(1e-12, because="rounding")


@notebook.exercise("1")
def the_elements(ask):
    asked = ask.function("elements", returns="a e omega")
    asked.case("any state", y=array_of(2, between(1, 2)))

    @asked.truth(agree=rounding)
    def in_logarithms(y):
        return np.sum(y), np.exp(np.log(y[0]) - np.log(y[1])), np.prod(y)


@notebook.exercise("2")
def the_perihelion(ask):
    asked = ask.function("perihelion")
    asked.case("any state", y=array_of(2, between(1, 2)))

    @asked.truth(agree=rounding)
    def by_hand(y):
        return (y[0] + y[1]) * (1 - y[0] / y[1]) * np.cos(y[0] * y[1])
"""
CELL = """

@notebook.exercise("3")
def a_ratio(ask):
    ask.cell("ratio").truth("ratio", 0.5, agree=rounding)
"""
RIGHT_ELEMENTS = """
def elements(y):
    return y[0] + y[1], y[0] / y[1], y[0] * y[1]
"""
PERIHELION = """
def perihelion(y):
    a, e, omega = elements(y)
    return a * (1 - e) * np.cos(omega)
"""
RATIO = "_, ratio, _ = elements(np.array([1.0, 2.0]))"
