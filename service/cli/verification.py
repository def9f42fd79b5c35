"""Comparison of graded samples with their expected reports, as text for the assignment's author."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ecp.document import document
from ecp.judge import MARKS, Verdict
from ecp.outcome import Ended
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.samples import Sample, SampleSet, codes, entry
from service.grading.result import GradedFile
from service.sandbox.time_budget import DEFAULT_LIMITS

CPU_FACTOR = 5  # a grading's limit of CPU time, in units of what the right solution uses


@dataclass
class Tally:
    """Counts over the samples of an assignment, with the checks made, the checks that failed and the diagnosis codes named.

    ``cpu_s`` is the most CPU time in seconds that grading a right sample used.
    """

    samples: int = 0
    unexpected: int = 0
    right: int = 0
    made: set[str] = field(default_factory=set)
    failed: set[str] = field(default_factory=set)
    named: set[str] = field(default_factory=set)
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
            self.named |= codes(document(graded.report))


def differences(sample: Sample, graded: GradedFile) -> list[str]:
    """Return the differences from the expected report: each such check with its line and diagnosis, then the codes."""
    if graded.report is None:
        return [f"cannot be graded: {graded.refused}"]
    report = document(graded.report)
    return [*_check_differences(sample, graded.report), *_code_differences(sample.codes, codes(report), graded.report)]


def cpu_warning(assignment: Assignment, tally: Tally) -> Iterator[str]:
    """Yield a warning if slower solutions than the right one would use up the CPU time of a grading."""
    if CPU_FACTOR * tally.cpu_s > DEFAULT_LIMITS.at_least(assignment.cpu_s).cpu_s:
        yield (
            f"warning: grading a right sample used {tally.cpu_s:.1f} s of CPU time; declare "
            f"cpu_s={CPU_FACTOR * tally.cpu_s:.0f}, so that slower solutions finish"
        )


def missing_entry(assignment: Assignment, graded: GradedFile) -> list[str]:
    """Return what to report about a sample without an entry in expected.toml."""
    if graded.report is None:
        return [f"cannot be graded: {graded.refused}"]
    if written := new_entry(assignment, graded):
        return ["has no entry in expected.toml; --write would add", *written.rstrip().split("\n")]
    if late := _timed_out(graded.report):
        slow = "a busy machine can cause that: run again, or add the entry by hand if the sample never ends"
        return [f"has no entry in expected.toml and none was added: {late} did not finish in time, and {slow}"]
    rule = "a sample named right_… must pass every check, and any other sample must fail one"
    return [f"has no entry in expected.toml and none was added: {rule}", *graded.report.text().rstrip().split("\n")]


def _timed_out(report: Report) -> str:
    """Return the names of the scenes and cells that did not finish in time."""
    return ", ".join(scene_end.scene for scene_end in report.scene_ends if scene_end.ended is Ended.TIMED_OUT)


def new_entry(assignment: Assignment, graded: GradedFile) -> str | None:
    """Return the entry for a sample without one, or None if its report contradicts its name or has a time-out."""
    if graded.report is None or graded.report.passed != graded.file.name.startswith("right_") or _timed_out(graded.report):
        return None
    return entry(graded.file.name, None, assignment, document(graded.report))


def summary(assignment: Assignment, found: SampleSet, tally: Tally, whole: bool) -> Iterator[str]:
    """Yield how many samples are as expected and which entries lack a file; for a ``whole`` set also warnings
    about checks and codes that no sample shows.
    """
    agreed = tally.samples - tally.unexpected
    yield f"{assignment.slug}: {agreed} of {tally.samples} samples as expected, {len(tally.made)} checks"
    yield from (f"{name}: listed in expected.toml, but the file does not exist" for name in found.missing)
    if whole:
        yield from _warning("no sample fails", [c.id for c in assignment.checks() if c.id not in tally.failed])
        yield from _warning("no sample shows the diagnosis codes", [c for c in assignment.codes if c not in tally.named])
        if not tally.right:
            yield "warning: no sample is all ✓"
        yield from cpu_warning(assignment, tally)


def _check_differences(sample: Sample, report: Report) -> Iterator[str]:
    outcomes = {o.id: o for o in report.outcomes()}
    for one in sample.differences(document(report)):
        want = f"expected {MARKS[one.expected]}" if one.expected else "expected no result"
        outcome = outcomes.get(one.check)
        if outcome is None:
            yield f"{one.check}: {want}, got no result: its exercise was not attempted, or its function is not defined"
            continue
        yield f"{one.check}: {want}, got {MARKS[outcome.verdict]}"
        yield from (f"  {line}" for line in outcome.text().split("\n"))


def _code_differences(expected: frozenset[str], got: set[str], report: Report) -> Iterator[str]:
    if missing := expected - got:
        yield f"missing diagnosis codes: {', '.join(sorted(missing))}"
    if more := got - expected:
        sentences = {d.code: d.sentence for o in report.outcomes() for d in o.diagnosis}
        yield from (f"unexpected diagnosis code: {code} ({sentences[code]})" for code in sorted(more))


def _warning(what: str, names: Sequence[str]) -> Iterator[str]:
    if names:
        yield f"warning: {what} {', '.join(names)}"
