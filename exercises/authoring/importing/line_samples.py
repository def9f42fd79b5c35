"""Samples that follow from a notebook's own lines: the untouched notebook, one that copies the shown values,
and the author's solutions.
"""

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.reported_lines import Line, reported_lines
from polhode.judging.outcome import Outcome
from polhode.judging.verdict import Verdict
from polhode.notebook.cell_to_python import statements_of
from polhode.report.report import Report

UNTOUCHED, COPIED, SOLVED = "untouched.ipynb", "copied_values.ipynb", "your_solutions.ipynb"


@dataclass(frozen=True)
class LineSample:
    """A notebook with its name. If it is ``right``, all lines must be ✓; else none that counts, other than
    those that the author accepts although their values are shown.
    """

    name: str
    source: str
    lines: Mapping[str, Line]
    right: bool = False

    def unexpected(self, report: Report) -> Iterator[str]:
        """Yield a sentence for each line that is not as it must be."""
        for outcome in (one for one in report.outcomes() if one.id in self.lines):
            line, passed = self.lines[outcome.id], outcome.verdict is Verdict.PASS
            if self.right and not passed:
                yield f"{outcome.line}{f' ({outcome.cause})' if outcome.cause else ''}"
            elif passed and not self.right:
                yield from self._wrongly_passed(outcome, line)

    def _wrongly_passed(self, outcome: Outcome, line: Line) -> Iterator[str]:
        if self.name == UNTOUCHED and not line.given:
            yield f"line {line.line}: {outcome.label} is ✓ without any student's code: write given=True"
        elif self.name == COPIED and line.counts and not line.accept:
            yield f"line {line.line}: {outcome.label} counts, and copying the shown values makes it ✓"


def line_samples(assignment: Assignment) -> Iterator[LineSample]:
    """Yield the samples of an assignment with lines. The author's solutions are those in the notebook and in
    samples/right_*.ipynb.
    """
    checks = reported_lines(assignment.checks())
    lines = {check.id: check.declared for check in checks}
    yield LineSample(UNTOUCHED, assignment.notebook(), lines)
    copied = defaultdict[str, list[str]](list)
    for check in checks:
        got = check.call.arguments[0]
        if check.declared.shown and got.isidentifier():
            value = f"{got} = __import__('numpy').array({check.truth().tolist()!r})"
            copied[_students_cell(assignment, check.cell)].append(value)
    if copied:
        sources = {name: "\n".join(values) for name, values in copied.items()}
        yield LineSample(COPIED, _filled(assignment, sources), lines)
    if (solved := solved_notebook(assignment)) is not None:
        yield LineSample(SOLVED, solved, lines, right=True)
    for path in right_notebooks(assignment.folder):
        yield LineSample(path.name, path.read_text(encoding="utf-8"), lines, right=True)


def right_notebooks(folder: Path) -> list[Path]:
    """Return the solved notebooks among an assignment's samples."""
    return sorted((folder / "samples").glob("right_*.ipynb"))


def solved_notebook(assignment: Assignment) -> str | None:
    """Return the published notebook with the author's solutions, None if its solution cells are empty."""
    own = {cell.name: cell.source for cell in assignment.published if not cell.is_given}
    return _filled(assignment, own) if any(map(statements_of, own.values())) else None


def _students_cell(assignment: Assignment, given: str) -> str:
    """Return the name of the last cell above a given one that students fill in, or of the first of all."""
    names = [cell.name for cell in assignment.published]
    own = [cell.name for cell in assignment.published if not cell.is_given]
    above = [name for name in own if names.index(name) < names.index(given)]
    return next(reversed(above), "")


def _filled(assignment: Assignment, sources: Mapping[str, str]) -> str:
    """Return the published cells as a notebook with ``sources`` in those that students fill in, by name; what
    has the name "" comes first.
    """
    cells = [("", sources[""])] if "" in sources else []
    for cell in assignment.published:
        cells.append((cell.id, cell.source if cell.is_given else sources.get(cell.name, "")))
    made: list[dict[str, Any]] = [
        {"cell_type": "code", "metadata": {}, "source": source, "outputs": [], "execution_count": None}
        | ({"id": id} if id else {})
        for id, source in cells
    ]
    return json.dumps({"cells": made, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
