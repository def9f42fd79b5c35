"""The likely causes of a ✗ or –."""

import logging
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from exercises.authoring.assignments.assignment import Assignment, Scene
from polhode.judging.outcome import Diagnosis
from service.grading.playing import PlayedJob
from service.sandbox.result import PlayResult

log = logging.getLogger(__name__)
Causes = Callable[[str], list[Diagnosis]]
"""A function that returns the diagnoses of a scene's results, given its name, or of a question's, given its
id.
"""


def diagnose(assignment: Assignment, scene: str, played: PlayedJob, reproduced: Causes) -> list[Diagnosis]:
    """Return the diagnoses of a scene, or none if the assignment's diagnosis fails, which must not prevent a
    report.

    ``reproduced`` returns those of a question by its id.
    """
    if (question := assignment.scene(scene).question) is not None:
        try:
            return reproduced(question["id"])
        except (ArithmeticError, ValueError):  # numbers too large or small for what compares them
            log.exception("the diagnosis of question %s failed", question["id"])
            return []
    function, inputs, arrays = assignment.scene(scene).function, played.inputs, played.result.arrays
    same = [s.name for s in assignment.scenes if s.function == function and s.name in arrays]
    try:
        with np.errstate(all="ignore"):
            found = assignment.diagnose_function(
                function, {name: (inputs[name], arrays[name]) for name in same}
            )
            if found is not None:
                return with_scenes(found, same)
            return with_scenes(assignment.diagnose(scene, inputs[scene], arrays[scene]), [scene])
    except Exception:
        log.exception("the diagnosis of scene %s failed", scene)
        return []


def with_scenes(found: list[Diagnosis], scenes: Iterable[str]) -> list[Diagnosis]:
    """Return diagnoses that record the ``scenes`` whose results show them."""
    return [replace(one, scenes=tuple(scenes)) for one in found]


def diagnose_failure(scenes: list[Scene], result: PlayResult, causes: Causes) -> list[Diagnosis]:
    """Return the diagnoses of the results of a scene or of the one before it, else one for its scene end."""
    for scene in scenes:
        for name in (scene.after, scene.name):
            if name in result.arrays and (found := causes(name)):
                return list(found)
    for scene in scenes:
        for name in (scene.after, scene.name):
            scene_end = result.scene_ends.get(name or "")
            if scene_end is not None and scene_end.code is not None:
                return [Diagnosis(scene_end.code, scene_end.cause, 1.0, (scene_end.scene,))]
    return []
