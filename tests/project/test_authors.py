"""The guide for course authors: each page's example is an assignment whose samples get the expected reports, and
the tutorial quotes its files.
"""

import itertools
import json
import re

import pytest

from polhode.report.document import document
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import choose, with_packages
from tests.support import author_pages
from tests.support.assignments import known
from tests.support.checkout import ROOT

TUTORIAL = ROOT / "docs/tutorials/first-assignment.md"
KEPLER = ROOT / "docs/tutorials/kepler"


@pytest.fixture(scope="module")
def sandbox():
    """A sandbox with the packages that the examples declare."""
    made = Sandbox(with_packages(choose("namespaces"), ["sympy"]))
    yield made
    made.close()


@pytest.fixture(scope="module", params=author_pages.PAGES, ids=lambda page: page.stem)
def example(request, tmp_path_factory):
    """A page and the assignment that its blocks are."""
    folder = author_pages.write(request.param, tmp_path_factory.mktemp("pages"))
    with known(folder) as found:
        assert not found.invalid, found.invalid
        (assignment,) = (a for a in found.valid.values() if a.slug == request.param.stem)
        yield request.param, assignment


def graded(sample, assignment, sandbox):
    return grade(Submission(sample.source), assignment, sandbox, 1, sample.ask).report


def test_the_solutions_of_a_page_are_right(example, sandbox):
    _, assignment = example
    right, *_ = assignment.made_samples()
    assert right.name == "right_all.py"
    assert right.unexpected(document(graded(right, assignment, sandbox))) == []


@pytest.mark.slow
def test_each_mistake_of_a_page_is_named_and_no_check_is_untested(example, sandbox):
    _, assignment = example
    failed = set()
    for sample in author_pages.wrong_samples(assignment):
        report = document(graded(sample, assignment, sandbox))
        assert sample.unexpected(report) == [], sample.name
        failed |= {outcome["id"] for e in report["exercises"] for outcome in e["outcomes"]
                   if outcome["verdict"] != "pass"}  # fmt: skip
    assert {check.id for check in assignment.checks()} <= failed
