"""What became of samples, against what was expected of them: told to the author of the assignment, line by line."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ecp.document import document
from ecp.judge import MARKS, Verdict
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.samples import Sample, SampleSet, codes, entry
from service.grading.result import GradedFile


@dataclass
class Tally:
    """What was seen of an assignment so far: checks that failed, codes that were named."""

    samples: int = 0
    otherwise: int = 0  # whose report was not the expected one
    right: int = 0
    made: set[str] = field(default_factory=set)
    failed: set[str] = field(default_factory=set)
    named: set[str] = field(default_factory=set)

    def add(self, graded: GradedFile, expected: bool) -> None:
        """Count a sample."""
        self.samples += 1
        self.otherwise += not expected
        self.right += graded.passed
        if graded.report:
            self.made |= {o.id for o in graded.report.outcomes()}
            self.failed |= {o.id for o in graded.report.outcomes() if o.verdict is Verdict.FAIL}
            self.named |= codes(document(graded.report))


def differences(sample: Sample, graded: GradedFile) -> list[str]:
    """What is not as expected: for each such check its line with numbers and cause, then the codes; empty if nothing is."""
    if graded.report is None:
        return [f"is no submission: {graded.refused}"]
    report = document(graded.report)
    return [*_of_checks(sample, graded.report), *_of_codes(sample.codes, codes(report), graded.report)]


def unlisted(assignment: Assignment, graded: GradedFile) -> list[str]:
    """What a sample without an expectation is told: the entry it would have, or that its name is not what its report says."""
    if graded.report is None:
        return [f"is no submission: {graded.refused}"]
    if written := new_entry(assignment, graded):
        return ["has no entry in expected.toml; with --write it would get", *written.rstrip().split("\n")]
    said = "has no entry in expected.toml; right_… is to be all ✓ and any other name not, so that none is written:"
    return [said, *graded.report.text().rstrip().split("\n")]


def new_entry(assignment: Assignment, graded: GradedFile) -> str | None:
    """The entry of a sample that has none; None where its report is not what its name says."""
    if graded.report is None or graded.report.passed != graded.file.name.startswith("right_"):
        return None
    return entry(graded.file.name, None, assignment, document(graded.report))


def summary(assignment: Assignment, found: SampleSet, tally: Tally, whole: bool) -> Iterator[str]:
    """How many were as expected; and, of ``whole`` sets, what no sample shows: these are warnings."""
    agreed = tally.samples - tally.otherwise
    yield f"{assignment.slug}: {agreed} of {tally.samples} samples as expected, {len(tally.made)} checks"
    yield from (f"{name}: expected.toml has an entry for it, but there is no such file" for name in found.missing)
    if whole:
        yield from _listing("no sample fails", [c.id for c in assignment.checks() if c.id not in tally.failed])
        yield from _listing("no sample shows the diagnosis codes", [c for c in assignment.codes if c not in tally.named])
        if not tally.right:
            yield "warning: no sample is all ✓"


def _of_checks(sample: Sample, report: Report) -> Iterator[str]:
    outcomes = {o.id: o for o in report.outcomes()}
    for one in sample.differences(document(report)):
        want = f"expected {MARKS[one.expected]}" if one.expected else "not to be made"
        outcome = outcomes.get(one.check)
        if outcome is None:
            yield f"{one.check}: {want}, not made: its exercise was not attempted, or its function is not defined"
            continue
        yield f"{one.check}: {want}, got {MARKS[outcome.verdict]}"
        yield from (f"  {line}" for line in outcome.text().split("\n"))


def _of_codes(expected: frozenset[str], got: set[str], report: Report) -> Iterator[str]:
    if missing := expected - got:
        yield f"codes expected, but not named: {', '.join(sorted(missing))}"
    if more := got - expected:
        sentences = {d.code: d.sentence for o in report.outcomes() for d in o.diagnosis}
        yield from (f"code named, but not expected: {code} ({sentences[code]})" for code in sorted(more))


def _listing(what: str, names: Sequence[str]) -> Iterator[str]:
    if names:
        yield f"warning: {what} {', '.join(names)}"
