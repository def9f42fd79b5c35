"""Deviations of a method's run from the exact motion over the whole time grid, for the charts and the atlas."""

import math
from typing import NamedTuple

import numpy as np

from reference.exact import Exact, Sampled
from reference.method import Run, Scene
from reference.observables import kinetic_energy, momentum_norm, orthonormality_error


class Errors(NamedTuple):
    """Largest deviations over a run; infinite if it diverges.

    ``w`` is relative to |ω₀|, ``energy`` and ``momentum`` (|L|) are relative to their start; ``R`` and
    ``orthonormality`` are elements of matrices.
    """

    w: float
    R: float
    energy: float
    momentum: float
    orthonormality: float


def exact_run(scene: Scene) -> Sampled:
    """Return the exact motion on the scene's grid, with R."""
    return Exact(scene.w0, scene.I).sample(scene.t, orientation=True)


def errors(scene: Scene, run: Run, exact: Sampled) -> Errors:
    """Return the deviations of ``run`` from ``exact``, which must have R."""
    assert exact.R is not None
    with np.errstate(all="ignore"):
        return Errors(
            w=_largest(run.w - exact.w) / math.hypot(*scene.w0),
            R=_largest(run.R - exact.R),
            energy=_largest(kinetic_energy(run.w, scene.I) / kinetic_energy(scene.w0, scene.I) - 1),
            momentum=_largest(momentum_norm(run.w, scene.I) / momentum_norm(scene.w0, scene.I) - 1),
            orthonormality=_largest(orthonormality_error(run.R)),
        )


def _largest(values: np.ndarray) -> float:
    worst = float(np.max(np.abs(values)))
    return worst if math.isfinite(worst) else math.inf
