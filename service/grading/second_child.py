"""The second child of a grading: it repeats questions in another order, with points along exact motions among
them.
"""

from collections.abc import Mapping, Sequence
from concurrent import futures
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from ecp.checks import Arrays
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Assignment, HostVerification, Inputs, Recording
from service.grading.author_errors import play
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

TRIES = (
    True,
    False,
    False,
)  # whether only the needed cells run; later tries ask what the earlier ones left without an answer


@dataclass(frozen=True)
class PlayedJob:
    """A job with the inputs and exact answers of its scenes, the result of playing it, and the grading's time
    budget.

    ``recalled`` are the recordings that are the results of scenes, by scene.
    """

    job: Job
    inputs: Mapping[str, Inputs]
    truths: dict[str, Arrays]
    result: PlayResult
    budget: TimeBudget
    recalled: Mapping[str, Recording] = field(default_factory=dict)


class SecondChild:
    """The child that answers the questions of a played job again, in another order, with points ``along``
    motions among them.

    The scenes ``spared`` are motions that need not be played if the answers along their exact motions
    suffice. Leaving the context waits until a child that was started beside the first one has exited.
    """

    def __init__(
        self, assignment: Assignment, spared: Sequence[SceneRequest], sandbox: Sandbox, seed: int
    ) -> None:
        self._assignment, self.spared, self._sandbox, self._seed = assignment, spared, sandbox, seed
        self.rng = np.random.default_rng([seed, 2])
        self.along: Mapping[str, Inputs] = {}
        self._asked = dict[
            str, tuple[list[str], np.ndarray]
        ]()  # by scene: motions along which points were added, and the order
        self._again: list[SceneRequest] = []
        self._starting: futures.Future[None] | None = None
        self._running: futures.Future[PlayResult] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        started: list[futures.Future[Any]] = [
            one for one in (self._starting, self._running) if one is not None
        ]
        futures.wait(started)

    def start(self, played: PlayedJob, scene: str) -> None:
        """Start the second child if the sandbox has a guest for it; the first one begins ``scene``.

        While the first child answers the last question, start the second one without a job. Send the job once
        every question is answered. If the start fails, the play starts another child.
        """
        asked, beside = self._all(played), self._sandbox.beside
        if self._running is not None or beside is None or not asked:
            return
        left = asked - set(self._questions(played))
        if left == {scene}:
            repeated = tuple(p for p in played.job.scenes if p.name in asked)
            self._starting = beside.submit(
                self._sandbox.start_child, replace(played.job, scenes=repeated), played.budget
            )
        elif not left:
            self._prepare(played)
            self._running = beside.submit(self._play, played, self._again, needed_cells=True)

    def compare(self, played: PlayedJob) -> tuple[set[str], dict[str, Arrays]]:
        """Return the scenes of ``played`` whose answers differ when repeated, and the answers to the points
        along motions.
        """
        result, other = played.result, PlayResult()
        running = self._running if set(self._asked) == set(self._questions(played)) else None
        if running is None:  # not started, or the first child has lost answers since
            if self._starting is not None:
                futures.wait([self._starting])
            self._prepare(played)

        def parts(name: str, second: Arrays) -> list[Arrays]:
            added, order = self._asked[name]
            inverse = np.argsort(order)
            lengths = [_length(result.arrays[name]), *(_length(self.along[one]) for one in added)]
            return _parts({key: array[inverse] for key, array in second.items()}, lengths)

        def agrees(name: str, second: Arrays) -> bool:
            return _agree(played.inputs[name], result.arrays[name], parts(name, second)[0])

        for needed_cells in TRIES:
            if left := [p for p in self._again if p.name not in other.arrays]:
                other.add(
                    running.result() if running else self._play(played, left, needed_cells=needed_cells)
                )
                running = None
            if needed_cells:  # a difference may come from a cell that was left out
                other.arrays = {name: found for name, found in other.arrays.items() if agrees(name, found)}
        unsteady, answers = set[str](), dict[str, Arrays]()
        for name, (added, _) in self._asked.items():
            if name not in other.arrays:
                scene_end = other.scene_ends.get(name)
                sentence = scene_end.sentence if scene_end else "the process ended"
                discard(
                    result, name, scene_end.ended if scene_end else Ended.EXITED, f"when repeated: {sentence}"
                )
                continue
            if not agrees(name, other.arrays[name]):
                unsteady.add(name)
            answers |= dict(zip(added, parts(name, other.arrays[name])[1:], strict=True))
        return unsteady, answers

    def _all(self, played: PlayedJob) -> set[str]:
        return {p.name for p in played.job.scenes if self._assignment.scene(p.name).twice}

    def _questions(self, played: PlayedJob) -> list[str]:
        """Return the scenes to repeat, in the order of the job."""
        asked = self._all(played)
        return [p.name for p in played.job.scenes if p.name in asked and p.name in played.result.arrays]

    def _prepare(self, played: PlayedJob) -> None:
        """Draw the points along motions and the order of the questions."""
        self.along, self._asked, self._again = (
            _points_along(self._assignment, played, self.spared, self._seed),
            {},
            [],
        )
        requests = {p.name: p for p in played.job.scenes}
        for name in self._questions(played):
            request, added = (
                requests[name],
                [one for one in self.along if _proof(self._assignment, one) == name],
            )
            inputs = _joined([request.inputs, *(self.along[one] for one in added)])
            order = self.rng.permutation(_length(inputs))
            self._asked[name] = (added, order)
            returns = {
                key: replace(spec, shape=(len(order), *spec.shape[1:]))
                for key, spec in request.returns.items()
            }
            shuffled = {key: value[order] for key, value in inputs.items()}
            self._again.append(replace(request, inputs=shuffled, returns=returns, after=None))

    def _play(self, played: PlayedJob, scenes: Sequence[SceneRequest], *, needed_cells: bool) -> PlayResult:
        job = replace(played.job, scenes=tuple(scenes), needed_cells=needed_cells)
        return play(job, self._assignment, self._sandbox, budget=played.budget)


def is_certified(drive: HostVerification, played: PlayedJob) -> bool:
    """Return whether the answers at points show that the function of a motion is right."""
    seen, proof = played.result.arrays, drive.proof
    return proof in seen and drive.certified(played.inputs[proof], seen[proof], played.truths[proof])


def discard(result: PlayResult, scene: str, scene_end: Ended, sentence: str) -> None:
    """Discard the arrays of a scene, so that its checks are unmeasured for the reason given by
    ``sentence``.
    """
    del result.arrays[scene]
    result.scene_ends[scene] = SceneEnd(scene=scene, ended=scene_end, sentence=sentence)


def _points_along(
    assignment: Assignment, played: PlayedJob, spared: Sequence[SceneRequest], seed: int
) -> dict[str, Inputs]:
    """Return points along the exact motion of each of the scenes ``spared`` whose function is certified."""
    rng, drives = np.random.default_rng([seed, 3]), {p.name: assignment.scene(p.name).drive for p in spared}
    return {
        name: drive.along(played.inputs[name], rng)
        for name, drive in drives.items()
        if drive and drive.along and is_certified(drive, played)
    }


def _proof(assignment: Assignment, scene: str) -> str:
    drive = assignment.scene(scene).drive
    assert drive is not None
    return drive.proof


def _length(arrays: Mapping[str, Any]) -> int:
    return len(next(iter(arrays.values())))


def _joined(several: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    return {key: np.concatenate([np.asarray(one[key]) for one in several]) for key in several[0]}


def _parts(arrays: Arrays, lengths: Sequence[int]) -> list[Arrays]:
    """Return the arrays, of which each has ``lengths`` in all, in parts of these lengths."""
    split = {key: np.split(array, np.cumsum(lengths)[:-1]) for key, array in arrays.items()}
    return [{key: split[key][k] for key in split} for k in range(len(lengths))]


def _agree(inputs: Inputs, first: Arrays, second: Arrays) -> bool:
    """Return whether the answers of both children, and those to a repeated question within the first, agree
    bit for bit.
    """
    columns = [np.ascontiguousarray(v).reshape(_length(inputs), -1).view(np.uint8) for v in inputs.values()]
    rows = np.concatenate(columns, axis=1)
    _, places, which = np.unique(rows.view(f"V{rows.shape[1]}")[:, 0], return_index=True, return_inverse=True)
    same = places[which]
    return all(
        a.tobytes() == second[name].tobytes() and a.tobytes() == a[same].tobytes()
        for name, a in first.items()
    )
