"""What a job tells a submission: its inputs, and no answer."""

import json

import numpy as np
import pytest

from exercises.authoring.assignments.catalogue import assignments
from service.grading.sandbox_job import draw_inputs, job_of, truth
from service.grading.submission import Submission
from service.sandbox.guest import wire

MOST = 0.5  # of an answer's numbers may be inputs too: the rate of a position is the velocity that was given


def told(assignment, scenes, inputs):
    """Return the job of these scenes as a guest reads it."""
    encoded = job_of(Submission("x = 1\n"), assignment, scenes, inputs).encode()
    return json.loads(encoded[wire.LENGTH.size :], object_hook=wire._decoded)


def numbers(value):
    """Return all numbers in a JSON document."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return set().union(*map(numbers, value))
    return {value} if isinstance(value, float) and not value.is_integer() else set()


@pytest.mark.parametrize("slug", sorted(assignments()))
def test_a_job_holds_no_exact_answer(slug):
    assignment = assignments()[slug]
    inputs = {scene.name: draw_inputs(scene, 3) for scene in assignment.scenes}
    given = numbers([scene["inputs"] for scene in told(assignment, assignment.scenes, inputs)["scenes"]])
    for scene in assignment.scenes:
        exact = truth(scene, inputs[scene.name])
        for name in scene.returns.keys() & exact.keys():
            answer = np.unique(np.asarray(exact[name], dtype=float))
            hard = {x for x in answer.tolist() if np.isfinite(x) and not x.is_integer()}
            assert len(hard & given) <= MOST * len(hard), (scene.name, name)


def test_a_job_does_not_say_which_points_lie_along_which_motion(rigid_body):
    scene = rigid_body.scene("probes")
    inputs = {"probes": draw_inputs(scene, 3)}
    (asked,) = told(rigid_body, [scene], inputs)["scenes"]
    assert asked["inputs"].keys() == {"t", "w", "I"}
