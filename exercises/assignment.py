"""The grammar of an assignment: scenes to play, exercises that judge them, figures that show them; and finding the folders."""

import functools
import importlib
import pkgutil
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import exercises
from ecp.checks import Arrays, Check
from ecp.exercise import Exercise
from ecp.outcome import Diagnosis, Swept

Inputs = Mapping[str, Any]
Ask = Callable[[float, NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


class InvalidAssignment(Exception):
    """A badly declared assignment; ``errors`` lists everything that is wrong with it."""

    def __init__(self, slug: str, errors: list[str]) -> None:
        super().__init__(f"assignment {slug}: " + "; ".join(errors))
        self.errors = errors


@dataclass(frozen=True)
class Blank:
    """An array a scene may bring back, as ``float64`` or ``uint8``: of exactly ``shape``, or where ``up_to`` of at least one and at
    most that many in every length but the last, which is exact."""

    shape: tuple[int, ...]
    dtype: str = "float64"
    up_to: bool = False


@dataclass(frozen=True)
class Drive:
    """How the host makes sure that a motion which came back is the one the student's function drives.

    It is if ``certified(inputs, seen, truth)`` of the scene ``proof``, where the function was asked for single values, also along
    the exact motion. Otherwise ``follows(inputs, seen, ask, rng)`` lets a trusted integrator call the function over short
    stretches of the motion, and where they differ ``motion(inputs, ask)`` plays all of it so.
    """

    proof: str
    certified: Callable[[Inputs, Arrays, Arrays], bool]
    follows: Callable[[Inputs, Arrays, Ask, np.random.Generator], bool]
    motion: Callable[[Inputs, Ask], Arrays]


@dataclass(frozen=True, eq=False)
class Scene:
    """One reproducible situation: ``play`` (a function of the folder's plays.py) calls ``function`` with ``inputs``.

    ``inputs`` is fixed, or drawn from the attempt's generator where the student must not know it. ``truth`` maps the inputs to
    the exact answer, on the host only. A scene is played only if the one it comes ``after`` was finished. Arrays of the truth that
    are ``known``, such as the times, are handed to checks and figures with what was seen: they are not asked of a stranger.

    A scene asked ``twice`` puts its questions again, in another order, to a second child: inputs and answers then all run along
    the questions in their first index, and the answers must agree bit for bit.
    """

    name: str
    play: str
    function: str
    inputs: Inputs | Callable[[np.random.Generator], Inputs]
    returns: Mapping[str, Blank]
    truth: Callable[[Inputs], Arrays]
    budget_s: float
    after: str | None = None
    known: tuple[str, ...] = ()
    twice: bool = False
    drive: Drive | None = None


@dataclass(frozen=True)
class Sweep:
    """Speed against accuracy of the student's own function, played only when somebody asks; ``read(seen, truth)`` tells it."""

    scene: Scene
    read: Callable[[Arrays, Arrays], Swept]


@dataclass(frozen=True)
class Assignment:
    """One notebook. ``folder`` holds ``setup.py`` (the notebook's Setup cell) and ``plays.py``, both of which cross the wall."""

    slug: str
    title: str
    version: str
    folder: Path
    scenes: tuple[Scene, ...]
    exercises: tuple[Exercise, ...]
    diagnose: Callable[[str, Inputs, Arrays], list[Diagnosis]] = field(default=lambda scene, inputs, seen: [])
    sweep: Sweep | None = None

    def __post_init__(self) -> None:
        if errors := self._errors():
            raise InvalidAssignment(self.slug, errors)

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

    def most_points(self, numbers: Collection[str] | None = None) -> int:
        """A point for each check of the exercises (default: all), but for those of functions that may be left out: a bonus."""
        asked = [e for e in self.exercises if numbers is None or e.number in numbers]
        return sum(len(e.made(e.functions, lambda scene: self.scene(scene).function)) for e in asked)

    def functions(self) -> set[str]:
        """Every name a student may define to be played."""
        return {s.function for s in self.scenes} | {f for e in self.exercises for f in e.asks_for()}

    def _errors(self) -> list[str]:
        names = [s.name for s in self.scenes]
        ids = [c.id for e in self.exercises for c in e.checks]
        errors = [f"scene {n} is declared twice" for n in sorted({n for n in names if names.count(n) > 1})]
        errors += [f"check id {i} is used twice" for i in sorted({i for i in ids if ids.count(i) > 1})]
        errors += [f"{f} is missing" for f in ("setup.py", "plays.py") if not (self.folder / f).is_file()]
        for exercise in self.exercises:
            errors += [f"exercise {exercise.number}: no scene {s}" for s in sorted(exercise.scenes() - set(names))]
            errors += [e for c in exercise.checks for e in c.errors()]
            errors += [f"motion {m.name}: scene {m.scene} brings no R" for m in exercise.motions if not self._turns(m.scene)]
        for at, scene in enumerate(self.scenes):
            if scene.after is not None and scene.after not in names[:at]:
                errors.append(f"scene {scene.name} comes after {scene.after}, which is not declared before it")
        return errors

    def _turns(self, scene: str) -> bool:
        return any("R" in s.returns for s in self.scenes if s.name == scene)


@functools.cache
def assignments() -> dict[str, Assignment]:
    """Every assignment by its slug: each package in this folder that defines ``ASSIGNMENT``."""
    found = {}
    for module in pkgutil.iter_modules(exercises.__path__):
        if module.ispkg:
            assignment: Assignment = importlib.import_module(f"exercises.{module.name}").ASSIGNMENT
            found[assignment.slug] = assignment
    return found
