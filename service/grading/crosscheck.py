"""Verification of results: repeat questions in a second child, and compare motions with the function that
computes them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ecp.checks import Arrays
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Ask, Assignment, Inputs, Scene
from service.grading.author_errors import play
from service.grading.second_child import PlayedJob, SecondChild, discard, is_certified
from service.sandbox.job import SceneRequest
from service.sandbox.sandbox import Sandbox

DRIVE_S = 20.0
NOT_FINISHED = "not run: it needs the scene {}, which did not finish"


@dataclass
class CrossCheck:
    """The result of ``cross_check``: ``unsteady`` scenes, whose answers differ when repeated, and how each
    motion was verified.
    """

    unsteady: set[str] = field(default_factory=set)
    how: dict[str, str] = field(default_factory=dict)


def may_be_spared(scene: Scene) -> bool:
    """Return whether answers at points can make it unnecessary to play a scene,
    a motion with drawn inputs.
    """
    return scene.drive is not None and scene.drive.along is not None and callable(scene.inputs)


def cross_check(
    assignment: Assignment, played: PlayedJob, second: SecondChild, sandbox: Sandbox
) -> CrossCheck:
    """Repeat questions in a second child and compare. Replace motions that do not follow the student's
    function by ones that do.

    Of the motions ``second.spared``, which have not been played, play those whose error the answers at points
    do not bound.
    """
    result = played.result
    checked = CrossCheck()
    checked.unsteady, answers = second.compare(played)
    _take_bounded(assignment, played, second.along, answers, checked)
    _play_rest(assignment, played, [p for p in second.spared if p.name not in checked.how], sandbox)
    doubtful: list[Scene] = []
    for scene in assignment.scenes:
        if scene.drive is None or scene.name not in result.arrays or scene.name in checked.how:
            continue
        proof = scene.drive.proof
        if proof not in result.arrays:
            discard(result, scene.name, Ended.NOT_PLAYED, NOT_FINISHED.format(proof))
        elif proof not in checked.unsteady and is_certified(scene.drive, played):
            computed = "computed in the sandbox"
            if scene.name in played.recalled:
                computed = (
                    f"not integrated: {scene.function} repeats one of every four calls of a recorded"
                    " integration, bit for bit"
                )
            checked.how[scene.name] = (
                f"{computed}; {scene.function} is verified by {proof}, at random and along the notebook's"
                " motions"
            )
        else:
            doubtful.append(scene)
    if doubtful:
        _drive(doubtful, assignment, played, sandbox, rng=second.rng, checked=checked)
    return checked


def _take_bounded(
    assignment: Assignment,
    played: PlayedJob,
    along: Mapping[str, Inputs],
    answers: Mapping[str, Arrays],
    checked: CrossCheck,
) -> None:
    """Add the results of the scenes whose error their answers ``along`` the exact motion bound."""
    for name, found in answers.items():
        scene = assignment.scene(name)
        assert scene.drive is not None and scene.drive.bounded is not None
        if scene.drive.proof in checked.unsteady:
            continue
        arrays = scene.drive.bounded(played.inputs[name], played.truths[name], along[name], found)
        if arrays is not None:
            checked.how[name] = (
                f"not integrated; {scene.function} is verified at points along the exact motion"
            )
            played.result.arrays[name] = dict(arrays)
            played.result.scene_ends[name] = SceneEnd(
                scene=name, ended=Ended.FINISHED, sentence=checked.how[name]
            )


def _play_rest(
    assignment: Assignment, played: PlayedJob, rest: Sequence[SceneRequest], sandbox: Sandbox
) -> None:
    """Play the scenes ``rest``, unless the one that they come after did not finish."""
    result = played.result
    for p in rest:
        if not result.finished(str(p.after)):
            followers = [
                other.name for other in played.job.scenes if other.after == p.after
            ]  # these ended with the child, maybe
            ends = [
                result.scene_ends[name]
                for name in followers
                if name in result.scene_ends and not result.finished(name)
            ]
            ends += [SceneEnd(scene=p.name, ended=Ended.NOT_PLAYED, sentence=NOT_FINISHED.format(p.after))]
            result.scene_ends[p.name] = replace(ends[0], scene=p.name)
    if left := tuple(p for p in rest if p.name not in result.scene_ends):
        more = play(replace(played.job, scenes=left), assignment, sandbox, budget=played.budget)
        more.stdout = ""  # the cells have printed it before
        result.add(more)


def _drive(
    scenes: list[Scene],
    assignment: Assignment,
    played: PlayedJob,
    sandbox: Sandbox,
    *,
    rng: np.random.Generator,
    checked: CrossCheck,
) -> None:
    """Compare stretches of these motions with the host's integration of the function, and replace motions
    that do not follow it.
    """
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
        SceneRequest(s.name, s.drive.play, s.function, {}, s.drive.returns, DRIVE_S, None, driver(s))
        for s in scenes
        if s.drive
    )
    answered = play(replace(played.job, scenes=requests), assignment, sandbox, budget=played.budget)
    for scene in scenes:
        follows, motion = answered.driven.get(scene.name, (False, None))
        if follows:
            checked.how[scene.name] = (
                f"computed in the sandbox; follows {scene.function} where the host called it"
            )
        elif motion is not None:
            result.arrays[scene.name] = dict(motion)
            checked.how[scene.name] = (
                f"integrated by the host: the motion computed in the sandbox does not follow {scene.function}"
            )
        else:
            scene_end = answered.scene_ends.get(scene.name)
            reason = (
                scene_end.sentence
                if scene_end and scene_end.ended is not Ended.FINISHED
                else "integration failed"
            )
            discard(result, scene.name, Ended.NOT_PLAYED, f"called by the server: {reason}")
            checked.how[scene.name] = (
                f"the motion computed in the sandbox does not follow {scene.function}, and the host could not"
                " integrate it"
            )
