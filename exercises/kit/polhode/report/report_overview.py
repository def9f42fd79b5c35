"""What a report says first, and in which order: causes, each once, and the exercises that fail for them.

The page, the notebook and the text of a report show this overview.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from polhode.judging.outcome import SELF_REPORTED, ExerciseReport, Outcome, SceneEnd
from polhode.judging.verdict import Verdict, line
from polhode.report.failure_causes import Cause, causes, counted, exercises_named, reasons
from polhode.report.student_line import StudentLine


@dataclass(frozen=True)
class Section:
    """An exercise, or several, one after the other, that fail for the same ``causes``, which exercises before
    them show; ``causes`` is empty for an exercise that stands for itself.
    """

    exercises: list[ExerciseReport]
    causes: list[Cause]

    def outcomes(self) -> list[Outcome]:
        """Return the outcomes of its exercises."""
        return [outcome for exercise in self.exercises for outcome in exercise.outcomes]

    @property
    def passed(self) -> bool:
        """Return whether every check that counts is ✓, or every check if none counts."""
        shown = self.outcomes()
        return all(o.verdict is Verdict.PASS for o in [o for o in shown if o.counted] or shown)

    @property
    def points(self) -> str:
        """Return the points earned out of those of the checks that count: "2 of 5 points"."""
        most = sum(o.points for o in self.outcomes() if o.counted)
        return f"{sum(o.earned for o in self.outcomes())} of {most} point{'s' * (most != 1)}"

    @property
    def heading(self) -> str:
        """Return the exercise's heading, or "Exercises 3–5: the same cause, 13 checks"."""
        first, *others = self.exercises
        if not self.causes:
            return first.heading
        sentences = {cause.diagnosis.sentence for cause in self.causes}
        explained = [o for o in self.outcomes() if sentences & {d.sentence for d in reasons(o) or []}]
        title = first.heading
        if others:
            named = exercises_named([exercise.number for exercise in self.exercises])
            title = named[0].upper() + named[1:]
        same = "the same cause" + "s" * (len(self.causes) > 1)
        return f"{title}: {same}, {counted(len(explained))}"


@dataclass(frozen=True)
class Overview:
    """The causes, the one that explains most first, the sections in the order of the exercises, and why a
    check counts that stands in several exercises, by its label.
    """

    causes: list[Cause]
    sections: list[Section]
    repeated: Mapping[str, str]

    @property
    def unexplained(self) -> Outcome | None:
        """Return the first outcome that counts and is not ✓, if nothing names a cause."""
        failed = [o for s in self.sections for o in s.outcomes() if reasons(o) is not None]
        return failed[0] if failed and not self.causes else None

    def references(self, outcome: Outcome) -> list[Cause]:
        """Return the causes to name beside an outcome: those that explain it, if there are others."""
        if len(self.causes) < 2 or outcome.verdict is Verdict.PASS:
            return []
        return [cause for cause in self.causes if cause.diagnosis in outcome.diagnosis]

    def detail(self, outcome: Outcome) -> str:
        """Return what the line says in its brackets, with the number of its cause in place of the cause."""
        detail = outcome.detail
        for cause in self.causes if outcome.verdict is Verdict.UNMEASURED else []:
            for words, more in {"not measured: ": "see ", "because ": "of ", "": ""}.items():
                sentence = cause.diagnosis.sentence
                detail = detail.replace(f"{words}{sentence}", f"{words}{more}cause {cause.number}")
        return detail

    def measured_and_allowed(self, outcome: Outcome) -> tuple[str, str]:
        """Return what was measured, or why nothing was unless a cause says it, and what is allowed."""
        if outcome.verdict is Verdict.UNMEASURED:
            return self.detail(outcome).partition(": see cause")[0], ""
        return outcome.measured_and_allowed()

    def line(self, outcome: Outcome) -> str:
        """Return the outcome's line, with the number of its cause in place of the cause."""
        return line(outcome.verdict, outcome.label, self.detail(outcome))

    def notes(self, outcome: Outcome) -> list[str]:
        """Return what stands below an outcome's line besides its causes and hints."""
        why = self.repeated.get(outcome.label)
        return [*outcome.notes(), *([why] if why and outcome.verdict is not Verdict.PASS else [])]

    def text(self, outcome: Outcome) -> str:
        """Return the outcome's line with notes, the numbers of its causes, and hints, indented below it."""
        causes = [
            f"cause {c.number}"
            for c in self.references(outcome)
            if f"cause {c.number}" not in self.line(outcome)
        ]
        others = [
            f"likely {d.code}: {d.sentence}"
            for d in outcome.causes()
            if all(d != cause.diagnosis for cause in self.causes)
        ]
        notes = [*self.notes(outcome), *causes, *others, *(f"hint: {hint}" for hint in outcome.hints)]
        return "\n".join([self.line(outcome), *(f"     {note}" for note in notes)])


def overview(
    exercises: Iterable[ExerciseReport],
    scene_ends: Sequence[SceneEnd] = (),
    lines: Iterable[StudentLine] = (),
) -> Overview:
    """Return the overview of the outcomes; ``lines`` are the student's that diagnoses are about."""
    shown = [exercise for exercise in exercises if exercise.outcomes]
    found = causes(shown, scene_ends, lines)
    return Overview(found, list(_sections(shown, found)), _repeated(shown))


def _sections(exercises: Iterable[ExerciseReport], found: Sequence[Cause]) -> Iterator[Section]:
    shown = set[str]()
    last: Section | None = None
    for exercise in exercises:
        given = [each for outcome in exercise.outcomes if (each := reasons(outcome)) is not None]
        sentences = {diagnosis.sentence for each in given for diagnosis in each}
        same = bool(sentences) and all(given) and sentences <= shown
        own = [cause for cause in found if same and cause.diagnosis.sentence in sentences]
        if last is not None and own and own == last.causes:
            last.exercises.append(exercise)
            continue
        if last is not None:
            yield last
        last = Section([exercise], own)
        shown |= sentences
    if last is not None:
        yield last


def _repeated(exercises: Iterable[ExerciseReport]) -> dict[str, str]:
    """Return for each label that stands in several exercises why it counts in each."""
    numbers: dict[str, list[str]] = {}
    for exercise in exercises:
        for outcome in exercise.outcomes:
            numbers.setdefault(outcome.label, []).append(exercise.number)
    return {
        label: f"counts in each of {exercises_named(found)}, because each of them uses this function"
        for label, found in numbers.items()
        if len(found) > 1
    }


def section_text(section: Section, seen: Overview) -> str:
    """Return a section as plain text: heading and lines, with notes if it stands for itself."""
    shown = seen.line if section.causes else seen.text
    blocks = []
    for exercise in section.exercises:
        outcomes = [
            shown(outcome) + ("" if exercise.is_self_reported else _without_points(outcome))
            for outcome in exercise.outcomes
        ]
        title = [] if len(section.exercises) == 1 else [exercise.heading]
        blocks.append("\n".join([*title, *outcomes]))
    return "\n".join([section.heading, *blocks])


def _without_points(outcome: Outcome) -> str:
    """Return a line below a ✓ or ✗ that carries no points, "" below others."""
    if outcome.counted or outcome.verdict is Verdict.UNMEASURED:
        return ""
    return f"\n     {SELF_REPORTED if outcome.self_reported else 'no points'}"
