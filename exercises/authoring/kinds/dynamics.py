"""Motions of a right-hand side from given starts, as an author declares them, and the question that plays
them.

The question owns the scenes of all its motions, whichever exercise checks them: points, random ones and ones
along every exact motion in one shuffled list, and each fixed motion.
"""

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec, Inputs, Scene, Sweep
from exercises.authoring.assignments.speed_vs_accuracy import BUDGET_S, SETTINGS, result
from exercises.authoring.draws import JointDraw
from exercises.authoring.questions.question import Later, Question, call_with
from polhode.judging.checks import Arrays
from polhode.judging.integration import Array
from polhode.judging.outcome import SweepResult
from polhode.kinds.motions import as_closely

NODES = 10  # points along each motion that is integrated
# along a motion that is not: they miss no stretch longer than 1/64 of it, about two integration steps
ALONG = 128
MOST_SWEPT = 20_000  # calls of one run of the chart; right functions need 7000
SHOWN = ("checks", "figures", "players", "shown", "motions")
"""What only checks and figures need of a question, not the process that plays it."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion from the state and parameters ``start`` to the time ``until``, printed at so many ``samples``,
    with the ``attitude`` of a body whose angular velocity the state is.

    ``known`` are exact numbers by the name of the check that compares with them: constants, or functions of
    the exact motion. ``charted`` adds it to the chart of speed against accuracy.
    """

    name: str
    start: Mapping[str, Any]
    until: float
    samples: int = 0
    attitude: bool = False
    budget_s: float = 12.0
    known: dict[str, Any] = field(default_factory=dict)
    charted: str | None = None

    @property
    def inputs(self) -> dict[str, Any]:
        """The inputs of its scene."""
        start = {name: np.asarray(value, dtype=float).tolist() for name, value in self.start.items()}
        return start | {"until": float(self.until), "samples": self.samples, "attitude": self.attitude}


@dataclass(frozen=True, eq=False)
class HiddenMotion:
    """A motion that is drawn anew for each grading: ``draw`` returns its start, and ``until``, the time at
    which it ends.
    """

    name: str
    draw: JointDraw
    attitude: bool = False

    def drawn(self, rng: np.random.Generator) -> Motion:
        """Return a new motion."""
        start = self.draw(rng)
        until = float(start.pop("until"))
        return Motion(self.name, start, until, attitude=self.attitude)


@dataclass(frozen=True)
class Sensitivity:
    """How a motion answers to errors: ``kappa``, by which it magnifies them, its counterpart ``duration`` in
    s, and the ``angle`` in rad that it turns.
    """

    kappa: float
    duration: float
    angle: float


@dataclass(eq=False)
class Dynamics:
    """What is exact about the motions of one function: ``exact(t, …, attitude)`` returns the state (d, n),
    and with ``attitude`` a pair of it and R (n, 3, 3); ``sensitivity(…, until)`` a ``Sensitivity``.

    ``fixed`` and ``hidden`` are the motions of all exercises.
    """

    time: str
    state: str
    exact: Callable[..., Any] | None = None
    sensitivity: Callable[..., Sensitivity] | None = None
    fixed: dict[str, Motion] = field(default_factory=dict)
    hidden: dict[str, HiddenMotion] = field(default_factory=dict)

    def states(self, motion: Motion, times: Array) -> Array:
        """Return the exact state (d, n) at ``times`` (n,)."""
        return self._called(motion, times, False)[0]

    def truth(self, motion: Motion) -> dict[str, Array]:
        """Return the exact arrays of a motion: times, state, R, what its sensitivity is, and the numbers that
        its checks compare with.
        """
        times = np.linspace(0.0, motion.until, motion.samples)
        state, R = self._called(motion, times, motion.attitude)
        found = {"t": times, self.state: state, **self.known(motion)} | ({} if R is None else {"R": R})
        given = {name: np.asarray(value, dtype=float) for name, value in motion.start.items()}
        given |= {self.time: times, self.state: state} | ({} if R is None else {"R": R})
        for check, known in motion.known.items():
            found[f"exact {check}"] = np.asarray(call_with(known, given) if callable(known) else known, float)
        return found

    def known(self, motion: Motion) -> dict[str, Array]:
        """Return what the sensitivity of a motion is: kappa, duration, speed, angle, and ``turned``, how much
        larger the error of the attitude is, if that is asked for.
        """
        if motion.name in self.fixed:
            return self._known_once(motion)
        return self._known(motion)

    @functools.lru_cache(maxsize=64)  # noqa: B019
    def _known_once(self, motion: Motion) -> dict[str, Array]:
        return self._known(motion)

    def _known(self, motion: Motion) -> dict[str, Array]:
        assert self.sensitivity is not None
        of = call_with(self.sensitivity, {**motion.start, "until": motion.until})
        found = {
            "kappa": of.kappa,
            "duration": of.duration,
            "angle": of.angle,
            "speed": np.linalg.norm(motion.start[self.state]),
            "turned": max(1.0, of.angle) if motion.attitude else 1.0,
        }
        return {name: np.array(value) for name, value in found.items()}

    def _called(self, motion: Motion, times: Array, attitude: bool) -> tuple[Array, Array | None]:
        assert self.exact is not None
        start = {name: np.asarray(value, dtype=float) for name, value in motion.start.items()}
        found = call_with(self.exact, {**start, self.time: times, "attitude": attitude})
        return found if isinstance(found, tuple) else (np.asarray(found, dtype=float), None)


@dataclass(frozen=True, eq=False)
class Driven(Question):
    """The question of a right-hand side with motions: ``dynamics``, the scene ``points`` of its values at
    points, and what one exercise asks of them. Of a function of an earlier exercise, ``again``, it adds
    checks and no scene.
    """

    dynamics: Dynamics = field(default_factory=lambda: Dynamics("t", "y"))
    points: str = ""
    again: bool = False
    checks: Sequence[Mapping[str, Any]] = ()
    figures: Sequence[Mapping[str, Any]] = ()
    players: Sequence[Mapping[str, Any]] = ()
    shown: str = ""

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """The question as data, with the motions and what is asked of them."""
        fixed = self.dynamics.fixed.values()
        return {
            **super().document,
            "scenes": {"public": None, "hidden": self.points},
            "points_scene": self.points,
            "settings": SETTINGS,
            "motions": {motion.name: {"start": motion.inputs} for motion in fixed},
            "checks": list(self.checks),
            "figures": list(self.figures),
            "players": list(self.players),
            "shown": self.shown,
        }

    @functools.cached_property
    def asked(self) -> dict[str, Any]:
        """The question as data for the process that plays it."""
        return {name: value for name, value in super().asked.items() if name not in SHOWN}

    def scenes(self) -> Iterator[Scene]:
        """Yield the scene of the points, and that of each fixed motion behind it."""
        if self.again:
            return
        yield self._points()
        for motion in self.dynamics.fixed.values():
            yield self._motion(motion)

    def _points(self) -> Scene:
        (name,) = self.values
        count = self.rows[1] + NODES * len(self.dynamics.fixed) + ALONG * len(self.dynamics.hidden)
        return Scene(
            name=self.points,
            play="play",
            function=self.function,
            inputs=self._drawn,
            returns=Later(lambda: {name: ArraySpec((count, *self.asked["returns"][0]["shape"]))}),
            truth=self._exact,
            budget_s=self.budget_s,
            known=tuple(f"at_{one}" for one in self.drawn),
            withheld=("motions", "rows"),
            question=Later(lambda: self.asked),
            diagnosed=self._diagnosed,
        )

    def _motion(self, motion: Motion) -> Scene:
        state, n = self.dynamics.state, motion.samples
        size = np.size(motion.start[state])
        returns = {state: ArraySpec((size, n))} | ({"R": ArraySpec((n, 3, 3))} if motion.attitude else {})
        return Scene(
            name=motion.name,
            play="play",
            function=self.function,
            inputs=motion.inputs,
            returns=returns,
            truth=lambda inputs: self.dynamics.truth(motion),
            budget_s=motion.budget_s,
            after=self.points,
            known=("t",),
            question=Later(lambda: self.asked | {"part": motion.name}),
        )

    def _drawn(self, rng: np.random.Generator) -> Inputs:
        """Return the author's points and those along all motions in random order; ``motions`` are these by
        name, ``rows`` the places of their points.
        """
        own = self.draw(rng, self.rows[1])
        motions = dict(self.dynamics.fixed)
        parts = [own, *(self._along(m, np.sort(rng.uniform(size=NODES)), rng) for m in motions.values())]
        for name, hidden in self.dynamics.hidden.items():
            motions[name] = hidden.drawn(rng)
            shares = (np.arange(ALONG) + rng.uniform(size=ALONG)) / ALONG
            parts.append(self._along(motions[name], shares, rng))
        sizes = [len(part[self.dynamics.time]) for part in parts]
        order = rng.permutation(sum(sizes))
        which = np.repeat(np.arange(len(parts)) - 1, sizes)[order]
        columns = {name: np.concatenate([part[name] for part in parts])[order] for name in own}
        rows = {name: np.flatnonzero(which == k) for k, name in enumerate(motions)}
        return {**columns, "motions": motions, "rows": rows}

    def _along(self, motion: Motion, shares: Array, rng: np.random.Generator) -> dict[str, Array]:
        """Return points on an exact motion after these ``shares`` (n,) of its duration."""
        n, start = len(shares), {k: np.asarray(v, dtype=float) for k, v in motion.start.items()}
        path = self.dynamics.states(motion, shares * motion.until).T
        found = {name: np.tile(value, (n, *np.ones(value.ndim, int))) for name, value in start.items()}
        # its own times would identify the points
        unrelated = rng.uniform(0.0, motion.until, n)
        shape = (n, *start[self.dynamics.state].shape)
        return found | {self.dynamics.state: path.reshape(shape), self.dynamics.time: unrelated}

    def _exact(self, inputs: Inputs) -> dict[str, Any]:
        """Return the exact values, and what ``polhode.kinds.motions`` needs of each motion."""
        rows = {name: value for name, value in inputs.items() if name not in ("motions", "rows")}
        found = self.exact(rows)
        for name, motion in inputs["motions"].items():
            found[f"{name}: rows"] = inputs["rows"][name]
            found |= {f"{name}: {what}": value for what, value in self.dynamics.known(motion).items()}
        return found

    def _diagnosed(self, inputs: Inputs) -> Array:
        """Return the author's own rows, which show a cause: those along motions are so many that a hundred
        variants would take too long.
        """
        along = np.concatenate([np.zeros(0, dtype=int), *inputs["rows"].values()])
        every = np.arange(len(inputs[self.dynamics.time]))
        return np.setdiff1d(every, along)


def chart(questions: Sequence[Question]) -> Sweep:
    """Return the chart of speed against accuracy for the motion of a question that is ``charted``."""
    question = questions[0]
    assert isinstance(question, Driven)
    dynamics = question.dynamics
    motion = next(one for one in dynamics.fixed.values() if one.charted)
    state, n, count = dynamics.state, motion.samples, len(SETTINGS)
    size = np.size(motion.start[state])
    times = np.linspace(0.0, motion.until, n)

    def truth(inputs: Inputs) -> Arrays:
        return {state: dynamics.states(motion, times)}

    def read(seen: Arrays, truth: Arrays) -> SweepResult:
        with np.errstate(all="ignore"):
            worst = np.abs(seen[state] - truth[state]).max(axis=(1, 2)) / np.linalg.norm(motion.start[state])
        return result(str(motion.charted), question.function, seen, worst, MOST_SWEPT + 1)

    scene = Scene(
        "sweep",
        "play",
        question.function,
        motion.inputs | {"most_calls": MOST_SWEPT},
        {
            state: ArraySpec((count, size, n)),
            "calls": ArraySpec((count,)),
            "seconds": ArraySpec((count,)),
            "per_call": ArraySpec(()),
        },
        truth,
        budget_s=BUDGET_S,
        question=Later(lambda: question.asked | {"part": "sweep"}),
    )
    known = dynamics.known(motion)
    return Sweep(
        scene,
        read,
        tolerance=as_closely(known).limit,
        sensitivity=lambda: float(known["kappa"]),
        exact=lambda: dynamics._called(motion, times, motion.attitude),
    )
