"""Playing a submission's job in the sandbox, with the exact answers computed on the host meanwhile."""

import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from exercises.authoring.assignments import packages
from exercises.authoring.assignments.assignment import Assignment, Inputs
from polhode.judging.author_errors import UNUSABLE, same_error
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Ended, SceneEnd
from service.grading.author_errors import MISSING_MODULE, fault
from service.grading.published.claims_in_loops import Claims
from service.grading.sandbox_job import truth
from service.grading.seed_repeatability import compare_afresh
from service.sandbox.job import Cell, Job
from service.sandbox.result import OnScene, PlayResult, ignore
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

OnProgress = Callable[[str, int, int], None]
"""A function called with the phase, the number of the scene in order, and the number of scenes."""
NO_SUBMISSION = """
class {name}: pass
def {function}(*values, **named): return {name}()
"""
"""Replaces a right submission where none is known. What it returns has no properties, and a submission cannot
return the same.
"""


@dataclass(frozen=True)
class PlayedJob:
    """A job with the inputs and exact answers of its scenes, the result of playing it, the grading's time
    budget, and the claims that loops of published cells make with the author's solution.
    """

    job: Job
    inputs: Mapping[str, Inputs]
    truths: dict[str, Arrays]
    result: PlayResult
    budget: TimeBudget
    claims_of_solution: Claims = field(default_factory=dict)


def play_job(
    job: Job,
    assignment: Assignment,
    inputs: dict[str, Inputs],
    sandbox: Sandbox,
    budget: TimeBudget,
    *,
    on_progress: OnProgress = lambda phase, scene, scenes: None,
) -> PlayedJob:
    """Play a job. Arrays of the exact answers that are known are added to the returned ones."""
    places = {request.name: k for k, request in enumerate(job.scenes, start=1)}
    exact: dict[str, Arrays] = {}
    failed: list[Exception] = []

    def on_scene(scene: str) -> None:
        on_progress("playing", places[scene], len(places))
        try:
            exact[scene] = truth(assignment.scene(scene), inputs[scene])
        except Exception as error:  # raised after the play: the guest goes on
            failed.append(error)

    result = play_and_find_fault(job, assignment, sandbox, budget, on_scene)
    if failed:
        raise failed[0]
    compare_afresh(job, result, sandbox, budget)
    on_progress("judging", len(places), len(places))
    for name in list(result.arrays):
        scene = assignment.scene(name)
        instead = scene.replaced(inputs[name], result.arrays[name]) if scene.replaced else None
        if isinstance(instead, str):
            del result.arrays[name]
            result.scene_ends[name] = SceneEnd(scene=name, ended=Ended.WRONG_ANSWER, sentence=instead)
        elif instead is not None:
            inputs[name], exact[name] = instead, scene.truth(instead)
    for name, arrays in result.arrays.items():
        arrays |= {known: exact[name][known] for known in assignment.scene(name).known}
    _list_packages(assignment, result)
    return PlayedJob(job, inputs, exact, result, budget)


def play_and_find_fault(
    job: Job,
    assignment: Assignment,
    sandbox: Sandbox,
    budget: TimeBudget,
    on_scene: OnScene = ignore,
) -> PlayResult:
    """Play the job as ``Sandbox.play`` does. Raises AssignmentFault if a scene fails because of the
    assignment.

    A scene whose exception the submission's code did not raise itself is played again, in another child, with
    a right submission, within the same ``budget``. If it fails at the same place, the assignment is the
    cause, else what the student's function returned.
    """
    result = sandbox.play(job, on_scene, budget)
    for scene in job.scenes:
        if (found := result.author_errors.get(scene.name)) is None:
            continue
        source = assignment.right_submission(scene.function)
        known = source is not None
        if source is None:
            source = NO_SUBMISSION.format(name=f"_{secrets.token_hex(8)}", function=scene.function)
        right = replace(job, cells=(Cell("solution.py", source),), scenes=(replace(scene, after=None),))
        other = sandbox.play(right, budget=budget).author_errors.get(scene.name)
        if other is not None and (same_error(found, other) if known else found == other):
            raise fault(assignment, f"scene {scene.name}: {other}")
        sentence = UNUSABLE.format(function=scene.function, error=result.scene_ends[scene.name].sentence)
        result.scene_ends[scene.name] = SceneEnd(
            scene=scene.name, ended=Ended.WRONG_ANSWER, sentence=sentence
        )
    return result


def _list_packages(assignment: Assignment, result: PlayResult) -> None:
    """Add to the sentence of a missing package what the sandbox has."""
    there = f" (the sandbox has {packages.listing(assignment.packages)})"
    for scene_end in (*result.cells.values(), *result.scene_ends.values()):
        if MISSING_MODULE.search(scene_end.sentence):
            scene_end.sentence += there
            scene_end.because = scene_end.because and scene_end.because + there
