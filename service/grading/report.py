"""The one Report: stored, served and printed."""

from pydantic import BaseModel, computed_field

from ecp.judge import Verdict
from exercises.outcome import Outcome, Swept
from service.sandbox.seen import Ending, SceneEnding


class Picture(BaseModel):
    """A figure or an animation that can be asked for by its ``name``."""

    name: str
    exercise: str
    title: str
    alt: str


class ExerciseReport(BaseModel):
    """The outcomes of one exercise, in the order the checks are declared."""

    number: str
    title: str
    outcomes: list[Outcome]

    def text(self) -> str:
        """The lines of the exercise; a cause shared by several is told once."""
        told: set[str] = set()
        lines = [f"Exercise {self.number}. {self.title}"]
        for outcome in self.outcomes:
            lines.append(outcome.text(told))
            told |= {d.sentence for d in outcome.diagnosis}
        return "\n".join(lines)


class Provenance(BaseModel):
    """What a regrade needs to give the same report: seed and versions; what stood around the code; and by scene, what makes a
    motion the student's function's own."""

    seed: int
    versions: dict[str, str]
    walls: str
    motions: dict[str, str] = {}
    phases_ms: dict[str, float] = {}


class Report(BaseModel):
    """All outcomes of one attempt. A point is a check that passed."""

    assignment: str
    version: str
    exercises: list[ExerciseReport]
    figures: list[Picture] = []
    animations: list[Picture] = []
    endings: list[SceneEnding] = []
    stdout: str = ""
    sweep: Swept | None = None
    provenance: Provenance

    @computed_field  # type: ignore[prop-decorator]
    @property
    def score(self) -> int:
        """Checks passed."""
        return sum(o.verdict is Verdict.PASS for o in self.outcomes())

    @computed_field  # type: ignore[prop-decorator]
    @property
    def max_score(self) -> int:
        """Checks made that count."""
        return sum(o.counted for o in self.outcomes())

    @computed_field  # type: ignore[prop-decorator]
    @property
    def passed(self) -> bool:
        """Every check ✓, and at least one check made."""
        return 0 < self.score == self.max_score

    def outcomes(self) -> list[Outcome]:
        """The outcomes of all exercises in order."""
        return [o for e in self.exercises for o in e.outcomes]

    def text(self) -> str:
        """The report as the notebook would print it, exercise by exercise, then what interrupted the code."""
        blocks = [e.text() for e in self.exercises if e.outcomes]
        if notes := [note for e in self.endings if (note := _note(e))]:
            blocks.append("\n".join(notes))
        if self.sweep:
            blocks.append(f"speed against accuracy: {self.sweep.line}")
        public = [o for o in self.outcomes() if o.counted and not o.hidden]
        passed = sum(o.verdict is Verdict.PASS for o in public)
        score = f"{self.score} of {self.max_score} checks ✓ (public checks: {passed} of {len(public)})"
        return "\n\n".join([*blocks, score]) + "\n"


def _note(ending: SceneEnding) -> str | None:
    if ending.traceback is None or ending.ending in (Ending.FINISHED, Ending.NOT_PLAYED):
        return None
    shown = "\n".join(f"     {line}" for line in ending.traceback.rstrip().split("\n"))
    return f"{ending.scene}: {ending.sentence}\n{shown}"
