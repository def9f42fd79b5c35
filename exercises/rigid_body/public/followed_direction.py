"""What the points that follow a motion show: the body axis, the body, or another direction of it."""

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import cameras
from ecp.kinds.animation.matching import Match
from ecp.kinds.animation.shown import Shown, samples

from . import boxes
from .compared_motion import Motion

Array = NDArray[np.float64]

PARALLEL = 0.03  # sine of the angle from the body axis
SPAN = 0.1  # of the length of two directions that show the body's attitude together
NAMES = "₁₂₃"


def read(match: Match, motion: Motion) -> Shown:
    """Return what the points of ``match`` show: the axis or the body, or another direction."""
    axis, seen = motion.axis, samples(match.times, motion.n)
    units = match.points / np.maximum(np.linalg.norm(match.points, axis=0), 1e-300)
    edges = None if axis is not None or motion.half is None else boxes.edges(match.points)
    if axis is None and motion.half is not None and (astray := boxes.displaced(match, motion.half, motion.R)):
        return Shown(False, "wrong-motion", astray)
    if edges is not None and motion.half is not None and boxes.disproportionate(edges, motion.half):
        sentence = f"the box is drawn with edges in the ratio {_ratio(edges)}, but half has {_ratio(motion.half)}"
        return Shown(False, "wrong-proportions", sentence)
    if axis is None or np.any(units[axis] >= np.sqrt(1 - PARALLEL**2)):
        return Shown(True, None, f"drawn as it is, {seen}")
    sizes = np.linalg.svd(units, compute_uv=False)
    if len(sizes) > 1 and sizes[1] >= SPAN * sizes[0]:
        stray = _stray_line(match, axis)
        return Shown(True, None, f"the body is drawn as it is, {seen}") if stray is None else _other_direction(stray, motion)
    return _other_direction(units[:, 0], motion)


def _stray_line(match: Match, axis: int) -> Array | None:
    """Return the direction (3,) of a line from a fixed end that is oblique to the axis, if no artist shows
    the axis itself.

    An artist shows it by a direction along it, or by three or more points in a plane across it.
    """
    artists, stray = np.array([path.artist for path in match.paths]), None
    for artist in np.unique(artists):
        points, bound = match.points[:, artists == artist].T, match.paths[int(np.argmax(artists == artist))].bound
        steps = np.concatenate([(points[:, None] - points).reshape(-1, 3), points if bound else points[:0]])
        steps = steps[np.linalg.norm(steps, axis=1) > SPAN * np.abs(points).max()]
        units = steps / np.linalg.norm(steps, axis=1, keepdims=True)
        slant = np.abs(units[:, axis])
        across = len(points) > 2 and np.ptp(points[:, axis]) <= PARALLEL * np.abs(points).max()
        if across or np.any(slant >= np.sqrt(1 - PARALLEL**2)):
            return None
        if (
            bound
            and len(units)
            and slant.min() > PARALLEL
            and np.linalg.svd(units, compute_uv=False)[1:].max(initial=0.0) <= PARALLEL
        ):
            stray = units[-1]
    return stray


def _ratio(lengths: Array) -> str:
    return " : ".join(f"{x:.3g}" for x in lengths / lengths.max())


def _other_direction(unit: Array, motion: Motion) -> Shown:
    assert motion.axis is not None
    k, wanted = int(np.argmax(np.abs(unit))), NAMES[motion.axis]
    if np.abs(unit[k]) >= np.sqrt(1 - PARALLEL**2):
        name = f"{'−' if unit[k] < 0 else ''}ê{NAMES[k]}"
        return Shown(False, "wrong-axis", f"the drawing follows {name}, not ê{wanted}: the axes of the body are the columns of R")
    if motion.L is not None and cameras.parallel(unit[None], motion.L):
        sentence = f"the drawing shows R·L, not ê{wanted}: L is fixed in space, do not apply R to it"
        return Shown(False, "moving-angular-momentum", sentence)
    inside = ", ".join(f"{round(float(x), 2) + 0.0:.2f}" for x in unit)
    return Shown(False, "wrong-axis", f"the drawing follows the direction ({inside}) of the body, not ê{wanted}")
