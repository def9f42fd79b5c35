"""Verification of results: repeat questions in a second child, and compare motions with the function that computes them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ecp.checks import Arrays
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Ask, Assignment, Inputs, Scene
from service.grading.author_errors import play
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

DRIVE_S = 20.0
TRIES = 2


@dataclass
class CrossCheck:
    """The result of ``cross_check``: ``unsteady`` scenes, whose answers differ when repeated, and how each motion was verified."""

    unsteady: set[str] = field(default_factory=set)
    how: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class PlayedJob:
    """A job with the inputs and exact answers of its scenes, the result of playing it, and the grading's time budget."""

    job: Job
    inputs: Mapping[str, Inputs]
    truths: dict[str, Arrays]
    result: PlayResult
    budget: TimeBudget


def cross_check(assignment: Assignment, played: PlayedJob, sandbox: Sandbox, seed: int) -> CrossCheck:
    """Repeat questions in a second child and compare. Replace motions that do not follow the student's function by ones that do."""
    result = played.result
    checked, rng = CrossCheck(), np.random.default_rng([seed, 2])
    checked.unsteady = _ask_again(assignment, played, sandbox, rng)
    doubtful: list[Scene] = []
    for scene in assignment.scenes:
        if scene.drive is None or scene.name not in result.arrays:
            continue
        proof = scene.drive.proof
        if proof not in result.arrays:
            _discard(result, scene.name, Ended.NOT_PLAYED, f"not run: it needs the scene {proof}, which did not finish")
        elif proof not in checked.unsteady and scene.drive.certified(
            played.inputs[proof], result.arrays[proof], played.truths[proof]
        ):
            checked.how[scene.name] = (
                f"computed in the sandbox; {scene.function} is verified by {proof}, at random and along the notebook's motions"
            )
        else:
            doubtful.append(scene)
    if doubtful:
        _drive(doubtful, assignment, played, sandbox, rng=rng, checked=checked)
    return checked


def _ask_again(assignment: Assignment, played: PlayedJob, sandbox: Sandbox, rng: np.random.Generator) -> set[str]:
    """Return the scenes whose answers differ in a second child, which gets their questions in another order."""
    job, result = played.job, played.result
    twice = [s for s in assignment.scenes if s.twice and s.name in result.arrays]
    orders = {s.name: rng.permutation(len(next(iter(result.arrays[s.name].values())))) for s in twice}
    again = [replace(p, inputs=_shuffled(p.inputs, orders[p.name]), after=None) for p in job.scenes if p.name in orders]
    other = PlayResult()
    for _ in range(TRIES):  # a child that did not finish is no evidence against the first one's answers
        if left := [p for p in again if p.name not in other.arrays]:
            other.add(play(replace(job, scenes=tuple(left)), assignment, sandbox, budget=played.budget))
    for name in set(orders) - set(other.arrays):
        scene_end = other.scene_ends.get(name)
        _discard(
            result,
            name,
            scene_end.ended if scene_end else Ended.EXITED,
            f"when repeated: {scene_end.sentence if scene_end else 'the process ended'}",
        )
    return {
        name
        for name, order in orders.items()
        if name in other.arrays and not _agree(played.inputs[name], result.arrays[name], other.arrays[name], order)
    }


def _discard(result: PlayResult, scene: str, scene_end: Ended, sentence: str) -> None:
    """Discard the arrays of a scene, so that its checks are unmeasured for the reason given by ``sentence``."""
    del result.arrays[scene]
    result.scene_ends[scene] = SceneEnd(scene=scene, ended=scene_end, sentence=sentence)


def _shuffled(inputs: Mapping[str, Any], order: np.ndarray) -> dict[str, Any]:
    return {key: np.asarray(value)[order] for key, value in inputs.items()}


def _agree(inputs: Inputs, first: Arrays, second: Arrays, order: np.ndarray) -> bool:
    """Return whether the answers of both children, and those to a repeated question within the first, agree bit for bit."""
    questions = zip(*(map(np.ndarray.tobytes, map(np.asarray, np.asarray(values))) for values in inputs.values()), strict=True)
    places = dict[tuple[bytes, ...], int]()
    same = [places.setdefault(question, k) for k, question in enumerate(questions)]
    return all(a[order].tobytes() == second[name].tobytes() and a.tobytes() == a[same].tobytes() for name, a in first.items())


def _drive(
    scenes: list[Scene],
    assignment: Assignment,
    played: PlayedJob,
    sandbox: Sandbox,
    *,
    rng: np.random.Generator,
    checked: CrossCheck,
) -> None:
    """Compare stretches of these motions with the host's integration of the function, and replace motions that do not follow it."""
    inputs, result = played.inputs, played.result

    def driver(scene: Scene) -> Any:
        def drive(ask: Ask) -> tuple[bool, Arrays | None]:
            assert scene.drive is not None
            if scene.drive.follows(inputs[scene.name], result.arrays[scene.name], ask, rng):
                return True, None
            try:
                return False, scene.drive.motion(inputs[scene.name], ask)
            except (ArithmeticError, ValueError):
                return False, None

        return drive

    requests = tuple(
        SceneRequest(s.name, s.drive.play, s.function, {}, s.drive.returns, DRIVE_S, None, driver(s)) for s in scenes if s.drive
    )
    answered = play(replace(played.job, scenes=requests), assignment, sandbox, budget=played.budget)
    for scene in scenes:
        follows, motion = answered.driven.get(scene.name, (False, None))
        if follows:
            checked.how[scene.name] = f"computed in the sandbox; follows {scene.function} where the host called it"
        elif motion is not None:
            result.arrays[scene.name] = dict(motion)
            checked.how[scene.name] = f"integrated by the host: the motion computed in the sandbox does not follow {scene.function}"
        else:
            scene_end = answered.scene_ends.get(scene.name)
            reason = scene_end.sentence if scene_end and scene_end.ended is not Ended.FINISHED else "integration failed"
            _discard(result, scene.name, Ended.NOT_PLAYED, f"called by the server: {reason}")
            checked.how[scene.name] = (
                f"the motion computed in the sandbox does not follow {scene.function}, and the host could not integrate it"
            )
