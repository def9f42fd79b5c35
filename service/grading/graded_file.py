"""The result of grading one file, from which every format is written."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from polhode.judging.outcome import Ended, Outcome, SceneEnd
from polhode.judging.verdict import Verdict
from polhode.report.report import Report

MARKS = {"pass": "✓", "fail": "✗", "timeout": "–", "error": "–", "unmeasured": "–"}
"""The states of a check and the marks of their verdicts, as in reports."""
WORDS = {
    "pass": "passed",
    "fail": "failed",
    "timeout": "timed out",
    "error": "stopped by an error or an unusable value",
    "unmeasured": "not measured",
}
ARRAYS = "arrays.npz"  # the name of the artefact with the arrays of a grading
NOT_STOPPED = (Ended.FINISHED, Ended.NOT_PLAYED, Ended.MISSING)


@dataclass(frozen=True, kw_only=True)
class GradedFile:
    """One file of a batch: its ``report``, or why it is no valid submission (``refused``), or a system fault
    (``fault``).

    ``file`` is its path, ``source`` its text, ``seconds`` the time of grading and ``cpu_s`` the CPU time used
    in the sandbox. ``pictures`` are the requested images by file name: figures as NAME.svg or NAME.png,
    contact sheets of animations as NAME.png. Their titles are in the report.
    """

    file: Path
    source: str = ""
    report: Report | None = None
    refused: str | None = None
    fault: str | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0
    cpu_s: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return self.report is not None and self.report.passed

    @property
    def points(self) -> int | None:
        """The points earned: 0 for an invalid submission, None after a system fault."""
        if self.report is None:
            return 0 if self.fault is None else None
        return self.report.score

    @property
    def why(self) -> str:
        """The reason why there is no report."""
        return self.refused or f"not graded: {self.fault}"


def summary(files: Sequence[GradedFile]) -> str:
    """Return a line with the number of files of each kind."""
    passed = sum(file.passed for file in files)
    refused, faults = (
        sum(file.refused is not None for file in files),
        sum(file.fault is not None for file in files),
    )
    kinds = {
        "all ✓": passed,
        "not all ✓": len(files) - passed - refused - faults,
        "no submission": refused,
        "not graded": faults,
    }
    return f"{len(files)} file{'s' * (len(files) != 1)}: " + ", ".join(
        f"{n} {kind}" for kind, n in kinds.items() if n
    )


def state(outcome: Outcome, scene_ends: Iterable[SceneEnd]) -> str:
    """Return a key of MARKS: the verdict or, for an unmeasured check, how the code stopped."""
    if outcome.verdict is not Verdict.UNMEASURED:
        return outcome.verdict.value
    scene_end = next((e.ended for e in scene_ends if e.sentence == outcome.cause), Ended.NOT_PLAYED)
    if scene_end is Ended.TIMED_OUT:
        return "timeout"
    return "unmeasured" if scene_end in NOT_STOPPED else "error"
