"""Every bundled assignment: its right solutions pass, its samples are as expected, and wrong versions of them
fail.
"""

import contextlib

import pytest

from exercises.authoring.assignments import catalogue
from service.cli.__main__ import main
from service.cli.authoring.mutants import grade_mutants
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.isolation.select import choose, with_packages
from service.sandbox.sandbox import Sandbox

DECLARED = [catalogue.slug_of(folder) for folder in catalogue._here() if folder.name != "rigid_body"]
SLOWEST = {"heavy-top", "random-walks", "lagrangian"}


@pytest.mark.parametrize("level", ["namespaces", "process"])
@pytest.mark.parametrize(
    "slug", [pytest.param(slug, marks=pytest.mark.slow) if slug in SLOWEST else slug for slug in DECLARED]
)
def test_the_right_solutions_pass(slug, level):
    assignment = catalogue.find(slug)
    right = next(sample for sample in assignment.made_samples() if sample.right)
    isolation = choose("namespaces") if level == "namespaces" else process_isolation()
    with contextlib.closing(Sandbox(with_packages(isolation, assignment.packages))) as sandbox:
        report = grade(Submission(right.source, right.name), assignment, sandbox, seed=1).report
    assert report.passed and report.score == assignment.max_points() > 0, report.text()
    assert report.provenance.versions.keys() >= {"python", "numpy", *assignment.packages}


@pytest.mark.exhaustive
@pytest.mark.parametrize("slug", DECLARED)
def test_every_sample_is_as_expected_on_four_seeds(slug, capsys):
    exit_code, printed = main(["verify", slug]), capsys.readouterr().out
    assert exit_code == 0 and "warning" not in printed, printed


@pytest.mark.exhaustive
@pytest.mark.parametrize("slug", DECLARED)
def test_at_least_99_percent_of_the_wrong_versions_fail(slug):
    wrong = [found for found in grade_mutants(catalogue.find(slug)) if found.wrong and found.measured]
    accepted = [found.mutant.sentence for found in wrong if found.accepted]
    assert len(accepted) <= 0.01 * len(wrong) and wrong, accepted
