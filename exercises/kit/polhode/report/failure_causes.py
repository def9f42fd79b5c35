"""The causes of failures: each diagnosis once, with all that it explains and the student's line."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile

from polhode.judging.outcome import Diagnosis, ExerciseReport, Outcome, SceneEnd
from polhode.judging.verdict import Verdict
from polhode.report.student_line import FRAME, StudentLine, of_component

FIRST, NEXT, LOOK = "Fix this first", "Then", "Look at this first"
SHORTEST_RANGE = 3  # numbers that are written "2–4"


@dataclass(frozen=True)
class Cause:
    """A diagnosis, numbered from 1, with the outcomes it explains, by exercise number.

    ``line`` is the student's line that it is about, ``scene_end`` that of the code that raised, if known.
    """

    number: int
    diagnosis: Diagnosis
    explains: Mapping[str, list[Outcome]]
    line: StudentLine | None = None
    scene_end: SceneEnd | None = None

    def outcomes(self) -> list[Outcome]:
        """Return all outcomes it explains."""
        return [outcome for outcomes in self.explains.values() for outcome in outcomes]

    @property
    def code(self) -> str:
        """Return "likely sign-flipped" for a code inferred from numbers, "raises" for how the code ended."""
        inferred = any(self.diagnosis.sentence not in (o.cause or "") for o in self.outcomes())
        return f"likely {self.diagnosis.code}" if inferred else self.diagnosis.code

    @property
    def extent(self) -> str:
        """Return what it explains: "21 checks in exercises 2–5"."""
        return f"{counted(len(self.outcomes()))} in {exercises_named(list(self.explains))}"

    def frames(self) -> str:
        """Return the student's frames of the traceback, without the exception's own text, if it has several:
        of a single one ``line`` says it all.
        """
        traceback = (self.scene_end and self.scene_end.traceback) or ""
        lines = list(takewhile(lambda line: not line or line[0].isspace(), traceback.split("\n")))
        return "\n".join(lines) if sum(bool(FRAME.match(line)) for line in lines) > 1 else ""

    @property
    def worst(self) -> str:
        """Return the place of the first wrong number that says where it is, "" if none does."""
        places = [o.where for o in self.outcomes() if o.where and o.verdict is Verdict.FAIL]
        with_numbers = [where for where in places if "expected" in where]
        return next(iter(with_numbers + places), "")


def causes(
    exercises: Iterable[ExerciseReport], scene_ends: Sequence[SceneEnd], lines: Iterable[StudentLine]
) -> list[Cause]:
    """Return the diagnoses of all counted outcomes that did not pass, the one that explains most first."""
    found: dict[str, tuple[Diagnosis, dict[str, list[Outcome]]]] = {}
    for exercise in exercises:
        for outcome in exercise.outcomes:
            for diagnosis in reasons(outcome) or []:
                _, explains = found.setdefault(diagnosis.sentence, (diagnosis, {}))
                explains.setdefault(exercise.number, []).append(outcome)
    ranked = sorted(found.values(), key=lambda one: -sum(map(len, one[1].values())))
    ended = {end.cause: end for end in reversed(scene_ends) if end.traceback}
    about = {one.about: one for one in lines}
    return [
        Cause(number, diagnosis, explains, about.get(name) or (end.line() if end else None), end)
        for number, (diagnosis, explains) in enumerate(ranked, start=1)
        for name in [diagnosis.sentence]
        for end in [ended.get(name)]
    ]


def reasons(outcome: Outcome) -> list[Diagnosis] | None:
    """Return the diagnoses of an outcome that counts against the student, None for any other."""
    return outcome.diagnosis if outcome.counted and outcome.verdict is not Verdict.PASS else None


def suspect_lines(
    exercises: Iterable[ExerciseReport],
    function_of: Callable[[str], str],
    cells_of: Callable[[str], Sequence[tuple[str, str]]],
) -> list[StudentLine]:
    """Return the student's line behind each diagnosis of one component of a function's value, where the
    source shows that line.

    ``function_of`` maps a check's id to the function it tests, ``cells_of`` that function to names and
    sources of cells, of which the last that defines it counts.
    """
    asked = {
        (diagnosis.sentence, diagnosis.component, function_of(outcome.id))
        for exercise in exercises
        for outcome in exercise.outcomes
        for diagnosis in reasons(outcome) or []
        if diagnosis.component is not None
    }
    found = {text: of_component(cells_of(name), name, k, text) for text, k, name in sorted(asked)}
    return [one for one in found.values() if one is not None]


def text(found: Sequence[Cause]) -> str:
    """Return the causes as plain text, each with the student's line and what it explains."""
    lines = []
    for cause in found:
        if cause.number <= 2:
            lines.append(f"{FIRST if cause.number == 1 else NEXT}:")
        lines.append(f"{cause.number}. {cause.diagnosis.sentence}")
        lines += [f"     {cause.line}"] if cause.line else []
        lines.append(f"     {cause.code}: {cause.extent}")
    return "\n".join(lines)


def exercises_named(numbers: Sequence[str]) -> str:
    """Return "exercise 2", "exercises 2 and 4" or "exercises 2–5"."""
    runs: list[list[str]] = []
    for number in dict.fromkeys(numbers):
        follows = (
            runs and runs[-1][-1].isdecimal() and number.isdecimal() and int(runs[-1][-1]) + 1 == int(number)
        )
        if follows:
            runs[-1].append(number)
        else:
            runs.append([number])
    named = [
        part for run in runs for part in ([f"{run[0]}–{run[-1]}"] if len(run) >= SHORTEST_RANGE else run)
    ]
    *before, last = named
    listed = f"{', '.join(before)} and {last}" if before else last
    return f"exercise{'s' * (listed != numbers[0])} {listed}"


def counted(number: int) -> str:
    """Return "1 check" or "3 checks"."""
    return f"{number} check{'s' * (number != 1)}"
