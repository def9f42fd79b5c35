"""The declaration of an assignment: what is asked about the solutions of one notebook.

``notebook = Notebook("kepler.ipynb")`` names the author's notebook beside the file, which holds text, Setup
and solutions. Each exercise is a function that is called with an ``Ask``.
"""

import functools
import inspect
import re
import sys
import traceback
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from exercises.authoring.ask import Ask
from exercises.authoring.asked import Asked, AskedSolution, DeclarationError
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_motions import AskedAgain, AskedDynamics
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.codes import CODES
from exercises.authoring.draws import Drawing, JointDraw, ListDraw
from exercises.authoring.points import allotted
from exercises.authoring.publishing.publish import Section
from exercises.authoring.questions import author, author_notebook
from exercises.authoring.questions.author_notebook import NUMBER, SEPARATOR, Cell, InvalidNotebook
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution, Solutions
from polhode.kinds import exercise as expand_exercise
from polhode.notebook.names import names_in

Declare = Callable[[Ask], None]


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

    def questions(self) -> list[Question]:
        """Return all questions in the order of the notebook beside the file that declares them."""
        return self._declared(self._folder)[0].questions()

    def errors(self, folder: Path) -> list[str]:
        """Return all errors of the declaration and of the notebook, each with its file and line."""
        try:
            declared, errors = self._declared(folder)
        except InvalidNotebook as error:
            return [str(error)]
        found = [f"assignment.py {error}" for error in errors]
        found += map(_in_declared_words, declared.errors(folder))
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
            stopped = _raised(lambda: exercise.declare(ask), exercise)  # noqa: B023
            errors += stopped
            errors += _errors_of(exercise, ask, cells)
            questions = list[list[Question]]()
            for k, asked in enumerate(ask.asked, 1):
                is_unfinished = bool(stopped) and k == len(ask.asked)
                uses = _uses(asked, earlier)
                failed = (
                    stopped
                    if is_unfinished
                    else _raised(lambda: questions.append(asked.questions(uses)), exercise)  # noqa: B023
                )
                errors += () if is_unfinished else failed
                if isinstance(asked, Asked) and not failed:
                    earlier[asked.solution_name] = asked.solution
            declared.exercise(
                exercise.number,
                exercise.title or _heading(cells, exercise.number) or "",
                *(question for several in questions for question in several),
                *ask.lines,
            )
            sound = not any(question.wrong for several in questions for question in several)
            if exercise.points is not None and sound and len(questions) == len(ask.asked):
                shares = [
                    a.share / len(several)
                    for a, several in zip(ask.asked, questions, strict=True)
                    for _ in several
                ]
                section = _with_points(declared.sections[-1], exercise.points, shares)
                declared.sections[-1] = section
                errors += _without_points(section, exercise)
        return declared, errors


class _WithGivenCells(author.Notebook):
    """A notebook whose Setup contains the constants of given cells behind it."""

    def setup_of(self, cells: list[Cell], names: list[str]) -> str:
        """Return the Setup. Where published cells run as they are, it has none of their constants."""
        if any(section.lines for section in self.sections):
            return super().setup_of(cells, names)
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
    checks = [_last_new(question.id, _check_ids(section, question)) for question in section.questions]
    given = allotted(points, checks, shares)
    return section._replace(
        questions=tuple(
            replace(question, data={**question.data, "points": {id: given[id] for id in ids}})
            for question, ids in zip(section.questions, checks, strict=True)
        )
    )


def _check_ids(section: Section, question: Question) -> list[str]:
    found = expand_exercise(section.number, "", [question.document], True).checks
    return [check.id for check in found]


def _last_new(question: str, checks: list[str]) -> list[str]:
    """Return the ids of a question's checks, those first that are made again with new inputs."""
    return sorted(checks, key=lambda id: not _is_repeated(question, id, checks))


def _is_repeated(question: str, check: str, checks: Collection[str]) -> bool:
    """Return whether a question's check is made again with new inputs, under the id that the kit gives it."""
    return f"{question}-new{check.removeprefix(question)}" in checks


def _without_points(section: Section, exercise: DeclaredExercise) -> Iterator[str]:
    """Yield an error for each question with too few points for what it checks."""
    for question in section.questions:
        points = question.data["points"]
        checked = [id for id in points if not _is_repeated(question.id, id, points)]
        if not all(points[id] for id in checked):
            yield (
                f"line {exercise.line}: points={exercise.points} leaves {sum(points.values())} for"
                f" {question.function}, of which {len(checked)} things are checked: a wrong one would cost"
                " nothing; give more points, or this question a larger share="
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
    pattern = re.compile(rf"exercise\s+{re.escape(number)}(?![\w.]){SEPARATOR}(.*)", re.IGNORECASE)
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
        return [f"line {line}: {_in_words(error)}"]
    return []


def _in_words(error: Exception) -> str:
    """Return the sentence about an exception: what a question has, if the author used another name."""
    text = str(error)
    if isinstance(error, TypeError) and (found := NO_ARGUMENT.fullmatch(text)) and found[1] in ASKING:
        method, name = getattr(ASKING[found[1]], found[2]), found[3]
        has = [p for p in inspect.signature(method).parameters if p not in ("self", "family")]
        where = ELSEWHERE.get(name, f"it has {', '.join(has)}")
        return f"{found[2]} has no argument {name}: {where}"
    if isinstance(error, AttributeError) and type(error.obj) in ASKING.values():
        has = [name for name, value in vars(type(error.obj)).items() if inspect.isfunction(value)]
        has = [name for name in [*has, "mistake"] if not name.startswith("_") and name != "questions"]
        return f"a question of this kind has no {error.name}: it has {', '.join(dict.fromkeys(has))}"
    return f"{type(error).__name__}: {error}"


ASKING: dict[str, Any] = {"Ask": Ask, "Asked": Asked, "AskedSolution": AskedSolution, "AskedCell": AskedCell}
NO_ARGUMENT = re.compile(r"(\w+)\.(\w+)\(\) got an unexpected keyword argument '(\w+)'")
ELSEWHERE = {
    "partial": "it is an argument of @notebook.exercise",
    "points": "it is an argument of @notebook.exercise; share= is the question's part of them",
    "uses": "leave it out, earlier solutions are found by their names in the solution",
    "truth": "decorate the exact answer with @question.truth",
    "agree": "give it to the truth, or call question.agree(…)",
}


def _in_declared_words(error: str) -> str:
    """Return an error of a question in the words of this form of a declaration."""
    for old, new in WORDS:
        error = error.replace(old, new)
    return error


WORDS = (
    ("Tolerance(limit=…, reason=…)", "relative(…, because=…), or at_most for a count"),
    ("Tolerance(rtol=…, atol=…, reason=…)", "close(rtol=…, atol=…, because=…)"),
    ("Tolerance(atol=…, reason=…)", "absolute(…, because=…)"),
    (": stability is ", ": stable_to is "),
    (": stability[1] is ", ": the tolerance of stable_to is "),
    (": order[1] is ", ": the tolerance of order is "),
    ("a motion needs t_end and follow, its tolerance", "a motion needs until= and follow=, its tolerance"),
    ("give rates=, a function", "decorate with @question.rates a function"),
    ("or itself(reason)", "or call is_its_own_truth(because=…)"),
    (", but ask names (", ", but its inputs are ("),
)
