"""Failures grouped by the diagnosis that explains them: the top of a report."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ecp.judge import Verdict
from ecp.outcome import Diagnosis, ExerciseReport, Outcome, SceneEnd


@dataclass(frozen=True)
class Cause:
    """A diagnosis, numbered from 1, with the outcomes it explains, by exercise number, and the student's line
    that raised, with its place, if one did.
    """

    number: int
    diagnosis: Diagnosis
    explains: Mapping[str, list[Outcome]]
    raised_at: str = ""

    def outcomes(self) -> list[Outcome]:
        """Return all outcomes it explains."""
        return [outcome for outcomes in self.explains.values() for outcome in outcomes]

    @property
    def likely(self) -> str:
        """Return "likely " for a diagnosis inferred from numbers, "" for one that is how the code ended."""
        return (
            "likely " if any(self.diagnosis.sentence not in (o.cause or "") for o in self.outcomes()) else ""
        )

    def where(self) -> list[str]:
        """Return one line per exercise with the labels of its checks."""
        return [
            f"exercise {number}: {'; '.join(o.label for o in outcomes)}"
            for number, outcomes in self.explains.items()
        ]


def causes(exercises: Iterable[ExerciseReport], scene_ends: Sequence[SceneEnd] = ()) -> list[Cause]:
    """Return the diagnoses of all counted outcomes that did not pass, the one that explains most first."""
    found: dict[str, tuple[Diagnosis, dict[str, list[Outcome]]]] = {}
    for exercise in exercises:
        for outcome in exercise.outcomes:
            for diagnosis in (
                outcome.diagnosis if outcome.counted and outcome.verdict is not Verdict.PASS else []
            ):
                _, explains = found.setdefault(diagnosis.sentence, (diagnosis, {}))
                explains.setdefault(exercise.number, []).append(outcome)
    ranked = sorted(found.values(), key=lambda one: -sum(map(len, one[1].values())))
    raised = {end.cause: end.raised_at() for end in reversed(scene_ends)}
    return [
        Cause(number, diagnosis, explains, raised.get(diagnosis.sentence, ""))
        for number, (diagnosis, explains) in enumerate(ranked, start=1)
    ]


def header(found: list[Cause]) -> str:
    """Return a line that counts the causes and what they explain,
    "" if they explain fewer than two checks.
    """
    explained = {outcome.id: outcome for cause in found for outcome in cause.outcomes()}
    if len(explained) < 2:
        return ""
    failed = sum(outcome.verdict is Verdict.FAIL for outcome in explained.values())
    unmeasured = len(explained) - failed
    counts = [f"{failed} failure{'s' * (failed > 1)}"] if failed else []
    counts += [f"{unmeasured} check{'s' * (unmeasured > 1)} not measured"] if unmeasured else []
    subject = "One cause explains" if len(found) == 1 else f"{len(found)} causes explain"
    return f"{subject} {' and '.join(counts)}:"


def text(found: list[Cause]) -> str:
    """Return the header and each cause with its checks as plain text, "" if there is none."""
    lines = [header(found)] if header(found) else []
    for cause in found:
        lines.append(f"{cause.number}. {cause.likely}{cause.diagnosis.code}: {cause.diagnosis.sentence}")
        lines += [f"     {cause.raised_at}"] if cause.raised_at else []
        lines += [f"     {where}" for where in cause.where()]
    return "\n".join(lines)


def numbers(found: list[Cause]) -> dict[str, int]:
    """Return the number of each cause by its sentence."""
    return {cause.diagnosis.sentence: cause.number for cause in found}
