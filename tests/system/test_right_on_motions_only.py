"""Functions that are right along exact motions, or in the usual cases, and wrong elsewhere: graded in the
sandbox, none passes.
"""

import pytest

from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.right_on_motions_only import ONLY_HERE, RIGHT, source


def graded(body, seed, rigid_body, sandbox):
    return grade(
        Submission.from_bytes(source(body).encode(), "submission.py"), rigid_body, sandbox, seed, ["2"]
    ).report


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "body",
    [
        pytest.param(body, id=name, marks=[pytest.mark.slow] if name == "every fiftieth call" else [])
        for name, body in ONLY_HERE.items()
    ],
)
def test_no_function_passes_that_is_wrong_somewhere(body, seed, rigid_body, sandbox):
    outcomes = list(graded(body, seed, rigid_body, sandbox).outcomes())
    assert any(outcome.verdict is Verdict.FAIL for outcome in outcomes)
    assert not any(outcome.verdict is Verdict.UNMEASURED for outcome in outcomes), (
        "it is judged by its values"
    )


def test_the_formula_of_all_of_them_passes(rigid_body, sandbox):
    assert graded(f"return {RIGHT}", 3, rigid_body, sandbox).passed
