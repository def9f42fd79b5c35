"""The text of ``assignment.py`` for an imported notebook: its settings, its exercises and its lines."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.importing.importing import PublishedNotebook
from exercises.authoring.importing.self_reported_checks import Placed
from exercises.authoring.importing.student_influence import is_shown
from exercises.authoring.importing.titles import exercise_heading

HEAD = '''"""{title}: imported from {file}.

The server runs the notebook's validation cells on what a student's cells computed. The comment above a line
says whether it counts, and what makes it count; docs/authors/importing.md explains it.
"""

{imports}from exercises.authoring import Notebook

notebook = Notebook(
    {quoted_file},
    title={quoted_title},
{packages}{data}    load_s={load_s:g},  # CPU time of one cell
    cpu_s={cpu_s:g},  # and of a whole grading
{memory})
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
GIVEN = "✓ without any student's code: it cannot count"
STRONG = "counts: compared with {expected}, which no student's cell can influence"
SHOWN = "value shown: {expected} stands in the notebook; accept=True lets the line count"
COPIED = SHOWN + ", also with {got} = {expected}"
LONGEST = 40  # characters of an argument in a comment
MOST_NUMBERS = 16  # of a truth that is written out
FACTOR = 5  # of what the author's cells take
USUAL_MB, STEP_MB = 512, 256
# where only students' cells take time and memory: those of a course take up to a minute and a gigabyte
CELL_S, GRADING_S, CELLS_MB = 60.0, 600.0, 2048


@dataclass(frozen=True)
class Findings:
    """What dry runs of a notebook found: the lines that are ✓ ``without_student``, the ``truths`` of lines,
    the seconds of CPU time of the costliest cell and of all, and the most MiB of memory. The author's
    solutions ran if the notebook ``has_solutions``.
    """

    without_student: Sequence[Placed] = ()
    truths: Mapping[Placed, NDArray[Any]] = field(default_factory=dict)
    cell_s: float = 0.0
    cpu_s: float = 0.0
    peak_mb: float = 0.0
    has_solutions: bool = False

    def budgets(self) -> dict[str, float]:
        """Return the assignment's ``load_s``, ``cpu_s``, and ``memory_mb`` if it needs more than usual."""
        least = (10.0, 60.0, USUAL_MB) if self.has_solutions else (CELL_S, GRADING_S, CELLS_MB)
        found = {
            "load_s": max(least[0], float(np.ceil(FACTOR * self.cell_s))),
            "cpu_s": max(least[1], float(np.ceil(FACTOR * self.cpu_s))),
        }
        needed = max(least[2], STEP_MB * int(np.ceil(2 * self.peak_mb / STEP_MB)))
        return found | ({"memory_mb": needed} if needed > USUAL_MB else {})


def assignment_file(notebook: PublishedNotebook, found: Findings) -> str:
    """Return the text of ``assignment.py`` for a published notebook, with what dry runs ``found``."""
    exercises = "".join(_exercises(notebook.taken, notebook.cells, found))
    budgets = found.budgets()
    memory = f"    memory_mb={budgets['memory_mb']},  # MiB of data\n" if "memory_mb" in budgets else ""
    head = HEAD.format(
        title=notebook.title,
        file=notebook.path.name,
        imports="import numpy as np\n\n" if "np.full" in exercises else "",
        quoted_title=quoted(notebook.title),
        quoted_file=quoted(notebook.path.name),
        packages=_tuple("packages", notebook.packages),
        data=_tuple("data", notebook.files),
        load_s=budgets["load_s"],
        cpu_s=budgets["cpu_s"],
        memory=memory,
    )
    return head + exercises


def _tuple(name: str, values: Iterable[str]) -> str:
    listed = ", ".join(map(quoted, values))
    return f"    {name}=({listed},),\n" if listed else ""


def _exercises(taken: Sequence[Placed], cells: Sequence[PublishedCell], found: Findings) -> Iterator[str]:
    used = set[str]()
    for heading, run in groupby(taken, key=lambda placed: placed.heading):
        number, title = exercise_heading(heading)
        number = next(n for n in (number, *map(str, range(1, 1000))) if n and n not in used)
        used.add(number)
        yield f"\n\n@notebook.exercise({quoted(number)}, {quoted(title or 'Checks')})\n"
        yield f"def exercise_{number.replace('.', '_')}(ask):\n"
        for placed in run:
            comment, arguments = _counting(placed, cells, found)
            yield f"    # {comment}\n    ask.line({quoted(placed.call.label)}{arguments})\n"


def _counting(placed: Placed, cells: Sequence[PublishedCell], found: Findings) -> tuple[str, str]:
    """Return the comment above a line, and the arguments that say whether it counts."""
    got, expected = map(_short, placed.call.arguments)
    if placed in found.without_student:
        return GIVEN, ", given=True"
    if (value := found.truths.get(placed)) is not None and (truth := _written(value)):
        if not is_shown(placed, cells):
            return STRONG.format(expected=expected), f", truth={truth}"
        shown = COPIED if placed.call.arguments[0].isidentifier() else SHOWN
        return shown.format(got=got, expected=expected), f", truth={truth}, shown=True"
    hint = HINTS.get(placed.call.kind, OWN_NUMBERS)
    hint = hint.format(got=got, expected=expected or "the expected value")
    return f"self-reported; what makes it count: {hint}", ""


def _short(text: str) -> str:
    words = " ".join(text.split())
    return words if len(words) <= LONGEST else f"{words[:LONGEST]}…"


def _written(value: NDArray[Any]) -> str:
    """Return a truth as Python: numbers, or a function that makes an array of equal ones. "" if it is too
    long.
    """
    if value.size <= MOST_NUMBERS:
        return repr(value.tolist())
    if np.all(value == value.flat[0]):
        return f"lambda: np.full({value.shape}, {value.flat[0].item()!r})"
    return ""


def quoted(text: str) -> str:
    """Return a string literal in the quotes that need fewer escapes, as the formatter writes it."""
    quote = "'" if text.count('"') > text.count("'") else '"'
    return quote + text.replace("\\", "\\\\").replace(quote, f"\\{quote}") + quote
