"""The scenes that the charts of the methods are measured on."""

from reference.exact import Exact
from reference.inertia import box_moments
from reference.methods.method import Scene

BOOK: tuple[float, float, float] = tuple(box_moments(1.0, 2.0, 1.4, 0.4).tolist())


def nudged(nudge: float, passages: float = 2.1, intervals: int = 40) -> Scene:
    """Return the book spun about its intermediate axis, off it by ``nudge``, for so many periods of ω."""
    w0 = (6 * nudge, 6.0, 0.7 * 6 * nudge)
    return Scene(f"separatrix, nudge {nudge:.0e}", w0, BOOK, passages * Exact(w0, BOOK).period, intervals)


EXERCISE_2 = Scene("exercise 2", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 20.0)
EXERCISE_5 = Scene("exercise 5, about ê₂", (0.12, 6.0, 0.12), BOOK, 2.5)
EXERCISE_6 = Scene("exercise 6", (0.2, 0.3, 3.0), (1.0, 1.0, 1.6), 8.0)
TOP = Scene("heavy top", (0.0, 0.6, 14.0), (1.0, 1.0, 0.6), 4.0, mgl=10.0, tilt=0.6)
ROD = Scene("rod, I₁ = 1e-4", (1e4, 0.3, 0.2), (1e-4, 1.0, 1.0 + 5e-5), 0.02)
SCENES = (EXERCISE_2, EXERCISE_5, EXERCISE_6, nudged(1e-2), ROD, TOP)
