"""The report of a grading, or of ``polhode.check``: outcomes by exercise, provenance, figures and scene
ends.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from polhode.judging.claims import NotebookCheck
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import SELF_REPORTED, ExerciseReport, Outcome, Picture, SceneEnd, SweepResult
from polhode.judging.verdict import Verdict
from polhode.report import failure_causes, report_overview
from polhode.report.failure_causes import exercises_named
from polhode.report.report_overview import Overview
from polhode.report.student_line import StudentLine

OWN_CHECKS = f"The notebook's own checks ({SELF_REPORTED})"


def pictures(exercises: Sequence[Exercise], shown: Collection[str]) -> tuple[list[Picture], list[Picture]]:
    """Return figures and animations of the exercises whose scenes are all among those ``shown``."""
    figures = [
        Picture(f.name, e.number, f.title, f.alt)
        for e in exercises
        for f in e.figures
        if set(f.scenes) <= set(shown)
    ]
    return figures, [
        Picture(a.name, e.number, a.title, a.alt) for e in exercises for a in e.animations if a.scene in shown
    ]


@dataclass
class Provenance:
    """What a regrade needs to give the same report: seed and versions; what stood around the code; by scene,
    what makes a motion the student's function's own; and which functions of earlier questions each question
    used, by its id.
    """

    seed: int
    versions: dict[str, str]
    isolation: str
    chains: dict[str, str] = field(default_factory=dict)
    phases_ms: dict[str, float] = field(default_factory=dict)


def out_of(points: int, bonus: int) -> str:
    """Return the points that a submission can have, those of optional functions apart: "36 + 6 bonus",
    without a bonus "36".
    """
    return f"{points} + {bonus} bonus" if bonus else str(points)


def no_picture(name: str) -> bytes | None:
    """Return None: outside a notebook a report has no pictures."""
    return None


@dataclass(repr=False)
class Report:
    """All outcomes of one grading. A passed check earns its points, one unless the author says otherwise.

    ``total`` is the number of points of every exercise that was to be graded, including those
    ``not_attempted`` (their numbers). ``max_points`` is the part of these exercises without optional
    functions, and ``bonus_points`` that of all optional functions, written or not. A local report has
    neither. ``suspect_lines`` are the student's lines that diagnoses are about.

    ``repr`` is the ✓/✗ lines, ``print(report)`` adds the causes. Only in a notebook it has pictures, which
    ``drawn`` draws or fetches (PNG or SVG by name), the bundle that was ``sent``, the ``address`` of its
    page, and a ``remark``. A ``local`` report comes from ``polhode.check`` and has the public checks only;
    it is ``weighted`` if one of the assignment's checks is worth more than a point.
    """

    assignment: str
    version: str
    exercises: list[ExerciseReport]
    provenance: Provenance
    total: int
    figures: list[Picture] = field(default_factory=list)
    animations: list[Picture] = field(default_factory=list)
    scene_ends: list[SceneEnd] = field(default_factory=list)
    suspect_lines: list[StudentLine] = field(default_factory=list)
    stdout: str = ""
    sweep: SweepResult | None = None
    notebook_checks: list[NotebookCheck] = field(default_factory=list)
    max_points: int | None = None
    bonus_points: int | None = None
    not_attempted: list[str] = field(default_factory=list)
    local: bool = field(default=False, metadata={"local_only": True}, compare=False)
    weighted: bool = field(default=False, metadata={"local_only": True}, compare=False)
    drawn: Callable[[str], bytes | None] = field(
        default=no_picture, metadata={"local_only": True}, compare=False
    )
    sent: Any = field(default=None, metadata={"local_only": True}, compare=False)
    address: str | None = field(default=None, metadata={"local_only": True}, compare=False)
    remark: str = field(default="", metadata={"local_only": True}, compare=False)

    COMPUTED_FIELDS: ClassVar = ("score", "max_score", "passed")

    @property
    def score(self) -> int:
        """Return the points earned."""
        return sum(o.earned for o in self.outcomes())

    @property
    def max_score(self) -> int:
        """Return the points of the checks that count."""
        return sum(o.points for o in self.outcomes() if o.counted)

    @property
    def bonus(self) -> int:
        """Return the points earned with optional functions."""
        return sum(o.earned for o in self.outcomes() if o.bonus)

    @property
    def out_of(self) -> str:
        """Return the points there are, with those of optional functions apart: "36 + 6 bonus"."""
        return str(self.total) if self.max_points is None else out_of(self.max_points, self.bonus_points or 0)

    @property
    def points(self) -> str:
        """Return the points earned out of those there are: "28 of 36, +6 of 6 bonus"."""
        if self.max_points is None:
            return f"{self.score} of {self.total}"
        bonus = f", +{self.bonus} of {self.bonus_points} bonus" if self.bonus_points else ""
        return f"{self.score - self.bonus} of {self.max_points}{bonus}"

    @property
    def passed(self) -> bool:
        """Return whether there is a check with points and all checks pass, also those without points. One
        that is not measured has not passed.
        """
        counted = [outcome for outcome in self.outcomes() if outcome.counted]
        return bool(self.max_score) and all(outcome.verdict is Verdict.PASS for outcome in counted)

    def outcomes(self) -> list[Outcome]:
        """Return the outcomes of all exercises in order."""
        return [o for e in self.exercises for o in e.outcomes]

    def overview(self) -> Overview:
        """Return what is shown first: the causes, each once, and the exercises in the order of the report."""
        return report_overview.overview(self.exercises, self.scene_ends, self.suspect_lines)

    def stops(self) -> list[SceneEnd]:
        """Return the scene ends with a traceback that no cause states, each traceback once."""
        stated = {cause.scene_end.traceback for cause in self.overview().causes if cause.scene_end}
        first = {end.traceback: end for end in reversed(self.scene_ends) if end.traceback not in stated}
        return [end for end in self.scene_ends if end.traceback and first.get(end.traceback) is end]

    def lines(self) -> str:
        """Return the ✓/✗ lines only."""
        return "\n".join(o.line for o in self.outcomes())

    def text(self) -> str:
        """Return the report as text: causes, the lines by exercise, the notebook's own checks, tracebacks and
        the summary.
        """
        seen = self.overview()
        blocks = [failure_causes.text(seen.causes)] if seen.causes else []
        blocks += [report_overview.section_text(section, seen) for section in seen.sections]
        if self.notebook_checks:
            blocks.append("\n".join([OWN_CHECKS, *(check.line for check in self.notebook_checks)]))
        blocks += [f"{end.scene}: {end.sentence}\n{_indented(end.traceback)}" for end in self.stops()]
        blocks += [
            f"Cause {c.number} in full:\n{_indented(frames)}" for c in seen.causes if (frames := c.frames())
        ]
        if self.sweep:
            blocks.append(f"speed versus accuracy: {self.sweep.line}")
        return "\n\n".join([*blocks, self.summary()]) + "\n"

    def summary(self) -> str:
        """Return the points out of all points, the public checks among them, and the exercises not
        attempted.
        """
        if self.local:
            what = "points of the public checks" if self.weighted else "public checks ✓"
            return f"{self.score} of {self.total} {what}{self._missed()}"
        return f"{self.points} points ({self.public()}){self._reported()}{self._missed()}"

    def public(self) -> str:
        """Return how many of the public checks are ✓: "public checks: 3 of 13"."""
        made = [o for o in self.outcomes() if o.counted and not o.hidden]
        return f"public checks: {sum(o.verdict is Verdict.PASS for o in made)} of {len(made)}"

    def _reported(self) -> str:
        reported = [o for o in self.outcomes() if o.self_reported]
        passed = sum(o.verdict is Verdict.PASS for o in reported)
        return f"; {passed} of {len(reported)} self-reported lines ✓" if reported else ""

    def _missed(self) -> str:
        return f"; not attempted: {exercises_named(self.not_attempted)}" if self.not_attempted else ""

    def __repr__(self) -> str:
        return self.lines()

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        from polhode.report.report_html import html

        return html(self)

    def _ipython_display_(self) -> None:
        from polhode.report.report_html import show

        show(self)


def _indented(traceback: str | None) -> str:
    return "\n".join(f"     {line}" for line in (traceback or "").rstrip().split("\n"))
