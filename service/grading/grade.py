"""Grading a submission: draw the scenes, play them in the sandbox, judge the results by the exact answers."""

import functools
import logging
import platform
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ecp.checks import Arrays, Check
from ecp.claims import Claim, NotebookCheck
from ecp.exercise import Exercise, attempted
from ecp.judge import Verdict
from ecp.notes import Absent, unsaid
from ecp.outcome import Diagnosis, Ended, ExerciseReport, Outcome, SceneEnd
from ecp.report import Provenance, Report, pictures
from exercises import packages
from exercises.assignment import Assignment, Inputs, Recording, Scene
from exercises.validation_cells import ReportedLine
from service.grading.author_errors import author_errors, play
from service.grading.chains import play_chains, with_used
from service.grading.crosscheck import CrossCheck, cross_check, may_be_spared
from service.grading.jobs import draw_inputs, job_of, truth
from service.grading.reproduction import diagnose_question
from service.grading.second_child import PlayedJob, SecondChild, discard
from service.grading.submission import Submission
from service.sandbox.job import Job
from service.sandbox.result import PlayResult, SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

log = logging.getLogger(__name__)
OnProgress = Callable[[str, int, int], None]
"""A function called with the phase, the number of the scene in order, and the number of scenes."""
Causes = Callable[[str], list[Diagnosis]]
"""A function that returns the diagnoses of a scene's results, given its name, or of a question's, given its
id.
"""
VERSIONS_OF = ("polhode", *packages.SANDBOX)
MISSING_MODULE = re.compile(r"\bModuleNotFoundError: No module named '[^']*'$")


@dataclass(frozen=True)
class Graded:
    """A report, the exercises it covers, the arrays it was judged from, by scene, and the CPU time used in
    the sandbox.

    Figures are drawn from the arrays. Those of ``recorded`` scenes are from recordings, which many
    submissions share.
    """

    report: Report
    exercises: list[Exercise]
    arrays: Mapping[str, Arrays]
    cpu_s: float
    recorded: Mapping[str, Recording]


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
    """Grade the exercises ``numbers`` (None: every exercise that the submission attempts).

    ``seed`` determines the hidden scenes. All processes together have the sandbox's time limits, or those
    that the assignment declares if they are longer; scenes that are left have then timed out. Raises
    UnknownExercise, and SystemFault if the sandbox fails, a package of the assignment is not installed, or
    the assignment's own code fails.
    """
    with author_errors(assignment):
        try:
            return _grade(submission, assignment, sandbox, seed, numbers, on_progress=on_progress)
        finally:
            sandbox.end_unused_child()


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
    asked = select(assignment, numbers)
    wanted = {s for e in asked for s in e.scenes()}
    needed = _with_precursors(assignment, with_used(assignment, wanted))
    scenes = [s for s in assignment.scenes if s.name in needed]
    limits = sandbox.limits.at_least(assignment.cpu_s)
    sandbox.start_child(
        job_of(submission, assignment, [s for s in scenes if not may_be_spared(s)]), TimeBudget(limits)
    )
    inputs = {s.name: draw_inputs(s, seed) for s in scenes}
    job, budget = job_of(submission, assignment, scenes, inputs, seed), TimeBudget(limits)

    def play_and_check(
        job: Job, on_progress: OnProgress = lambda phase, scene, scenes: None
    ) -> tuple[PlayedJob, CrossCheck]:
        spared = [p for p in job.scenes if may_be_spared(assignment.scene(p.name))]
        first = job.without({p.name for p in spared})
        with SecondChild(assignment, spared, sandbox, seed) as second:
            played = _play(first, assignment, inputs, sandbox, budget, second=second, on_progress=on_progress)
            result = played.result
            on_progress("judging", len(first.scenes), len(first.scenes))
            crossed = cross_check(assignment, played, second, sandbox)
        result.scene_ends = {
            p.name: result.scene_ends[p.name] for p in job.scenes if p.name in result.scene_ends
        }
        _add_known_arrays(assignment, result, played.truths)
        return played, crossed

    played, crossed = play_and_check(job, on_progress)
    chains = play_chains(assignment, played, crossed, play_and_check, functools.partial(_passes, assignment))
    result = played.result
    covered = asked if numbers is not None else _covered(asked, result.written)
    reproduced = functools.cache(lambda question: diagnose_question(assignment, question, played, sandbox))
    causes = functools.cache(lambda scene: _diagnose(assignment, scene, played, reproduced))
    sections = [_judge(e, assignment, played, crossed, causes, remarks=chains.remarks) for e in covered]
    reported = _with_precursors(assignment, {s for e in covered for s in e.scenes()})
    shown = {name: arrays for name, arrays in result.arrays.items() if name in reported}
    figures, animations = pictures(covered, shown)
    numbers = [e.number for e in asked]
    report = Report(
        assignment=assignment.slug,
        version=assignment.version,
        exercises=sections,
        figures=figures,
        animations=animations,
        scene_ends=[*result.cells.values(), *(e for e in result.scene_ends.values() if e.scene in reported)],
        stdout=result.stdout,
        notebook_checks=_notebook_checks(result),
        provenance=Provenance(
            seed,
            versions(assignment.packages),
            sandbox.isolation.name,
            motions=crossed.how,
            chains=chains.used,
        ),
        total=assignment.max_points(numbers, result.written),
        max_points=assignment.max_points(numbers),
        bonus_points=assignment.bonus_points(numbers),
        not_attempted=[e.number for e in asked if e not in covered],
    )
    return Graded(report, covered, shown, budget.cpu_s, _judged(played.recalled, shown))


def _judged(recalled: Mapping[str, Recording], shown: Mapping[str, Arrays]) -> dict[str, Recording]:
    """Return the recordings whose arrays were judged. Others have been replaced by a motion that the host has
    integrated.
    """
    return {
        scene: one
        for scene, one in recalled.items()
        if scene in shown and all(shown[scene].get(name) is array for name, array in one.arrays.items())
    }


def select(assignment: Assignment, numbers: Iterable[str] | None) -> list[Exercise]:
    """Return the exercises ``numbers`` (None: all) in the assignment's order. Raises UnknownExercise."""
    if numbers is None:
        return list(assignment.exercises)
    wanted = set(numbers)
    if unknown := wanted - {e.number for e in assignment.exercises}:
        raise UnknownExercise(f"assignment {assignment.slug} has no exercise {', '.join(sorted(unknown))}")
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
    return [e for e in exercises if e in tried or any(isinstance(check, ReportedLine) for check in e.checks)]


@functools.cache
def versions(more: tuple[str, ...] = ()) -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on, ``more`` of an assignment
    among them.
    """
    return {"python": platform.python_version()} | {
        name: packages.version(name) for name in (*VERSIONS_OF, *more)
    }


def _play(
    job: Job,
    assignment: Assignment,
    inputs: dict[str, Inputs],
    sandbox: Sandbox,
    budget: TimeBudget,
    *,
    second: SecondChild,
    on_progress: OnProgress,
) -> PlayedJob:
    """Play the job, and start the ``second`` child as soon as possible. Return the job with its result and
    the exact answers, also of the scenes spared, computed meanwhile.
    """
    places = {request.name: k for k, request in enumerate(job.scenes, start=1)}
    exact: dict[str, Arrays] = {}
    failed: list[Exception] = []

    def on_scene(scene: str, so_far: PlayResult) -> None:
        on_progress("playing", places[scene], len(places))
        try:
            second.start(PlayedJob(job, inputs, exact, so_far, budget), scene)
            for name in (scene, *(p.name for p in second.spared if p.after == scene)):
                exact[name] = truth(assignment.scene(name), inputs[name])
        except Exception as error:  # raised after the play: the guest goes on
            failed.append(error)

    result = play(job, assignment, sandbox, on_scene, budget)
    if failed:
        raise failed[0]
    recalled = dict[str, Recording]()
    for name in list(result.arrays):
        scene = assignment.scene(name)
        if scene.recorded and (number := result.arrays[name].get("recorded")) is not None:
            if (known := scene.recorded.recall(number)) is None:
                discard(
                    result,
                    name,
                    Ended.WRONG_ANSWER,
                    "the play returned the number of a recorded motion that does not exist",
                )
                continue
            result.arrays[name], recalled[name] = dict(known.arrays), known
        instead = scene.replaced(inputs[name], result.arrays[name]) if scene.replaced else None
        if isinstance(instead, str):
            del result.arrays[name]
            result.scene_ends[name] = SceneEnd(scene=name, ended=Ended.WRONG_ANSWER, sentence=instead)
        elif instead is not None:
            inputs[name], exact[name] = instead, scene.truth(instead)
    for scene_end in (*result.cells.values(), *result.scene_ends.values()):
        if MISSING_MODULE.search(scene_end.sentence):
            there = f" (the sandbox has {packages.listing(assignment.packages)})"
            scene_end.sentence += there
            scene_end.because = scene_end.because and scene_end.because + there
    truths = {
        name: arrays
        for name, arrays in exact.items()
        if name in {*result.arrays, *(p.name for p in second.spared)}
    }
    return PlayedJob(job, inputs, truths, result, budget, recalled)


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


def _add_known_arrays(assignment: Assignment, result: PlayResult, truths: Mapping[str, Arrays]) -> None:
    for name, arrays in result.arrays.items():
        arrays |= {known: truths[name][known] for known in assignment.scene(name).known}


def _judge(
    exercise: Exercise,
    assignment: Assignment,
    played: PlayedJob,
    crossed: CrossCheck,
    causes: Causes,
    *,
    remarks: Mapping[str, list[str]],
) -> ExerciseReport:
    outcomes, result, said = [], played.result, set[str]()
    for check in exercise.applicable_checks(result.written, assignment.names):
        scenes = [assignment.scene(name) for name in check.scenes]
        outcome = _outcome(check, scenes, result, played.truths)
        if unsteady := next((s for s in scenes if {s.name, s.after} & crossed.unsteady), None):
            if outcome.verdict is Verdict.PASS:
                outcome = check.failed("the same questions in another order got different answers")
            outcome.diagnosis, outcome.partial = [_unsteady(unsteady)], None
        elif absent := _absent(check, scenes, result):
            outcome.diagnosis = [Diagnosis(absent.code, absent.sentence, 1.0)] if absent.code else []
        elif outcome.verdict is not Verdict.PASS:
            outcome.diagnosis = _diagnose_failure(scenes, result, causes)
        outcome.hidden = assignment.hidden(check)
        outcome.remarks = [remark for name in check.scenes[:1] for remark in remarks.get(name, [])]
        noted = [result.noted(name) for s in scenes for name in (s.name, s.after)]
        outcome.remarks += unsaid(noted, said)
        outcomes.append(outcome)
    return ExerciseReport(number=exercise.number, title=exercise.title, outcomes=outcomes)


def _unsteady(scene: Scene) -> Diagnosis:
    sentence = (
        f"{scene.function} does not always return the same value for the same arguments: "
        "it must not use the clock, random numbers or results of earlier calls"
    )
    return Diagnosis(code="not-deterministic", sentence=sentence, confidence=1.0)


def _passes(assignment: Assignment, check: Check, played: PlayedJob, crossed: CrossCheck) -> bool:
    scenes = [assignment.scene(name) for name in check.scenes]
    steady = not any({s.name, s.after} & crossed.unsteady for s in scenes)
    outcome = _outcome(check, scenes, played.result, played.truths)
    return steady and (outcome.verdict is Verdict.PASS or not outcome.counted)


def _outcome(check: Check, scenes: list[Scene], result: PlayResult, truths: Mapping[str, Arrays]) -> Outcome:
    if isinstance(check, ReportedLine):
        claims = result.reported.get((check.cell, check.call.place), ())
        return check.reported(claims, _cause_of_cell(check.cell, result), stopped=check.cell in result.cells)
    for scene in scenes:
        if not result.finished(scene.name):
            return check.unmeasured(_cause(scene, result))
    if absent := _absent(check, scenes, result):
        return check.unmeasured(absent.sentence)
    return check.judge([result.arrays[s.name] for s in scenes], [truths[s.name] for s in scenes])


def _absent(check: Check, scenes: list[Scene], result: PlayResult) -> Absent | None:
    """Return why an array that the check reads is absent, None if none is."""
    found = (result.noted(s.name).unread(check.arrays) for s in scenes if result.finished(s.name))
    return next(filter(None, found), None)


def _cause(scene: Scene, result: PlayResult) -> str:
    """Return why a scene has no result: its own scene end, or that of the scene it comes after."""
    scene_end = result.scene_ends.get(scene.name)
    if scene_end is None:
        return "your code stopped before this scene was played"
    if (
        scene_end.ended is Ended.NOT_PLAYED
        and scene.after in result.scene_ends
        and not result.finished(scene.after)
    ):
        scene_end = result.scene_ends[scene.after]
    return scene_end.sentence


def _cause_of_cell(cell: str, result: PlayResult) -> str:
    """Return why a published cell did not reach a line."""
    if cell not in result.cells:
        return "the cell did not reach this line, or your code stopped before"
    return f"the validation cell stopped with {result.cells[cell].sentence}"


def _diagnose(assignment: Assignment, scene: str, played: PlayedJob, reproduced: Causes) -> list[Diagnosis]:
    """Return the diagnoses of a scene, or none if the assignment's diagnosis fails, which must not prevent a
    report.

    ``reproduced`` returns those of a question by its id.
    """
    if (question := assignment.scene(scene).question) is not None:
        return reproduced(question["id"])
    function, inputs, arrays = assignment.scene(scene).function, played.inputs, played.result.arrays
    same = [s.name for s in assignment.scenes if s.function == function and s.name in arrays]
    try:
        with np.errstate(all="ignore"):
            found = assignment.diagnose_function(
                function, {name: (inputs[name], arrays[name]) for name in same}
            )
            return assignment.diagnose(scene, inputs[scene], arrays[scene]) if found is None else found
    except Exception:
        log.exception("the diagnosis of scene %s failed", scene)
        return []


def _diagnose_failure(scenes: list[Scene], result: PlayResult, causes: Causes) -> list[Diagnosis]:
    """Return the diagnoses of the results of a scene or of the one before it, else one for its scene end."""
    for scene in scenes:
        for name in (scene.after, scene.name):
            if name in result.arrays and (found := causes(name)):
                return list(found)
    for scene in scenes:
        for name in (scene.after, scene.name):
            scene_end = result.scene_ends.get(name or "")
            if scene_end is not None and scene_end.code is not None:
                return [Diagnosis(code=scene_end.code, sentence=scene_end.cause, confidence=1.0)]
    return []
