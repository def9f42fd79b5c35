"""Parts of figures: undistorted 3-D axes, arrows, a box in any attitude, and a legend above the axes.

Lengths are in the units of the axes. ``R`` (3, 3) is an attitude body → space, ``half`` (3,) are the box's
half edges.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FACE_COLORS = ["#c0851a", "#e3b667", "#46506b", "#7b86a6", "#16213e", "#3a4a6a"]
"""One colour per face of :func:`box_polys`, in its order: the course notebook's list."""


def cube_axes(ax: Any, reach: float) -> Any:
    """Set equal scales from −reach to reach on all three axes of a 3-D ``ax`` and return ``ax``."""
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
    ax.set_box_aspect((1, 1, 1))
    return ax


def arrow(ax: Any, tip: ArrayLike, **style: Any) -> Any:
    """Draw a line from the origin to ``tip`` (3,) on a 3-D ``ax`` and return it."""
    x, y, z = np.asarray(tip, dtype=float)
    return ax.plot([0, x], [0, y], [0, z], **style)[0]


def legend_above(ax: Any, columns: int = 4) -> None:
    """Put the legend of ``ax`` above it, where it covers no data, with at most as many ``columns`` as its
    figure has room for; a title goes above both.
    """
    longest = max(map(len, ax.get_legend_handles_labels()[1]), default=0)
    room = int((ax.figure.get_figwidth() - 0.6) / (0.4 + 0.065 * longest))  # inches, of a letter too
    columns = max(1, min(columns, room))
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, frameon=False, fontsize=9,
        borderaxespad=0.2,
              handlelength=1.4, columnspacing=1.2)  # fmt: skip
    ax.set_title(ax.get_title(), fontsize=9, pad=22)


def box_polys(R: ArrayLike, half: ArrayLike) -> list[NDArray[np.float64]]:
    """Return the six faces of a box with half edges ``half`` (3,) in attitude ``R`` (3, 3), corners (4, 3) in
    space.

    The order is the course notebook's: −ê₃, +ê₃, −ê₂, +ê₂, +ê₁, −ê₁.
    """
    x, y = (-1, 1, 1, -1) * 2, (-1, -1, 1, 1) * 2
    corners = np.array([x, y, [-1] * 4 + [1] * 4], dtype=float).T * np.asarray(half, dtype=float)
    turned = corners @ np.asarray(R, dtype=float).T
    return [turned[list(face)] for face in _FACES]


_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (0, 3, 7, 4))
