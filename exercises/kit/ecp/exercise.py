"""An exercise as it is declared: its checks, its figures, the animation of a student's own that it shows, the motions to play."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ecp.checks import Arrays, Check

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


@dataclass(frozen=True)
class Figure:
    """A picture drawn on demand: ``draw(canvas, seen, truth)`` gets one mapping of arrays per scene."""

    name: str
    title: str
    alt: str
    scenes: tuple[str, ...]
    draw: Callable[["Canvas", list[Arrays], list[Arrays]], None]


@dataclass(frozen=True)
class Animation:
    """A student's animation, kept as a contact sheet of the frames (n, h, w, 3) that ``scene`` brought back."""

    name: str
    title: str
    alt: str
    scene: str
    array: str = "frames"


@dataclass(frozen=True)
class Motion:
    """A motion to play: the attitudes R (n, 3, 3) that ``scene`` brought back, beside the exact ones, as a box that turns.

    ``half`` (3,) are half the edges of the uniform box that has the scene's moments, up to a factor; ``axis`` (0, 1, 2) is the
    body axis whose path is shown.
    """

    name: str
    title: str
    alt: str
    scene: str
    half: tuple[float, float, float]
    axis: int


@dataclass(frozen=True)
class Exercise:
    """A numbered section. A submission that defines any of its ``functions``, or of those it can do without, has attempted it.

    A check of a function in ``optional`` is left out where that function is not defined.
    """

    number: str
    title: str
    functions: tuple[str, ...]
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...] = ()
    animations: tuple[Animation, ...] = ()
    optional: tuple[str, ...] = ()
    motions: tuple[Motion, ...] = ()

    def asks_for(self) -> set[str]:
        """Names of the functions it is about."""
        return {*self.functions, *self.optional}

    def made(self, written: Collection[str], function_of: Callable[[str], str]) -> list[Check]:
        """Its checks, without those of an optional function that is not ``written``; ``function_of`` a scene's name."""
        absent = set(self.optional) - set(written)
        return [check for check in self.checks if not absent & {function_of(scene) for scene in check.scenes}]

    def scenes(self) -> set[str]:
        """Names of the scenes its checks, figures, animations and motions read."""
        shown = [s for f in self.figures for s in f.scenes] + [a.scene for a in self.animations] + [m.scene for m in self.motions]
        return {s for c in self.checks for s in c.scenes} | set(shown)


def attempted(exercises: Sequence[Exercise], written: Collection[str]) -> list[Exercise]:
    """Those that ask for a function that is ``written``; all of them where none is."""
    return [e for e in exercises if e.asks_for() & set(written)] or list(exercises)
