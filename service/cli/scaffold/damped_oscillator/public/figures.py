"""The student's own motion beside the exact one. A figure is drawn when somebody looks, on a bare canvas."""

from typing import TYPE_CHECKING

from ecp.checks import Arrays
from ecp.exercise import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


def _motion(canvas: "Canvas", seen: list[Arrays], truth: list[Arrays]) -> None:
    axes = canvas.add_subplot()
    axes.plot(seen[0]["t"], seen[0]["y"][0], color="#0072b2", label="x of yours")
    axes.plot(truth[0]["t"], truth[0]["y"][0], color="0.25", ls=":", label="exact")
    axes.set_xlabel("t / s")
    axes.set_ylabel("x / m")
    axes.legend(loc="upper right")


MOTION = Figure(
    "motion", "The damped motion", "x over time: the curve of your equation and, dotted, the exact one.", ("damped",), _motion
)
