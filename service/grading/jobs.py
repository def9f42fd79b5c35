"""The sandbox job of a grading: the inputs of its scenes, and their exact answers, which stay on the host."""

import functools
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ecp.checks import Arrays
from exercises.assignment import ArraySpec, Assignment, Inputs, Recorded, Scene
from service.grading.published import with_published
from service.grading.submission import Submission
from service.sandbox.job import Job, Kept, SceneRequest


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
    inputs: Mapping[str, Inputs] | None = None,
    seed: int = 0,
) -> Job:
    """Return the sandbox job of a submission's cells and these scenes. Without ``inputs`` it is one for
    ``Sandbox.start_child``.

    ``seed`` determines at which calls to compare recordings.
    """
    drawn = None if inputs is None else seed
    recorded = {
        s.name: _recorded_inputs(s, s.recorded, drawn) for s in scenes if s.recorded and s.recorded.recordings
    }
    requests = tuple(
        SceneRequest(
            s.name,
            s.play,
            s.function,
            {**(inputs[s.name] if inputs is not None else {}), **recorded.get(s.name, {})},
            {**s.returns, **({"recorded": ArraySpec((), alone=True)} if s.name in recorded else {})},
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


def _recorded_inputs(scene: Scene, recorded: Recorded, seed: int | None) -> dict[str, Any]:
    calls = {"recorded": _calls(recorded)}
    if seed is None:
        return calls
    rng = np.random.default_rng([seed, 4, zlib.crc32(scene.name.encode())])
    return calls | {"sample": recorded.sample(recorded.recordings, rng)}


@functools.cache
def _calls(recorded: Recorded) -> Kept:
    return Kept.of([one.calls.tobytes() for one in recorded.recordings])


@functools.cache
def _fixed_truth(scene: Scene) -> Arrays:
    assert not callable(scene.inputs)
    return scene.truth(scene.inputs)
