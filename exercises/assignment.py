"""The grammar of an assignment: scenes to play, exercises that judge them, figures that show them."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays, Check
from ecp.exercise import Exercise
from ecp.outcome import Diagnosis, SweepResult

Inputs = Mapping[str, Any]
Answers = Mapping[str, tuple[Inputs, Arrays]]
"""By scene, what a function was asked there and what came back."""
RightHandSide = Callable[[float, NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


class InvalidAssignment(Exception):
    """A badly declared assignment; ``errors`` lists everything that is wrong with it."""

    def __init__(self, slug: str, errors: list[str]) -> None:
        super().__init__(f"assignment {slug}: " + "; ".join(errors))
        self.errors = errors


class NoAssignment(LookupError):
    """There is none of that slug, or nobody can tell which is meant; the message tells which there are."""


@dataclass(frozen=True)
class ArraySpec:
    """An array a scene may bring back, as ``float64`` or ``uint8``: of exactly ``shape``, or where ``up_to`` of at least one and at
    most that many in every length but the last, which is exact."""

    shape: tuple[int, ...]
    dtype: str = "float64"
    up_to: bool = False


@dataclass(frozen=True)
class HostVerification:
    """How the host makes sure that a motion which came back is the one the student's function drives.

    It is if ``certified(inputs, seen, truth)`` of the scene ``proof``, where the function was asked for single values, also along
    the exact motion. Otherwise ``follows(inputs, seen, ask, rng)`` lets a trusted integrator call the function over short
    stretches of the motion, and where they differ ``motion(inputs, ask)`` plays all of it so.
    """

    proof: str
    certified: Callable[[Inputs, Arrays, Arrays], bool]
    follows: Callable[[Inputs, Arrays, RightHandSide, np.random.Generator], bool]
    motion: Callable[[Inputs, RightHandSide], Arrays]


@dataclass(frozen=True, eq=False)
class Scene:
    """One reproducible situation: ``play`` (a function of the folder's plays.py) calls ``function`` with ``inputs``.

    ``inputs`` is fixed, or drawn from the attempt's generator where the student must not know it. ``truth`` maps the inputs to
    the exact answer, on the host only. A scene is played only if the one it comes ``after`` was finished. Arrays of the truth that
    are ``known``, such as the times, are handed to checks and figures with what was seen: they are not asked of a stranger.

    ``replaced(inputs, seen)`` gives the inputs that a student used instead of the scene's, a sentence where the answer cannot be
    judged by them, or None where the scene's own were used.

    A scene asked ``twice`` puts its questions again, in another order, to a second child: inputs and answers then all run along
    the questions in their first index, and the answers must agree bit for bit.
    """

    name: str
    play: str
    function: str
    inputs: Inputs | Callable[[np.random.Generator], Inputs]
    returns: Mapping[str, ArraySpec]
    truth: Callable[[Inputs], Arrays]
    budget_s: float
    after: str | None = None
    known: tuple[str, ...] = ()
    twice: bool = False
    drive: HostVerification | None = None
    replaced: Callable[[Inputs, Arrays], Inputs | str | None] | None = None


@dataclass(frozen=True)
class Sweep:
    """Speed against accuracy of the student's own function, played only when somebody asks; ``read(seen, truth)`` tells it."""

    scene: Scene
    read: Callable[[Arrays, Arrays], SweepResult]


@dataclass(frozen=True)
class Assignment:
    """One notebook. ``folder`` holds ``setup.py`` (the notebook's Setup cell) and ``plays.py``, both of which cross the wall.

    ``packages`` names distributions, such as ``("sympy", "pandas")``, that submissions can import besides numpy, scipy and
    matplotlib: they must be installed on the server. ``diagnose`` names the causes of one scene's numbers, and
    ``diagnose_function`` those that explain all scenes of a function together, or None: then each scene is diagnosed alone.
    ``codes`` are the diagnosis codes that its causes and plays give:
    ``polhode verify`` tells those that no sample shows.
    """

    slug: str
    title: str
    version: str
    folder: Path
    scenes: tuple[Scene, ...]
    exercises: tuple[Exercise, ...]
    diagnose: Callable[[str, Inputs, Arrays], list[Diagnosis]] = field(default=lambda scene, inputs, seen: [])
    diagnose_function: Callable[[str, Answers], list[Diagnosis] | None] = field(default=lambda function, answers: None)
    sweep: Sweep | None = None
    codes: tuple[str, ...] = ()
    packages: tuple[str, ...] = ()

    def scene(self, name: str) -> Scene:
        """The scene of that name."""
        return next(s for s in self.scenes if s.name == name)

    def hidden(self, check: Check) -> bool:
        """Whether a check reads something drawn for each attempt, which nobody is told."""
        return any(callable(self.scene(name).inputs) for name in check.scenes)

    def exercise(self, number: str) -> Exercise:
        """The exercise of that number; KeyError if there is none."""
        for exercise in self.exercises:
            if exercise.number == number:
                return exercise
        raise KeyError(number)

    def checks(self) -> list[Check]:
        """All of them, in order."""
        return [c for e in self.exercises for c in e.checks]

    def max_points(self, numbers: Collection[str] | None = None) -> int:
        """A point for each check of the exercises (default: all), but for those of functions that may be left out: a bonus."""
        asked = [e for e in self.exercises if numbers is None or e.number in numbers]
        return sum(len(e.applicable_checks(e.functions, lambda scene: self.scene(scene).function)) for e in asked)

    def functions(self) -> set[str]:
        """Every name a student may define to be played."""
        return {s.function for s in self.scenes} | {f for e in self.exercises for f in e.function_names()}
