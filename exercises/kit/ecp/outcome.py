"""A check's answer as it stands in a report; and how the execution of a scene stopped."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar

from ecp.judge import Verdict, line

NEARLY = 0.01  # a margin above this may be a matter of a few roundings,
SMALL = 1e-6  # if the tolerance that would pass is not larger than this


class Ended(StrEnum):
    """How the execution of a scene, or of a cell, stopped. It says nothing about whether the answer is right."""

    FINISHED = "finished"
    RAISED = "raised"
    SYNTAX = "syntax-error"
    WRONG_ANSWER = "wrong-answer"
    MISSING = "missing-function"
    TIMED_OUT = "timed-out"
    MEMORY = "memory"
    EXITED = "exited"
    KILLED = "killed"
    OUTPUT = "output"
    PROTOCOL = "protocol"
    NOT_PLAYED = "not-played"


@dataclass
class SceneEnd:
    """How one scene or cell ended, with the public diagnosis code and the student's traceback where there is one."""

    scene: str
    ended: Ended = field(metadata={"formerly": "ending"})
    sentence: str
    code: str | None = None
    traceback: str | None = None


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """What was allowed, and why just that much. Only the numbers a check uses are set."""

    rtol: float | None = None
    atol: float | None = None
    limit: float | None = None
    reason: str


@dataclass(frozen=True)
class Diagnosis:
    """The named likely cause of a ✗: a public code, a sentence for the student, and how sure it is (0 to 1)."""

    code: str
    sentence: str
    confidence: float


@dataclass(kw_only=True)
class Outcome:
    """One check of one attempt. ``cause`` says why nothing was measured; ``margin`` is allowed / measured.

    ``hidden``: its scenes were drawn for this attempt. ``counted`` is false where the check does not apply to what was handed in,
    such as points to follow in a drawing that has none; ``hints`` are remarks that cost nothing.
    """

    id: str
    label: str
    verdict: Verdict
    detail: str
    measured: float | None = None
    expected: float | None = None
    tolerance: Tolerance
    margin: float | None = None
    where: str | None = None
    cause: str | None = None
    diagnosis: list[Diagnosis] = field(default_factory=list)
    hints: list[str] = field(default_factory=list)
    hidden: bool = False
    counted: bool = True

    COMPUTED_FIELDS: ClassVar = ("line",)

    @property
    def line(self) -> str:
        """The ✓/✗ line, byte for byte as in the notebook."""
        return line(self.verdict, self.label, self.detail)

    def notes(self) -> list[str]:
        """Where a ✗ is worst, and how far off it is."""
        if self.verdict is not Verdict.FAIL:
            return []
        found = [f"worst at {self.where}"] if self.where else []
        if not self.margin:
            return found
        found.append(f"{1 / self.margin:.3g} times the allowed difference")
        if self.margin >= NEARLY and not self.diagnosis and (would := self._would_pass()):
            found.append(f"no known slip gives these numbers: perhaps the tolerance is merely too tight; it would pass at {would}")
        return found

    def _would_pass(self) -> str | None:
        """The tolerances with which this ✗ would be a ✓; None where they would be more than a few roundings."""
        larger, tolerance = 1.0001 / (self.margin or 1.0), self.tolerance
        allowed = {"rtol": tolerance.rtol, "atol": tolerance.atol, "limit": tolerance.limit}
        needed = {name: value * larger for name, value in allowed.items() if value}
        if not needed or max(needed.values()) > SMALL:
            return None
        return ", ".join(f"{name} = {value:.2g}" for name, value in needed.items())

    def causes(self) -> list[Diagnosis]:
        """The likely causes that the line itself does not state; none of a ✓."""
        return [] if self.verdict is Verdict.PASS else [d for d in self.diagnosis if d.sentence not in (self.cause or "")]

    def text(self, numbers: Mapping[str, int] | None = None) -> str:
        """The line, and for anything but ✓ what helps to find the discrepancy, indented below it.

        A cause whose sentence has one of the ``numbers`` is stated at the top of the report: here its number stands for it.
        """
        above = numbers or {}
        hints = [f"hint: {hint}" for hint in self.hints]
        if self.verdict is Verdict.PASS:
            return "\n".join([self.line, *(f"     {hint}" for hint in hints)])
        causes = [
            f"cause {above[d.sentence]}: {d.code}" if d.sentence in above else f"likely {d.code}: {d.sentence}"
            for d in self.causes()
        ]
        return "\n".join([self.line, *(f"     {note}" for note in [*self.notes(), *causes, *hints])])


@dataclass(frozen=True)
class SweptPoint:
    """A solver at one tolerance: right-hand side calls, largest error over the run (None: it blew up), CPU seconds."""

    method: str
    rtol: float
    calls: int
    error: float | None
    seconds: float


@dataclass
class SweepResult:
    """Speed against accuracy of a submission: its points on ``scene`` of the reference chart, and in one line where it stands."""

    scene: str
    points: list[SweptPoint]
    line: str
