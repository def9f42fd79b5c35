"""Diagnosis by reproduction: the one variant of the right solution that returns the student's numbers.

The variants are played in the sandbox, without the submission, because a wrong solution may not end.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

from ecp.checks import Arrays
from ecp.kinds import diagnose, reproduces
from ecp.outcome import Diagnosis
from exercises.assignment import Assignment, Scene
from exercises.solution import Variant
from service.grading.diagnosing import with_scenes
from service.grading.playing import PlayedJob
from service.sandbox.job import Job
from service.sandbox.result import TooBusy
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

VARIANT_S = 0.5  # of CPU time for one variant of one scene; the right solution needs far less
LIMITS = TimeLimits(cpu_s=30.0, wall_s=60.0)  # of all variants that one grading plays

Predictions = Mapping[Variant, Arrays]
_public: WeakKeyDictionary[Scene, Predictions] = WeakKeyDictionary()


def diagnose_question(
    assignment: Assignment, id: str, played: PlayedJob, sandbox: Sandbox, budget: TimeBudget
) -> list[Diagnosis]:
    """Return the diagnosis of the variant that alone reproduces the arrays of the question's scenes, else
    none.

    An author's mistake takes precedence over a generated variant. Parts of a question, such as a motion,
    follow from its values. A kind that diagnoses its arrays itself needs no variant. The diagnosis records
    the scenes that were needed: the public ones if they alone show it. If the ``budget`` is
    spent before all variants are known, or the machine is too busy, there is none. Raises SystemFault if the
    sandbox fails.
    """
    arrays, used = played.result.arrays, list[str]()
    left: Sequence[Variant] | None = None
    public: tuple[list[Diagnosis], tuple[str, ...]] = ([], ())
    asked = [(s, s.question) for s in assignment.scenes if s.question is not None and s.name in arrays]
    scenes = [s for s, question in asked if question["id"] == id and not question.get("part")]
    for scene in sorted(scenes, key=lambda scene: callable(scene.inputs)):
        assert scene.question is not None
        used.append(scene.name)
        own = diagnose(scene.question, arrays[scene.name], played.truths[scene.name])
        if own is not None:
            return with_scenes(own, [scene.name])
        try:
            predicted = _predict(assignment, scene, played, sandbox, budget, only=left)
        except TooBusy:
            return []
        if predicted is None:
            return []
        alike = [v for v in predicted if reproduces(scene.question, arrays[scene.name], predicted[v])]
        left = alike if left is None else [v for v in left if v in alike]
        if not callable(scene.inputs):
            public = _only(left), tuple(used)
    found = _only(left or [])
    return with_scenes(found, public[1] if found == public[0] else used)


def _only(variants: Sequence[Variant]) -> list[Diagnosis]:
    """Return the diagnosis that these variants have in common, else none. The author's come first."""
    for candidates in ([v for v in variants if v.declared], [v for v in variants if not v.declared]):
        if found := {(v.code, v.sentence) for v in candidates}:
            (code, sentence), *others = found
            return [Diagnosis(code, sentence, 1.0)] if code and not others else []
    return []


def _predict(
    assignment: Assignment,
    scene: Scene,
    played: PlayedJob,
    sandbox: Sandbox,
    budget: TimeBudget,
    *,
    only: Sequence[Variant] | None,
) -> Predictions | None:
    """Return the arrays of each variant (``only``: of these, if the scene is hidden) that finishes the scene
    and differs from the right solution, or None if the ``budget`` is spent before all are known.
    """
    if only is not None and not only:
        return {}
    if scene in _public:
        return _public[scene]
    assert scene.question is not None
    right, *variants = assignment.variants(scene.question["id"])
    chosen = [right, *(variants if only is None or not callable(scene.inputs) else only)]
    found = play_variants(played.job, scene.name, chosen, sandbox, budget, budget_s=VARIANT_S)
    if budget.exceeded():
        return None
    exact = found.pop(right, {})
    differing = {
        variant: arrays for variant, arrays in found.items() if not reproduces(scene.question, arrays, exact)
    }
    if not callable(scene.inputs):
        _public[scene] = differing
    return differing


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
