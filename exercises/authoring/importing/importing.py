"""An assignment from a published notebook whose validation cells call ``validate``:
every line self-reported.
"""

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from exercises.authoring.importing.requirements import dependencies
from exercises.authoring.importing.validation_cells import Placed, placed_calls, published_cells
from exercises.authoring.importing.words import words
from exercises.authoring.notebook import NUMBER
from exercises.authoring.questions.author_notebook import SOLUTION, Cell, InvalidNotebook, read

CELL_S, GRADING_S = 60, 600  # CPU time of a cell, and of a grading: cells of a course take up to a minute
HEAD = '''"""{title}: imported from {file}.

The server runs the notebook's validation cells on what a student's cells computed. Their lines are
self-reported and carry no points. The comment above a line says what makes it count; docs/authors/ has the
questions.
"""

from exercises.authoring import Notebook

notebook = Notebook(
    {quoted_file},
    title={quoted_title},
{packages}{data}    load_s={cell_s},  # CPU time of one cell
    cpu_s={grading_s},  # and of a whole grading
)
'''
OWN_NUMBERS = "a claim about variables, or a question about the functions that compute it"
HINTS = {
    "close": "truth=… for {expected}, or a question about the function that computes {got}",
    "conserved": "ask.right_hand_side(…, conserved=…), which integrates the student's function itself",
    "check": OWN_NUMBERS,
    "positive": OWN_NUMBERS,
    "below": OWN_NUMBERS,
}
"""What makes a line count, by its kind."""
MOST_SLUG = 60  # characters
LONGEST = 40  # characters of an argument in a comment


class Imported(NamedTuple):
    """The text of assignment.py, the number of validation calls taken over, each of the others as a sentence,
    the data ``files`` that the cells read, by name, and the modules that are ``lacking`` on this machine.
    """

    slug: str
    title: str
    text: str
    taken: int
    left: list[str]
    warnings: list[str]
    files: dict[str, bytes]
    lacking: list[str]


def imported(path: Path, course: Path) -> Imported:
    """Return the assignment of a published notebook; ``course`` is the folder for the course's own packages.

    Raises InvalidNotebook if it has no validation call."""
    cells = read(path)
    title = _title(cells) or path.stem
    known = words((course,))
    placed = list(placed_calls(cells, published_cells(cells, (), known), known))
    taken = [one for one in placed if one.call.label and not one.call.in_function]
    if not taken:
        raise InvalidNotebook(
            f"{path.name} has no cell that calls validate.close, check, conserved, positive or below"
        )
    why = {True: "the call is inside a function", False: "the call has no label"}
    left = [
        f"{p.cell.name}, line {p.call.place[0]}: {why[p.call.in_function]}" for p in placed if p not in taken
    ]
    packages, files, warnings, lacking = dependencies(cells, path.parent, course)
    if not any(SOLUTION in cell.tags for cell in cells):
        warnings.append(
            f"no cell is tagged {SOLUTION}: the server then runs every cell that contains code as it is"
            " published"
        )
    text = HEAD.format(
        title=title,
        file=path.name,
        quoted_title=quoted(title),
        quoted_file=quoted(path.name),
        packages=_tuple("packages", packages),
        data=_tuple("data", files),
        cell_s=CELL_S,
        grading_s=GRADING_S,
    )
    text += "".join(_exercises(taken))
    name = re.sub(r"[^a-z0-9]+", "-", path.stem.lower()).strip("-") or "notebook"
    slug = (name if name[0].isalpha() else f"notebook-{name}")[:MOST_SLUG].rstrip("-")
    return Imported(slug, title, text, len(taken), left, warnings, files, lacking)


def _tuple(name: str, values: Iterable[str]) -> str:
    listed = ", ".join(map(quoted, values))
    return f"    {name}=({listed},),\n" if listed else ""


def _exercises(taken: Sequence[Placed]) -> Iterator[str]:
    used = set[str]()
    for heading, run in groupby(taken, key=lambda placed: placed.heading):
        match = re.match(rf"(?:exercise\s+)?({NUMBER.pattern})(?!\w)\W*(.*)", heading, re.IGNORECASE)
        number = match[1] if match else ""
        title = (match[match.re.groups] if match else "") or heading or "Checks"
        number = next(n for n in (number, *map(str, range(1, 1000))) if n and n not in used)
        used.add(number)
        yield f"\n\n@notebook.exercise({quoted(number)}, {quoted(title)})\n"
        yield f"def exercise_{number.replace('.', '_')}(ask):\n"
        for placed in run:
            got, expected = (
                text if len(text) <= LONGEST else f"{text[:LONGEST]}…" for text in placed.call.arguments
            )
            hint = HINTS.get(placed.call.kind, OWN_NUMBERS).format(
                got=got, expected=expected or "the expected value"
            )
            yield f"    # validate.{placed.call.kind}: {hint}\n    ask.line({quoted(placed.call.label)})\n"


def _title(cells: Sequence[Cell]) -> str:
    """Return the title of the course's ``header(number=…, title=…)``, else the first heading."""
    for node in (node for cell in cells for node in cell.nodes):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "header":
            given = {k.arg: k.value.value for k in node.keywords if isinstance(k.value, ast.Constant)}
            if given.get("title"):
                return " ".join(str(given[name]) for name in ("number", "title") if given.get(name))
    return next((text for cell in cells for _, text in cell.headings), "")


def quoted(text: str) -> str:
    """Return a string literal in the quotes that need fewer escapes, as the formatter writes it."""
    quote = "'" if text.count('"') > text.count("'") else '"'
    return quote + text.replace("\\", "\\\\").replace(quote, f"\\{quote}") + quote
