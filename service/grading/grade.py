"""Grading a submission: draw the scenes, play them in the sandbox, judge the results by the exact answers."""

import functools
import logging
import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from exercises.authoring.assignments import packages
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.reported_lines import reported_lines
from polhode.judging.checks import Arrays
from polhode.judging.claims import Claim, NotebookCheck
from polhode.judging.exercise import Exercise, attempted
from polhode.judging.outcome import Diagnosis
from polhode.report.failure_causes import suspect_lines
from polhode.report.report import Provenance, Report, pictures
from service.grading.author_errors import author_errors
from service.grading.chains import play_chains, with_used
from service.grading.diagnosis import matching_variants
from service.grading.judge_exercise import judge
from service.grading.published.claims_in_loops import claims_of_solution
from service.grading.run_in_sandbox import OnProgress, play_job
from service.grading.sandbox_job import draw_inputs, job_of
from service.grading.submission import Submission
from service.sandbox.result import PlayResult, SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget
from service.sandbox.untrusted_text import text

log = logging.getLogger(__name__)
VERSIONS_OF = ("polhode", *packages.SANDBOX)
MOST_NAMED = 100  # characters of unknown exercises in a sentence


@dataclass(frozen=True)
class Graded:
    """A report, the exercises it covers, the arrays it was judged from, by scene, and the CPU time used in
    the sandbox.

    Figures are drawn from the arrays.
    """

    report: Report
    exercises: list[Exercise]
    arrays: Mapping[str, Arrays]
    cpu_s: float


class UnknownExercise(ValueError):
    """The assignment has no exercise with that number."""


def grade(
    submission: Submission,
    assignment: Assignment,
    sandbox: Sandbox,
    seed: int,
    numbers: Iterable[str] | None = None,
    *,
    on_progress: OnProgress = lambda phase, scene, scenes: None,
) -> Graded:
    """Grade the exercises ``numbers`` (None: those that the submission requests, or else attempts).

    ``seed`` determines the hidden scenes. All processes that run the submission have together the sandbox's
    time limits, or those that the assignment declares if they are longer; scenes that are left have then
    timed out. The variants that diagnose its errors have limits of their own. Raises
    UnknownExercise, and SystemFault if the sandbox fails, a package of the assignment is not installed, or
    the assignment's own code fails.
    """
    with author_errors(assignment):
        return _grade(submission, assignment, sandbox, seed, numbers, on_progress=on_progress)


def _grade(
    submission: Submission,
    assignment: Assignment,
    sandbox: Sandbox,
    seed: int,
    numbers: Iterable[str] | None,
    *,
    on_progress: OnProgress,
) -> Graded:
    if absent := missing_packages(assignment):
        raise SystemFault(absent)
    numbers = submission.exercises if numbers is None else numbers
    asked = select(assignment, numbers)
    wanted = {s for e in asked for s in e.scenes()}
    needed = _with_precursors(assignment, with_used(assignment, wanted))
    scenes = [s for s in assignment.scenes if s.name in needed]
    inputs = {s.name: draw_inputs(s, seed) for s in scenes}
    budget = TimeBudget(sandbox.limits.at_least(assignment.cpu_s))
    with budget.charged():
        job = job_of(submission, assignment, scenes, inputs)
    played = play_job(job, assignment, inputs, sandbox, budget, on_progress=on_progress)
    played = replace(played, claims_of_solution=claims_of_solution(assignment, sandbox))
    chains = play_chains(assignment, played, sandbox)
    result = played.result
    covered = asked if numbers is not None else _covered(asked, result.written)
    variants = TimeBudget(matching_variants.LIMITS)

    @functools.cache
    def causes(question: str) -> list[Diagnosis]:
        try:
            return matching_variants.diagnose_question(assignment, question, played, sandbox, variants)
        except (ArithmeticError, ValueError):  # numbers too large or small for what compares them
            log.exception("the diagnosis of question %s failed, so its report has none", question)
            return []

    sections = [judge(e, assignment, played, causes, remarks=chains.remarks) for e in covered]
    reported = _with_precursors(assignment, {s for e in covered for s in e.scenes()})
    shown = {name: arrays for name, arrays in result.arrays.items() if name in reported}
    figures, animations = pictures(covered, shown)
    cells = [(cell.name, cell.source) for cell in submission.cells()]
    numbers = [e.number for e in asked]
    report = Report(
        assignment=assignment.slug,
        version=assignment.version,
        exercises=sections,
        figures=figures,
        animations=animations,
        scene_ends=[*result.cells.values(), *(e for e in result.scene_ends.values() if e.scene in reported)],
        suspect_lines=suspect_lines(sections, assignment.tested_function, lambda name: cells),
        stdout=result.stdout,
        notebook_checks=_notebook_checks(result),
        provenance=Provenance(
            seed,
            versions(assignment.packages),
            sandbox.isolation.name,
            chains=chains.used,
        ),
        total=assignment.max_points(numbers, result.written),
        max_points=assignment.max_points(numbers),
        bonus_points=assignment.bonus_points(numbers),
        not_attempted=[e.number for e in asked if e not in covered],
    )
    return Graded(report, covered, shown, budget.cpu_s)


def select(assignment: Assignment, numbers: Iterable[str] | None) -> list[Exercise]:
    """Return the exercises ``numbers`` (None: all) in the assignment's order. Raises UnknownExercise."""
    if numbers is None:
        return list(assignment.exercises)
    wanted = set(numbers)
    if unknown := wanted - {e.number for e in assignment.exercises}:
        named = text(", ".join(sorted(unknown)), MOST_NAMED)
        raise UnknownExercise(f"assignment {assignment.slug} has no exercise {named}")
    return [e for e in assignment.exercises if e.number in wanted]


def missing_packages(assignment: Assignment) -> str:
    """Return a sentence that names the assignment's packages that are not installed, or ""."""
    absent = ", ".join(packages.missing(assignment.packages))
    return (
        f"assignment {assignment.slug} needs packages that are not installed on this server: {absent}"
        if absent
        else ""
    )


def _covered(exercises: list[Exercise], defined: set[str]) -> list[Exercise]:
    """Return the exercises that a submission attempts, and those with lines of published cells, which always
    run.
    """
    tried = attempted(exercises, defined)
    return [e for e in exercises if e in tried or reported_lines(e.checks)]


@functools.cache
def versions(more: tuple[str, ...] = ()) -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on, ``more`` of an assignment
    among them.
    """
    return {"python": platform.python_version()} | {
        name: packages.version(name) for name in (*VERSIONS_OF, *more)
    }


def _notebook_checks(result: PlayResult) -> list[NotebookCheck]:
    if not result.claims_left_out:
        return result.claims
    more = Claim(
        "check",
        f"{result.claims_left_out} more checks",
        left_out=f"at most {len(result.claims)} are accepted",
    )
    return [*result.claims, more.outcome("")]


def _with_precursors(assignment: Assignment, wanted: set[str]) -> set[str]:
    """Return the ``wanted`` scenes and those that they come after, where a failure shows its cause first."""
    return wanted | {after for s in assignment.scenes if s.name in wanted and (after := s.after) is not None}
