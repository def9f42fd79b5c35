"""Counts over the graded samples of an assignment, which ``polhode verify`` sums up."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.verdict import Verdict
from service.grading.graded_file import GradedFile
from service.sandbox.time_budget import DEFAULT_LIMITS

CPU_FACTOR = 5  # a grading's limit of CPU time, in units of what the right solution uses


@dataclass
class Tally:
    """Counts over samples, with the checks made and the checks that failed. ``faults``
    could not be graded.

    ``cpu_s`` is the most CPU time in seconds that grading a right sample used.
    """

    samples: int = 0
    unexpected: int = 0
    faults: int = 0
    right: int = 0
    made: set[str] = field(default_factory=set)
    failed: set[str] = field(default_factory=set)
    cpu_s: float = 0.0

    def add(self, graded: GradedFile, expected: bool) -> None:
        """Count a sample."""
        self.samples += 1
        self.unexpected += not expected
        self.right += graded.passed
        self.cpu_s = max(self.cpu_s, graded.cpu_s if graded.passed else 0.0)
        if graded.report:
            self.made |= {o.id for o in graded.report.outcomes()}
            self.failed |= {o.id for o in graded.report.outcomes() if o.verdict is Verdict.FAIL}


def cpu_warning(assignment: Assignment, tally: Tally) -> Iterator[str]:
    """Yield a warning if slower solutions than the right one would use up the CPU time of a grading."""
    if CPU_FACTOR * tally.cpu_s > DEFAULT_LIMITS.at_least(assignment.cpu_s).cpu_s:
        yield (
            f"warning: grading a right sample used {tally.cpu_s:.1f} s of CPU time; declare "
            f"cpu_s={CPU_FACTOR * tally.cpu_s:.0f}, so that slower solutions finish"
        )
