"""Whether answers can be believed: asked twice in two children, and motions compared with the function that is to drive them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ecp.checks import Arrays
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Assignment, Inputs, RightHandSide, Scene
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox

DRIVE_S = 20.0
TRIES = 2


@dataclass
class CrossCheck:
    """``unsteady``: scenes whose answers were others when asked again. ``how``: what makes each motion the function's own."""

    unsteady: set[str] = field(default_factory=set)
    how: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Attempt:
    """What was asked, with the exact answers, and what came back."""

    job: Job
    inputs: Mapping[str, Inputs]
    truths: Mapping[str, Arrays]
    seen: PlayResult


def cross_check(assignment: Assignment, attempt: Attempt, sandbox: Sandbox, seed: int) -> CrossCheck:
    """Ask again and compare; a motion that is not the function's own is replaced by the one that is."""
    seen = attempt.seen
    found, rng = CrossCheck(), np.random.default_rng([seed, 2])
    found.unsteady = _ask_again(assignment, attempt, sandbox, rng)
    doubtful: list[Scene] = []
    for scene in assignment.scenes:
        if scene.drive is None or scene.name not in seen.arrays:
            continue
        proof = scene.drive.proof
        if proof not in seen.arrays:
            _forget(seen, scene.name, Ended.NOT_PLAYED, f"it comes after {proof}")
        elif proof not in found.unsteady and scene.drive.certified(
            attempt.inputs[proof], seen.arrays[proof], attempt.truths[proof]
        ):
            found.how[scene.name] = (
                f"played in the child; {scene.function} is certified by {proof}, at random and along the notebook's motions"
            )
        else:
            doubtful.append(scene)
    if doubtful:
        _drive(doubtful, attempt, sandbox, rng, found)
    return found


def _ask_again(assignment: Assignment, attempt: Attempt, sandbox: Sandbox, rng: np.random.Generator) -> set[str]:
    """Scenes whose answers are others in a second child, where their questions come in another order."""
    job, seen = attempt.job, attempt.seen
    twice = [s for s in assignment.scenes if s.twice and s.name in seen.arrays]
    orders = {s.name: rng.permutation(len(next(iter(seen.arrays[s.name].values())))) for s in twice}
    again = [replace(p, inputs=_shuffled(p.inputs, orders[p.name]), after=None) for p in job.scenes if p.name in orders]
    other = PlayResult()
    for _ in range(TRIES):  # a child that did not come to its end says nothing against the answers of the first
        if left := [p for p in again if p.name not in other.arrays]:
            other.add(sandbox.play(replace(job, scenes=tuple(left))))
    for name in set(orders) - set(other.arrays):
        scene_end = other.scene_ends.get(name)
        _forget(
            seen,
            name,
            scene_end.ended if scene_end else Ended.EXITED,
            f"asked again, {scene_end.sentence if scene_end else 'it ended'}",
        )
    return {
        name
        for name, order in orders.items()
        if name in other.arrays and not _agree(attempt.inputs[name], seen.arrays[name], other.arrays[name], order)
    }


def _forget(seen: PlayResult, scene: str, scene_end: Ended, sentence: str) -> None:
    """Take back what a scene brought: it is not measured, and the sentence says why."""
    del seen.arrays[scene]
    seen.scene_ends[scene] = SceneEnd(scene=scene, ended=scene_end, sentence=sentence)


def _shuffled(inputs: Mapping[str, Any], order: np.ndarray) -> dict[str, Any]:
    return {key: np.asarray(value)[order] for key, value in inputs.items()}


def _agree(inputs: Inputs, first: Arrays, second: Arrays, order: np.ndarray) -> bool:
    """Bit for bit: each answer in both children, and within the first one those to a question that was put twice."""
    asked = np.column_stack([np.asarray(v, dtype=float).reshape(len(order), -1) for v in inputs.values()])
    _, same = np.unique(asked, axis=0, return_inverse=True)
    representative = np.zeros(same.max() + 1, dtype=int)
    representative[same] = np.arange(len(order))
    return all(
        a[order].tobytes() == second[name].tobytes() and a.tobytes() == a[representative[same]].tobytes()
        for name, a in first.items()
    )


def _drive(scenes: list[Scene], attempt: Attempt, sandbox: Sandbox, rng: np.random.Generator, found: CrossCheck) -> None:
    """Compare stretches of these motions with what the host makes of the function, and replace those that do not follow it."""
    inputs, seen = attempt.inputs, attempt.seen

    def driver(scene: Scene) -> Any:
        def drive(ask: RightHandSide) -> tuple[bool, Arrays | None]:
            assert scene.drive is not None
            if scene.drive.follows(inputs[scene.name], seen.arrays[scene.name], ask, rng):
                return True, None
            try:
                return False, scene.drive.motion(inputs[scene.name], ask)
            except Exception:
                return False, None

        return drive

    played = tuple(SceneRequest(s.name, "", s.function, {}, {}, DRIVE_S, None, driver(s)) for s in scenes)
    answered = sandbox.play(replace(attempt.job, scenes=played))
    for scene in scenes:
        follows, motion = answered.driven.get(scene.name, (False, None))
        if follows:
            found.how[scene.name] = f"played in the child; follows {scene.function} where the host called it"
        elif motion is not None:
            seen.arrays[scene.name] = dict(motion)
            found.how[scene.name] = f"played by the host, call by call: what the child played does not follow {scene.function}"
        else:
            scene_end = answered.scene_ends.get(scene.name)
            said = (
                scene_end.sentence
                if scene_end and scene_end.ended is not Ended.FINISHED
                else "the integrator does not get on with it"
            )
            _forget(seen, scene.name, Ended.NOT_PLAYED, f"called by the host, {said}")
            found.how[scene.name] = f"what the child played does not follow {scene.function}, and the host could not play it"
