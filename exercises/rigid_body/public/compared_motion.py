"""The motion of a body that an animation is compared with."""

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import timing
from ecp.kinds.animation.matching import finely

Array = NDArray[np.float64]


class Motion:
    """R (n, 3, 3) at times ``t`` (n,), with the curves and laws that an animation is compared with.

    L (3,) and the half edges ``half`` (3,) of the box are given if they are drawn.
    """

    def __init__(self, at: Array, t: Array, R: Array, L: Array | None, axis: int | None, *, half: Array | None = None) -> None:
        self.L, self.axis, self.half, self.n = L, axis, half, len(t)
        self.R, rate = finely(R)
        spin = np.swapaxes(self.R, 1, 2) @ rate
        self.w = np.einsum("gij,gj->gi", self.R, spin[:, [2, 0, 1], [1, 2, 0]])  # in space, up to its unit
        self.turned = self._turns(R[:, :, axis], L) if L is not None and axis is not None else self._angle()
        self.laws = timing.laws(at, t, self.turned)

    def _turns(self, tips: Array, L: Array) -> Array:
        """Return the turns of the axis about L since the start (n,)."""
        z = L / np.linalg.norm(L)
        across = tips - np.outer(tips @ z, z)
        if np.linalg.norm(across, axis=1).min() < 1e-6:
            return self._angle()
        x = across[0] / np.linalg.norm(across[0])
        angle = np.unwrap(np.arctan2(across @ np.cross(z, x), across @ x))
        return np.asarray(np.maximum.accumulate(np.abs(angle)) / (2 * np.pi))

    def _angle(self) -> Array:
        """Return the turns of the body since the start (n,)."""
        speed = np.linalg.norm(self.w, axis=1)
        angle = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])[:: timing.PER]
        return np.asarray(angle / (2 * np.pi * timing.PER))
