"""Diagnosis by reproduction: which wrong version of the right solution returns the student's numbers.

The variants are played in the sandbox, without the submission, because a wrong solution may not end.
"""

import functools
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from exercises.authoring.assignments.assignment import Assignment, Scene
from exercises.authoring.mutants.solution import Variant
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis
from polhode.kinds import diagnose, reproduces
from service.grading.diagnosing import with_scenes
from service.grading.explanations import (
    WHOLE,
    Cause,
    Component,
    causes,
    components,
    diagnoses,
    wrong_components,
)
from service.grading.playing import PlayedJob
from service.grading.quoting import StudentCode
from service.grading.readings import in_general, unrepeatable
from service.sandbox.job import Job
from service.sandbox.result import TooBusy
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

VARIANT_S = 0.5  # of CPU time for one variant of one scene; the right solution needs far less
EXPRESSION_S = 3.0  # a variant that returns expressions, whose values to 30 digits take half a second
LIMITS = TimeLimits(cpu_s=30.0, wall_s=60.0)  # of all variants that one grading plays

Predictions = Mapping[Variant, Arrays]
_public: WeakKeyDictionary[Scene, dict[str, Predictions]] = WeakKeyDictionary()
"""The predictions of single and of double changes for public scenes, whose inputs are fixed."""


class _NotKnown(Exception):
    """The budget is spent before all variants are known."""


def diagnose_question(
    assignment: Assignment, id: str, played: PlayedJob, sandbox: Sandbox, budget: TimeBudget
) -> list[Diagnosis]:
    """Return the diagnosis of the cause that alone predicts the arrays of the question's scenes, else those
    of its wrong components, each for itself; none if nothing predicts them.

    Of several causes, declared mistakes come first; solutions with two changes are played only if nothing
    else predicts any wrong component. Parts of a question, such as a motion, follow from its values. A kind
    that diagnoses its arrays itself needs no variant. The diagnosis records the scenes that were needed: the
    public ones if they alone show it. If the ``budget`` is spent before all variants are known, or the
    machine is too busy, there is none. Raises SystemFault if the sandbox fails.
    """
    arrays = played.result.arrays
    asked = [(s, s.question) for s in assignment.scenes if s.question is not None and s.name in arrays]
    scenes = [s for s, question in asked if question["id"] == id and not question.get("part")]
    scenes.sort(key=lambda scene: callable(scene.inputs))
    played = _with_enough_rows(scenes, played)
    arrays = played.result.arrays
    for scene in scenes:
        assert scene.question is not None
        own = diagnose(scene.question, arrays[scene.name], played.truths[scene.name])
        if own is None and _is_wrong(scene, played):
            own = unrepeatable(scene.question, arrays[scene.name], played.truths[scene.name]) or None
        if own is not None:
            return with_scenes(own, [scene.name])

    def predict(kind: str, scene: Scene, versions: Sequence[Variant]) -> Predictions:
        assert scene.question is not None
        known = _public.setdefault(scene, {})
        if kind not in known:
            each_s = EXPRESSION_S if scene.question["kind"] == "expression" else VARIANT_S
            found = play_variants(played.job, scene.name, versions, sandbox, budget, budget_s=each_s)
            if budget.exceeded():
                raise _NotKnown
            differing = _differing(scene, versions[0], found, played.truths[scene.name])
            if callable(scene.inputs):
                return differing
            known[kind] = differing
        return known[kind]

    wrong = {
        s.name: wrong_components(s.question, arrays[s.name], played.truths[s.name])
        for s in scenes
        if s.question is not None
    }
    kinds = {"single": assignment.variants} | ({"double": assignment.pairs} if any(wrong.values()) else {})
    try:
        for kind, versions in kinds.items():
            if found := _explained(scenes, played, wrong, versions(id), functools.partial(predict, kind)):
                return found
    except (_NotKnown, TooBusy):
        pass
    for scene in (scene for scene in scenes if wrong.get(scene.name)):
        assert scene.question is not None
        if found := in_general(scene.question, arrays[scene.name], played.truths[scene.name]):
            return with_scenes(found, [scene.name])
    return []


def _with_enough_rows(scenes: Sequence[Scene], played: PlayedJob) -> PlayedJob:
    """Return the played job with those rows of the scenes that are enough to find a cause."""
    arrays, truths, requests = dict(played.result.arrays), dict(played.truths), list(played.job.scenes)
    for scene in scenes:
        if (choose := scene.diagnosed) is None:
            continue
        rows = choose(played.inputs[scene.name])
        count = next(iter(scene.returns.values())).shape[0]

        def chosen(columns: Mapping[str, Any], rows: Any = rows, count: int = count) -> dict[str, Any]:
            return {
                name: np.asarray(column)[rows] if np.ndim(column) and len(column) == count else column
                for name, column in columns.items()
            }

        arrays[scene.name], truths[scene.name] = chosen(arrays[scene.name]), chosen(truths[scene.name])
        k = next(k for k, request in enumerate(requests) if request.name == scene.name)
        returns = {
            name: replace(spec, shape=(len(rows), *spec.shape[1:])) for name, spec in scene.returns.items()
        }
        requests[k] = replace(requests[k], inputs=chosen(requests[k].inputs), returns=returns)
    result = replace(played.result, arrays=arrays)
    return replace(played, result=result, truths=truths, job=replace(played.job, scenes=tuple(requests)))


def _is_wrong(scene: Scene, played: PlayedJob) -> bool:
    assert scene.question is not None
    arrays, truth = played.result.arrays[scene.name], played.truths[scene.name]
    return bool(wrong_components(scene.question, arrays, truth))


def _explained(
    scenes: Sequence[Scene],
    played: PlayedJob,
    wrong: Mapping[str, Sequence[Component]],
    versions: Sequence[Variant],
    predict: Callable[[Scene, Sequence[Variant]], Predictions],
) -> list[Diagnosis]:
    """Return the diagnoses of the scenes' arrays by versions of the right solution, or by what the arrays
    are. ``wrong`` are the wrong components of each scene.
    """
    if not scenes:
        return []
    used = list[str]()
    left: dict[Component, set[Cause]] = {}
    public: tuple[list[Diagnosis], tuple[str, ...]] = ([], ())
    right = 0
    student = StudentCode([cell.source for cell in played.job.cells], scenes[0].function)
    for scene in scenes:
        assert scene.question is not None
        used.append(scene.name)
        seen, truth = played.result.arrays[scene.name], played.truths[scene.name]
        chosen = _chosen(versions[1:], left, wrong[scene.name])
        predicted = predict(scene, [*versions[:1], *chosen]) if chosen else {}
        found = causes(scene.question, seen, truth, predicted, wrong[scene.name])
        left = {part: left[part] & of if part in left else of for part, of in {**left, **found}.items()}
        right = len(components(scene.question, seen)) - len(left.keys() - {WHOLE}) if wrong[scene.name] else 0
        if not callable(scene.inputs):
            public = diagnoses(left, student, right), tuple(used)
    given = diagnoses(left, student, right)
    return with_scenes(given, public[1] if given == public[0] else used)


def _chosen(
    variants: Sequence[Variant],
    left: Mapping[Component, Collection[Cause]],
    wrong: Sequence[Component],
) -> Sequence[Variant]:
    """Return the variants that are left for the ``wrong`` components; all if one of them is new."""
    if not left or any(component not in left for component in wrong):
        return variants
    still = {cause.variant for of in left.values() for cause in of}
    return [variant for variant in variants if variant in still]


def _differing(scene: Scene, right: Variant, found: dict[Variant, Arrays], truth: Arrays) -> Predictions:
    """Return the arrays of the versions that differ from those of the ``right`` solution."""
    assert scene.question is not None
    exact = found.get(right, {})
    return {
        variant: arrays
        for variant, arrays in found.items()
        if variant is not right and not reproduces(scene.question, arrays, exact, truth)
    }


def play_variants(
    job: Job,
    scene: str,
    variants: Sequence[Variant],
    sandbox: Sandbox,
    budget: TimeBudget,
    *,
    budget_s: float,
) -> dict[Variant, Arrays]:
    """Play one scene of a job with each variant in place of the submission, each for at most ``budget_s`` and
    all within ``budget``. Return the arrays of those that finish it in time.
    """
    (request,) = (request for request in job.scenes if request.name == scene)
    one = replace(request.together, budget_s=budget_s, after=None)
    requests = tuple(replace(one, name=str(k), source=variant.source) for k, variant in enumerate(variants))
    found = sandbox.play(
        replace(job, cells=(), functions=(), variables=(), scenes=requests), budget=budget
    ).arrays
    return {variant: found[str(k)] for k, variant in enumerate(variants) if str(k) in found}
