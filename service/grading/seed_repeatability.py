"""Whether a random function draws from its argument alone: its result for a seed is asked for once more, in a
process in which it has not been called before.

In the process of all other calls, a function could ignore its generator and remember what it returned.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from polhode.judging.outcome import Ended
from polhode.kinds.random import AFRESH
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget


def compare_afresh(job: Job, result: PlayResult, sandbox: Sandbox, budget: TimeBudget) -> None:
    """Set ``again`` to 0 in each row of a random scene in ``result`` whose answer another child does not
    repeat. What that child has no time for is left as it is.
    """
    requests = [
        _afresh(scene) for scene in job.scenes if _has_seeds(scene.question) and result.finished(scene.name)
    ]
    if not requests:
        return
    fresh = sandbox.play(
        replace(job, scenes=tuple(requests)).without_statements(result.left_out), budget=budget
    )
    for request in requests:
        end, arrays = fresh.scene_ends.get(request.name), result.arrays[request.name]
        if fresh.finished(request.name):
            found = fresh.arrays[request.name]
            same = [_equal(arrays[name][:, -1], found[name]) for name in found]
            arrays["again"] = arrays["again"] * np.all(same, axis=0)
        elif end is not None and end.ended is not Ended.TIMED_OUT:
            arrays["again"] = np.zeros_like(arrays["again"])


def _has_seeds(question: Mapping[str, Any] | None) -> bool:
    return bool(question and question["kind"] == "random" and (question["generators"] or question["seeds"]))


def _afresh(scene: SceneRequest) -> SceneRequest:
    """Return the request of the last repetition alone, which is the first call in its process."""
    returns = {
        name: replace(spec, shape=(spec.shape[0], *spec.shape[2:]))
        for name, spec in scene.returns.items()
        if name != "again"
    }
    return replace(scene, question={**(scene.question or {}), AFRESH: True}, returns=returns, after=None)


def _equal(one: Any, other: Any) -> Any:
    """Return for each row whether all its numbers are the same, or both not a number."""
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    return same.reshape(len(same), -1).all(axis=1)
