"""The sandbox job of a grading: the inputs of its scenes, and their exact answers, which stay on the host."""

import functools
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ecp.checks import Arrays
from exercises.assignment import Assignment, Inputs, Scene
from service.grading.published import with_published
from service.grading.submission import Submission
from service.sandbox.job import Job, SceneRequest


def draw_inputs(scene: Scene, seed: int) -> Inputs:
    """Return the scene's inputs: fixed, or drawn with a generator seeded by ``seed`` and the scene's name."""
    if not callable(scene.inputs):
        return scene.inputs
    return scene.inputs(np.random.default_rng([seed, zlib.crc32(scene.name.encode())]))


def truth(scene: Scene, inputs: Inputs) -> Arrays:
    """Return the exact answer of a scene. It is cached if the inputs are fixed."""
    return scene.truth(inputs) if callable(scene.inputs) else _fixed_truth(scene)


def job_of(
    submission: Submission,
    assignment: Assignment,
    scenes: Sequence[Scene],
    inputs: Mapping[str, Inputs],
) -> Job:
    """Return the sandbox job of a submission's cells and these scenes."""
    requests = tuple(
        SceneRequest(
            s.name,
            s.play,
            s.function,
            {name: value for name, value in inputs[s.name].items() if name not in s.withheld},
            s.returns,
            s.budget_s,
            s.after,
            question=None if s.question is None else dict(s.question),
            needs=s.needs,
        )
        for s in scenes
    )
    functions, variables = tuple(sorted(assignment.functions())), tuple(sorted(assignment.variables()))
    data = {name: assignment.folder / name for name in assignment.data}
    cells = (
        with_published(submission.cells(), assignment.published)
        if assignment.published
        else submission.cells()
    )
    job = Job(assignment.setup, assignment.plays, cells, functions, requests, variables=variables, data=data)
    return job if assignment.load_s is None else replace(job, load_budget_s=assignment.load_s)


@functools.cache
def _fixed_truth(scene: Scene) -> Arrays:
    assert not callable(scene.inputs)
    return scene.truth(scene.inputs)
