"""Variables that a cell assigns, and claims about several of them: in the sandbox, and their declaration."""

import pytest

from exercises.authoring.kinds.variables import variables
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.author_notebooks import declared
from tests.support.solutions import cell
from tests.support.toolbox import mistaken


def cells(toolbox):
    return next(q for q in toolbox.notebook.questions() if q.kind == "variables")


def report(toolbox, sandbox, source):
    return grade(Submission(source), toolbox.assignment, sandbox, 1, ["11"]).report


@pytest.mark.parametrize(("number", "failed"), [(0, {"11-rate"}), (1, {"11-claim-1"}), (2, {"11-axes"})])
def test_a_mistake_fails_its_check(toolbox, sandbox, number, failed):
    found = report(toolbox, sandbox, mistaken(toolbox, "rate", number))
    assert {o.id for o in found.outcomes() if o.verdict is Verdict.FAIL} == failed, found.text()


def test_a_claim_shows_its_numbers(toolbox, sandbox):
    found = report(toolbox, sandbox, cells(toolbox).source)
    assert found.passed, found.text()
    assert found.outcomes()[-1].detail == "growth_extreme = 0.001414, growth_middle = 0.005084"


@pytest.mark.parametrize(
    ("change", "absent", "reason"),
    [
        ("rate = None", "11-rate", "rate is not defined"),
        ("del rate", "11-rate", "rate is not defined"),
        ("del axes", "11-axes", "axes is not defined"),
        ("del growth_middle", "11-claim-1", "growth_middle is not defined"),
        ("rate = 'fast'", "11-rate", "rate must be a real number; it is a str"),
        ("rate = axes", "11-rate", "rate must be a number; it is an array of shape (3,)"),
        ("axes = axes[:2]", "11-axes", "axes must be an array of shape (3,); it is an array of shape (2,)"),
        ("axes = [[1], [1, 2]]", "11-axes", "axes must be an array of shape (3,); it is a ragged list"),
    ],
)
def test_another_value_is_unmeasured_with_its_reason_and_alone(toolbox, sandbox, change, absent, reason):
    found = report(toolbox, sandbox, f"{cells(toolbox).source}\n{change}")
    for outcome in found.outcomes():
        if outcome.id == absent:
            assert outcome.verdict is Verdict.UNMEASURED and reason in outcome.line, found.text()
            assert outcome.diagnosis[0].code in ("missing-function", "wrong-shape")
        else:
            assert outcome.verdict is Verdict.PASS, found.text()


def test_a_variable_of_a_failed_statement_is_missing_with_that_cause(toolbox, sandbox):
    failing = cells(toolbox).source.replace("rate = ", "rate = nothing + ")
    found = {o.id: o for o in report(toolbox, sandbox, failing).outcomes()}
    assert (
        "rate is not defined because submission.py stopped: NameError: name 'nothing'"
        in found["11-rate"].line
    )


def test_an_array_of_one_number_is_accepted_with_a_remark(toolbox, sandbox):
    found = report(toolbox, sandbox, f"{cells(toolbox).source}\nrate = np.array([[rate]])")
    assert found.passed, found.text()
    remarks = [remark for outcome in found.outcomes() for remark in outcome.remarks]
    assert remarks == ["rate is an array of shape (1, 1), which is accepted for a number: use x.item()"]


def test_a_variable_that_is_not_finite_fails_alone(toolbox, sandbox):
    found = report(toolbox, sandbox, f"{cells(toolbox).source}\nrate = float('nan')")
    assert [o.verdict for o in found.outcomes()] == [Verdict.FAIL, Verdict.PASS, Verdict.PASS], found.text()
    assert "rate holds values that are not finite numbers" in found.outcomes()[0].line


def test_numbers_of_other_types_are_accepted(toolbox, sandbox):
    changed = "rate, axes = np.float32(3)**-0.5 * 0 + np.array(3**-0.5), [1/6, 1/3, 1/2]"
    found = report(toolbox, sandbox, f"{cells(toolbox).source}\n{changed}")
    assert found.passed, found.text()


FREE_FALL = """
from exercises.authoring import Notebook, close

notebook = Notebook("notebook.ipynb")


@notebook.exercise("1")
def free_fall(ask):
    fitted = ask.cell("g_fit")
    fitted.truth("g_fit", 9.81, agree=close(rtol=1e-9, atol=0, because="rounding"))
    fitted.claim("error < 0.1", "it is small", because="1 %")
"""


@pytest.mark.parametrize(
    ("old", "new", "errors"),
    [
        ("g_fit", "g_fit", []),
        ('"g_fit"', '"h_fit"', ["no solution cell of the notebook assigns h_fit"]),
        (
            'cell("g_fit")',
            'cell("g_fit other")',
            ["other has no truth and no claim: give one, or do not ask for it"],
        ),
        ('"g_fit", 9.81', '"g_fit"', ["g_fit has no truth: give a number or a function that computes it"]),
        ("error <", "spread <", ["the cell does not assign spread"]),
    ],
)
def test_the_errors_of_a_declaration(tmp_path, old, new, errors):
    solution = "g_fit = 9.81\nerror = 0.02\nother = 1"
    folder = declared(tmp_path / "falling", FREE_FALL.replace(old, new), solution)
    with known(folder) as catalogue:
        found = catalogue.invalid["falling"].errors if catalogue.invalid else []
    assert [error.partition(": ")[2] for error in found] == errors


def test_what_a_cell_prints_is_not_output_of_the_command(capsys):
    printing = cell("ratio = 0.5\nprint('a line in the middle of a JSON document')", "ratio")
    near = Tolerance(limit=1e-9, reason="rounding")
    assert variables(printing, {"ratio": 0.5}, agree={"ratio": near}).student["ratio"] == 0.5
    assert capsys.readouterr().out == ""
