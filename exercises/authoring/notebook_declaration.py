"""The declaration of an assignment: what is asked about the solutions of one notebook.

``notebook = Notebook("kepler.ipynb")`` names the author's notebook beside the file, which holds text, Setup
and solutions. Each exercise is a function that is called with an ``Ask``.
"""

import functools
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from types import FunctionType
from typing import Any, TypeGuard

from exercises.authoring.ask import Ask
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_motions import AskedAgain, AskedDynamics
from exercises.authoring.asked_solution import Asked
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.declaration import Declaration
from exercises.authoring.declaration_errors import raised
from exercises.authoring.diagnosis_codes import CODES
from exercises.authoring.draws import Drawing, JointDraw, ListDraw
from exercises.authoring.points import with_points, without_points
from exercises.authoring.questions import author_notebook
from exercises.authoring.questions.author_notebook import NUMBER, SEPARATOR, Cell, InvalidNotebook
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution, Solutions
from polhode.notebook.names import names_in


@dataclass(frozen=True)
class DeclaredExercise:
    """One exercise function with the arguments of its decorator."""

    number: str
    title: str | None
    points: int | None
    partial: bool
    declare: FunctionType
    line: int


class Notebook:
    """The assignment about one ``notebook``, a file beside the declaration.

    ``title`` is by default the first heading of the notebook. Reports name the ``version``. ``packages`` are
    distributions that submissions import besides numpy, scipy and matplotlib, ``data`` files of the folder
    that they read. A grading may use ``cpu_s`` of CPU time, and each cell ``load_s``; a submission's data may
    take ``memory_mb`` MiB.
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
        memory_mb: int | None = None,
    ) -> None:
        self.notebook, self.title = notebook, title
        self._folder = Path(sys._getframe(1).f_code.co_filename).parent
        self._given: dict[str, Any] = {
            "version": version,
            "packages": packages,
            "data": data,
            "cpu_s": cpu_s,
            "load_s": load_s,
            "memory_mb": memory_mb,
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
    ) -> Callable[[FunctionType], FunctionType]:
        """Decorate the function that says what an exercise asks for.

        ``title`` is by default that of the notebook's heading "Exercise NUMBER". ``points`` are those of the
        whole exercise, divided among its checks by the shares of its questions; by default each check is
        worth one. With ``partial`` a ✗ earns the part of its points that the fraction of right inputs is.
        """
        line = sys._getframe(1).f_lineno

        def decorate(declare: FunctionType) -> FunctionType:
            self._exercises.append(DeclaredExercise(number, title, points, partial, declare, line))
            return declare

        return decorate

    def questions(self) -> list[Question]:
        """Return all questions in the order of the notebook beside the file that declares them."""
        return self._declared(self._folder)[0].questions()

    def errors(self, folder: Path) -> list[str]:
        """Return all errors of the declaration and of the notebook, each with its file and line."""
        try:
            declared, errors = self._declared(folder)
        except InvalidNotebook as error:
            return [str(error)]
        return list(dict.fromkeys([*errors, *declared.errors()]))

    def assignment(self, folder: Path) -> Assignment:
        """Return the assignment that grading reads, of a declaration without errors."""
        return self._declared(folder)[0].assignment()

    @functools.cache  # noqa: B019
    def _declared(self, folder: Path) -> tuple[Declaration, list[str]]:
        """Return the questions of all exercises, and the errors found while they were declared."""
        cells, errors = author_notebook.read(folder / self.notebook), list[str]()
        title = self.title or next((text for cell in cells for _, text in cell.headings), None)
        if title is None:
            errors.append(f"assignment.py: the notebook {self.notebook} has no heading: give title=")
        declared = Declaration(title or "", folder, self.notebook, cells, self._given)
        exercises = _Exercises(declared, Solutions(cells, folder))
        for exercise in self._exercises:
            errors += (f"assignment.py {error}" for error in exercises.declare(exercise))
        return declared, errors


@dataclass
class _Exercises:
    """Exercises as they are declared one after the other: each sees the solutions and motions of earlier
    ones.
    """

    declared: Declaration
    solutions: Solutions
    earlier: dict[str, NotebookSolution] = field(default_factory=dict)
    dynamics: dict[str, AskedDynamics] = field(default_factory=dict)

    def declare(self, exercise: DeclaredExercise) -> list[str]:
        """Add the questions of an exercise and return its errors."""
        ask = Ask(self.solutions, exercise.partial, self.dynamics)
        stopped = raised(lambda: exercise.declare(ask), exercise.declare)
        errors = [*stopped, *_errors_of(exercise, ask, self.declared.cells)]
        questions = list[list[Question]]()
        # the last question is unfinished if the function stopped
        for asked in ask.asked[:-1] if stopped else ask.asked:
            uses = self._used_by(asked)
            failed = raised(lambda: questions.append(asked.questions(uses)), exercise.declare)  # noqa: B023
            errors += failed
            if isinstance(asked, Asked) and not failed:
                self.earlier[asked.solution_name] = asked.solution
        title = exercise.title or _heading(self.declared.cells, exercise.number) or ""
        every = [question for several in questions for question in several]
        section = self.declared.add(exercise.number, title, every, ask.lines)
        is_sound = len(questions) == len(ask.asked) and not any(question.wrong for question in every)
        if _is_count(exercise.points) and is_sound:
            pairs = zip(ask.asked, questions, strict=True)
            shares = [asked.share / len(several) for asked, several in pairs for _ in several]
            section = with_points(section, exercise.points, shares)
            self.declared.sections[-1] = section
            errors += (f"line {exercise.line}: {error}" for error in without_points(section, exercise.points))
        return errors

    def _used_by(self, asked: Asked | AskedCell | AskedAgain) -> list[NotebookSolution]:
        """Return the earlier solutions, functions, that a solution calls."""
        names = names_in(asked.solution.source)
        return [
            solution
            for name, solution in self.earlier.items()
            if name in names.now | names.later and name != asked.solution_name and solution.is_function
        ]


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
    if exercise.points is not None and not _is_count(exercise.points):
        yield f"line {exercise.line}: points is {exercise.points!r}; it must be an integer ≥ 1"
    if exercise.partial and exercise.points is None:
        yield f"line {exercise.line}: partial=True divides points: give points= too"
    for asked in ask.asked:
        yield from (f"line {error.line}: {error}" for error in asked.errors)
        for mistake in asked.mistakes:
            if mistake.code is not None and mistake.code not in CODES:
                alike = get_close_matches(mistake.code, sorted(CODES)) or ["missing-term"]
                yield (
                    f"line {mistake.line}: there is no diagnosis code {mistake.code}: choose one, such as"
                    f" {' or '.join(alike)}"
                )


def _is_count(points: int | None) -> TypeGuard[int]:
    return isinstance(points, int) and points >= 1


def _heading(cells: list[Cell], number: str) -> str | None:
    """Return the title in the heading "Exercise NUMBER — title" of the notebook, None if there is none."""
    pattern = re.compile(rf"exercise\s+{re.escape(number)}(?![\w.]){SEPARATOR}(.*)", re.IGNORECASE)
    found = (pattern.match(text) for cell in cells for _, text in cell.headings)
    return next((match[1] or match[0] for match in found if match), None)
