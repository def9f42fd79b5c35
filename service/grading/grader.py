"""Grading, and speed against accuracy of a submission, in one sandbox."""

import json
import time
from collections.abc import Collection

from exercises.authoring.assignments.assignment import Assignment, Sweep
from exercises.authoring.assignments.speed_vs_accuracy import compared
from polhode.judging.outcome import SweepResult
from polhode.report.dataclass_json import document
from polhode.report.report import Report
from service.grading.author_errors import author_errors, find_assignment
from service.grading.diagnosis.matching_variants import LIMITS
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.published.claims_in_loops import has_loops
from service.grading.run_in_sandbox import OnProgress, play_and_find_fault
from service.grading.sandbox_job import job_of, truth
from service.grading.submission import Submission
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget


class SweepFailed(Exception):
    """Speed against accuracy could not be measured. The message is for the student."""


class Grader:
    """Grades submissions in ``sandbox``, which passes its self-test before its first use."""

    def __init__(self, sandbox: Sandbox) -> None:
        self.sandbox = sandbox

    def longest_s(self, slug: str) -> float:
        """Return the seconds that a submission to an assignment occupies the sandbox at most. Raises
        SystemFault.
        """
        assignment = find_assignment(slug)
        solution = 1 if has_loops(assignment) else 0  # a worker plays it once
        return (1 + solution) * self.sandbox.limits.at_least(assignment.cpu_s).wall_s + LIMITS.wall_s

    def ready(self) -> None:
        """Return when the sandbox has passed its self-test. Raises SystemFault if it has not."""
        if not self.sandbox.self_tested:
            self.sandbox.self_test()

    def sweep(
        self, submission: Submission, assignment: Assignment, exercises: Collection[str] = ()
    ) -> SweepResult:
        """Measure speed against accuracy of a submission's function, and of a right solution right after: of
        the first of the ``exercises`` that has a chart, else of the assignment's first.

        Raises SweepFailed if that is not possible.
        """
        sweep = assignment.sweep_of(exercises) or assignment.sweep
        if sweep is None:
            raise SweepFailed(f"assignment {assignment.slug} does not measure speed against accuracy")
        self.ready()
        function = sweep.scene.function
        mine = self._swept(submission, assignment, sweep)
        source = assignment.right_submission(function)
        right = self._swept(Submission(source), assignment, sweep) if source else None
        return compared(mine, right, sweep, function)

    def _swept(self, submission: Submission, assignment: Assignment, sweep: Sweep) -> SweepResult:
        """Play a sweep with a submission's function. Raises SweepFailed if that is not possible."""
        scene = sweep.scene
        assert not callable(scene.inputs)
        began = time.monotonic()
        job = job_of(submission, assignment, [scene], {scene.name: scene.inputs})
        budget = TimeBudget(self.sandbox.limits.at_least(assignment.cpu_s))
        result = play_and_find_fault(job, assignment, self.sandbox, budget)
        elapsed = time.monotonic() - began
        if not result.finished(scene.name):
            scene_end = result.scene_ends.get(scene.name)
            raise SweepFailed(scene_end.sentence if scene_end else "your code stopped before the measurement")
        try:
            with author_errors(assignment):
                exact = truth(scene, scene.inputs)
            with author_errors(assignment, numbers=True):
                swept = sweep.read(result.arrays[scene.name], exact)
        except (ArithmeticError, ValueError) as error:
            raise SweepFailed(f"the results cannot be compared with the exact motion ({error})") from error
        arrived = sum(point.seconds for point in swept.points if not point.stopped)
        if not rendering.plausible(swept) or arrived > elapsed:
            raise SweepFailed(
                "the measurement returned impossible numbers of calls or seconds: submit your functions alone"
            )
        return swept

    def grade_and_pack(
        self,
        submission: Submission,
        slug: str,
        seed: int,
        on_progress: OnProgress,
    ) -> tuple[Report, dict[str, bytes]]:
        """Grade a submission. Return the report and its artefacts by name. Raises Cancelled, SystemFault."""
        self.ready()
        began = time.perf_counter()
        graded = grade(submission, find_assignment(slug), self.sandbox, seed, on_progress=on_progress)
        judged = time.perf_counter()
        packed = rendering.pack(graded)
        graded.report.provenance.phases_ms = {
            "grade": 1e3 * (judged - began),
            "pack": 1e3 * (time.perf_counter() - judged),
        }
        return graded.report, packed

    def sweep_and_draw(self, submission: Submission, slug: str) -> tuple[str, bytes]:
        """Measure speed against accuracy. Return JSON and an SVG chart. Raises SweepFailed, Cancelled."""
        swept = self.sweep(submission, find_assignment(slug))
        return json.dumps(document(swept)), rendering.draw_sweep(swept)
