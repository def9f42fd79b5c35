"""Mistakes of a declaration: samples, and diagnoses of submissions that return the same numbers."""

import pytest

from polhode.report.dataclass_json import document
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.author_notebooks import declared
from tests.support.toolbox import FOLDER

INIT = "class Pendulum:\n    def __init__(self, l, g):\n"


@pytest.fixture(scope="module")
def toolbox():
    with known(FOLDER) as catalogue:
        yield catalogue.valid["toolbox"]


def diagnoses(toolbox, sandbox, source, number, seed=1):
    report = grade(Submission(source), toolbox, sandbox, seed, [number]).report
    assert not report.passed
    return {(d.code, d.sentence) for outcome in report.outcomes() for d in outcome.diagnosis}


@pytest.mark.slow
def test_every_sample_made_from_the_declaration_is_as_expected(toolbox, sandbox):
    for sample in toolbox.made_samples():
        report = grade(Submission(sample.source), toolbox, sandbox, 2, sample.ask).report
        assert sample.unexpected(document(report)) == [], report.text()


def test_a_mistake_written_differently_has_its_diagnosis(toolbox, sandbox):
    source = """
def find_root(f, a, b, tol):
    for _ in range(42):
        m = a + (b - a) / 2
        a, b = (m, b) if f(m) > 0 else (a, m)
    return (a + b) / 2
"""
    assert diagnoses(toolbox, sandbox, source, "1") == {
        ("sign-flipped", "the search keeps the half without the root")
    }


def test_a_change_of_one_node_is_named_without_the_terms_of_the_solution(toolbox, sandbox):
    source = f"{INIT}        self.T = 2 * pi * sqrt(g / l)\n    def period(self): return self.T"
    ((code, sentence),) = diagnoses(toolbox, sandbox, source, "3")
    assert code == "wrong-divisor" and "upside down" in sentence and "self.l" not in sentence


def test_numbers_of_no_wrong_solution_have_no_diagnosis(toolbox, sandbox):
    source = f"{INIT}        self.l = l\n    def period(self): return 1.2345 * self.l"
    assert diagnoses(toolbox, sandbox, source, "3") == set()


def test_a_multiple_of_the_right_values_is_named_by_its_factor(toolbox, sandbox):
    source = (
        "from scipy.optimize import bisect\n"
        "def find_root(f, a, b, tol): return bisect(f, a, b, xtol=1e-13) / 2"
    )
    half = ("constant-factor", "find_root is 0.5 times the right value")
    assert diagnoses(toolbox, sandbox, source, "1") == {half}


def test_a_mistake_that_holds_for_the_public_inputs_only_is_not_diagnosed(toolbox, sandbox):
    source = f"""{INIT}        self.l, self.g, Pendulum.n = l, g, Pendulum.n + 1
    n = 0
    def period(self): return (pi if Pendulum.n <= 3 else 3.3) * sqrt(self.l / self.g)
"""
    report = grade(Submission(source), toolbox, sandbox, 1, ["3"]).report
    assert "constant-factor" not in {d.code for outcome in report.outcomes() for d in outcome.diagnosis}


WITH_DATA = """
from exercises.authoring import Notebook, between, relative

notebook = Notebook("notebook.ipynb", data=("factor.csv",))


@notebook.exercise("1")
def scaling(ask):
    scaled = ask.function("scaled")
    scaled.case("any number", x=between(0, 1))
    scaled.truth(lambda x: x + x, agree=relative(1e-12, because="rounding"))
    scaled.mistake("wrong-operator", "the factor is added", change="FACTOR * x -> FACTOR + x")
"""
SETUP = "import numpy as np\n\nFACTOR = np.loadtxt('factor.csv')"


def test_a_mistake_is_diagnosed_where_the_setup_reads_a_data_file(tmp_path, sandbox):
    solution = "def scaled(x):\n    return FACTOR * x\n"
    folder = declared(tmp_path / "scaling", WITH_DATA, solution, setup=SETUP)
    (folder / "factor.csv").write_text("2.0\n")
    with known(folder) as catalogue:
        source = "def scaled(x): return x + FACTOR"
        assert diagnoses(catalogue.valid["scaling"], sandbox, source, "1") == {
            ("wrong-operator", "the factor is added")
        }
