"""Every sample of rigid-body, graded through the real sandbox, gets the report that is expected of it.

``make test`` grades samples until every diagnosis code and every verdict of a check has been seen (of
drawings one right and one wrong one for each exercise), and exercise 2 of every fourth
right function; ``make test-all`` grades every sample whole.
"""

from dataclasses import replace

import pytest

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.samples import samples
from polhode.report.dataclass_json import document
from service.grading.grade import grade
from service.grading.submission import Submission

PATIENCE = 4.0  # times the budgets: on a loaded machine a sample that ends has the time to
SEEDS = [3, *(pytest.param(seed, marks=pytest.mark.exhaustive) for seed in (1, 11, 2026))]


SAMPLES = samples(assignments()["rigid-body"])
RIGHT = [sample for sample in SAMPLES if sample.ask is None and sample.file.name.startswith("right_")]


def samples():
    """The samples in order; those that show no code and no verdict for the first time are slow."""
    seen = set()
    for sample in SAMPLES:
        # its own verdicts follow from the code, and a drawing takes long
        drawing = sample.ask in (
            ["5"],
            ["6"],
        )
        shown = (
            {*sample.codes, *sample.verdicts.items()}
            if not drawing
            else {(*sample.ask, sample.file.name[:5])}
        )
        if takes_long := sample.file.name in ("wrong_finite_difference.py", "hostile_endless.py"):
            shown = set()
        yield pytest.param(
            sample, id=sample.file.name, marks=[pytest.mark.slow] if takes_long or shown <= seen else []
        )
        seen |= shown


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


@pytest.mark.parametrize("sample", [pytest.param(sample, id=sample.file.name) for sample in RIGHT[::4]])
def test_no_right_function_is_refused(sample, sandbox, patient):
    submission = Submission.from_bytes(sample.file.read_bytes(), sample.file.name)
    report = grade(submission, patient, sandbox, 3, ["2"]).report
    assert report.passed and report.score == 5, report.text()
