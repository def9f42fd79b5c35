"""The pages docs/authors/*.md as assignments: their Python blocks are solution cells and an assignment.py."""

import re
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.samples import Sample
from tests.support.author_notebooks import solved
from tests.support.checkout import ROOT

SETUP_PAGE = ROOT / "docs/authors.md"
PAGES = sorted(
    page
    for page in (ROOT / "docs/authors").glob("*.md")
    if "from exercises.authoring import" in page.read_text()
)
GIVEN = re.compile(r"\w+ = [\d.]+\n")
"""A given cell: one constant."""


def blocks(page: Path, language: str) -> list[str]:
    """Return the blocks of a page in a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


def write(page: Path, into: Path) -> Path:
    """Write the assignment of a page into the folder ``into`` and return its own folder."""
    folder = into / page.stem.replace("-", "_")
    folder.mkdir(parents=True)
    declared = [one for one in blocks(page, "python") if "exercises.authoring" in one or "@notebook." in one]
    text = "\n\n".join(declared)
    solutions = [one for one in blocks(page, "python") if one not in declared]
    (common,) = blocks(SETUP_PAGE, "python")
    further = [one for one in solutions if re.fullmatch(r"((import|from) .*\n)+", one)]
    solutions = [one for one in solutions if one not in further]
    setup = "".join([common, *further])
    (name,) = re.findall(r'Notebook\("([\w.]+)"', text)
    (folder / "assignment.py").write_text(text)
    numbers = re.findall(r'@notebook\.exercise\("(\w+)"', text)
    (folder / name).write_text(solved(_title(page), setup, numbers, solutions, GIVEN))
    return folder


def _title(page: Path) -> str:
    return page.read_text().split("\n")[0].removeprefix("# ")


def wrong_samples(assignment: Assignment) -> list[Sample]:
    """Return the samples of the declared mistakes, in order."""
    return [sample for sample in assignment.made_samples() if sample.name.startswith("wrong_")]
