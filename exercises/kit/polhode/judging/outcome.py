"""The outcome of a check as it appears in a report, and how the execution of a scene ended."""

import re
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar

from polhode.judging.verdict import RowsRight, Verdict, line
from polhode.report.student_line import StudentLine, raised

SELF_REPORTED = "self-reported, no points"
NEARLY = 0.01  # a larger margin may be explained by a few rounding errors,
SMALL = 1e-6  # if the tolerance that would pass is at most this
ALLOWED = re.compile(r" \(((?:rtol|limit|must) ?[^()]*)\)")  # in the brackets of a line


class Ended(StrEnum):
    """How the execution of a scene or a cell ended. It does not say whether the answer is right."""

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
    """How one scene or cell ended: the sentence, the diagnosis code, and the student's traceback if there is
    one.

    If it follows from an earlier failure, ``because`` is the part of the sentence that says which.
    """

    scene: str
    ended: Ended
    sentence: str
    code: str | None = None
    traceback: str | None = None
    because: str | None = None

    @property
    def cause(self) -> str:
        """Return the sentence of the first failure."""
        return self.because or self.sentence

    def line(self) -> StudentLine | None:
        """Return the student's last line of the traceback, None if there is none."""
        return raised(self.traceback)


@dataclass(frozen=True, kw_only=True)
class Tolerance:
    """The allowed deviation and its reason. Only the numbers that a check uses are set."""

    rtol: float | None = None
    atol: float | None = None
    limit: float | None = None
    reason: str

    def numbers(self) -> dict[str, float]:
        """Return the numbers that are set, by name."""
        named = {"rtol": self.rtol, "atol": self.atol, "limit": self.limit}
        return {name: value for name, value in named.items() if value is not None}


@dataclass(frozen=True)
class Diagnosis:
    """The likely cause of a ✗: a stable code, a sentence for the student, and the confidence (0 to 1).

    ``scenes`` are those whose results show it. A server adds them: before it releases the details of hidden
    checks, it shows no cause that needs a hidden scene.
    ``component`` is the index of the component of the function's value that it is about, if it is about one.
    """

    code: str
    sentence: str
    confidence: float
    scenes: tuple[str, ...] = ()
    component: int | None = field(default=None, compare=False)


@dataclass(kw_only=True)
class Outcome:
    """The outcome of one check. ``cause`` says why nothing was measured, and ``cause_scene`` which scene
    ended so, if that may depend on its inputs; ``margin`` is allowed / measured.

    ``hidden``: the check's scenes have random inputs. ``counted`` is false if the check does not apply to the
    submission, such as points to follow in a drawing that has none. ``hints`` do not affect the verdict.
    ``remarks`` say what it rests on besides the student's code, such as a reference function, and what was
    accepted but should be otherwise. ``points`` is what the check is worth; ``partial`` is given for a ✗ with
    partial credit. ``self_reported``: the student's own code computed what is compared and what it is
    compared with. ``bonus``: the check is one of an optional function.
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
    cause_scene: str | None = None
    diagnosis: list[Diagnosis] = field(default_factory=list)
    hints: list[str] = field(default_factory=list)
    hidden: bool = False
    counted: bool = True
    remarks: list[str] = field(default_factory=list)
    points: int = 1
    partial: RowsRight | None = None
    self_reported: bool = False
    bonus: bool = False

    COMPUTED_FIELDS: ClassVar = ("line", "earned")

    @property
    def line(self) -> str:
        """Return the ✓/✗ line, byte for byte as in the notebook."""
        return line(self.verdict, self.label, self.detail)

    @property
    def earned(self) -> int:
        """Return the points earned: all for a ✓; for a ✗ with partial credit the share of right inputs,
        rounded down; else 0.
        """
        if self.verdict is Verdict.PASS:
            return self.points
        if self.verdict is Verdict.UNMEASURED or self.partial is None:
            return 0
        return min(self.points * self.partial.right // self.partial.rows, self.points - 1)

    def measured_and_allowed(self) -> tuple[str, str]:
        """Return what the line says in its brackets in two parts: what was measured, and what is allowed."""
        allowed = ALLOWED.search(self.detail)
        if allowed is None:
            return self.detail, ""
        return self.detail[: allowed.start()] + self.detail[allowed.end() :], allowed[1]

    def notes(self) -> list[str]:
        """Return the remarks, the place of a ✗'s worst value, and its partial credit."""
        if self.verdict is not Verdict.FAIL:
            return list(self.remarks)
        found = [*self.remarks, *([f"worst at {self.where}"] if self.where else [])]
        nearly = self.margin is not None and self.margin >= NEARLY
        if nearly and not self.diagnosis and (would := self._would_pass()):
            found.append(f"no known mistake gives these numbers; it would pass at {would}")
        if self.partial:
            right = f"{self.partial.right} of {self.partial.rows} inputs are right"
            found.append(f"{right}: {self.earned} of {self.points} points")
        return found

    def _would_pass(self) -> str | None:
        """Return the tolerances with which this ✗ would pass, or None if they are more than a few rounding
        errors.
        """
        larger = 1.0001 / (self.margin or 1.0)
        needed = {name: value * larger for name, value in self.tolerance.numbers().items() if value}
        if not needed or max(needed.values()) > SMALL:
            return None
        return ", ".join(f"{name} = {value:.2g}" for name, value in needed.items())

    def causes(self) -> list[Diagnosis]:
        """Return the likely causes that the line itself does not state. A ✓ has none."""
        return (
            []
            if self.verdict is Verdict.PASS
            else [d for d in self.diagnosis if d.sentence not in (self.cause or "")]
        )

    def text(self) -> str:
        """Return the line and notes, likely causes and hints, indented below it."""
        causes = [f"likely {d.code}: {d.sentence}" for d in self.causes()]
        notes = [*self.notes(), *causes, *(f"hint: {hint}" for hint in self.hints)]
        return "\n".join([self.line, *(f"     {note}" for note in notes)])


@dataclass(frozen=True)
class SweptPoint:
    """A solver at one tolerance ``rtol``, or a stepper at one ``step``: right-hand side calls, the error of
    the run (None: it diverged or was ``stopped`` at the most calls), CPU seconds.
    """

    method: str
    rtol: float | None
    calls: int
    error: float | None
    seconds: float
    step: float | None = None
    stopped: bool = False


@dataclass
class SweepResult:
    """Speed against accuracy of a submission: its points on the motion ``scene``, and what follows from them.

    ``reference`` are the points of the right solution, measured right after, and ``per_call`` the seconds of
    one call of the submission's function and of the solution's. ``tolerance`` is the check's, ``sensitivity``
    the motion's κ, and ``closed_form`` the seconds of the exact motion at the exercise's samples.
    """

    scene: str
    points: list[SweptPoint]
    line: str
    reference: list[SweptPoint] = field(default_factory=list)
    per_call: list[float] = field(default_factory=list)
    tolerance: float | None = None
    sensitivity: float | None = None
    closed_form: float | None = None


@dataclass
class ExerciseReport:
    """The outcomes of one exercise, in the order of its declaration."""

    number: str
    title: str
    outcomes: list[Outcome]

    @property
    def heading(self) -> str:
        """Return number and title, and whether all of it is self-reported."""
        own = f" ({SELF_REPORTED})" if self.is_self_reported else ""
        return f"Exercise {self.number}. {self.title}{own}"

    @property
    def is_self_reported(self) -> bool:
        """Return whether it has outcomes and the student's own code computed both sides of each."""
        return bool(self.outcomes) and all(outcome.self_reported for outcome in self.outcomes)


@dataclass
class Picture:
    """A figure or animation that can be requested by its ``name``."""

    name: str
    exercise: str
    title: str
    alt: str
