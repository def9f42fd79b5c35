"""Verification of the samples in an assignment's folder against their expected reports in expected.toml."""

import sys
from collections.abc import Iterator, Sequence

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.samples import Sample, SampleSet, codes, entry, with_entries
from polhode.judging.outcome import Ended
from polhode.judging.verdict import MARKS
from polhode.report.dataclass_json import document
from polhode.report.report import Report
from service.cli.authoring.verify.tally import Tally, cpu_warning
from service.cli.batch_progress import Progress
from service.cli.output_file import write
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.graded_file import GradedFile
from service.sandbox.isolation.levels import Isolation


def verify_written(
    assignment: Assignment,
    found: SampleSet,
    seed: int,
    isolation: Isolation,
    jobs: int | None,
    *,
    add_entries: bool,
    whole: bool,
) -> int:
    """Grade the samples and print the differences from what is expected of each. Returns the exit code.

    With ``add_entries`` an entry is written for each sample that has none. With the ``whole`` set, also
    print what no sample shows.
    """
    known = {sample.file: sample for sample in found.samples}
    requests = [
        GradeRequest(file, tuple(sample.ask) if sample.ask else None) for file, sample in known.items()
    ]
    requests += [GradeRequest(file) for file in found.unlisted]
    if not requests:
        folder = assignment.folder / "samples"
        print(f"polhode: {assignment.slug}: no sample to grade in {folder}", file=sys.stderr)
        return 2
    tally, entries, options = Tally(), list[str](), GradeOptions(assignment, seed)
    with Progress(len(requests), "as expected") as progress:
        for graded in grade_files(requests, options, isolation, jobs, progress.update):
            name = graded.file.name
            if graded.fault:
                tally.faults += 1
                progress.print(f"?  {name}   not graded (system fault): {graded.fault}", good=False)
                continue
            sample = known.get(graded.file)
            new = new_entry(assignment, graded) if add_entries and sample is None else None
            entries += [new] if new else []
            wrong = list(differences(sample, graded)) if sample else []
            wrong += [] if sample or new else missing_entry(assignment, graded)
            tally.add(graded, expected=not wrong)
            head = f"{'✗' if wrong else '✓'}  {name}{'   (entry written)' if new else ''}"
            progress.print("\n     ".join([head, *wrong]), good=not wrong)
    if entries:
        write(assignment.folder / "samples" / "expected.toml", with_entries(assignment, entries))
    for line in summary(assignment, found, tally, whole=whole and not tally.faults):
        print(line)
    return 2 if tally.faults else 1 if tally.unexpected or found.missing else 0


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
