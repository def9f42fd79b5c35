"""The declaration of an exercise: its functions, checks, figures, animations and motions."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from polhode.judging.checks import Arrays, Check

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


NamesOf = Callable[[str], set[str]]
"""A function from a scene's name to the names of a submission that the scene cannot be played without."""


@dataclass(frozen=True)
class Figure:
    """A figure drawn on demand. ``draw(canvas, seen, truth)`` gets one mapping of arrays per scene."""

    name: str
    title: str
    alt: str
    scenes: tuple[str, ...]
    draw: Callable[["Canvas", list[Arrays], list[Arrays]], None]


@dataclass(frozen=True)
class Animation:
    """A student's animation, stored as a contact sheet of the frames (n, h, w, 3) that ``scene`` returned."""

    name: str
    title: str
    alt: str
    scene: str
    array: str = "frames"


@dataclass(frozen=True)
class Motion:
    """A motion to play: the attitudes R (n, 3, 3), body → space, that ``scene`` returned, next to the exact
    ones, as a turning box.

    ``half`` (3,) are the half edges of the uniform box with the scene's moments, up to a factor; ``axis`` (0,
    1, 2) is the body axis whose path is shown.
    """

    name: str
    title: str
    alt: str
    scene: str
    half: tuple[float, float, float]
    axis: int


@dataclass(frozen=True)
class Exercise:
    """A numbered section. A submission that defines one of its ``functions`` or ``optional`` functions
    attempts it.

    The checks of a function in ``optional`` are left out if that function is not defined, and so are those
    that need a function of another exercise, unless it is one of the ``prerequisites``. ``variables`` are
    those among the names of ``functions`` and ``optional`` that stand for a value computed in a cell: a
    number, an array, a string, a dict.
    """

    number: str
    title: str
    functions: tuple[str, ...]
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...] = ()
    animations: tuple[Animation, ...] = ()
    optional: tuple[str, ...] = ()
    motions: tuple[Motion, ...] = ()
    variables: tuple[str, ...] = ()
    prerequisites: tuple[str, ...] = ()

    def function_names(self) -> set[str]:
        """Return the names of its functions, the optional ones included."""
        return {*self.functions, *self.optional}

    def applicable_checks(self, written: Collection[str], names_of: NamesOf) -> list[Check]:
        """Return its checks without those that need a name that is neither ``written`` nor one of its
        functions or prerequisites.
        """
        present = {*self.functions, *self.prerequisites} - set(self.optional) | set(written)
        return [check for check in self.checks if all(names_of(scene) <= present for scene in check.scenes)]

    def scenes(self) -> set[str]:
        """Return the names of the scenes that its checks, figures, animations and motions read."""
        shown = (
            [s for f in self.figures for s in f.scenes]
            + [a.scene for a in self.animations]
            + [m.scene for m in self.motions]
        )
        return {s for c in self.checks for s in c.scenes} | set(shown)


def attempted(exercises: Sequence[Exercise], written: Collection[str]) -> list[Exercise]:
    """Return the exercises that ask for a function that is ``written``, or all of them if none does."""
    return [e for e in exercises if e.function_names() & set(written)] or list(exercises)


def points(
    chosen: Sequence[Exercise], exercises: Sequence[Exercise], written: Collection[str], names_of: NamesOf
) -> int:
    """Return the points of the ``chosen`` of all ``exercises``, without those of optional functions that are
    not ``written``.
    """
    asked = {f for e in exercises for f in e.functions}
    present = [(asked - set(e.optional)) | set(written) for e in chosen]
    return sum(
        c.points
        for e, names in zip(chosen, present, strict=True)
        for c in e.applicable_checks(names, names_of)
    )
