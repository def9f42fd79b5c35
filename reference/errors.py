"""Deviations of a method's run from the exact motion over the whole time grid,
for the charts and the atlas.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.exact import Exact, Sampled
from reference.method import Run, Scene
from reference.observables import kinetic_energy, momentum_norm, orthonormality_error, space_momentum


class Errors(NamedTuple):
    """Largest deviations over a run; infinite if it diverges.

    ``w`` is relative to |ω₀|, ``energy`` and ``momentum`` (|L|) are relative to their start; ``R`` and
    ``orthonormality`` are elements of matrices. For a heavy top ``momentum`` is that of L_z or L₃, relative
    to
    |L| at the start.
    """

    w: float
    R: float
    energy: float
    momentum: float
    orthonormality: float


def exact_run(scene: Scene) -> Sampled:
    """Return the exact motion on the scene's grid, with R."""
    if scene.mgl:
        top = scene.top()
        return Sampled(top.omega(scene.t), top.attitude(scene.t))
    return Exact(scene.w0, scene.I).sample(scene.t, orientation=True)


def errors(scene: Scene, run: Run, exact: Sampled) -> Errors:
    """Return the deviations of ``run`` from ``exact``, which must have R."""
    assert exact.R is not None
    with np.errstate(all="ignore"):
        return Errors(
            w=_largest(run.w - exact.w) / math.hypot(*scene.w0),
            R=_largest(run.R - exact.R),
            energy=_largest(_energy(scene, run.w, run.R) / _energy(scene, scene.w0, scene.R0) - 1),
            momentum=_largest(_momentum(scene, run)),
            orthonormality=_largest(orthonormality_error(run.R)),
        )


def _energy(scene: Scene, w: ArrayLike, R: NDArray[np.float64]) -> NDArray[np.float64]:
    return kinetic_energy(w, scene.I) + scene.mgl * R[..., 2, 2]


def _momentum(scene: Scene, run: Run) -> NDArray[np.float64]:
    """Return how far |L| (n,) has drifted, or L_z and L₃ (2, n) of a heavy top,
    relative to |L| at the start.
    """
    size = momentum_norm(scene.w0, scene.I)
    if not scene.mgl:
        return momentum_norm(run.w, scene.I) / size - 1
    start = np.array(scene.w0)[:, None]
    kept, kept0 = (
        np.array([space_momentum(R, w, scene.I)[:, 2], scene.I[2] * w[2]])
        for R, w in ((run.R, run.w), (scene.R0[None], start))
    )
    return (kept - kept0) / size


def _largest(values: np.ndarray) -> float:
    worst = float(np.max(np.abs(values)))
    return worst if math.isfinite(worst) else math.inf
