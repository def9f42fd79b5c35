"""The student's motion and the exact one in one figure. Figures are drawn on request."""

from typing import TYPE_CHECKING

from polhode.judging.checks import Arrays
from polhode.judging.exercise import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


def _motion(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    axes = canvas.add_subplot()
    axes.plot(seen[0]["t"], seen[0]["y"][0], color="#0072b2", label="your x")
    axes.plot(truth[0]["t"], truth[0]["y"][0], color="0.25", ls=":", label="exact")
    axes.set_xlabel("t / s")
    axes.set_ylabel("x / m")
    axes.legend(loc="upper right")


MOTION = Figure(
    "motion",
    "The damped motion",
    "x over time: from your equation, and exact (dotted).",
    ("damped",),
    _motion,
)
