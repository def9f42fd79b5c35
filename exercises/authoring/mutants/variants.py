"""What follows from the mistakes of a declaration: variants of the right solution that predict numbers, and
samples.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from exercises.authoring.assignments.samples import codes
from exercises.authoring.importing.self_reported_checks import LINE
from exercises.authoring.mutants.mutation import pairs, variants
from exercises.authoring.mutants.solution import Variant
from exercises.authoring.portable_source import WrittenMistake
from exercises.authoring.questions.author_arguments import Mistake
from exercises.authoring.questions.question import Question
from polhode.judging.verdict import Verdict


def variants_of(question: Question, before: str) -> list[Variant]:
    """Return the right solution itself, then each mistake and each one-place change of it, behind the source
    ``before``.
    """
    right = question.source
    declared = [
        Variant("", "", right),
        *(Variant(m.code or "", m.sentence, m.source(right)) for m in question.mistakes),
    ]
    made = [*(replace(v, declared=True) for v in declared), *variants(right)]
    return [replace(v, source=f"{before}\n\n{v.source}") for v in made]


def pairs_of(question: Question, before: str) -> list[Variant]:
    """Return the right solution, then those with two changes, behind the source ``before``."""
    made = [Variant("", "", question.source), *pairs(question.source)]
    return [replace(v, source=f"{before}\n\n{v.source}") for v in made]


UNSEEN = "every check is ✓: the mistake changes nothing that the checks see"


@dataclass(frozen=True)
class MadeSample:
    """A sample made from the declaration: all right solutions, those up to one question with one of its
    mistakes, or the author's notebook.

    ``ask`` are its exercises. A wrong sample fails at least one check, and its report has ``code``, if the
    mistake has one.
    """

    name: str
    source: str
    ask: tuple[str, ...]
    right: bool
    code: str | None = None

    @property
    def is_notebook(self) -> bool:
        """Whether this is the author's notebook."""
        return self.name.endswith(".ipynb")

    def unexpected(self, report: Mapping[str, Any]) -> list[str]:
        """Return the differences of a report, as JSON, from the expected one, one sentence each."""
        outcomes = [o for e in report["exercises"] for o in e["outcomes"]]
        # a sample of functions has no validation cells
        outcomes = [o for o in outcomes if LINE not in o["id"]]
        failed = [o["id"] for o in outcomes if o["verdict"] != Verdict.PASS]
        if self.right:
            return [f"{id} is not ✓" for id in failed]
        found = ", ".join(sorted(codes(report))) or "none"
        if not failed:
            return [UNSEEN]
        if self.code is None or found == self.code:
            return []
        if found == "none":
            return [f"{self.code} is not named: another mistake has its numbers, or to try it takes long"]
        return [f"the diagnosis is {found}, not {self.code}"]


def made_samples(questions: Sequence[tuple[str, Question]], notebook: Path) -> Iterator[MadeSample]:
    """Yield the sample of all right solutions, the author's ``notebook``, and a sample for each mistake.

    ``questions`` are those of each exercise's number. A sample of a mistake has the right solutions of the
    questions before it and of the others of its exercise.
    """
    numbers = tuple(dict.fromkeys(number for number, _ in questions))
    yield MadeSample("right_all.py", source_before(questions, len(questions)), numbers, right=True)
    yield MadeSample(notebook.name, notebook.read_text(encoding="utf-8"), numbers, right=True)
    made = list[Mistake | WrittenMistake]()
    for k, (number, question) in enumerate(questions):
        for at, mistake in enumerate(question.mistakes, 1):
            if any(mistake is one for one in made):  # in another case of the function
                continue
            made.append(mistake)
            others = [q.source for n, q in questions[k + 1 :] if n == number and q.source != question.source]
            source = "\n\n".join([source_before(questions, k), mistake.source(question.source), *others])
            about = (mistake.code or "no_code").replace("-", "_")
            yield MadeSample(
                f"wrong_{question.id}_{at}_{about}.py", source, (number,), right=False, code=mistake.code
            )


def source_before(questions: Sequence[tuple[str, Question]], k: int) -> str:
    """Return the right solutions of the first ``k`` questions, each function once."""
    return "\n\n".join(dict.fromkeys(question.source for _, question in questions[:k]))
