"""A rotating body, and its motion on the grid of times with which an animation is compared."""

from dataclasses import dataclass

import numpy as np

from polhode.kinds.animation.curve_matching import finely
from polhode.kinds.animation.frame_times import PER, Array, Frames

NAMES = ("ê₁", "ê₂", "ê₃")


@dataclass(frozen=True, eq=False)
class Body:
    """A body with attitudes R (n, 3, 3), from body axes to space, at times ``t`` (n,), and what a student
    draws of it.

    That is the body axis number ``axis``, or for None any points of the body; the angular momentum L (3,) in
    space if it is given; and a box with half edges ``half`` (3,) along the body axes if these are given.
    """

    t: Array
    R: Array
    axis: int | None = None
    L: Array | None = None
    half: Array | None = None


class Motion:
    """The motion of ``body`` on the grid of times, and the frames ``at`` (f, 3) of its animation with their
    ``rests``.

    Attitudes R (G, 3, 3), and in space the axis ``tip`` (G, 3), the angular velocity w (G, 3) up to its unit,
    and ``unit`` (3,) along L.
    """

    def __init__(self, body: Body, at: Array, rests: tuple[int, int] = (0, 0)) -> None:
        self.axis, self.half = body.axis, body.half
        at, t, self.R, rate = finely(at, body.t, body.R)
        self.tip = self.R[:, :, 2 if body.axis is None else body.axis]
        spin = np.swapaxes(self.R, 1, 2) @ rate
        self.w = np.einsum("gij,gj->gi", self.R, spin[:, [2, 0, 1], [1, 2, 0]])
        self.unit = None if body.L is None else body.L / np.linalg.norm(body.L)
        self.name = "the body" if body.axis is None else NAMES[body.axis]
        self.frames = Frames(at, t, self._turns(), rests)

    def _turns(self) -> Array:
        """Return the turns since the start (n,): of the axis about L, or of the body."""
        if self.unit is not None and self.axis is not None:
            tips = self.tip[::PER]
            across = tips - np.outer(tips @ self.unit, self.unit)
            if np.linalg.norm(across, axis=1).min() >= 1e-6:
                angle = np.unwrap(np.arctan2(across @ np.cross(self.unit, across[0]), across @ across[0]))
                return np.asarray(np.maximum.accumulate(np.abs(angle)) / (2 * np.pi))
        speed = np.linalg.norm(self.w, axis=1)
        return np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])[::PER] / (2 * np.pi * PER)
