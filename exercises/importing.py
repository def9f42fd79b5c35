"""An assignment from a published notebook whose validation cells call ``validate``: every line self-reported."""

import ast
import importlib.metadata
import re
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from ecp.notebook.cells import statements_of
from exercises.author_notebook import SOLUTION, Cell, InvalidNotebook, read
from exercises.validation_cells import Placed, placed_calls, published_cells

CELL_S, GRADING_S = 60, 600  # CPU time of a cell, and of a grading: cells of a course take up to a minute
DATA_FILE = re.compile(r"(?!\.)[\w\-. ]+\.(csv|txt|dat|tsv|npy|npz|json|h5|fits)")
AVAILABLE = {"ecp", "numpy", "scipy", "matplotlib", "mpl_toolkits"}
HEAD = '''"""{title}: imported from {file}.

The server runs the notebook's validation cells on what a student's cells computed. Their lines are self-reported and
carry no points. The comment above a line says what makes it count; docs/authors.md has the questions.
"""

from exercises.author import Notebook, line

notebook = Notebook(
    {quoted_title},
    notebook={quoted_file},
{packages}{data}    load_s={cell_s},  # CPU time of one cell
    cpu_s={grading_s},  # and of a whole grading
)
'''
OWN_NUMBERS = "a claim about variables, or a question about the functions that compute it"
HINTS = {
    "close": "truth=… for {expected}, or a question about the function that computes {got}",
    "conserved": "a question of kind ode with conserved=…, which integrates the student's function itself",
    "check": OWN_NUMBERS,
    "positive": OWN_NUMBERS,
    "below": OWN_NUMBERS,
}
"""What makes a line count, by its kind."""
LONGEST = 40  # characters of an argument in a comment


class Imported(NamedTuple):
    """The text of assignment.py, the number of validation calls taken over, each of the others as a sentence, and the data files
    that the cells read, by name.
    """

    slug: str
    title: str
    text: str
    taken: int
    left: list[str]
    warnings: list[str]
    data: dict[str, bytes]


def imported(path: Path) -> Imported:
    """Return the assignment of a published notebook. Raises InvalidNotebook if it has no validation call."""
    cells = read(path)
    title = _title(cells) or path.stem
    placed = list(placed_calls(cells, published_cells(cells, ())))
    taken = [one for one in placed if one.call.label and not one.call.in_function]
    if not taken:
        raise InvalidNotebook(f"{path.name} has no cell that calls validate.close, check, conserved, positive or below")
    left = [f"{one.cell.name}, line {one.call.place[0]}: {_reason(one)}" for one in placed if one not in taken]
    packages, warnings = _packages(cells)
    listed = f"    packages=({', '.join(map(_quoted, packages))},),\n" if packages else ""
    data, absent = _data(cells, path.parent)
    warnings += absent
    if not any(SOLUTION in cell.tags for cell in cells):
        warnings.append(f"no cell is tagged {SOLUTION}: the server then runs every cell that contains code as it is published")
    text = HEAD.format(
        title=title,
        file=path.name,
        quoted_title=_quoted(title),
        quoted_file=_quoted(path.name),
        packages=listed,
        data=f"    data=({', '.join(map(_quoted, data))},),\n" if data else "",
        cell_s=CELL_S,
        grading_s=GRADING_S,
    )
    text += "".join(_exercises(taken))
    return Imported(_slug(path.stem), title, text, len(taken), left, warnings, data)


def _exercises(taken: Sequence[Placed]) -> Iterator[str]:
    used = set[str]()
    for heading, run in groupby(taken, key=lambda placed: placed.heading):
        match = re.match(r"(?:exercise\s+)?(\d[\w.]*)\W*(.*)", heading, re.IGNORECASE)
        number, title = (match[1].rstrip("."), match[2] or heading) if match else ("", heading or "Checks")
        number = next(n for n in (number, *map(str, range(1, 1000))) if n and n not in used)
        used.add(number)
        yield f"\nnotebook.exercise(\n    {_quoted(number)},\n    {_quoted(title)},\n"
        for placed in run:
            yield f"    # validate.{placed.call.kind}: {_hint(placed)}\n    line({_quoted(placed.call.label)}),\n"
        yield ")\n"


def _hint(placed: Placed) -> str:
    got, expected = (text if len(text) <= LONGEST else f"{text[:LONGEST]}…" for text in placed.call.arguments)
    return HINTS[placed.call.kind].format(got=got, expected=expected or "the expected value")


def _reason(placed: Placed) -> str:
    return "the call is inside a function" if placed.call.in_function else "the call has no label"


def _title(cells: Sequence[Cell]) -> str:
    """Return the title of the course's ``header(number=…, title=…)``, else the first heading."""
    for node in (node for cell in cells if cell.kind == "code" for s in statements_of(cell.source) for node in ast.walk(s.node)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "header":
            given = {k.arg: k.value.value for k in node.keywords if isinstance(k.value, ast.Constant)}
            if given.get("title"):
                return " ".join(str(given[name]) for name in ("number", "title") if given.get(name))
    return next((text for cell in cells for _, text in cell.headings), "")


def _packages(cells: Sequence[Cell]) -> tuple[tuple[str, ...], list[str]]:
    """Return the distributions that the notebook imports, and a warning for each module that the server or the kit lacks."""
    nodes = [node for cell in cells if cell.kind == "code" for s in statements_of(cell.source) for node in ast.walk(s.node)]
    modules = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
    modules |= {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
    modules |= {
        f"ecp.{name.name}" for node in nodes if isinstance(node, ast.ImportFrom) and node.module == "ecp" for name in node.names
    }
    top = {module.split(".")[0] for module in modules} - AVAILABLE - set(sys.stdlib_module_names)
    known = importlib.metadata.packages_distributions()
    found = sorted({known[name][0] for name in top if name in known})
    warnings = [
        f"{name} is not installed on this machine: install it, and name it in packages" for name in sorted(top) if name not in known
    ]
    warnings += _aliases(nodes)
    warnings += [f"the kit has no {name}: the cells that import it fail" for name in sorted(modules) if _is_missing(name)]
    return tuple(found), warnings


def _data(cells: Sequence[Cell], folder: Path) -> tuple[dict[str, bytes], list[str]]:
    """Return the files beside the notebook that its code names, and a warning for each that is not there."""
    nodes = [node for cell in cells if cell.kind == "code" for s in statements_of(cell.source) for node in ast.walk(s.node)]
    named = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    files = sorted(name for name in named if DATA_FILE.fullmatch(name))
    found = {name: (folder / name).read_bytes() for name in files if (folder / name).is_file()}
    return found, [f"{name} is not beside the notebook: the cells that read it fail" for name in files if name not in found]


def _aliases(nodes: Sequence[ast.AST]) -> Iterator[str]:
    """Yield a warning for each other name of ``validate`` or of its functions, whose calls are not found."""
    for node in nodes:
        for name in node.names if isinstance(node, ast.ImportFrom) else ():
            module = node.module if isinstance(node, ast.ImportFrom) else None
            if (module, name.name) == ("ecp", "validate") and name.asname not in (None, "validate"):
                yield f"the notebook calls validate {name.asname}: calls under that name are not taken over"
            elif module == "ecp.validate":
                yield f"the notebook imports validate.{name.name} by its own name: calls under it are not taken over"


def _is_missing(module: str) -> bool:
    import ecp

    first, _, name = module.partition(".")
    return first == "ecp" and bool(name) and not hasattr(ecp, name) and find_spec(module) is None


def _slug(stem: str) -> str:
    slug = re.sub(r"[^a-z0-9]+", "-", stem.lower()).strip("-") or "notebook"
    return slug if slug[0].isalpha() else f"notebook-{slug}"


def _quoted(text: str) -> str:
    quote = "'" if '"' in text and "'" not in text else '"'
    return quote + text.replace("\\", "\\\\").replace(quote, f"\\{quote}") + quote
