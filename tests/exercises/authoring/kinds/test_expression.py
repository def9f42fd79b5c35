"""Expressions of sympy: equal at points, whatever their form; only numbers leave the sandbox."""

import json
import sys

import pytest
import sympy

from exercises.authoring.assignments.catalogue import find
from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose, with_packages
from service.sandbox.sandbox import Sandbox
from tests.support.assignments import known
from tests.support.toolbox import FOLDER, Toolbox, check_locally, mistaken, right


@pytest.fixture(scope="module")
def symbolic():
    with known(FOLDER.parent / "symbolic") as catalogue:
        assert not catalogue.invalid
        assignment = find("symbolic")
        yield Toolbox(sys.modules["exercises.symbolic.assignment"].notebook, assignment)


@pytest.fixture(scope="module")
def sympy_sandbox():
    sandbox = Sandbox(with_packages(choose("namespaces"), ["sympy"]))
    yield sandbox
    sandbox.close()


def report(symbolic, sandbox, source, seed=1):
    return grade(Submission(source), symbolic.assignment, sandbox, seed).report


@pytest.mark.slow
def test_the_right_solutions_pass_in_the_sandbox_and_in_the_kit(symbolic, sympy_sandbox, tmp_path):
    found = report(symbolic, sympy_sandbox, right(symbolic))
    assert found.passed, found.text()
    assert found.provenance.versions["sympy"] == sympy.__version__
    served = [outcome.line for outcome in found.outcomes() if not outcome.hidden]
    assert json.loads(check_locally("symbolic", right(symbolic), tmp_path)) == served


@pytest.mark.slow
def test_mistakes_fail_in_the_sandbox(symbolic, sympy_sandbox):
    for function, number in (("gaussian_moment", 0), ("flow", 0)):
        wrong = report(symbolic, sympy_sandbox, mistaken(symbolic, function, number))
        assert {
            o.verdict for o in wrong.outcomes() if not o.label.startswith("flow is right: potential")
        } == {Verdict.FAIL}


def unmeasured(symbolic, answer):
    """The reason why an answer of flow is not measured, None if it is."""
    from polhode.judging.return_value import WrongAnswer

    question = next(q for q in symbolic.notebook.questions() if q.function == "flow")
    names = question.defined_by(
        f"def flow(z, U):\n    x = sp.Symbol('x')\n    k = sp.Symbol('k', integer=True)\n    return {answer}"
    )
    rows = {"z": [[0.7, 1.1], [1.2, 0.6]], "U": [1.1, 0.8]}
    try:
        seen = question.play(names, rows)
    except WrongAnswer as error:
        return str(error)
    truth = question.exact(rows)
    assert (
        abs(seen["velocity"] - truth["velocity"]).max() < 1e-13
        and abs(seen["potential"] - truth["potential"]).max() < 1e-13
    )
    return None


@pytest.mark.parametrize(
    "velocity",
    [
        "sp.Derivative(U * (z + 1/z), z)",
        "U * (1 - z**-2) + sp.sin(z)**2 + sp.cos(z)**2 - 1",
        pytest.param("U * (1 - sp.Integral(2 * x**-3, (x, z, sp.oo)))", marks=pytest.mark.slow),
        "U * (1 - z**-2) * sp.exp(-U) * sp.Sum(U**k / sp.factorial(k), (k, 0, sp.oo))",
        "U * sp.Limit((1 - z**-2) * sp.sin(x) / x, x, 0)",
        "sp.expand(U * (1 - 1/z) * (1 + 1/z)).rewrite(sp.exp)",
        "(U * (1 - z**-2)).subs(z, sp.Symbol('z', positive=True))",
    ],
)
def test_an_equivalent_form_is_right(symbolic, velocity):
    assert unmeasured(symbolic, f"U * (z + 1/z), {velocity}") is None
    assert unmeasured(symbolic, f"[U * (z + 1/z), {velocity}]") is None


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("None", "flow returned None: is a return statement missing?"),
        ("'U*z', z", "flow must be a sympy expression; it is a str"),
        ("sp.Eq(z, U), z", "flow must be a sympy expression; it is an Equality"),
        ("z, x", "flow contains x; it may contain only z, U"),
        ("z, sp.Function('f')(z)", "flow has no value at z = 0.7+1.1j, U = 1.1: f(z)"),
        ("z, sp.zoo * z", "flow has no value at"),
        ("z", "flow must return 2 values (potential, velocity)"),
        ("z, [z, z]", "flow (velocity) must return a number; it returned shape (2,)"),
    ],
)
def test_an_answer_that_is_no_such_expression_is_unmeasured(symbolic, answer, reason):
    assert reason in unmeasured(symbolic, answer)


@pytest.mark.slow
def test_an_expression_that_takes_for_ever_costs_the_student_s_process_only(symbolic, sympy_sandbox):
    endless = "def gaussian_moment(a, n):\n    return sp.factorial(10**9) * a"
    found = report(symbolic, sympy_sandbox, endless)
    assert {o.verdict for o in found.outcomes()} == {Verdict.UNMEASURED}, found.text()
