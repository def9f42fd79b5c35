"""A published notebook whose validation cells call ``validate``, read as an assignment."""

import json
import platform
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.importing.requirements import dependencies
from exercises.authoring.importing.self_reported_checks import Placed, placed_calls, published_cells
from exercises.authoring.importing.titles import notebook_title
from exercises.authoring.importing.validation_words import words
from exercises.authoring.questions.author_notebook import SOLUTION, InvalidNotebook, errors, read

NEWER = f" (this is Python {platform.python_version()}: newer syntax needs a server with a newer one)"
MOST_SLUG = 60  # characters
OTHERS = {
    "nbgrader": re.compile(r'"nbgrader"\s*:|### BEGIN SOLUTION'),
    "Otter-Grader": re.compile(r'"otter"\s*:|# (BEGIN|ASSIGNMENT) (QUESTION|CONFIG)|\botter\.Notebook\('),
}
"""What shows that a notebook is made for another grader, by that grader's name."""


@dataclass(frozen=True)
class PublishedNotebook:
    """A notebook to be imported: its ``cells``, the calls ``taken`` over as lines, each of the others
    and what else the author must know as a sentence, the packages and the data ``files`` that the cells
    need, and the modules that are ``lacking`` on this machine. ``content`` is the file without outputs.
    """

    path: Path
    slug: str
    title: str
    content: bytes
    cells: tuple[PublishedCell, ...]
    taken: list[Placed]
    left: list[str]
    warnings: list[str]
    packages: list[str]
    files: dict[str, bytes]
    lacking: list[str]

    @property
    def has_solutions(self) -> bool:
        """Whether a cell that students fill in contains the author's code."""
        return any(not cell.is_given and not _is_comment(cell.source) for cell in self.cells)


def read_published(
    path: Path, course: Path, wanted: Mapping[str, str], slug: str | None = None, prefix: str = ""
) -> PublishedNotebook:
    """Return a published notebook; ``course`` is the folder for the course's own packages, ``wanted`` the
    lines of its requirements.txt by module. Its slug is ``slug``, or else ``prefix`` and the file's name.

    Raises InvalidNotebook if it has no validation call."""
    cells = read(path)
    text = path.read_text(encoding="utf-8")
    if other := next((name for name, shows in OTHERS.items() if shows.search(text)), None):
        raise InvalidNotebook(
            f"{path.name} is a notebook of {other}: docs/authors/from-nbgrader-or-otter.md says how its tests"
            " become questions"
        )
    if wrong := list(errors(cells)):
        raise InvalidNotebook(f"{path.name}: {'; '.join(wrong)}{NEWER}")
    known = words((course,))
    published = published_cells(cells, (), known)
    placed = list(placed_calls(cells, published, known))
    taken = [one for one in placed if one.call.label and not one.call.in_function]
    if not taken:
        raise InvalidNotebook(
            f"{path.name} has no cell that calls validate.close, check, conserved, positive or below"
        )
    why = {
        True: "the call is inside a function: move it to the top level of the cell",
        False: "the call has no label",
    }
    left = [
        f"{p.cell.name}, line {p.call.place[0]}: {why[p.call.in_function]}" for p in placed if p not in taken
    ]
    packages, files, warnings, lacking = dependencies(cells, path.parent, course, wanted)
    if not any(SOLUTION in cell.tags for cell in cells):
        warnings.append(
            f"no cell is tagged {SOLUTION}: the server then runs every cell that contains code as it is"
            " published"
        )
    title = notebook_title(cells) or path.stem
    content = _without_outputs(text)
    return PublishedNotebook(
        path,
        slug or _slug(prefix + path.stem),
        title,
        content,
        published,
        taken,
        left,
        warnings,
        packages,
        files,
        lacking,
    )


def _slug(name: str) -> str:
    words = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "notebook"
    return (words if words[0].isalpha() else f"notebook-{words}")[:MOST_SLUG].rstrip("-")


def _without_outputs(text: str) -> bytes:
    """Return a notebook's JSON with empty outputs, unchanged if it has none."""
    notebook = json.loads(text)
    full = [cell for cell in notebook["cells"] if cell.get("outputs")]
    for cell in full:
        cell["outputs"] = []
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + "\n" if full else text).encode()


def _is_comment(source: str) -> bool:
    return all(not line.strip() or line.lstrip().startswith("#") for line in source.split("\n"))
