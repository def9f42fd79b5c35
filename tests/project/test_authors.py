"""The guide for course authors: each page's example is an assignment whose samples get the expected reports,
and the tutorial quotes its files.
"""

import inspect
import json
import re

import pytest

from docs import authored
from exercises.authoring import Ask
from polhode.report.dataclass_json import document
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose, with_packages
from service.sandbox.sandbox import Sandbox
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


GUIDE = [ROOT / "docs/authors.md", *sorted((ROOT / "docs/authors").glob("*.md"))]


def test_the_guide_names_what_an_author_imports_and_asks_for():
    told = "".join(page.read_text() for page in GUIDE)
    for name in authored.IMPORTED:
        assert re.search(rf"\b{name}\b", told), name
    for name, (_, owner) in authored.OBJECTS.items():
        for method in authored.methods(owner):
            assert re.search(rf"\b{method}\b", told), (name, method)


def test_every_argument_of_a_question_is_explained_where_it_stands():
    """In the docstring, of which the reference is made, or in the guide."""
    told = "".join(page.read_text() for page in GUIDE)
    for method, function in authored.methods(Ask).items():
        for argument in inspect.signature(function).parameters:
            text = f"{inspect.getdoc(function)} {inspect.getdoc(Ask)} {told}"
            assert argument in {"self", "name"} or re.search(rf"`{argument}\b", text), (method, argument)


@pytest.mark.parametrize("page", author_pages.PAGES, ids=lambda page: page.stem)
def test_a_page_of_a_kind_has_a_picture_an_example_and_pitfalls(page):
    text = page.read_text()
    assert page.with_suffix(".png").is_file() and f"]({page.stem}.png)" in text
    assert "\n## Pitfalls\n" in text and "ask." in text and ".mistake(" in text


def test_every_block_of_a_page_belongs_to_its_example():
    """So every Python block of the guide runs: as a solution, as Setup, or as a part of an assignment."""
    with_code = [page for page in GUIDE if author_pages.blocks(page, "python")]
    assert with_code == [author_pages.SETUP_PAGE, *author_pages.PAGES]


def test_the_report_that_a_page_quotes_is_that_of_its_first_mistake(example, sandbox):
    page, assignment = example
    quoted = author_pages.blocks(page, "text")
    if quoted:
        wrong = author_pages.wrong_samples(assignment)[0]
        assert quoted[0] in graded(wrong, assignment, sandbox).text()


def test_the_tutorial_quotes_its_files():
    cells = json.loads((KEPLER / "kepler.ipynb").read_text())["cells"]
    files = [(KEPLER / "assignment.py").read_text(), *("".join(cell["source"]) for cell in cells)]
    quoted = author_pages.blocks(TUTORIAL, "python")
    assert len(quoted) >= 4
    for block in quoted:
        assert any(block.strip("\n") in file for file in files), block
    assert 'notebook = Notebook("kepler.ipynb")' in files[0] and len(TUTORIAL.read_text().splitlines()) <= 140


def test_the_report_that_the_tutorial_quotes_is_that_of_its_commands(sandbox):
    (source,) = re.findall(r"<<'END'\n(.*?)END\n", TUTORIAL.read_text(), re.DOTALL)
    (quoted,) = author_pages.blocks(TUTORIAL, "text")
    with known(KEPLER) as found:
        report = grade(Submission(source), found.valid["kepler"], sandbox, 1).report
    assert quoted in report.text()


def test_a_mistake_that_a_later_exercise_declares_is_a_sample(tmp_path):
    page = ROOT / "docs/authors/right-hand-sides.md"
    with known(author_pages.write(page, tmp_path)) as found:
        names = [sample.name for sample in author_pages.wrong_samples(found.valid[page.stem])]
    assert names == [f"wrong_{number}_1_sign_flipped.py" for number in (1, 2, 3)]
