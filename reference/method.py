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
    """A motion to compute: moments ``I`` (3,) kg m², ω(0) = ``w0`` (3,) rad/s, R(0) = 1, at ``intervals`` + 1
    even times up to ``t_end`` s.

    With a torque ``mgl`` in N m it is a heavy top with I₁ = I₂, and R(0) is a turn by ``tilt`` rad about x.
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

    @property
    def euler_angles(self) -> tuple[float, ...]:
        """Return θ, φ, ψ and their rates (6,) at the start of a heavy top."""
        swing = self.w0[1] / math.sin(self.tilt)
        return self.tilt, 0.0, 0.0, self.w0[0], swing, self.w0[2] - swing * math.cos(self.tilt)

    def top(self) -> HeavyTop:
        """Return the exact motion of a heavy top."""
        return HeavyTop(self.euler_angles, self.I[0], self.I[2], self.mgl)


@dataclass(frozen=True)
class Run:
    """A method's result for a scene: ``w`` (3, n), ``R`` (n, 3, 3) and ``calls``.

    ``calls`` counts evaluations of the right-hand side; for geometric methods, the rotations and iterations
    in its place.
    """

    w: Array
    R: Array
    calls: int


@dataclass(frozen=True)
class Method:
    """A numerical method: ``run(scene, setting)`` with one of ``settings``.

    A setting is the number of steps per interval for a fixed step, rtol for an adaptive one. ``order`` is
    that of a fixed-step method, None for others. ``line`` names the family.
    """

    name: str
    line: str
    order: int | None
    settings: tuple[float, ...]
    run: Callable[[Scene, float], Run]


STEPS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)


def fixed(
    name: str, line: str, order: int, kernel: Callable[[Array, Array, float, int, int, Array, Array], int]
) -> Method:
    """Return a fixed-step method from a compiled ``kernel(w0, I, h, intervals, steps, w, R)`` that fills w
    (n, 3) and R (n, 3, 3).

    The kernel returns the number of calls.
    """

    def run(scene: Scene, setting: float) -> Run:
        steps = int(setting)
        w, R = np.empty((scene.intervals + 1, 3)), np.empty((scene.intervals + 1, 3, 3))
        h = scene.t_end / (scene.intervals * steps)
        calls = kernel(np.array(scene.w0), np.array(scene.I), h, scene.intervals, steps, w, R)
        return Run(w.T, R, calls)

    return Method(name, line, order, STEPS, run)
