"""A drawing by the student's own camera: turned, not mirrored, and the same for the body, L and the labels."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import cameras, timing
from ecp.kinds.animation.matching import matched_at, timed
from ecp.kinds.animation.pictures import Path, Picture, directions
from ecp.kinds.animation.shown import Shown, samples

from .compared_motion import Motion
from .followed_direction import PARALLEL, read

Array = NDArray[np.float64]

REFINED = 3  # rounds in which times and perspective are fitted in turn
NEAREST = 0.5  # inverse of the distance of a camera from the centre, in lengths of the axis
SKEW = 0.1  # sine of the angle between the line of sight and the normal of the drawing
UNAMBIGUOUS = 0.45  # of the motion: some camera makes a shorter arc of any curve look like one of ê₃
SIGNS, SWAPS = ((-1, 1, 1), (1, -1, 1), (1, 1, -1)), ([1, 0, 2], [2, 1, 0], [0, 2, 1])
MIRRORS = [np.diag(signs) for signs in SIGNS] + [np.eye(3)[swap] for swap in SWAPS]


def by_own_camera(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """Return the student's own camera, and what it shows."""
    for laws in (motion.laws, timing.wrong_laws(at, motion.n)):
        if len(laws) and (own := own_camera(picture, motion, laws)):
            if laws is motion.laws and (other := unlabelled(picture, own[0])):
                return None, Shown(False, "mirrored", other)
            if laws is motion.laws and motion.axis is None:
                return own[0], _checked_box(picture, motion, own[0], own[1])
            if laws is motion.laws:
                return _checked(picture, motion, *own)
            if np.ptp(own[1]) > UNAMBIGUOUS * motion.n or np.any(np.diff(own[1]) < 0):
                return None, Shown(False, "wrong-frames", f"the body is drawn, but {timing.describe(own[1], at, motion.n)}")
    return None, None


def unlabelled(picture: Picture, camera: Array) -> str | None:
    """Return which coordinates are drawn if one of the two that the labels name has the opposite sign, else None."""
    if not picture.plane:
        return None
    signs = [camera[row, k] for row, k in enumerate(picture.plane)]
    if min(map(abs, signs)) < np.sqrt(1 - PARALLEL**2) or signs[0] * signs[1] > 0:
        return None
    names = ["xyz"[k] for k in picture.plane]
    shown = [f"{'−' if sign < 0 else ''}{name}" for sign, name in zip(signs, names, strict=True)]
    return f"axes labelled {' and '.join(names)} show {' and '.join(shown)}"


def _checked(picture: Picture, motion: Motion, camera: Array, times: Array, origins: list[Array]) -> tuple[Array | None, Shown]:
    """Judge a camera: it must not mirror, must draw L too, and must not turn about an L that stays."""
    seen = samples(times, motion.n)
    if len(camera) == 3 and np.linalg.det(camera) < 0:
        return None, Shown(False, "mirrored", f"the drawing is a mirror image of the motion{_swapped(camera)}")
    if motion.L is not None:
        L = motion.L / np.linalg.norm(motion.L)
        some, sure = directions(picture, origins)
        for plain in cameras.plain(len(camera)):
            if np.linalg.norm(camera @ L - plain @ L) <= PARALLEL:
                sentence = "the drawing is turned about L, as at another time: frame and sample do not match"
                return None, Shown(False, "wrong-frames", sentence)
            kept = np.linalg.norm(plain @ L) > PARALLEL and cameras.parallel(some, plain @ L)
            if kept and not cameras.parallel(some, camera @ L) and np.linalg.norm(camera @ L) > PARALLEL:
                return None, Shown(False, "mirrored", "the body and L are drawn in different coordinates")
        if len(camera) == 2 and np.linalg.norm(camera @ L) > PARALLEL and not cameras.points_along(some, sure, camera @ L):
            if cameras.parallel(some, -camera @ L):
                return None, Shown(False, "wrong-axis", "ê₃ and L are drawn on opposite sides: one of them has the wrong sign")
            return camera, Shown(None, None, "seen from another side: draw L in the same way, so that the view can be checked")
    return camera, Shown(True, None, f"seen from another side, {seen}")


def _checked_box(picture: Picture, motion: Motion, camera: Array, times: Array) -> Shown:
    """Judge the camera of a box, whose mirror image by a camera −M looks the same as the box turned by M."""
    if len(camera) == 3 and any(np.abs(camera + mirror).max() <= PARALLEL for mirror in MIRRORS):
        sentence = f"a mirror image{_swapped(-camera)}? The box turned by 180° looks the same: draw x, y and z as they are"
        return Shown(None, "mirrored", sentence)
    return read(matched_at(picture, np.einsum("ia,gab->gib", camera, motion.R), times), motion)


def _swapped(camera: Array) -> str:
    whole = np.rint(camera)
    if np.abs(camera - whole).max() > PARALLEL:
        return ""
    moved = [k for k in range(3) if not whole[k, k]]
    return f": {' and '.join('xyz'[k] for k in moved)} are swapped" if len(moved) == 2 else ": the sign of a coordinate is wrong"


def own_camera(picture: Picture, motion: Motion, laws: Array) -> tuple[Array, Array, list[Array]] | None:
    """Return a camera, the times of the frames and the origins, found from a drawn direction or from the points of a body."""
    for path in picture.paths if motion.axis is not None else []:
        fit = timed(motion.R[:, None, :, motion.axis], path.places[:, None, :], laws)
        camera = cameras.straightened(fit.coefficients.T) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, [path.origin] if path.bound else []
    for path in picture.paths if motion.axis is not None and picture.dimensions == 2 else []:
        if path.bound and (seen := _in_perspective(motion, path.places, laws)):
            return *seen, [path.origin]
    nine = np.concatenate([motion.R.reshape(-1, 1, 9), np.ones((len(motion.R), 1, 1))], axis=2)
    for paths in _bodies(picture):
        values = np.stack([path.places for path in paths], axis=1)
        fit = timed(nine, values.reshape(len(values), 1, -1), laws)
        camera = cameras.of_body(fit.coefficients, nine[fit.grid, 0, :9], values) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, []
    return None


def _in_perspective(motion: Motion, drawn: Array, laws: Array) -> tuple[Array, Array] | None:
    """Return a camera (2, 3) and the times of the axis, whose tip p is ``drawn`` (f, 2) as M p / (1 − q·p).

    q points towards the viewer, which excludes mirror images. On the cone p·L is constant, so a multiple of L
    may be added to q and M scaled.
    """
    if motion.L is None:
        return None
    curve = motion.R[:, :, motion.axis]
    law = laws[int(np.argmin(timing.screened(curve[:, None], drawn[:, None, :], laws).sum(axis=1)))]
    times, none = law, np.zeros((len(drawn), 3))
    camera: Array | None = None
    for _ in range(REFINED):
        tip = curve[timing.on_grid(times, len(curve))]
        rows = [np.column_stack([*(tip if k == row else none for k in (0, 1)), drawn[:, [row]] * tip]) for row in (0, 1)]
        q = np.linalg.lstsq(np.concatenate(rows), drawn.T.ravel(), rcond=None)[0][6:]
        fit = timed(curve[:, None], (drawn * (1 - tip @ q)[:, None])[:, None, :], law[None])
        camera = cameras.straightened(fit.coefficients.T) if fit else None
        if fit is None or camera is None:
            return None
        times = fit.times
    assert camera is not None
    L = motion.L / np.linalg.norm(motion.L)
    design = np.column_stack([L, np.cross(camera[0], camera[1])])
    along, near = np.linalg.lstsq(design, q, rcond=None)[0]
    scale = 1 - along * float(np.mean(curve @ L))
    if np.linalg.norm(design @ [along, near] - q) > SKEW * np.linalg.norm(q) or not 0 < near / scale < NEAREST:
        return None
    return camera, times


def _bodies(picture: Picture) -> list[list[Path]]:
    """Return groups of three or more paths that may belong to one body: of one artist, or of all artists with
    one or two paths.
    """
    groups: dict[tuple[str, int], list[Path]] = {}
    free = [path for path in picture.paths if not path.bound]
    owned = Counter(path.artist for path in free)
    for path in free:
        count = owned[path.artist]
        groups.setdefault(("artist", path.artist) if count > 2 else ("each", count), []).append(path)
    return [paths for paths in groups.values() if len(paths) > 2]
