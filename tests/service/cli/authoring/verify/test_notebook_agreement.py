"""The published notebook, run with the students' kit, agrees with the server."""

import json

import pytest

from service.cli.authoring.verify.notebook_agreement import notebook_differences
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.toolbox import FOLDER

DECLARED = """
from exercises.authoring import Notebook, between, relative

notebook = Notebook("one.ipynb", title="Doubling")


@notebook.exercise("1", "Doubling")
def doubling(ask):
    double = ask.function("double")
    double.case("", x=between(0, 1))
    double.truth(lambda x: x + x, agree=relative(1e-12, because="rounding"))
    double.mistake("constant-factor", "it triples", change="2 * -> 3 *")
"""


@pytest.fixture
def doubling(tmp_path, sandbox):
    """Return a function that runs the notebook with these cells, and the assignment's reports by sample."""

    def run(*cells, swapped=False):
        folder = tmp_path / "doubling"
        folder.mkdir()
        (folder / "assignment.py").write_text(DECLARED)
        written = [
            {"cell_type": "code", "source": cell, "metadata": {}, "outputs": [], "execution_count": None}
            for cell in cells
        ]
        (folder / "one.ipynb").write_text(
            json.dumps({"cells": written, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
        )
        with known(folder) as catalogue:
            assignment = catalogue.valid["doubling"]
            samples = list(assignment.made_samples())
            reports = [
                grade(Submission(sample.source, sample.name), assignment, sandbox, 1, sample.ask).report
                for sample in samples
            ]
            named = zip(
                [sample.name for sample in samples], reports[::-1] if swapped else reports, strict=True
            )
            return notebook_differences(assignment, samples, dict(named))

    return run


@pytest.mark.slow
def test_only_the_server_has_a_reference(toolbox_samples, sandbox):
    assignment, samples = toolbox_samples
    reports = {
        one.name: grade(Submission(one.source), assignment, sandbox, 1, one.ask).report for one in samples
    }
    assert any(outcome.remarks for report in reports.values() for outcome in report.outcomes())
    assert notebook_differences(assignment, samples, reports) == {one.name: [] for one in samples}


@pytest.fixture
def toolbox_samples():
    """The test assignment and the sample with a wrong function that later ones use."""
    with known(FOLDER) as catalogue:
        assignment = catalogue.valid["toolbox"]
        yield assignment, [one for one in assignment.made_samples() if one.name.startswith("wrong_12-heun")]


SETUP, SOLUTION = "%matplotlib inline\nimport numpy as np", "def double(x):\n    return 2 * x\nk = 1"


def test_right_and_wrong_solutions_get_the_verdicts_of_the_server(doubling):
    found = doubling(SETUP, SOLUTION, "assert double(2) in (4, 6)", "assert polhode.check")
    assert found == {"right_all.py": [], "wrong_1_1_constant_factor.py": []}


@pytest.mark.slow
def test_another_verdict_than_the_servers_is_reported(doubling):
    found = doubling(SETUP, SOLUTION, swapped=True)
    assert [
        "✓  double is right" in line and "on the server: ✗" in line for line in found["right_all.py"]
    ] == [True]
    assert len(found["wrong_1_1_constant_factor.py"]) == 1


def test_a_cell_that_fails_with_the_right_solution_is_reported(doubling):
    found = doubling(SETUP, SOLUTION, "assert double(2) == 5")
    assert found["right_all.py"] == ["in the notebook: code cell 3: AssertionError: "]


def test_later_cells_read_what_the_authors_solution_cell_sets_besides(doubling):
    found = doubling(
        SETUP, "k = 3\ndef double(x):\n    return 2 * x\nfour = double(2)", "assert four in (4, 6) and k == 3"
    )
    assert found == {"right_all.py": [], "wrong_1_1_constant_factor.py": []}


def test_a_program_that_stops_is_reported_once(doubling):
    found = doubling(SETUP, SOLUTION, "import os; os._exit(3)")
    assert list(found) == ["right_all.py", "wrong_1_1_constant_factor.py"]
    assert (
        found["right_all.py"] == ["the notebook could not be run: exit code 3"]
        and found["wrong_1_1_constant_factor.py"] == []
    )
