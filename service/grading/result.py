"""A file that was graded, or why it was not: the one thing that every telling is made of."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ecp.judge import Verdict
from ecp.outcome import Ended, Outcome, SceneEnd
from ecp.report import Report


@dataclass(frozen=True, kw_only=True)
class GradedFile:
    """One file of a batch: its ``report``; or why it is no submission, which is the student's to mend (``refused``); or our own
    ``fault``, and then there is no verdict.

    ``file`` is the path as it was found and ``source`` its text. ``pictures`` are those that were asked for, by file name: figures
    as NAME.svg or NAME.png, contact sheets of animations as NAME.png; titles and what they show stand in the report.
    """

    file: Path
    source: str = ""
    report: Report | None = None
    refused: str | None = None
    fault: str | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Every check ✓."""
        return self.report is not None and self.report.passed

    @property
    def points(self) -> int | None:
        """Checks passed; none of what is no submission, and not known after a fault."""
        if self.report is None:
            return 0 if self.fault is None else None
        return self.report.score

    @property
    def why(self) -> str:
        """Why there is no report."""
        return self.refused or f"not graded: {self.fault}"


def summary(files: Sequence[GradedFile]) -> str:
    """How many files there are of each kind, in a line."""
    passed = sum(file.passed for file in files)
    refused, faults = sum(file.refused is not None for file in files), sum(file.fault is not None for file in files)
    kinds = {"all ✓": passed, "not all ✓": len(files) - passed - refused - faults, "no submission": refused, "not graded": faults}
    return f"{len(files)} file{'s' * (len(files) != 1)}: " + ", ".join(f"{n} {kind}" for kind, n in kinds.items() if n)


MARKS = {"pass": "✓", "fail": "✗", "timeout": "⏱", "error": "!", "unmeasured": "–"}
"""The states of a check, each with its shape."""
WORDS = {"pass": "passed", "fail": "failed", "timeout": "timed out", "error": "stopped by an error", "unmeasured": "not measured"}
NEVER_BEGUN = (Ended.FINISHED, Ended.NOT_PLAYED, Ended.MISSING)


def state(outcome: Outcome, scene_ends: Iterable[SceneEnd]) -> str:
    """Its verdict; where nothing was measured, a key of MARKS that tells how the code stopped."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return outcome.verdict.value
    scene_end = next((e.ended for e in scene_ends if e.sentence == outcome.cause), Ended.NOT_PLAYED)
    if scene_end is Ended.TIMED_OUT:
        return "timeout"
    return "unmeasured" if scene_end in NEVER_BEGUN else "error"
