"""The questions of all exercises that a ``Notebook`` declares, and the assignment that grading reads."""

import functools
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exercises.authoring.assignments.assignment import Assignment, Sweep
from exercises.authoring.importing.reported_lines import Line
from exercises.authoring.importing.self_reported_checks import (
    line_errors,
    published_cells,
    reported_exercises,
)
from exercises.authoring.importing.validation_words import course_packages, course_words
from exercises.authoring.publishing import publish
from exercises.authoring.publishing.publish import Section
from exercises.authoring.questions import author_notebook
from exercises.authoring.questions.author_notebook import Cell
from exercises.authoring.questions.question import Question
from exercises.authoring.questions.question_errors import question_errors
from polhode.kinds import exercise as expand_exercise

if TYPE_CHECKING:
    from exercises.authoring.mutants.solution import Variant
    from exercises.authoring.mutants.variants import MadeSample

PLAYS = "\nfrom polhode.kinds import adopt, play\n"
"""The functions that play the scenes of questions, which are data."""


@dataclass
class Declaration:
    """The questions about the ``cells`` of one ``notebook`` in ``folder``.

    ``given`` are the version, packages, data files and limits of the ``Assignment``.
    """

    title: str
    folder: Path
    notebook: str
    cells: list[Cell]
    given: dict[str, Any]
    sections: list[Section] = field(default_factory=list)

    def add(self, number: str, title: str, questions: list[Question], lines: list[Line]) -> Section:
        """Add an exercise of questions, and of lines that the notebook's validation cells print."""
        names = [question.function for question in questions]
        unique = len(names) == len(set(names)) > 1
        ids = [f"{number}-{name}" if unique else f"{number}-{k}" for k, name in enumerate(names, 1)]
        ids = [number] if len(names) == 1 else ids
        identified = tuple(replace(q, id=id, number=number) for q, id in zip(questions, ids, strict=True))
        self.sections.append(Section(number, title, identified, tuple(lines)))
        return self.sections[-1]

    def questions(self) -> list[Question]:
        """Return the questions of all exercises in order."""
        return [question for section in self.sections for question in section.questions]

    def errors(self) -> list[str]:
        """Return the errors of all questions and of the author's notebook, each with its file."""
        declared = [error for question in self.questions() for error in question_errors(question)]
        declared += line_errors(self.cells, self.sections, course_words(self.folder))
        found = [f"assignment.py {error}" for error in declared]
        return [*found, *(f"{self.notebook}: {error}" for error in author_notebook.errors(self.cells))]

    def assignment(self) -> Assignment:
        """Return the assignment that grading reads, of a declaration without errors. Runs nothing of the
        author's solutions.
        """
        slug, words = self.folder.name.replace("_", "-"), course_words(self.folder)
        documents = {s.number: tuple(question.document for question in s.questions) for s in self.sections}
        expanded = [expand_exercise(s.number, s.title, documents[s.number], True) for s in self.sections]
        return Assignment(
            slug=slug,
            title=self.title,
            folder=self.folder,
            scenes=tuple(scene for question in self.questions() for scene in question.scenes()),
            exercises=tuple(reported_exercises(expanded, self.cells, self.sections, words)),
            published=published_cells(self.cells, self._names(), words) if self._has_lines() else (),
            setup=self._setup(),
            plays=PLAYS if self.questions() else "",
            sweeps=self._sweeps(),
            notebook=functools.cache(
                lambda: publish.published(slug, self.cells, self.sections, course_packages(self.folder))
            ),
            variants=functools.cache(self._variants),
            pairs=functools.cache(self._pairs),
            source_before=lambda id: self._with_source_before(id)[1],
            made_samples=self._made_samples,
            questions={number: asked for number, asked in documents.items() if asked},
            **self.given,
        )

    def _has_lines(self) -> bool:
        return any(section.lines for section in self.sections)

    def _names(self) -> list[str]:
        return [name for section in self.sections for name in section.names]

    def _setup(self) -> str:
        """Return the Setup, with the constants of given cells behind it unless the published cells run as
        they are.
        """
        if self._has_lines():
            return author_notebook.setup(self.cells, self._names())
        return author_notebook.setup_with_constants(self.cells, self._names())

    def _sweeps(self) -> tuple[Sweep, ...]:
        """Return the chart of speed against accuracy of each question that has one, with the others of its
        kind behind it.
        """
        charted = [(q.sweep, q) for q in self.questions() if q.sweep]
        same = {kind: [q for _, q in charted if q.kind == kind] for kind in {q.kind for _, q in charted}}
        return tuple(sweep([q, *(other for other in same[q.kind] if other is not q)]) for sweep, q in charted)

    # The modules of mistakes are imported when they are needed: grading a right submission needs none of
    # them.

    def _made_samples(self) -> "Iterable[MadeSample]":
        from exercises.authoring.mutants.variants import made_samples

        made = made_samples(self._numbered(), self.folder / self.notebook) if self.questions() else ()
        return (one for one in made if not (self.folder / "samples" / one.name).is_file())

    def _variants(self, id: str) -> "list[Variant]":
        from exercises.authoring.mutants.variants import variants_of

        return variants_of(*self._with_source_before(id))

    def _pairs(self, id: str) -> "list[Variant]":
        from exercises.authoring.mutants.variants import pairs_of

        return pairs_of(*self._with_source_before(id))

    def _numbered(self) -> list[tuple[str, Question]]:
        return [(section.number, question) for section in self.sections for question in section.questions]

    def _with_source_before(self, id: str) -> tuple[Question, str]:
        """Return the question ``id`` and the source of the right solutions of those before it."""
        from exercises.authoring.mutants.variants import source_before

        numbered = self._numbered()
        k = next(k for k, (_, question) in enumerate(numbered) if question.id == id)
        return numbered[k][1], source_before(numbered, k)
