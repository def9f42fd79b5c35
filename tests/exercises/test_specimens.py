"""Every sample of rigid-body, graded through the real sandbox, gets the report that is expected of it.

The first sample of each expected report, and every right ``euler_eqs``, are graded by ``make test``; ``make test-all`` grades all.
"""

from dataclasses import replace

import pytest

from ecp.document import document
from exercises.assignment import assignments
from exercises.specimens import specimens
from service.grading.grade import grade
from service.grading.submission import Submission

PATIENCE = 4.0  # times the budgets: on a loaded machine a sample that ends has the time to
SEEDS = [3, *(pytest.param(seed, marks=pytest.mark.exhaustive) for seed in (1, 11, 2026))]


def samples():
    """The samples in order, those marked slow whose expected report an earlier sample has."""
    seen = set()
    for sample in specimens(assignments()["rigid-body"]):
        expected = (tuple(sample.ask or ()), frozenset(sample.verdicts.items()), sample.codes)
        right_function = sample.ask is None and not sample.codes
        yield pytest.param(sample, id=sample.file.name, marks=[pytest.mark.slow] if expected in seen and not right_function else [])
        seen.add(expected)


@pytest.fixture(scope="module")
def patient(rigid_body):
    """The assignment with more time for each scene."""
    scenes = [replace(scene, budget_s=PATIENCE * scene.budget_s) for scene in rigid_body.scenes]
    return replace(rigid_body, scenes=type(rigid_body.scenes)(scenes))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("sample", [*samples()])
def test_a_sample_gets_its_expected_report(sample, seed, sandbox, rigid_body, patient):
    submission = Submission.from_bytes(sample.file.read_bytes(), sample.file.name)
    ends = "timeout" not in sample.codes
    report = document(grade(submission, patient if ends else rigid_body, sandbox, seed, sample.ask).report)
    assert sample.unexpected(report) == []
    outcomes = [outcome for exercise in report["exercises"] for outcome in exercise["outcomes"]]
    assert all(outcome["cause"] for outcome in outcomes if outcome["verdict"] == "unmeasured")
