"""Comparison of graded samples with their expected reports, as text for the assignment's author."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.samples import Sample, SampleSet, codes, entry
from exercises.authoring.assignments.validation import format_error
from polhode.judging.judge import MARKS, Verdict
from polhode.judging.outcome import Ended
from polhode.report.document import document
from polhode.report.report import Report
from service.grading.jobs import draw_inputs, truth
from service.grading.result import GradedFile
from service.sandbox.time_budget import DEFAULT_LIMITS

CPU_FACTOR = 5  # a grading's limit of CPU time, in units of what the right solution uses


@dataclass
class Tally:
    """Counts over the samples of an assignment, with the checks made and the checks that failed. ``faults``
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


def declaration_errors(assignment: Assignment, seed: int) -> list[str]:
    """Return what the author's draws, truths and solutions raise when each scene is asked once, with file and
    line.
    """
    found = []
    for scene in (scene for scene in assignment.scenes if scene.question is not None):
        try:
            truth(scene, draw_inputs(scene, seed))
        except (Exception, SystemExit) as error:
            found.append(format_error(error, assignment.folder))
    return list(dict.fromkeys(found))


def differences(sample: Sample, graded: GradedFile) -> Iterator[str]:
    """Yield the differences from the expected report: each such check with its line and diagnosis, then the
    codes.
    """
    if graded.report is None:
        yield f"cannot be graded: {graded.refused}"
        return
    outcomes = {o.id: o for o in graded.report.outcomes()}
    for id, expected in sample.differences(document(graded.report)).items():
        want = f"expected {MARKS[expected]}" if expected else "expected no result"
        if id not in outcomes:
            yield (
                f"{id}: {want}, got no result: its exercise was not attempted, or its function is not defined"
            )
            continue
        yield f"{id}: {want}, got {MARKS[outcomes[id].verdict]}"
        yield from (f"  {line}" for line in outcomes[id].text().split("\n"))
    got = codes(document(graded.report))
    if missing := sample.codes - got:
        yield f"missing diagnosis codes: {', '.join(sorted(missing))}"
    sentences = {d.code: d.sentence for o in outcomes.values() for d in o.diagnosis}
    yield from (
        f"unexpected diagnosis code: {code} ({sentences[code]})" for code in sorted(got - sample.codes)
    )


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
        return [
            f"has no entry in expected.toml and none was added: {late} did not finish in time, and {slow}"
        ]
    rule = "a sample named right_… must pass every check, and any other sample must fail one"
    return [
        f"has no entry in expected.toml and none was added: {rule}",
        *graded.report.text().rstrip().split("\n"),
    ]


def _timed_out(report: Report) -> str:
    """Return the names of the scenes and cells that did not finish in time."""
    return ", ".join(scene_end.scene for scene_end in report.scene_ends if scene_end.ended is Ended.TIMED_OUT)


def new_entry(assignment: Assignment, graded: GradedFile) -> str | None:
    """Return the entry for a sample without one, or None if its report contradicts its name or has a
    time-out.
    """
    if (
        graded.report is None
        or graded.report.passed != graded.file.name.startswith("right_")
        or _timed_out(graded.report)
    ):
        return None
    return entry(graded.file.name, None, assignment, document(graded.report))


def summary(assignment: Assignment, found: SampleSet, tally: Tally, whole: bool) -> Iterator[str]:
    """Yield how many samples are as expected and which entries lack a file; for a ``whole`` set also warnings
    about checks and codes that no sample shows.
    """
    agreed = tally.samples - tally.unexpected
    yield (
        f"{assignment.slug}: {agreed} of {tally.samples + tally.faults} samples as expected,"
        f" {len(tally.made)} checks" + (f"; {tally.faults} not graded" if tally.faults else "")
    )
    yield from (f"{name}: listed in expected.toml, but the file does not exist" for name in found.missing)
    if whole:
        yield from _warning(
            "no sample fails", [c.id for c in assignment.checks() if c.id not in tally.failed]
        )
        if not tally.right:
            yield "warning: no sample is all ✓"
        yield from cpu_warning(assignment, tally)


def _warning(what: str, names: Sequence[str]) -> Iterator[str]:
    if names:
        yield f"warning: {what} {', '.join(names)}"
