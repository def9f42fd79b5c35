"""The declaration that a course author writes: one ``assignment.py`` for each notebook.

The file makes one ``Notebook`` and adds its exercises, each of one or more questions. The functions of
``exercises.authoring.kinds`` make the questions.
"""

import functools
import inspect
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exercises.authoring.assignments.assignment import Assignment, Sweep
from exercises.authoring.importing.lines import Line
from exercises.authoring.importing.validation_cells import line_errors, published_cells, reported_exercises
from exercises.authoring.importing.words import course_packages, course_words
from exercises.authoring.publishing import publish
from exercises.authoring.publishing.publish import Section
from exercises.authoring.questions import author_notebook
from exercises.authoring.questions.author_notebook import Cell, InvalidNotebook
from exercises.authoring.questions.declared import Draw, Family, Itself, Mistake, Value
from exercises.authoring.questions.question import Question
from exercises.authoring.questions.question_errors import question_errors, uses_errors
from polhode.judging.outcome import Tolerance
from polhode.kinds import exercise as expand_exercise

if TYPE_CHECKING:
    from exercises.authoring.mutants.mistakes import MadeSample
    from exercises.authoring.mutants.solution import Variant

__all__ = [
    "Notebook",
    "Tolerance",
    "Value",
    "choice",
    "family",
    "integers",
    "itself",
    "mistake",
    "uniform",
]


PLAYS = "\nfrom polhode.kinds import adopt, play\n"
"""The functions that play the scenes of questions, which are data."""


def uniform(low: float, high: float, *shape: int) -> Draw:
    """Return a draw of a number, or of an array of ``shape``, between ``low`` and ``high``."""
    return lambda rng: rng.uniform(low, high, shape or None)


def integers(low: int, high: int, *shape: int) -> Draw:
    """Return a draw of an integer, or of an array of ``shape``, from ``low`` to ``high`` inclusive."""
    return lambda rng: rng.integers(low, high, size=shape or None, endpoint=True)


def choice(*values: Any) -> Draw:
    """Return a draw of one of these ``values``."""
    return lambda rng: values[rng.integers(len(values))]


def family(text: str, *over: str, **given: Any) -> Family:
    """Return a function argument: the expression ``text`` over the variables ``over``.

    ``given`` are its parameters: constants, or draws. The expression may use the functions of
    ``polhode.kinds.asking.MATHEMATICS``.

    >>> family("E - e*sin(E) - M", "E", M=uniform(0.01, 3.1), e=0.3).over
    ('E',)
    """
    return Family(text, over, given)


def mistake(old: str, new: str, code: str | None = None, sentence: str = "") -> Mistake:
    """Return a known wrong answer: the right solution with ``old`` replaced by ``new`` in its source.

    ``code`` is a diagnosis code and ``sentence`` says what the student did. Without them the mistake is a
    sample only.
    """
    return Mistake(old, new, code, sentence, sys._getframe(1).f_lineno)


def itself(reason: str) -> Itself:
    """Return the declaration that nothing but the right solution can be its truth, and why."""
    return Itself(reason)


@dataclass
class Notebook:
    """One notebook's assignment. ``notebook`` is the author's notebook beside the file, with all texts and
    the Setup cells.

    ``setup`` replaces the Setup cell where there is no notebook. ``packages``, ``cpu_s``, ``load_s``,
    ``memory_mb`` and ``data`` are those of ``Assignment``.
    """

    title: str
    notebook: str | None = None
    setup: str | None = None
    version: str = "1"
    packages: tuple[str, ...] = ()
    cpu_s: float | None = None
    data: tuple[str, ...] = ()
    load_s: float | None = None
    memory_mb: int | None = None
    sections: list[Section] = field(default_factory=list)
    line: int = 0

    def __post_init__(self) -> None:
        self.line = sys._getframe(2).f_lineno

    def exercise(self, number: str, title: str, *asked: Question | Line) -> None:
        """Add an exercise of questions, and of lines that the notebook's validation cells print."""
        questions = [one for one in asked if isinstance(one, Question)]
        lines = tuple(one for one in asked if isinstance(one, Line))
        names = [question.function for question in questions]
        unique = len(names) == len(set(names)) > 1
        ids = [f"{number}-{name}" if unique else f"{number}-{k}" for k, name in enumerate(names, 1)]
        ids = [number] if len(names) == 1 else ids
        identified = tuple(replace(q, id=id, number=number) for q, id in zip(questions, ids, strict=True))
        self.sections.append(Section(number, title, identified, lines=lines))

    def questions(self) -> list[Question]:
        """Return the questions of all exercises in order."""
        return [question for section in self.sections for question in section.questions]

    def errors(self, folder: Path) -> list[str]:
        """Return the errors of all questions and of the author's notebook, each with its file."""
        questions = self.questions()
        declared = [error for question in questions for error in question_errors(question)]
        declared += [
            error for k, question in enumerate(questions) for error in uses_errors(question, questions[:k])
        ]
        if self.notebook and self.setup is not None:
            declared.append(
                f"line {self.line}: both notebook= and setup= are given: the Setup is the notebook's; remove"
                " setup="
            )
        found = [f"assignment.py {error}" for error in declared]
        try:
            cells = self._cells(folder)
        except InvalidNotebook as error:
            return [*found, str(error)]
        functions = [q for q in questions if inspect.isfunction(q.solution) and not q.variables]
        parameters = {q.function: list(inspect.signature(q.solution).parameters) for q in functions}
        wrong = author_notebook.errors(cells, self._names(), parameters) if cells else ()
        found += [
            f"assignment.py {error}" for error in line_errors(cells, self.sections, course_words(folder))
        ]
        return [*found, *(f"{self.notebook}: {error}" for error in wrong)]

    def assignment(self, folder: Path) -> Assignment:
        """Return the assignment that grading reads, of a declaration without errors. Runs nothing of the
        author's solutions.
        """
        slug, cells = folder.name.replace("_", "-"), self._cells(folder)
        setup = self.setup_of(cells, self._names()) if cells else self.setup or ""
        documents = {s.number: tuple(question.document for question in s.questions) for s in self.sections}
        expanded = [expand_exercise(s.number, s.title, documents[s.number], True) for s in self.sections]
        return Assignment(
            slug=slug,
            title=self.title,
            version=self.version,
            folder=folder,
            scenes=tuple(scene for question in self.questions() for scene in question.scenes()),
            exercises=tuple(reported_exercises(expanded, cells, self.sections, course_words(folder))),
            published=(
                published_cells(cells, self._names(), course_words(folder))
                if any(section.lines for section in self.sections)
                else ()
            ),
            setup=setup,
            plays=PLAYS if self.questions() else "",
            packages=self.packages,
            cpu_s=self.cpu_s,
            data=self.data,
            load_s=self.load_s,
            memory_mb=self.memory_mb,
            sweeps=self._sweeps(),
            notebook=functools.cache(
                lambda: publish.published(
                    slug,
                    cells or publish.plain(self.title, setup, self.sections),
                    self.sections,
                    course_packages(folder),
                )
            ),
            variants=functools.cache(self._variants),
            pairs=functools.cache(self._pairs),
            source_before=lambda id: self._with_source_before(id)[1],
            made_samples=lambda: self._made_samples(folder),
            questions={number: asked for number, asked in documents.items() if asked},
        )

    def setup_of(self, cells: list[Cell], names: list[str]) -> str:
        """Return the Setup of a notebook whose solutions are ``names``."""
        return author_notebook.setup(cells, names)

    def _sweeps(self) -> tuple[Sweep, ...]:
        """Return the chart of speed against accuracy of each question that has one, with the others of its
        kind behind it.
        """
        charted = [(q.sweep, q) for q in self.questions() if q.sweep]
        same = {kind: [q for _, q in charted if q.kind == kind] for kind in {q.kind for _, q in charted}}
        return tuple(sweep([q, *(other for other in same[q.kind] if other is not q)]) for sweep, q in charted)

    def _cells(self, folder: Path) -> list[Cell]:
        """Return the cells of the author's notebook, none without one. Raises InvalidNotebook."""
        return author_notebook.read(folder / self.notebook) if self.notebook else []

    def _names(self) -> list[str]:
        return [name for section in self.sections for name in section.names]

    def _numbered(self) -> list[tuple[str, Question]]:
        return [(section.number, question) for section in self.sections for question in section.questions]

    # The modules of mistakes are imported when they are needed: grading a right submission needs none of
    # them.

    def _made_samples(self, folder: Path) -> "Iterable[MadeSample]":
        from exercises.authoring.mutants.mistakes import made_samples

        notebook = folder / self.notebook if self.notebook else None
        made = made_samples(self._numbered(), notebook) if self.questions() else ()
        return (one for one in made if not (folder / "samples" / one.name).is_file())

    def _variants(self, id: str) -> "list[Variant]":
        from exercises.authoring.mutants.mistakes import variants_of

        return variants_of(*self._with_source_before(id))

    def _pairs(self, id: str) -> "list[Variant]":
        from exercises.authoring.mutants.mistakes import pairs_of

        return pairs_of(*self._with_source_before(id))

    def _with_source_before(self, id: str) -> tuple[Question, str]:
        """Return the question ``id`` and the source of the right solutions of those before it."""
        from exercises.authoring.mutants.mistakes import source_before

        numbered = self._numbered()
        k = next(k for k, (_, question) in enumerate(numbered) if question.id == id)
        return numbered[k][1], source_before(numbered, k)
