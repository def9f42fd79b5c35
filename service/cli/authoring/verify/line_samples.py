"""Verification of a published notebook's own lines by the samples that follow from them."""

import tempfile
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.line_samples import line_samples
from exercises.authoring.importing.reported_lines import reported_lines
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.sandbox.isolation.levels import Isolation


def has_lines(assignment: Assignment) -> bool:
    """Return whether an assignment takes over lines of its notebook."""
    return bool(reported_lines(assignment.checks()))


def verify_lines(assignment: Assignment, seed: int, isolation: Isolation, jobs: int | None) -> int:
    """Grade the samples and print each with what is not as it must be. Returns the exit code."""
    samples, codes = {sample.name: sample for sample in line_samples(assignment)}, [0]
    with tempfile.TemporaryDirectory() as folder:
        requests = [GradeRequest(Path(folder, name)) for name in samples]
        for request in requests:
            request.file.write_text(samples[request.file.name].source, encoding="utf-8")
        for graded in grade_files(requests, GradeOptions(assignment, seed), isolation, jobs):
            sample = samples[graded.file.name]
            wrong = [graded.why] if graded.report is None else list(sample.unexpected(graded.report))
            print("\n     ".join([f"{'✗' if wrong else '✓'}  {sample.name}", *wrong]))
            codes.append(2 if graded.fault else 1 if wrong else 0)
    counted = sum(line.counts for line in next(iter(samples.values())).lines.values())
    agreed = sum(code == 0 for code in codes[1:])
    print(
        f"{assignment.slug}: {agreed} of {len(samples)} samples of its lines as expected; {counted} of"
        f" {len(next(iter(samples.values())).lines)} lines count"
    )
    if not any(sample.right for sample in samples.values()):
        print(
            "no solved notebook: put one into samples/ as right_all.ipynb, so that every line is seen to be ✓"
        )
    return max(codes)
