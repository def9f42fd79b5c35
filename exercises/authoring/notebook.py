"""The declaration of an assignment: what is asked about the solutions of one notebook.

``notebook = Notebook("kepler.ipynb")`` names the author's notebook beside the file, which holds text, Setup
and solutions. Each exercise is a function that is called with an ``Ask``.
"""

import functools
import inspect
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from exercises.authoring.ask import Ask
from exercises.authoring.asked import Asked, DeclarationError
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_motions import AskedAgain, AskedDynamics
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.codes import CODES
from exercises.authoring.draws import Drawing, JointDraw, ListDraw
from exercises.authoring.points import allotted
from exercises.authoring.publishing.publish import Section
from exercises.authoring.questions import author, author_notebook
from exercises.authoring.questions.author_notebook import Cell, InvalidNotebook
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution, Solutions
from polhode.kinds import exercise as expand_exercise
from polhode.notebook.names import names_in

Declare = Callable[[Ask], None]
NUMBER = re.compile(r"\d+[a-z]?(\.\d+)*")


@dataclass(frozen=True)
class DeclaredExercise:
    """One exercise function with the arguments of its decorator."""

    number: str
    title: str | None
    points: int | None
    partial: bool
    declare: Declare
    line: int


class Notebook:
    """One notebook's assignment. ``title`` is by default the first heading of the notebook.

    ``packages``, ``data``, ``cpu_s`` and ``load_s`` are those of
    ``exercises.authoring.assignments.assignment.Assignment``.
    """

    def __init__(
        self,
        notebook: str,
        *,
        title: str | None = None,
        version: str = "1",
        packages: tuple[str, ...] = (),
        data: tuple[str, ...] = (),
        cpu_s: float | None = None,
        load_s: float | None = None,
    ) -> None:
        self.notebook, self.title = notebook, title
        self._given: dict[str, Any] = {
            "version": version,
            "packages": packages,
            "data": data,
            "cpu_s": cpu_s,
            "load_s": load_s,
        }
        self._exercises: list[DeclaredExercise] = []

    def draw(self, function: Callable[[Drawing], Any]) -> JointDraw:
        """Decorate a function that draws what belongs together and returns it by name, or a generator
        function that yields all inputs of a question.
        """
        made = ListDraw if inspect.isgeneratorfunction(function) else JointDraw
        return made(function)

    def exercise(
        self, number: str, title: str | None = None, *, points: int | None = None, partial: bool = False
    ) -> Callable[[Declare], Declare]:
        """Decorate the function that says what an exercise asks for.

        ``title`` is by default that of the notebook's heading "Exercise NUMBER". ``points`` are those of the
        whole exercise, divided among its checks by the shares of its questions; by default each check is
        worth one. With ``partial`` a ✗ earns the part of its points that the fraction of right inputs is.
        """
        line = sys._getframe(1).f_lineno

        def decorate(declare: Declare) -> Declare:
            self._exercises.append(DeclaredExercise(number, title, points, partial, declare, line))
            return declare

        return decorate

    def errors(self, folder: Path) -> list[str]:
        """Return all errors of the declaration and of the notebook, each with its file and line."""
        try:
            declared, errors = self._declared(folder)
        except InvalidNotebook as error:
            return [str(error)]
        found = [*(f"assignment.py {error}" for error in errors), *declared.errors(folder)]
        return list(dict.fromkeys(found))

    def assignment(self, folder: Path) -> Assignment:
        """Return the assignment that grading reads, of a declaration without errors."""
        return self._declared(folder)[0].assignment(folder)

    @functools.cache  # noqa: B019
    def _declared(self, folder: Path) -> tuple[author.Notebook, list[str]]:
        """Return the questions of all exercises, and the errors found while they were declared."""
        cells = author_notebook.read(folder / self.notebook)
        solutions, errors = Solutions(cells, folder), list[str]()
        title = self.title or next((text for cell in cells for _, text in cell.headings), None)
        if title is None:
            errors.append(f"the notebook {self.notebook} has no heading: give title=")
        declared = _WithGivenCells(title or "", notebook=self.notebook, **self._given)
        declared.line = 1
        earlier: dict[str, NotebookSolution] = {}
        dynamics: dict[str, AskedDynamics] = {}
        for exercise in self._exercises:
            ask = Ask(solutions, exercise.partial, dynamics)
            errors += _raised(lambda: exercise.declare(ask), exercise)  # noqa: B023
            errors += _errors_of(exercise, ask, cells)
            questions = list[list[Question]]()
            for asked in ask.asked:
                uses = _uses(asked, earlier)
                failed = _raised(lambda: questions.append(asked.questions(uses)), exercise)  # noqa: B023
                errors += failed
                if isinstance(asked, Asked) and not failed:
                    earlier[asked.solution_name] = asked.solution
            declared.exercise(
                exercise.number,
                exercise.title or _heading(cells, exercise.number) or "",
                *(question for several in questions for question in several),
            )
            if exercise.points is not None and len(questions) == len(ask.asked):
                shares = [
                    a.share / len(several)
                    for a, several in zip(ask.asked, questions, strict=True)
                    for _ in several
                ]
                declared.sections[-1] = _with_points(declared.sections[-1], exercise.points, shares)
        return declared, errors


class _WithGivenCells(author.Notebook):
    """A notebook whose Setup contains the constants of given cells behind it."""

    def setup_of(self, cells: list[Cell], names: list[str]) -> str:
        """Return the Setup."""
        return author_notebook.setup_with_constants(cells, names)


def _uses(
    asked: Asked | AskedCell | AskedAgain, earlier: dict[str, NotebookSolution]
) -> list[NotebookSolution]:
    """Return the earlier solutions, functions, that a solution calls."""
    names = names_in(asked.solution.source)
    return [
        solution
        for name, solution in earlier.items()
        if name in names.now | names.later and name != asked.solution_name and solution.is_function
    ]


def _with_points(section: Section, points: int, shares: list[float]) -> Section:
    """Return an exercise whose checks are worth ``points`` together."""
    documents = [question.document for question in section.questions]
    checks = [
        [check.id for check in expand_exercise(section.number, "", [document], True).checks]
        for document in documents
    ]
    given = allotted(points, checks, shares)
    return section._replace(
        questions=tuple(
            replace(question, data={**question.data, "points": {id: given[id] for id in ids}})
            for question, ids in zip(section.questions, checks, strict=True)
        )
    )


def _errors_of(exercise: DeclaredExercise, ask: Ask, cells: list[Cell]) -> Iterator[str]:
    if not NUMBER.fullmatch(exercise.number):
        yield (
            f"line {exercise.line}: {exercise.number!r} is no exercise number: write one such as 2, 2a or 2.1"
        )
    elif exercise.title is None and _heading(cells, exercise.number) is None:
        yield (
            f"line {exercise.line}: the notebook has no heading that begins with Exercise {exercise.number}:"
            " add it, or give title="
        )
    for asked in ask.asked:
        yield from (f"line {error.line}: {error}" for error in asked.errors)
        for mistake in asked.mistakes:
            if mistake.code is not None and mistake.code not in CODES:
                yield (
                    f"line {mistake.line}: there is no diagnosis code {mistake.code}: choose one of"
                    " docs/checks.md, such as missing-term"
                )


def _heading(cells: list[Cell], number: str) -> str | None:
    """Return the title in the heading "Exercise NUMBER — title" of the notebook, None if there is none."""
    pattern = re.compile(rf"exercise\s+{re.escape(number)}(?![\w.])\W*(.*)", re.IGNORECASE)
    found = (pattern.match(text) for cell in cells for _, text in cell.headings)
    return next((match[1] or match[0] for match in found if match), None)


def _raised(declare: Callable[[], object], exercise: DeclaredExercise) -> list[str]:
    """Return what the author's code raised, with the line of the author's file, nothing if it raised
    nothing.
    """
    try:
        declare()
    except DeclarationError as error:
        return [f"line {error.line}: {error}"]
    except Exception as error:
        file = exercise.declare.__code__.co_filename
        own = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
        line = own[-1].lineno if own else exercise.line
        return [f"line {line}: {type(error).__name__}: {error}"]
    return []
