"""An assignment as grading reads it: scenes, exercises, sweeps and packages."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polhode.judging.checks import Arrays, Check
from polhode.judging.exercise import Exercise, points
from polhode.judging.outcome import SweepResult
from polhode.report.report import out_of

Inputs = Mapping[str, Any]


class InvalidAssignment(Exception):
    """The declaration of the assignment ``slug`` is invalid; ``errors`` lists all of its errors."""

    def __init__(self, slug: str, errors: list[str]) -> None:
        super().__init__(f"assignment {slug}: " + "; ".join(errors))
        self.slug, self.errors = slug, errors


class NoAssignment(LookupError):
    """There is no assignment of that slug, or several fit; the message lists those that exist."""


@dataclass(frozen=True)
class ArraySpec:
    """An array that a scene may return, as ``float64`` or ``uint8``.

    It has exactly ``shape``. If ``up_to`` is set, every length but the last may be from one to that of
    ``shape``.
    """

    shape: tuple[int, ...]
    dtype: str = "float64"
    up_to: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """One reproducible call: ``play`` (a function of the assignment's plays) calls ``function`` with
    ``inputs``.

    ``inputs`` are fixed, or drawn from the submission's random generator so that the student cannot know
    them. ``truth`` maps the inputs to the exact answer, on the host only. The scene is played only if the one
    it comes ``after`` has finished. Arrays of the truth that are ``known``, such as times, are added to the
    returned ones for checks and figures.

    ``replaced(inputs, seen)`` returns the inputs that a student used instead of the scene's, a sentence if
    the answer cannot be judged by them, or None if the scene's own were used.

    ``function`` may also name a variable of the submission, see ``Exercise``. ``play`` may use further names
    of the submission if they are in ``needs``: the scene is played only if all of them are defined.

    The scene of a ``question`` (polhode.kinds) is played by ``play(question, student, inputs)``, and its
    inputs run along its rows in their first index.

    Inputs that are ``withheld`` stay on the host: only ``truth`` gets them. ``diagnosed(inputs)`` returns the
    rows of a question that are enough to find a cause, by default all.
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
    replaced: Callable[[Inputs, Arrays], Inputs | str | None] | None = None
    needs: tuple[str, ...] = ()
    question: Mapping[str, Any] | None = None
    withheld: tuple[str, ...] = ()
    diagnosed: Callable[[Inputs], NDArray[Any]] | None = None


@dataclass(frozen=True)
class Sweep:
    """A chart of speed against accuracy of the student's function, played while a worker is idle.
    ``read(seen, truth)`` returns the result.

    ``tolerance`` is that of the check of this motion, ``sensitivity`` returns the motion's κ, and ``exact``
    computes it in closed form at the exercise's own samples. A right submission of the assignment is measured
    beside.
    """

    scene: Scene
    read: Callable[[Arrays, Arrays], SweepResult]
    tolerance: float | None = None
    sensitivity: Callable[[], float] | None = None
    exact: Callable[[], object] | None = None


class PublishedCell(NamedTuple):
    """A code cell of the students' notebook. ``is_given`` is false for one that the student fills in;
    ``is_validation`` is true for one that calls ``validate``.
    """

    name: str
    source: str
    is_given: bool
    id: str = ""
    is_validation: bool = False


@dataclass(frozen=True)
class Assignment:
    """One notebook. ``setup`` is the text of its Setup cell and ``plays`` that of the functions that play the
    scenes; both run inside the sandbox.

    ``packages`` names distributions, such as ``("sympy", "pandas")``, that submissions can import besides
    numpy, scipy and matplotlib; they must be installed on the server. ``cpu_s`` is the CPU time in seconds
    that one grading may use, if that is more than the server's limit: five times as much as the right
    solution uses. ``data`` names files of the folder that submissions read by the same relative name, such as
    "pendulum.csv". ``load_s`` is the CPU time in seconds for a submission's cells, if that is more than 10:
    for each cell, if there are ``published`` ones. ``memory_mb`` is the MiB of memory for its data, if that
    is more than 512.

    ``questions`` are those of each exercise as data, for the students' kit. ``variants`` returns the right
    solution and wrong ones of a question by its id (exercises.authoring.mutants.solution.Variant), ``pairs``
    those with two changes, ``source_before`` the right solutions of the questions before it, and
    ``made_samples`` the samples that follow from the declaration
    (exercises.authoring.mutants.variants.MadeSample). ``notebook`` returns the students' notebook.
    ``published`` are its code cells, if the server runs those that are given in place of the student's
    copies.
    """

    slug: str
    title: str
    version: str
    folder: Path
    scenes: tuple[Scene, ...]
    exercises: tuple[Exercise, ...]
    setup: str
    plays: str
    sweeps: tuple[Sweep, ...] = ()
    packages: tuple[str, ...] = ()
    cpu_s: float | None = None
    data: tuple[str, ...] = ()
    load_s: float | None = None
    memory_mb: int | None = None
    published: tuple[PublishedCell, ...] = ()
    notebook: Callable[[], str] = field(default=lambda: "")
    questions: Mapping[str, tuple[Mapping[str, Any], ...]] = field(default_factory=dict)
    variants: Callable[[str], Sequence[Any]] = field(default=lambda question: ())
    pairs: Callable[[str], Sequence[Any]] = field(default=lambda question: ())
    source_before: Callable[[str], str] = field(default=lambda question: "")
    made_samples: Callable[[], Iterable[Any]] = field(default=lambda: ())

    def right_submission(self, function: str) -> str | None:
        """Return the source of a right submission that defines ``function``, or None if there is none."""
        if made := next((sample.source for sample in self.made_samples() if sample.right), None):
            return str(made)
        defines = re.compile(rf"^(?:def |class |){re.escape(function)}\b *[(:=]", re.MULTILINE)
        samples = (
            path.read_text(encoding="utf-8") for path in sorted((self.folder / "samples").glob("right_*.py"))
        )
        return next((source for source in samples if defines.search(source)), None)

    @property
    def sweep(self) -> Sweep | None:
        """The chart of speed against accuracy of a submission, if the assignment has one: the first."""
        return self.sweeps[0] if self.sweeps else None

    def sweep_of(self, numbers: Collection[str]) -> Sweep | None:
        """Return the first chart of speed against accuracy of these exercises."""
        functions = {name for number in numbers for name in self.exercise(number).functions}
        return next((sweep for sweep in self.sweeps if sweep.scene.function in functions), None)

    def scene(self, name: str) -> Scene:
        """Return the scene of that name. Raises StopIteration if there is none."""
        return next(s for s in self.scenes if s.name == name)

    def hidden(self, check: Check) -> bool:
        """Return whether a check is about a scene with random inputs: the first that it reads."""
        return any(callable(self.scene(name).inputs) for name in check.scenes[:1])

    def exercise(self, number: str) -> Exercise:
        """Return the exercise of that number. Raises KeyError if there is none."""
        return {exercise.number: exercise for exercise in self.exercises}[number]

    def checks(self) -> list[Check]:
        """Return the checks of all exercises in order."""
        return [c for e in self.exercises for c in e.checks]

    def tested_function(self, check: str) -> str:
        """Return the function that the check of that id tests. Raises StopIteration if there is no check."""
        return self.scene(next(c.scenes[0] for c in self.checks() if c.id == check)).function

    def expected_checks(self, exercise: Exercise) -> list[Check]:
        """Return the checks of an exercise without those of its optional functions."""
        asked = {f for e in self.exercises for f in e.functions} - set(exercise.optional)
        return exercise.applicable_checks(asked, self.names)

    def max_points(self, numbers: Collection[str] | None = None, written: Collection[str] = ()) -> int:
        """Return the points of the exercises ``numbers`` (default: all), without those of optional functions
        that are not ``written``.
        """
        chosen = [e for e in self.exercises if numbers is None or e.number in numbers]
        return points(chosen, self.exercises, written, self.names)

    def bonus_points(self, numbers: Collection[str] | None = None) -> int:
        """Return the points of the optional functions of these exercises (default: all), which ``max_points``
        leaves out.
        """
        chosen = [c for e in self.exercises if numbers is None or e.number in numbers for c in e.checks]
        return sum(check.points for check in chosen) - self.max_points(numbers)

    @cached_property
    def most_points(self) -> int:
        """Return the points of all exercises, without those of optional functions."""
        return self.max_points()

    @property
    def points_note(self) -> str:
        """Return how many checks carry no points, "" if all do."""
        checks = self.checks()
        count = sum(check.points == 0 for check in checks)
        return f"{count} of {len(checks)} checks carry no points" if count else ""

    @cached_property
    def out_of(self) -> str:
        """Return the points of the assignment, with those of optional functions apart: "36 + 6 bonus"."""
        return out_of(self.most_points, self.bonus_points())

    def names(self, scene: str) -> set[str]:
        """Return the names of a submission that a scene, and those it comes after,
        cannot be played without.
        """
        found = self.scene(scene)
        return {found.function, *found.needs} | (
            self.names(found.after) if found.after is not None else set()
        )

    def functions(self) -> set[str]:
        """Return the names of all functions and variables that a student may define."""
        return {s.function for s in self.scenes} | {f for e in self.exercises for f in e.function_names()}

    def variables(self) -> set[str]:
        """Return the names of all variables that a student may define."""
        return {name for e in self.exercises for name in e.variables}
