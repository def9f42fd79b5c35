"""The likely causes of a ✗ or –."""

import logging
from collections.abc import Callable, Iterable
from dataclasses import replace

from exercises.authoring.assignments.assignment import Assignment, Scene
from polhode.judging.outcome import Diagnosis
from service.sandbox.result import PlayResult

log = logging.getLogger(__name__)
Causes = Callable[[str], list[Diagnosis]]
"""A function that returns the diagnoses of a scene's results, given its name, or of a question's, given its
id.
"""


def diagnose(assignment: Assignment, scene: str, reproduced: Causes) -> list[Diagnosis]:
    """Return the diagnoses of a scene, or none if they fail, which must not prevent a report.

    ``reproduced`` returns those of a question by its id.
    """
    if (question := assignment.scene(scene).question) is None:
        return []
    try:
        return reproduced(question["id"])
    except (ArithmeticError, ValueError):  # numbers too large or small for what compares them
        log.exception("the diagnosis of question %s failed", question["id"])
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
