"""Deviations of a method's run from the exact motion over the whole time grid."""

import math
from typing import NamedTuple

import numpy as np

from reference.exact import Exact, Sampled
from reference.methods.method import Run, Scene
from reference.observables import kinetic_energy, orthonormality_error


class Errors(NamedTuple):
    """Largest deviations over a run; infinite if it diverges.

    ``w`` is relative to |ω₀|, ``energy`` to its start; ``R`` and ``orthonormality`` are elements of matrices.
    """

    w: float
    R: float
    energy: float
    orthonormality: float


def exact_run(scene: Scene) -> Sampled:
    """Return the exact motion on the scene's grid, with R."""
    if scene.mgl:
        top = scene.top()
        return Sampled(top.omega(scene.t), top.attitude(scene.t))
    return Exact(scene.w0, scene.I, scene.R0 if scene.tilt else None).sample(scene.t, orientation=True)


def errors(scene: Scene, run: Run, exact: Sampled | None = None) -> Errors:
    """Return the deviations of ``run`` from ``exact``, which must have R (default: ``exact_run``'s)."""
    exact = exact or exact_run(scene)
    assert exact.R is not None
    with np.errstate(all="ignore"):
        energy = kinetic_energy(run.w, scene.I) + scene.mgl * run.R[:, 2, 2]
        return Errors(
            w=_largest(run.w - exact.w) / math.hypot(*scene.w0),
            R=_largest(run.R - exact.R),
            energy=_largest(energy / energy[0] - 1),
            orthonormality=_largest(orthonormality_error(run.R)),
        )


def _largest(values: np.ndarray) -> float:
    worst = float(np.max(np.abs(values)))
    return worst if math.isfinite(worst) else math.inf
