"""Grade a submission: draw the scenes, play them behind the wall, judge what comes back by the exact motion."""

import functools
import logging
import platform
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import metadata

import numpy as np

from ecp.checks import Arrays, Check
from ecp.claims import Claim, NotebookCheck
from ecp.exercise import Exercise, attempted
from ecp.judge import Verdict
from ecp.outcome import Diagnosis, Ended, Outcome, SceneEnd
from ecp.report import ExerciseReport, Provenance, Report, pictures
from exercises import packages
from exercises.assignment import Assignment, Inputs, Scene
from service.grading.crosscheck import Attempt, CrossCheck, cross_check
from service.grading.submission import Submission
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult, SystemFault
from service.sandbox.sandbox import Sandbox

log = logging.getLogger(__name__)
Tell = Callable[[str, int, int], None]
"""Called with the phase, the scene's place in order and the number of scenes."""
Causes = Callable[[str], list[Diagnosis]]
"""The diagnoses of the numbers that the scene of that name brought back."""
VERSIONS_OF = ("polhode", "numpy", "scipy", "matplotlib")


@dataclass(frozen=True)
class Graded:
    """A report, the exercises it covers, and the arrays it was judged from: what figures are drawn of."""

    report: Report
    exercises: list[Exercise]
    arrays: Mapping[str, Arrays]


class UnknownExercise(ValueError):
    """An exercise number the assignment does not have."""


def grade(
    submission: Submission,
    assignment: Assignment,
    sandbox: Sandbox,
    seed: int,
    numbers: Iterable[str] | None = None,
    *,
    tell: Tell = lambda phase, scene, scenes: None,
) -> Graded:
    """Grade the exercises ``numbers``, or without them every exercise the submission has attempted.

    ``seed`` draws the scenes a student must not know; the same seed gives the same questions.
    ``tell`` hears how far it is. Raises UnknownExercise, and Fault when the sandbox fails: then there is no report.
    """
    if absent := missing_packages(assignment):
        raise SystemFault(absent)
    asked = select(assignment, numbers)
    wanted = {s for e in asked for s in e.scenes()}
    inputs = {s.name: draw_inputs(s, seed) for s in assignment.scenes if s.name in _with_precursors(assignment, wanted)}
    job = job_of(submission, assignment, [s for s in assignment.scenes if s.name in inputs], inputs)
    seen, truths = _play(job, assignment, inputs, sandbox, tell)
    tell("judging", len(job.scenes), len(job.scenes))
    attempt = Attempt(job, inputs, truths, seen)
    crossed = cross_check(assignment, attempt, sandbox, seed)
    _add_what_is_known(assignment, seen, truths)
    covered = asked if numbers is not None else attempted(asked, seen.defined)
    causes = functools.cache(lambda scene: _diagnosed(assignment, scene, inputs, seen.arrays))
    sections = [_judge(e, assignment, attempt, crossed, causes) for e in covered]
    told = _with_precursors(assignment, {s for e in covered for s in e.scenes()})
    shown = {name: arrays for name, arrays in seen.arrays.items() if name in told}
    figures, animations = pictures(covered, shown)
    missed = [e.number for e in asked if e not in covered]
    report = Report(
        assignment=assignment.slug,
        version=assignment.version,
        exercises=sections,
        figures=figures,
        animations=animations,
        scene_ends=[*seen.cells.values(), *(e for e in seen.scene_ends.values() if e.scene in told)],
        stdout=seen.stdout,
        notebook_checks=_own_checks(seen),
        provenance=Provenance(seed=seed, versions=versions(), isolation=sandbox.isolation.name, motions=crossed.how),
        not_attempted=missed,
    )
    report.total = report.max_score + assignment.max_points(missed)
    return Graded(report, covered, shown)


def select(assignment: Assignment, numbers: Iterable[str] | None) -> list[Exercise]:
    """The exercises of those numbers, in the assignment's order; all of them for None."""
    if numbers is None:
        return list(assignment.exercises)
    wanted = set(numbers)
    if unknown := wanted - {e.number for e in assignment.exercises}:
        raise UnknownExercise(f"assignment {assignment.slug} has no exercise {', '.join(sorted(unknown))}")
    return [e for e in assignment.exercises if e.number in wanted]


def missing_packages(assignment: Assignment) -> str:
    """Say which packages of the assignment this server does not have; "" if none."""
    absent = ", ".join(packages.missing(assignment.packages))
    return f"assignment {assignment.slug} needs packages that are not installed on this server: {absent}" if absent else ""


def draw_inputs(scene: Scene, seed: int) -> Inputs:
    """The scene's inputs: fixed, or drawn from a generator of the seed and the scene's name alone."""
    if not callable(scene.inputs):
        return scene.inputs
    return scene.inputs(np.random.default_rng([seed, zlib.crc32(scene.name.encode())]))


def truth(scene: Scene, inputs: Inputs) -> Arrays:
    """The exact answer of a scene; kept where the inputs are fixed."""
    return scene.truth(inputs) if callable(scene.inputs) else _fixed_truth(scene)


def job_of(submission: Submission, assignment: Assignment, scenes: Iterable[Scene], inputs: Mapping[str, Inputs]) -> Job:
    """The question for the far side of the wall: the submission's cells and these scenes."""
    played = tuple(SceneRequest(s.name, s.play, s.function, inputs[s.name], s.returns, s.budget_s, s.after) for s in scenes)
    setup, plays = ((assignment.folder / name).read_text(encoding="utf-8") for name in ("setup.py", "plays.py"))
    return Job(setup, plays, submission.cells(), tuple(sorted(assignment.functions())), played)


@functools.cache
def versions() -> dict[str, str]:
    """Versions of Python and of what the numbers depend on."""
    return {"python": platform.python_version()} | {name: metadata.version(name) for name in VERSIONS_OF}


@functools.cache
def _fixed_truth(scene: Scene) -> Arrays:
    assert not callable(scene.inputs)
    return scene.truth(scene.inputs)


def _play(
    job: Job, assignment: Assignment, inputs: dict[str, Inputs], sandbox: Sandbox, tell: Tell
) -> tuple[PlayResult, dict[str, Arrays]]:
    """What came back, and the exact answer to each scene of it, worked out while the guest plays that scene."""
    places = {played.name: k for k, played in enumerate(job.scenes, start=1)}
    exact: dict[str, Arrays] = {}

    def begin(scene: str) -> None:
        tell("playing", places[scene], len(places))
        exact[scene] = truth(assignment.scene(scene), inputs[scene])

    seen = sandbox.play(job, begin)
    for name in list(seen.arrays):
        scene = assignment.scene(name)
        instead = scene.replaced(inputs[name], seen.arrays[name]) if scene.replaced else None
        if isinstance(instead, str):
            del seen.arrays[name]
            seen.scene_ends[name] = SceneEnd(scene=name, ended=Ended.WRONG_ANSWER, sentence=instead)
        elif instead is not None:
            inputs[name], exact[name] = instead, scene.truth(instead)
    for scene_end in (*seen.cells.values(), *seen.scene_ends.values()):
        if scene_end.ended is Ended.RAISED and scene_end.sentence.startswith("ModuleNotFoundError: "):
            scene_end.sentence += f" (the sandbox has {packages.listing(assignment.packages)})"
    return seen, {name: exact[name] for name in seen.arrays}


def _own_checks(seen: PlayResult) -> list[NotebookCheck]:
    if not seen.claims_left_out:
        return seen.claims
    more = Claim("check", f"{seen.claims_left_out} more checks", left_out=f"at most {len(seen.claims)} are taken")
    return [*seen.claims, more.outcome("")]


def _with_precursors(assignment: Assignment, wanted: set[str]) -> set[str]:
    """The wanted scenes and those they come after, which tell the likelier cause of a failure first."""
    return wanted | {after for s in assignment.scenes if s.name in wanted and (after := s.after) is not None}


def _add_what_is_known(assignment: Assignment, seen: PlayResult, truths: Mapping[str, Arrays]) -> None:
    for name, arrays in seen.arrays.items():
        arrays |= {known: truths[name][known] for known in assignment.scene(name).known}


def _judge(exercise: Exercise, assignment: Assignment, attempt: Attempt, crossed: CrossCheck, causes: Causes) -> ExerciseReport:
    outcomes, seen = [], attempt.seen
    for check in exercise.applicable_checks(seen.defined, lambda scene: assignment.scene(scene).function):
        scenes = [assignment.scene(name) for name in check.scenes]
        outcome = _outcome(check, scenes, seen, attempt.truths)
        if unsteady := next((s for s in scenes if {s.name, s.after} & crossed.unsteady), None):
            if outcome.verdict is Verdict.PASS:
                outcome = check.failed("the same questions in another order got other answers")
            outcome.diagnosis = [_unsteady(unsteady)]
        elif outcome.verdict is not Verdict.PASS:
            outcome.diagnosis = _likely(scenes, seen, causes)
        outcome.hidden = assignment.hidden(check)
        outcomes.append(outcome)
    return ExerciseReport(number=exercise.number, title=exercise.title, outcomes=outcomes)


def _unsteady(scene: Scene) -> Diagnosis:
    sentence = f"{scene.function} does not answer the same question alike: it must use its arguments only, not the clock or chance"
    return Diagnosis(code="not-deterministic", sentence=sentence, confidence=1.0)


def _outcome(check: Check, scenes: list[Scene], seen: PlayResult, truths: Mapping[str, Arrays]) -> Outcome:
    for scene in scenes:
        if not seen.finished(scene.name):
            return check.unmeasured(_cause(scene, seen))
    return check.judge([seen.arrays[s.name] for s in scenes], [truths[s.name] for s in scenes])


def _cause(scene: Scene, seen: PlayResult) -> str:
    """Why a scene brought nothing: its own scene_end, or that of the scene it comes after, or of the cell that failed before."""
    scene_end = seen.scene_ends.get(scene.name)
    if scene_end is None:
        return "your code stopped before this was played"
    if scene_end.ended is Ended.NOT_PLAYED and scene.after in seen.scene_ends and not seen.finished(scene.after):
        scene_end = seen.scene_ends[scene.after]
    if scene_end.ended is Ended.MISSING and (failed := _failed_cell(seen)):
        return f"{scene_end.sentence}; {failed.scene} stopped with {failed.sentence}"
    return scene_end.sentence


def _failed_cell(seen: PlayResult) -> SceneEnd | None:
    """The one cell that failed; with several, which of them was to define a function cannot be told."""
    return next(iter(seen.cells.values())) if len(seen.cells) == 1 else None


def _diagnosed(assignment: Assignment, scene: str, inputs: Mapping[str, Inputs], arrays: Mapping[str, Arrays]) -> list[Diagnosis]:
    """The causes found; none where looking for them fails, because a missing cause must not cost a report."""
    function = assignment.scene(scene).function
    same = [s.name for s in assignment.scenes if s.function == function and s.name in arrays]
    try:
        with np.errstate(all="ignore"):
            found = assignment.diagnose_function(function, {name: (inputs[name], arrays[name]) for name in same})
            return assignment.diagnose(scene, inputs[scene], arrays[scene]) if found is None else found
    except Exception:
        log.exception("no cause could be looked for in scene %s", scene)
        return []


def _likely(scenes: list[Scene], seen: PlayResult, causes: Causes) -> list[Diagnosis]:
    """The likely cause: what the numbers of a scene or of the one before it single out, else how it ended."""
    for scene in scenes:
        for name in (scene.after, scene.name):
            if name in seen.arrays and (found := causes(name)):
                return list(found)
    for scene in scenes:
        for name in (scene.after, scene.name):
            scene_end = seen.scene_ends.get(name or "")
            if scene_end is not None and scene_end.ended is Ended.MISSING and (failed := _failed_cell(seen)):
                scene_end = failed
            if scene_end is not None and scene_end.code is not None:
                return [Diagnosis(code=scene_end.code, sentence=scene_end.sentence, confidence=1.0)]
    return []
