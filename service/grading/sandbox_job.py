"""The sandbox job of a grading: the inputs of its scenes, and their exact answers, which stay on the host."""

import functools
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from exercises.authoring.assignments.assignment import Assignment, Inputs, Scene
from exercises.authoring.importing.reported_lines import reported_lines
from polhode.judging.checks import Arrays
from polhode.kinds.student_calls import unit_of
from service.grading.published.given_cells import with_published
from service.grading.submission import Submission
from service.sandbox.job import FunctionsApart, Job, Line, SceneRequest


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
    requests = tuple(_request(scene, inputs[scene.name]) for scene in scenes)
    functions, variables = tuple(sorted(assignment.functions())), tuple(sorted(assignment.variables()))
    data = {name: assignment.folder / name for name in assignment.data}
    cells = (
        with_published(submission.cells(), assignment.published)
        if assignment.published
        else submission.cells()
    )
    job = Job(
        assignment.setup,
        assignment.plays,
        cells,
        functions,
        requests,
        variables=variables,
        data=data,
        lines=_lines(assignment),
    )
    if assignment.load_s is not None:
        job = replace(job, load_budget_s=assignment.load_s)
    return replace(job, memory_mb=max(job.memory_mb, assignment.memory_mb or 0))


def _lines(assignment: Assignment) -> dict[tuple[str, tuple[int, int]], Line]:
    """Return the lines of published cells, by cell and place."""
    return {
        (check.cell, check.call.place): Line(
            check.call.numbers, None if check.declared.truth is None else check.truth
        )
        for check in reported_lines(assignment.checks())
    }


def _request(scene: Scene, inputs: Inputs) -> SceneRequest:
    apart = _functions_apart(scene, inputs)
    kept = {*scene.withheld, *(apart.inputs if apart else ())}
    return SceneRequest(
        scene.name,
        scene.play,
        scene.function,
        {name: value for name, value in inputs.items() if name not in kept},
        scene.returns,
        scene.budget_s,
        scene.after,
        question=None if scene.question is None else dict(scene.question),
        needs=scene.needs,
        apart=apart,
    )


def _functions_apart(scene: Scene, inputs: Inputs) -> FunctionsApart | None:
    """Return the functions that the scene of a question passes to the submission, if they must not be in its
    process.
    """
    question = scene.question
    if question is None or question.get("part") or not question.get("apart"):
        return None
    families = {name: question["families"][name] for name in question["apart"]}
    rows = len(next(iter(inputs.values()), [()]))
    constants = {name: [value] * rows for name, value in question["constants"].items()}
    known = {name for family in families.values() for name in family["given"]}
    columns = constants | dict(inputs)
    values = {name: column for name, column in columns.items() if name in known}
    passed = [columns[name] for name in question["parameters"] if name in columns]
    units = [unit_of(column[row] for column in passed) for row in range(rows)]
    return FunctionsApart(families, values, units)


@functools.cache
def _fixed_truth(scene: Scene) -> Arrays:
    assert not callable(scene.inputs)
    return scene.truth(scene.inputs)
