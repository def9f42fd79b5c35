"""Drawing helpers of the notebook: three-dimensional axes that do not distort, arrows, a box in an attitude.

Lengths are in the units of the axes, ``R`` (3, 3) is an attitude body → space, ``half`` (3,) are the box's half edges.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FACE_COLORS = ("#0072b2", "#56b4e9", "#009e73", "#a6d96a", "#d55e00", "#e69f00")
"""One colour per face: ±ê₁ blue, ±ê₂ green, ±ê₃ orange (after Okabe and Ito's colour-blind safe set)."""


def cube_axes(ax: Any, reach: float) -> Any:
    """Equal scales on all three axes of a 3-D ``ax``, from −reach to reach; returns ``ax``."""
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
    ax.set_box_aspect((1, 1, 1))
    return ax


def arrow(ax: Any, tip: ArrayLike, **style: Any) -> Any:
    """An arrow from the origin to ``tip`` (3,) on a 3-D ``ax``; returns the line."""
    x, y, z = np.asarray(tip, dtype=float)
    return ax.plot([0, x], [0, y], [0, z], **style)[0]


def box_polys(R: ArrayLike, half: ArrayLike) -> NDArray[np.float64]:
    """The six faces (6, 4, 3) of a box in attitude ``R``, in the order +ê₁, −ê₁, +ê₂, −ê₂, +ê₃, −ê₃."""
    corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)], dtype=float)
    faces = np.empty((6, 4, 3))
    for face in range(6):
        axis, side = face // 2, 1 - 2 * (face % 2)
        faces[face] = np.insert(corners, axis, side, axis=1)
    return faces * np.asarray(half, dtype=float) @ np.asarray(R, dtype=float).T
