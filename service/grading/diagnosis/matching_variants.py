"""Diagnosis by reproduction: which wrong version of the right solution returns the student's numbers.

The variants are played in the sandbox, without the submission, because a wrong solution may not end.
"""

import functools
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Assignment, Scene
from exercises.authoring.mutants.solution import Variant
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis
from polhode.kinds import diagnose, reproduces
from service.grading.diagnosis.explanations import (
    WHOLE,
    Cause,
    Component,
    Rank,
    causes,
    components,
    diagnoses,
    wrong_components,
)
from service.grading.diagnosis.number_patterns import in_general, unrepeatable
from service.grading.diagnosis.quoting import StudentCode
from service.grading.run_in_sandbox import PlayedJob
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import TooBusy
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

VARIANT_S = 0.5  # of CPU time for one variant of one scene; the right solution needs far less
LONG_S = 3.0  # for a declared mistake, of which there are few, and for expressions, whose digits take time
LIMITS = TimeLimits(cpu_s=30.0, wall_s=60.0)  # of all variants that one grading plays
FEW_ROWS = 8  # that tell most variants from the cause: playing them first takes a third of the time
NEARLY = 1e-2  # relative distance on few rows, far above the tolerance of values that are compared

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

    Of several causes, declared mistakes come first, and if they predict all, no other version is played;
    solutions with two changes are played only if nothing else predicts any wrong component. Parts of a
    question, such as a motion, follow from its values. A kind that diagnoses its arrays itself needs no
    variant. The diagnosis records the scenes that were needed: the public ones if they alone show it. If the
    ``budget`` is spent before all variants are known, or the machine is too busy, there is none. Raises
    SystemFault if the sandbox fails.
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
            return _with_scenes(own, [scene.name])

    def play_versions(of: PlayedJob, scene: Scene, versions: Sequence[Variant]) -> dict[Variant, Arrays]:
        assert scene.question is not None
        is_long = scene.question["kind"] == "expression" or all(one.declared for one in versions[1:])
        each_s = LONG_S if is_long else VARIANT_S
        found = play_variants(of.job, scene.name, versions, sandbox, budget, budget_s=each_s)
        if budget.exceeded():
            raise _NotKnown
        return found

    def predict(kind: str, scene: Scene, versions: Sequence[Variant]) -> Predictions:
        known = _public.setdefault(scene, {})
        if kind not in known:
            if callable(scene.inputs) and wrong[scene.name] and _count(played, scene) > 2 * FEW_ROWS:
                few = _with_rows(played, scene, np.arange(FEW_ROWS))
                found = play_versions(few, scene, versions)
                possible = _possible(few, scene, wrong[scene.name], found)
                versions = [version for version in versions if version is versions[0] or version in possible]
            found = play_versions(played, scene, versions)
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
    kinds: dict[str, Callable[[str], Sequence[Variant]]] = {
        "declared": functools.partial(_declared, assignment),
        "single": assignment.variants,
    }
    kinds |= {"double": assignment.pairs} if any(wrong.values()) else {}
    try:
        for kind, versions in kinds.items():
            found, is_declared = _explained(
                scenes, played, wrong, versions(id), functools.partial(predict, kind)
            )
            if found and (is_declared or kind != "declared"):
                return found
    except (_NotKnown, TooBusy):
        pass
    for scene in (scene for scene in scenes if wrong.get(scene.name)):
        assert scene.question is not None
        if found := in_general(scene.question, arrays[scene.name], played.truths[scene.name]):
            return _with_scenes(found, [scene.name])
    return []


def _with_scenes(found: list[Diagnosis], scenes: Iterable[str]) -> list[Diagnosis]:
    """Return diagnoses that record the ``scenes`` whose results show them."""
    return [replace(one, scenes=tuple(scenes)) for one in found]


def _declared(assignment: Assignment, id: str) -> list[Variant]:
    """Return the right solution of a question and its declared mistakes."""
    versions = assignment.variants(id)
    return [*versions[:1], *(version for version in versions[1:] if version.declared)]


def _with_enough_rows(scenes: Sequence[Scene], played: PlayedJob) -> PlayedJob:
    """Return the played job with those rows of the scenes that are enough to find a cause."""
    for scene in scenes:
        if scene.diagnosed is not None:
            played = _with_rows(played, scene, scene.diagnosed(played.inputs[scene.name]))
    return played


def _with_rows(played: PlayedJob, scene: Scene, rows: NDArray[Any]) -> PlayedJob:
    """Return the played job with these rows of a scene."""
    request, count = _request(played, scene), _count(played, scene)

    def chosen(columns: Mapping[str, Any]) -> dict[str, Any]:
        return {
            name: np.asarray(column)[rows] if np.ndim(column) and len(column) == count else column
            for name, column in columns.items()
        }

    returns = {
        name: replace(spec, shape=(len(rows), *spec.shape[1:])) for name, spec in request.returns.items()
    }
    fewer = replace(request, inputs=chosen(request.inputs), returns=returns)
    scenes = tuple(fewer if one.name == scene.name else one for one in played.job.scenes)
    arrays = {**played.result.arrays, scene.name: chosen(played.result.arrays[scene.name])}
    truths = {**played.truths, scene.name: chosen(played.truths[scene.name])}
    result, job = replace(played.result, arrays=arrays), replace(played.job, scenes=scenes)
    return replace(played, result=result, truths=truths, job=job)


def _request(played: PlayedJob, scene: Scene) -> SceneRequest:
    (request,) = (request for request in played.job.scenes if request.name == scene.name)
    return request.together


def _count(played: PlayedJob, scene: Scene) -> int:
    """Return the number of rows of a scene, along the first index of each of its arrays."""
    return next(iter(_request(played, scene).returns.values())).shape[0]


def _possible(
    few: PlayedJob, scene: Scene, wrong: Sequence[Component], found: Mapping[Variant, Arrays]
) -> set[Variant]:
    """Return the variants whose numbers are nearly proportional to those of a wrong component on few rows:
    only they can predict it, or a multiple of it, on all.
    """
    arrays, truths = few.result.arrays[scene.name], few.truths[scene.name]

    def fits(component: Component, predicted: Arrays) -> bool:
        if component.name not in predicted:
            return False
        truth = truths[component.name]
        unit = np.abs(truth).reshape(len(truth), -1).max(axis=1)
        got, want = (
            component.of(one[component.name]).reshape(len(truth), -1) / np.where(unit, unit, 1.0)[:, None]
            for one in (arrays, predicted)
        )
        size = np.sum(want * want)
        factor = np.sum(got * want) / size if size else 0.0
        return not np.linalg.norm(got - factor * want) > NEARLY * np.linalg.norm(got)  # NaN may fit

    with np.errstate(all="ignore"):
        return {v for v, predicted in found.items() if any(fits(component, predicted) for component in wrong)}


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
) -> tuple[list[Diagnosis], bool]:
    """Return the diagnoses of the scenes' arrays by versions of the right solution, or by what the arrays
    are, and whether declared mistakes predict all of them, so that no other version matters.

    ``wrong`` are the wrong components of each scene.
    """
    if not scenes:
        return [], False
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
    return _with_scenes(given, public[1] if given == public[0] else used), _all_declared(left)


def _all_declared(left: Mapping[Component, Collection[Cause]]) -> bool:
    """Return whether declared mistakes predict the whole answer, or each wrong component."""
    declared = {part for part, found in left.items() if any(cause.rank is Rank.DECLARED for cause in found)}
    wrong = left.keys() - {WHOLE}
    return WHOLE in declared or (bool(wrong) and wrong <= declared)


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
