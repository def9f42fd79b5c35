"""What a method is to a chart: a name, an order, settings from coarse to fine, and a way to run a scene."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scene:
    """A motion to compute: moments ``I`` (3,), ω(0) = ``w0`` (3,), R(0) = 1, at ``intervals`` + 1 even times up to ``t_end``."""

    name: str
    w0: tuple[float, float, float]
    I: tuple[float, float, float]
    t_end: float
    intervals: int = 40

    @property
    def t(self) -> Array:
        """The times (n,)."""
        return np.linspace(0.0, self.t_end, self.intervals + 1)


@dataclass(frozen=True)
class Run:
    """What a method made of a scene: ``w`` (3, n), ``R`` (n, 3, 3), and how often it evaluated the right-hand side, or for
    geometric methods the rotations and iterations that stand in its place."""

    w: Array
    R: Array
    calls: int


@dataclass(frozen=True)
class Method:
    """``run(scene, setting)`` with one of ``settings``: steps per interval for a fixed step, rtol for an adaptive one.

    ``order`` is that of a fixed-step method, None for others. ``line`` names the family.
    """

    name: str
    line: str
    order: int | None
    settings: tuple[float, ...]
    run: Callable[[Scene, float], Run]


STEPS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)


def fixed(name: str, line: str, order: int, kernel: Callable[[Array, Array, float, int, int, Array, Array], int]) -> Method:
    """A fixed-step method from a compiled ``kernel(w0, I, h, intervals, steps, w, R)`` that fills w (n, 3) and R (n, 3, 3)."""

    def run(scene: Scene, setting: float) -> Run:
        steps = int(setting)
        w, R = np.empty((scene.intervals + 1, 3)), np.empty((scene.intervals + 1, 3, 3))
        h = scene.t_end / (scene.intervals * steps)
        calls = kernel(np.array(scene.w0), np.array(scene.I), h, scene.intervals, steps, w, R)
        return Run(w.T, R, calls)

    return Method(name, line, order, STEPS, run)
