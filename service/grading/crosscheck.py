"""Verification of results: repeat questions in a second child, and compare motions with the function that computes them."""

from collections.abc import Collection, Mapping, Sequence
from concurrent import futures
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from ecp.checks import Arrays
from ecp.outcome import Ended, SceneEnd
from exercises.assignment import Ask, Assignment, HostVerification, Inputs, Scene
from service.grading.author_errors import play
from service.sandbox.job import Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget

DRIVE_S = 20.0
TRIES = (True, False, False)  # whether only the needed cells run; later tries ask what the earlier ones left without an answer
NOT_FINISHED = "not run: it needs the scene {}, which did not finish"


@dataclass
class CrossCheck:
    """The result of ``cross_check``: ``unsteady`` scenes, whose answers differ when repeated, and how each motion was verified."""

    unsteady: set[str] = field(default_factory=set)
    how: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class PlayedJob:
    """A job with the inputs and exact answers of its scenes, the result of playing it, and the grading's time budget.

    The results of the scenes ``recalled`` are recorded ones.
    """

    job: Job
    inputs: Mapping[str, Inputs]
    truths: dict[str, Arrays]
    result: PlayResult
    budget: TimeBudget
    recalled: Collection[str] = ()


def may_be_spared(scene: Scene) -> bool:
    """Return whether answers at points can make it unnecessary to play a scene, a motion with drawn inputs."""
    return scene.drive is not None and scene.drive.along is not None and callable(scene.inputs)


def cross_check(assignment: Assignment, played: PlayedJob, second: "SecondChild", sandbox: Sandbox) -> CrossCheck:
    """Repeat questions in a second child and compare. Replace motions that do not follow the student's function by ones that do.

    Of the motions ``second.spared``, which have not been played, play those whose error the answers at points do not bound.
    """
    result = played.result
    checked = CrossCheck()
    checked.unsteady, answers = second.compare(played)
    _take_bounded(assignment, played, second.along, answers, checked)
    _play_rest(assignment, played, [p for p in second.spared if p.name not in checked.how], sandbox)
    doubtful: list[Scene] = []
    for scene in assignment.scenes:
        if scene.drive is None or scene.name not in result.arrays or scene.name in checked.how:
            continue
        proof = scene.drive.proof
        if proof not in result.arrays:
            _discard(result, scene.name, Ended.NOT_PLAYED, NOT_FINISHED.format(proof))
        elif proof not in checked.unsteady and _is_certified(scene.drive, played):
            computed = "computed in the sandbox"
            if scene.name in played.recalled:
                computed = f"not integrated: {scene.function} repeats every call of a recorded integration, bit for bit"
            checked.how[scene.name] = (
                f"{computed}; {scene.function} is verified by {proof}, at random and along the notebook's motions"
            )
        else:
            doubtful.append(scene)
    if doubtful:
        _drive(doubtful, assignment, played, sandbox, rng=second.rng, checked=checked)
    return checked


def _is_certified(drive: HostVerification, played: PlayedJob) -> bool:
    seen, proof = played.result.arrays, drive.proof
    return proof in seen and drive.certified(played.inputs[proof], seen[proof], played.truths[proof])


def _points_along(assignment: Assignment, played: PlayedJob, spared: Sequence[SceneRequest], seed: int) -> dict[str, Inputs]:
    """Return points along the exact motion of each of the scenes ``spared`` whose function is certified."""
    rng, drives = np.random.default_rng([seed, 3]), {p.name: assignment.scene(p.name).drive for p in spared}
    return {
        name: drive.along(played.inputs[name], rng)
        for name, drive in drives.items()
        if drive and drive.along and _is_certified(drive, played)
    }


def _take_bounded(
    assignment: Assignment, played: PlayedJob, along: Mapping[str, Inputs], answers: Mapping[str, Arrays], checked: CrossCheck
) -> None:
    """Add the results of the scenes whose error their answers ``along`` the exact motion bound."""
    for name, found in answers.items():
        scene = assignment.scene(name)
        assert scene.drive is not None and scene.drive.bounded is not None
        if scene.drive.proof in checked.unsteady:
            continue
        arrays = scene.drive.bounded(played.inputs[name], played.truths[name], along[name], found)
        if arrays is not None:
            checked.how[name] = f"not integrated; {scene.function} is verified at points along the exact motion"
            played.result.arrays[name] = dict(arrays)
            played.result.scene_ends[name] = SceneEnd(scene=name, ended=Ended.FINISHED, sentence=checked.how[name])


def _play_rest(assignment: Assignment, played: PlayedJob, rest: Sequence[SceneRequest], sandbox: Sandbox) -> None:
    """Play the scenes ``rest``, unless the one that they come after did not finish."""
    result = played.result
    for p in rest:
        if not result.finished(str(p.after)):
            followers = [other.name for other in played.job.scenes if other.after == p.after]  # these ended with the child, maybe
            ends = [result.scene_ends[name] for name in followers if name in result.scene_ends and not result.finished(name)]
            ends += [SceneEnd(scene=p.name, ended=Ended.NOT_PLAYED, sentence=NOT_FINISHED.format(p.after))]
            result.scene_ends[p.name] = replace(ends[0], scene=p.name)
    if left := tuple(p for p in rest if p.name not in result.scene_ends):
        more = play(replace(played.job, scenes=left), assignment, sandbox, budget=played.budget)
        more.stdout = ""  # the cells have printed it before
        result.add(more)


class SecondChild:
    """The child that answers the questions of a played job again, in another order, with points ``along`` motions among them.

    These are exact motions of the scenes ``spared``. Leave the context only when the child has exited.
    """

    def __init__(self, assignment: Assignment, spared: Sequence[SceneRequest], sandbox: Sandbox, seed: int) -> None:
        self._assignment, self.spared, self._sandbox, self._seed = assignment, spared, sandbox, seed
        self.rng = np.random.default_rng([seed, 2])
        self.along: Mapping[str, Inputs] = {}
        self._asked = dict[str, tuple[list[str], np.ndarray]]()  # by scene: motions along which points were added, and the order
        self._again: list[SceneRequest] = []
        self._running: futures.Future[PlayResult] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        if self._running is not None:
            futures.wait([self._running])

    def start(self, played: PlayedJob) -> None:
        """Start it beside the first child if that has answered every question, and the sandbox has a guest for a second one."""
        if self._running is None and self._sandbox.beside is not None and set(self._questions(played)) == self._all(played):
            self._prepare(played)
            self._running = self._sandbox.beside.submit(self._play, played, self._again, needed_cells=True)

    def compare(self, played: PlayedJob) -> tuple[set[str], dict[str, Arrays]]:
        """Return the scenes of ``played`` whose answers differ when repeated, and the answers to the points along motions."""
        result, other = played.result, PlayResult()
        if self._running is None or set(self._asked) != set(self._questions(played)):
            self._running = None
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
                running, self._running = self._running, None
                other.add(running.result() if running else self._play(played, left, needed_cells=needed_cells))
            if needed_cells:  # a difference may come from a cell that was left out
                other.arrays = {name: found for name, found in other.arrays.items() if agrees(name, found)}
        unsteady, answers = set[str](), dict[str, Arrays]()
        for name, (added, _) in self._asked.items():
            if name not in other.arrays:
                scene_end = other.scene_ends.get(name)
                sentence = scene_end.sentence if scene_end else "the process ended"
                _discard(result, name, scene_end.ended if scene_end else Ended.EXITED, f"when repeated: {sentence}")
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
        self.along, self._asked, self._again = _points_along(self._assignment, played, self.spared, self._seed), {}, []
        requests = {p.name: p for p in played.job.scenes}
        for name in self._questions(played):
            request, added = requests[name], [one for one in self.along if _proof(self._assignment, one) == name]
            inputs = _joined([request.inputs, *(self.along[one] for one in added)])
            order = self.rng.permutation(_length(inputs))
            self._asked[name] = (added, order)
            returns = {key: replace(spec, shape=(len(order), *spec.shape[1:])) for key, spec in request.returns.items()}
            shuffled = {key: value[order] for key, value in inputs.items()}
            self._again.append(replace(request, inputs=shuffled, returns=returns, after=None))

    def _play(self, played: PlayedJob, scenes: Sequence[SceneRequest], *, needed_cells: bool) -> PlayResult:
        job = replace(played.job, scenes=tuple(scenes), needed_cells=needed_cells)
        return play(job, self._assignment, self._sandbox, budget=played.budget)


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


def _discard(result: PlayResult, scene: str, scene_end: Ended, sentence: str) -> None:
    """Discard the arrays of a scene, so that its checks are unmeasured for the reason given by ``sentence``."""
    del result.arrays[scene]
    result.scene_ends[scene] = SceneEnd(scene=scene, ended=scene_end, sentence=sentence)


def _agree(inputs: Inputs, first: Arrays, second: Arrays) -> bool:
    """Return whether the answers of both children, and those to a repeated question within the first, agree bit for bit."""
    columns = [np.ascontiguousarray(v).reshape(_length(inputs), -1).view(np.uint8) for v in inputs.values()]
    rows = np.concatenate(columns, axis=1)
    _, places, which = np.unique(rows.view(f"V{rows.shape[1]}")[:, 0], return_index=True, return_inverse=True)
    same = places[which]
    return all(a.tobytes() == second[name].tobytes() and a.tobytes() == a[same].tobytes() for name, a in first.items())


def _drive(
    scenes: list[Scene],
    assignment: Assignment,
    played: PlayedJob,
    sandbox: Sandbox,
    *,
    rng: np.random.Generator,
    checked: CrossCheck,
) -> None:
    """Compare stretches of these motions with the host's integration of the function, and replace motions that do not follow it."""
    inputs, result = played.inputs, played.result

    def driver(scene: Scene) -> Any:
        def drive(ask: Ask) -> tuple[bool, Arrays | None]:
            assert scene.drive is not None
            if scene.drive.follows(inputs[scene.name], result.arrays[scene.name], ask, rng):
                return True, None
            try:
                return False, scene.drive.motion(inputs[scene.name], ask)
            except (ArithmeticError, ValueError):
                return False, None

        return drive

    requests = tuple(
        SceneRequest(s.name, s.drive.play, s.function, {}, s.drive.returns, DRIVE_S, None, driver(s)) for s in scenes if s.drive
    )
    answered = play(replace(played.job, scenes=requests), assignment, sandbox, budget=played.budget)
    for scene in scenes:
        follows, motion = answered.driven.get(scene.name, (False, None))
        if follows:
            checked.how[scene.name] = f"computed in the sandbox; follows {scene.function} where the host called it"
        elif motion is not None:
            result.arrays[scene.name] = dict(motion)
            checked.how[scene.name] = f"integrated by the host: the motion computed in the sandbox does not follow {scene.function}"
        else:
            scene_end = answered.scene_ends.get(scene.name)
            reason = scene_end.sentence if scene_end and scene_end.ended is not Ended.FINISHED else "integration failed"
            _discard(result, scene.name, Ended.NOT_PLAYED, f"called by the server: {reason}")
            checked.how[scene.name] = (
                f"the motion computed in the sandbox does not follow {scene.function}, and the host could not integrate it"
            )
