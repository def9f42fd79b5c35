"""Lines of a published notebook's validation cells, as checks.

The server runs the published cells in place of the student's copies. The arguments of each ``validate`` call
leave the sandbox as data and are judged again. The student's code computed them, so a line is self-reported
and carries no points until the author names a truth or trusts it.
"""

import builtins
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.importing.reported_lines import NOTEBOOK, TRUTH, Line, ReportedLine
from exercises.authoring.importing.validation_calls import Call, calls
from exercises.authoring.importing.validation_words import Words
from exercises.authoring.questions.author_notebook import INSTALL, Cell
from polhode.judging.checks import Check
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Judgement
from polhode.notebook.cell_to_python import python_of, statements_of

WITHIN_EXERCISE = re.compile(r"(validation|solution)\b", re.IGNORECASE)
LINE = "-line-"  # in the id of each line's check


def published_cells(cells: Sequence[Cell], names: Sequence[str], words: Words) -> tuple[PublishedCell, ...]:
    """Return the code cells of the published notebook. Those that the student fills in are tagged as
    solutions or bind a name of ``names``.
    """
    code = [cell for cell in cells if cell.kind == "code" and INSTALL not in cell.tags]
    return tuple(
        PublishedCell(
            f"published cell {number}",
            cell.source,
            _is_given(cell, names),
            cell.id,
            bool(calls(cell.source, words)),
        )
        for number, cell in enumerate(code, 1)
    )


def _is_given(cell: Cell, names: Sequence[str]) -> bool:
    """Return whether the student leaves the cell as it is: it is no solution, and contains more than
    comments.
    """
    is_comment = python_of(cell.source) is not None and not statements_of(cell.source)
    return not (is_comment or cell.is_solution(names))


class Placed(NamedTuple):
    """A call in a published cell, with the text of the heading above it."""

    cell: PublishedCell
    call: Call
    heading: str


def placed_calls(cells: Sequence[Cell], published: Sequence[PublishedCell], words: Words) -> Iterator[Placed]:
    """Yield the validation calls of the given cells in order.
    Headings such as "Validation 2" or "Solution" do not count.
    """
    heading, code = "", iter(published)
    for cell in cells:
        heading = next(
            (text for _, text in reversed(cell.headings) if not WITHIN_EXERCISE.match(text)), heading
        )
        if cell.kind == "code" and INSTALL not in cell.tags and (one := next(code)).is_given:
            yield from (Placed(one, call, heading) for call in calls(one.source, words))


def line_errors(cells: Sequence[Cell], sections: Sequence[Any], words: Words) -> Iterator[str]:
    """Yield an error for each line that the notebook does not have in that order, or that cannot count."""
    lines = [line for section in sections for line in section.lines]
    published = published_cells(cells, (), words) if lines else ()
    left = [placed.call for placed in placed_calls(cells, published, words)] if lines else []
    for line in lines:
        call = next((call for call in left if call.label == line.label), None)
        if call is None:
            yield (
                f"line {line.line}: no validation cell has, after the lines before, the label {line.label!r}"
            )
            continue
        left = left[left.index(call) + 1 :]
        if line.given and (line.trust or line.truth is not None):
            yield (
                f"line {line.line}: with given=True it is ✓ without any student's code, so it cannot count:"
                " remove truth= and trust="
            )
        if not (line.truth is None or TRUTH.holds(line.truth)):
            yield f"line {line.line}: truth is {line.truth!r}; it must be {TRUTH.text}"
        if line.truth is not None and call.kind != "close":
            remedy = "use trust=True, or ask a question"
            yield (
                f"line {line.line}: validate.{call.kind} has no expected value that truth= could replace:"
                f" {remedy}"
            )
        elif line.truth is not None and call.computed:
            remedy = "write it there as a number, or ask a question"
            widened = f"the validation cell computes {call.computed[0]}, which the student's code could widen"
            yield f"line {line.line}: {widened}: {remedy}"


def reported_exercises(
    exercises: Iterable[Exercise], cells: Sequence[Cell], sections: Sequence[Any], words: Words
) -> Iterator[Exercise]:
    """Yield the exercises with their lines as checks. The student defines the names that their cells read."""
    if not any(section.lines for section in sections):
        yield from exercises
        return
    names = [name for section in sections for name in section.names]
    published = published_cells(cells, names, words)
    left = list(placed_calls(cells, published, words))
    for exercise, section in zip(exercises, sections, strict=True):
        checks, used = list[Check](), list[PublishedCell]()
        for k, line in enumerate(section.lines, 1):
            at = next(k for k, placed in enumerate(left) if placed.call.label == line.label)
            (cell, call, _), left = left[at], left[at + 1 :]
            used.append(cell)
            checks.append(_check(f"{exercise.number}{LINE}{k}", line, cell, call))
        read = tuple(name for name in read_names(published, used) if name not in exercise.functions)
        yield replace(
            exercise,
            functions=(*exercise.functions, *read),
            variables=(*exercise.variables, *read),
            checks=(*exercise.checks, *checks),
        )


def _check(id: str, line: Line, cell: PublishedCell, call: Call) -> ReportedLine:
    def word(seen: Any, truth: Any) -> Judgement:
        raise NotImplementedError

    reason = NOTEBOOK if line.counts else f"{NOTEBOOK}; {line.status.value}"
    points = line.points if line.counts else 0
    return ReportedLine(
        id,
        line.label,
        (),
        word,
        Tolerance(reason=reason),
        points=points,
        cell=cell.name,
        call=call,
        declared=line,
    )


def read_names(cells: Sequence[PublishedCell], used: Sequence[PublishedCell]) -> list[str]:
    """Return the names that the cells ``used`` read and that no given cell binds: the student must define
    them.
    """
    given = {
        name for cell in cells if cell.is_given for s in statements_of(cell.source) for name in s.names.bound
    }
    read = [
        name
        for cell in used
        for s in statements_of(cell.source)
        for name in sorted(s.names.now | s.names.later)
    ]
    return [name for name in dict.fromkeys(read) if name not in given and not hasattr(builtins, name)]
