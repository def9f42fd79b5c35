"""A method as a chart needs it: a name, an order, settings from coarse to fine, and a function that runs a
scene.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.heavy_top import HeavyTop

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scene:
    """A motion to compute: moments ``I`` (3,) kg m², ω(0) = ``w0`` (3,) rad/s, and R(0), a turn by ``tilt``
    rad about x, at ``intervals`` + 1 even times up to ``t_end`` s.

    With a torque ``mgl`` in N m it is a heavy top with I₁ = I₂.
    """

    name: str
    w0: tuple[float, float, float]
    I: tuple[float, float, float]
    t_end: float
    intervals: int = 40
    mgl: float = 0.0
    tilt: float = 0.0

    @property
    def t(self) -> Array:
        """Return the times (n,) in s."""
        return np.linspace(0.0, self.t_end, self.intervals + 1)

    @property
    def R0(self) -> Array:
        """Return R(0) (3, 3)."""
        c, s = math.cos(self.tilt), math.sin(self.tilt)
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])

    def top(self) -> HeavyTop:
        """Return the exact motion of a heavy top."""
        swing = self.w0[1] / math.sin(self.tilt)
        spin = self.w0[2] - swing * math.cos(self.tilt)
        return HeavyTop((self.tilt, 0.0, 0.0, self.w0[0], swing, spin), self.I[0], self.I[2], self.mgl)


@dataclass(frozen=True)
class Run:
    """A method's result for a scene: ``w`` (3, n), ``R`` (n, 3, 3) and ``calls``.

    ``calls`` counts evaluations of the right-hand side; for geometric methods, the substeps or iterations in
    its place.
    """

    w: Array
    R: Array
    calls: int


@dataclass(frozen=True)
class Method:
    """A numerical method: ``run(scene, setting)`` with one of ``settings``.

    A setting is the number of steps per interval for a fixed step, rtol for an adaptive one. ``order`` is
    that of a fixed-step method, None for others.
    """

    name: str
    order: int | None
    settings: tuple[float, ...]
    run: Callable[[Scene, float], Run]
