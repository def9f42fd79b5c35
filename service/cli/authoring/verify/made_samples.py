"""Verification of a declaration: the samples that follow from it, graded on several seeds, and its published
notebook.
"""

import functools
import statistics
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.validation import format_error
from exercises.authoring.mutants.variants import UNSEEN, MadeSample
from polhode.judging.verdict import Verdict
from polhode.kinds import NEW_INPUTS
from polhode.report.dataclass_json import document
from polhode.report.report import Report
from service.cli.authoring.verify.notebook_agreement import notebook_differences
from service.cli.authoring.verify.tally import Tally, cpu_warning
from service.cli.batch_progress import Progress
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.graded_file import GradedFile
from service.grading.sandbox_job import draw_inputs, truth
from service.sandbox.isolation.levels import Isolation

SLOW_S, MOST = 2.0, 3  # an exercise whose grading uses more CPU time is named, at most so many


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


def verify_made(
    assignment: Assignment,
    samples: Mapping[str, MadeSample],
    seeds: range,
    isolation: Isolation,
    jobs: int | None,
    *,
    whole: bool,
) -> int:
    """Grade the samples, by name, on each seed, run the published notebook, and print the results.

    With the ``whole`` set, also print what no sample shows. Returns the exit code.
    """
    if not samples:
        print(f"polhode: {assignment.slug}: no sample to grade", file=sys.stderr)
        return 2
    results, steps = _Results(assignment, samples), len(samples) * (len(seeds) + 1)
    with tempfile.TemporaryDirectory() as folder, Progress(steps, "as expected") as progress:
        requests = [GradeRequest(Path(folder, name), sample.ask) for name, sample in samples.items()]
        for request in requests:
            request.file.write_text(samples[request.file.name].source, encoding="utf-8")
        for turn, seed in enumerate(seeds):
            update = functools.partial(
                lambda before, done: progress.update(before + done), turn * len(samples)
            )
            for graded in grade_files(requests, GradeOptions(assignment, seed), isolation, jobs, update):
                progress.print("", good=results.add(seed, graded))
        update = functools.partial(
            lambda before, done: progress.update(before + done), len(seeds) * len(samples)
        )
        found = notebook_differences(assignment, list(samples.values()), results.reports, update)
    for name, wrong in results.differences.items():
        wrong += [*results.same_numbers(name), *found.get(name, ())]
        print("\n     ".join([f"{'✗' if wrong else '✓'}  {name}", *wrong]))
    for line in results.summary(len(seeds), whole=whole and not results.faults):
        print(line)
    return 2 if results.faults else 1 if any(results.differences.values()) else 0


class _Results:
    """What the gradings showed: the ``differences`` of each sample from what is expected, and the last
    ``reports``.
    """

    def __init__(self, assignment: Assignment, samples: Mapping[str, MadeSample]) -> None:
        self.assignment, self.samples, self.tally = assignment, samples, Tally()
        self.faults: set[str] = set()
        self.differences: dict[str, list[str]] = {name: [] for name in samples}
        self.reports: dict[str, Report] = {}
        self._measured: defaultdict[str, list[tuple[str, Verdict, str]]] = defaultdict(list)
        self._cpu_s: defaultdict[tuple[str, ...], list[float]] = defaultdict(list)

    def _left_open(self, sample: MadeSample) -> str:
        """Return what the questions of a sample's exercises ignore, in parentheses, or ""."""
        asked = [
            value
            for n in sample.ask
            for question in self.assignment.questions.get(n, ())
            for value in question["returns"]
        ]
        left_open = sorted({f"{value['name']} up to {value['up_to']}" for value in asked if value["up_to"]})
        return f" (they compare {', '.join(left_open)})" if left_open else ""

    def add(self, seed: int, graded: GradedFile) -> bool:
        """Add the grading of a sample. Return whether it is as expected."""
        name, report = graded.file.name, graded.report
        if graded.fault:
            self.faults.add(name)
            self.differences[name].append(f"seed {seed}: not graded (system fault): {graded.fault}")
            return False
        wrong = [f"cannot be graded: {graded.refused}"]
        if report is not None:
            self.reports[name] = report
            self._measured[name] += [(o.id, o.verdict, f"{o.measured or 0:.6g}") for o in report.outcomes()]
            self._cpu_s[self.samples[name].ask].append(graded.cpu_s)
            sample = self.samples[name]
            wrong = [
                line.replace(UNSEEN, UNSEEN + self._left_open(sample))
                for line in sample.unexpected(document(report))
            ]
            wrong += [f"  {line}" for line in report.text().split("\n")] if wrong else []
        self.tally.add(graded, expected=not wrong)
        self.differences[name] += [f"seed {seed}: {line}" for line in wrong]
        return not wrong

    def same_numbers(self, name: str) -> Iterator[str]:
        """Yield a line for each other mistake that the checks do not distinguish from that of an unexpected
        sample.
        """
        sample, numbers = self.samples[name], self._measured[name]
        if (
            self.differences[name]
            and not sample.right
            and any(verdict is Verdict.FAIL for _, verdict, _ in numbers)
        ):
            for other in [s for s in self.samples.values() if s.ask == sample.ask and s.name != name]:
                if self._measured[other.name] == numbers:
                    again = "give both mistakes the same code and sentence"
                    yield (
                        f"the checks do not distinguish it from {other.name}{self._left_open(sample)}:"
                        f" {again}"
                    )

    def summary(self, seeds: int, *, whole: bool) -> Iterator[str]:
        """Yield how many samples are as expected, and for a ``whole`` set the checks that no sample fails and
        slow exercises.
        """
        agreed = sum(not wrong for wrong in self.differences.values())
        yield (
            f"{self.assignment.slug}: {agreed} of {len(self.samples)} samples as expected on {seeds}"
            f" {'seeds' if seeds > 1 else 'seed'}, {len(self.tally.made)} checks"
            + (f"; {len(self.faults)} not graded" if self.faults else "")
        )
        if whole:
            yield from self._untested()
            yield from cpu_warning(self.assignment, self.tally)
            yield from self._slow()

    def _untested(self) -> Iterator[str]:
        ids: defaultdict[tuple[str, str], list[str]] = defaultdict(list)
        for check in self.assignment.checks():
            if check.scenes and check.id not in self.tally.failed:
                ids[
                    self.assignment.scene(check.scenes[0]).function, check.label.removesuffix(NEW_INPUTS)
                ].append(check.id)
        for (function, label), found in ids.items():
            yield (
                f"warning: no sample fails {' and '.join(found)}: declare a mistake of {function} that fails"
                f' "{label}"'
            )

    def _slow(self) -> Iterator[str]:
        times = {ask[0]: statistics.median(times) for ask, times in self._cpu_s.items() if len(ask) == 1}
        for number in sorted(times, key=times.__getitem__, reverse=True)[:MOST]:
            if times[number] > SLOW_S:
                yield (
                    f"exercise {number} uses {times[number]:.1f} s of CPU time: fewer rows, repetitions or"
                    " steps make it faster"
                )
