"""Mistakes in a drawing: the transposed R, ω in place of the axis, the motion at other times or backwards."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import cameras, timing
from ecp.kinds.animation.matching import along, at_any_time, matched
from ecp.kinds.animation.pictures import Picture
from ecp.kinds.animation.shown import Shown

from .compared_motion import Motion
from .followed_direction import NAMES, read

Array = NDArray[np.float64]

TRANSPOSED = "the drawing follows the transposed R: R takes body components to space, so ê₃ is R[:, :, 2], its third column"


def spin(picture: Picture, motion: Motion) -> Iterator[Shown]:
    """Yield ω drawn in place of the axis: its tip is a point of the body as well, up to a constant shift."""
    if motion.axis is None or not len(motion.laws):
        return
    for camera in cameras.plain(picture.dimensions):
        if along(picture, motion.w @ camera.T, motion.laws):
            yield Shown(False, "wrong-motion", f"the drawing follows ω, not ê{NAMES[motion.axis]}")


def otherwise(picture: Picture, motion: Motion, at: Array) -> Iterator[Shown]:
    """Yield what the paths show if it is not the body at its times, drawn as it is."""
    axis, late = motion.axis, timing.wrong_laws(at, motion.n)
    if transposed(picture, motion):
        yield Shown(False, "transposed-rotation", TRANSPOSED)
    for camera in cameras.plain(picture.dimensions):
        curves = np.einsum("ia,gab->gib", camera, motion.R)
        if axis is None and len(motion.laws) and matched(picture, curves @ motion.R, motion.laws):
            yield Shown(False, "wrong-motion", "R is applied twice to the drawn points")
        if len(motion.laws) and matched(picture, curves, (motion.n - 1) - motion.laws):
            yield Shown(False, "wrong-motion", "the motion is drawn backwards in time")
        fit = _axis_at(picture, motion, camera, late)
        match = None if fit else matched(picture, curves, late)
        if found := fit or (match if match and read(match, motion).found else None):
            yield _wrong_frames(motion, timing.describe(found.times, at, motion.n))
        elif axis is not None and (shows := at_any_time(picture, curves[:, :, axis], at)):
            yield _wrong_frames(motion, f"its samples are mistimed: {shows}")


def transposed(picture: Picture, motion: Motion) -> bool:
    """Return whether something drawn follows the transposed R."""
    curves = (np.einsum("ia,gba->gib", camera, motion.R) for camera in cameras.plain(picture.dimensions))
    return len(motion.laws) > 0 and any(matched(picture, curve, motion.laws) for curve in curves)


def mistimed(picture: Picture, motion: Motion, at: Array) -> Shown | None:
    """Return how the axis of the body is drawn at other times than the frames', or None if it is not."""
    if motion.axis is None:
        return None
    late = timing.wrong_laws(at, motion.n)
    for camera in cameras.plain(picture.dimensions):
        if fit := _axis_at(picture, motion, camera, late):
            return _wrong_frames(motion, timing.describe(fit.times, at, motion.n))
    return None


def _axis_at(picture: Picture, motion: Motion, camera: Array, laws: Array) -> timing.Fit | None:
    """Return the times, among those of ``laws``, at which a path shows the body axis; None if there is no axis or no such path."""
    return None if motion.axis is None else along(picture, motion.R[:, :, motion.axis] @ camera.T, laws)


def _wrong_frames(motion: Motion, how: str) -> Shown:
    name = "the body" if motion.axis is None else f"ê{NAMES[motion.axis]}"
    return Shown(False, "wrong-frames", f"{name} is drawn, but {how}")
