"""The line of a student's file that a check refers to: where the code raised, else where the tested function
is defined.

Definitions are found by their first line, without parsing Python. A notebook's cell is located in the JSON
text that stores it.
"""

import bisect
import json
import re
from json import scanner
from json.decoder import scanstring  # type: ignore[attr-defined]
from typing import Any, cast

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import Outcome
from polhode.notebook.strip_outputs import is_notebook
from polhode.report.student_line import BREAK
from service.formats.check_text import stopped_by
from service.grading.graded_file import GradedFile
from service.grading.submission import cell_name, source_locations

Numbered = list[tuple[int, str]]
"""The lines of a cell, each with its number in the file."""


class SourceLines:
    """The source lines of one file of an assignment."""

    def __init__(self, file: GradedFile, assignment: Assignment) -> None:
        self._scene_ends = file.report.scene_ends if file.report else []
        self._functions = {
            c.id: assignment.scene(c.scenes[0]).function for c in assignment.checks() if c.scenes
        }
        whole = {cell_name(file.file.name): list(enumerate(BREAK.split(file.source), start=1))}
        self._cells = _notebook(file.source) if is_notebook(file.source, file.file.name) else whole

    def line_of(self, outcome: Outcome) -> int | None:
        """Return the line number (from 1) that the outcome refers to, or None if there is none."""
        scene_end = stopped_by(outcome, self._scene_ends)
        for place in reversed(source_locations(scene_end)) if scene_end else ():
            cell = self._cells.get(place.cell, [])
            if 1 <= place.line <= len(cell):
                return cell[place.line - 1][0]
        return self._defined(self.function(outcome))

    def function(self, outcome: Outcome) -> str:
        """Return the function that the check tests, or "" if the assignment no longer has the check."""
        return self._functions.get(outcome.id, "")

    def _defined(self, name: str) -> int | None:
        """Return the line of the last unindented definition of ``name``, else of the last definition."""
        begins = re.compile(
            rf"([ \t]*)(?:(?:async[ \t]+)?def[ \t]+{re.escape(name)}[ \t]*\(|{re.escape(name)}[ \t]*=(?!=))"
        )
        lines = [line for cell in self._cells.values() for line in cell] if name else []
        found = [(not match[1], number) for number, line in lines if (match := begins.match(line))]
        return max(found)[1] if found else None


class _PositionedStr(str):
    """A string of a JSON text with its position ``at``."""

    at: int


def _notebook(source: str) -> dict[str, Numbered]:
    """Return the lines of each code cell, keyed by its name in tracebacks; empty if the source is no
    notebook.
    """
    try:
        notebook = _PositionDecoder().decode(source)
        code = [_pieces(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    except (ValueError, LookupError, TypeError, RecursionError):
        return {}
    ends = [end.start() for end in re.finditer("\n", source)]
    return {f"cell {number}": _in_file(pieces, ends) for number, pieces in enumerate(code, start=1)}


def _pieces(source: Any) -> list[_PositionedStr]:
    pieces = [source] if isinstance(source, str) else list(source)
    if not all(isinstance(piece, _PositionedStr) for piece in pieces):
        raise TypeError("a cell's source is text")
    return cast(list[_PositionedStr], pieces)


def _in_file(pieces: list[_PositionedStr], ends: list[int]) -> Numbered:
    """Return the lines of a cell, each numbered by the file line on which its JSON string begins. ``ends``
    are the file's line ends.
    """
    begins, whole = [], ""
    for piece in pieces:
        begins.append(len(whole))
        whole += piece
    starts = [0, *(end.end() for end in BREAK.finditer(whole))]
    holders = [pieces[bisect.bisect_right(begins, start) - 1] if pieces else None for start in starts]
    numbers = [bisect.bisect_left(ends, piece.at) + 1 if piece is not None else 1 for piece in holders]
    return list(zip(numbers, BREAK.split(whole), strict=True))


class _PositionDecoder(json.JSONDecoder):
    """Python's JSON decoder, returning strings with their positions."""

    def __init__(self) -> None:
        super().__init__()
        self.parse_string = _scan_string
        self.scan_once = scanner.py_make_scanner(self)  # type: ignore[attr-defined]


def _scan_string(source: str, begin: int, strict: bool) -> tuple[_PositionedStr, int]:
    value, end = scanstring(source, begin, strict)
    text = _PositionedStr(value)
    text.at = begin
    return text, end
