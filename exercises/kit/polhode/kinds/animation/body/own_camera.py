"""A drawing by the student's own camera: turned, not mirrored, and the same for the body,
L and the labels.
"""

from collections import Counter, defaultdict

import numpy as np

from polhode.kinds.animation import cameras, frame_times
from polhode.kinds.animation.body.body_motion import Motion
from polhode.kinds.animation.body.direction import read
from polhode.kinds.animation.cameras import PARALLEL
from polhode.kinds.animation.curve_matching import matched, together
from polhode.kinds.animation.drawn_paths import Path, Picture
from polhode.kinds.animation.frame_times import Array
from polhode.kinds.animation.visibility import Shown

View = tuple[Array | None, Shown | None]  # a camera and what it shows
Own = tuple[Array, Array]  # a camera and the times of the frames

ROUNDS = 3  # in which times and perspective are fitted in turn
NEAREST = 0.5  # inverse of the distance of a camera from the centre, in lengths of the axis
TURNED = "the drawing is turned about L, as at another time: frame and sample do not match"
UNAMBIGUOUS = 0.45  # of the motion: some camera makes a shorter arc of any curve look like one of the axis


def by_own_camera(picture: Picture, motion: Motion) -> View:
    """Return the student's own camera, and what it shows."""
    frames = motion.frames
    if own := _own_camera(picture, motion, frames.laws):
        wrong = cameras.mislabelled(picture.plane, own[0])
        if wrong:
            return None, Shown(False, "mirrored", wrong)
        return (_checked_box if motion.axis is None else _checked)(picture, motion, *own)
    own = _own_camera(picture, motion, frames.late)
    if own and (np.ptp(own[1]) > UNAMBIGUOUS * frames.n or np.any(np.diff(own[1]) < 0)):
        return None, Shown(False, "wrong-frames", f"the body is drawn, but {frames.wrong(own[1])}")
    return None, None


def _checked(picture: Picture, motion: Motion, camera: Array, times: Array) -> View:
    """Judge a camera: it must not mirror, must draw L too, and must not turn about an L that stays."""
    shown = Shown(True, None, f"seen from another side, {motion.frames.covered(times)}")
    if len(camera) == 3 and np.linalg.det(camera) < 0:
        shown = Shown(False, "mirrored", f"the drawing is a mirror image of the motion{_swapped(camera)}")
    elif motion.unit is not None:
        shown = _beside_momentum(picture, camera, motion.unit, motion.name) or shown
    return None if shown.found is False else camera, shown


def _beside_momentum(picture: Picture, camera: Array, unit: Array, name: str) -> Shown | None:
    """Return why the camera does not fit the fixed directions of the picture, of which one should be L; None
    if it does.
    """
    L, some = camera @ unit, picture.directions()[0]
    seen = bool(np.linalg.norm(L) > PARALLEL)
    for as_it_is in (plain @ unit for plain in cameras.plain(len(camera))):
        if np.linalg.norm(L - as_it_is) <= PARALLEL:
            return Shown(False, "wrong-frames", TURNED)
        kept = np.linalg.norm(as_it_is) > PARALLEL and cameras.parallel(some, as_it_is)
        if seen and kept and not cameras.parallel(some, L):
            return Shown(False, "mirrored", "the body and L are drawn in different coordinates")
    if len(camera) == 3 or not seen or picture.keeps(L):
        return None
    if cameras.parallel(some, -L):
        return Shown(
            False, "wrong-axis", f"{name} and L are drawn on opposite sides: one of them has the wrong sign"
        )
    return Shown(
        None, None, "seen from another side: draw L in the same way, so that the view can be checked"
    )


def _checked_box(picture: Picture, motion: Motion, camera: Array, times: Array) -> View:
    """Judge the camera of a box, whose mirror image by a camera −M looks the same as the box turned by M."""
    if len(camera) == 3 and (how := _swapped(-camera)) and np.trace(camera) < 0 < -np.sum(np.rint(camera)):
        sentence = f"a mirror image{how}? The box turned by 180° looks the same: draw x, y and z as they are"
        return camera, Shown(None, "mirrored", sentence)
    match = matched(picture, camera @ motion.R, times[None])
    return camera, (
        read(match, motion) if match else Shown(True, None, f"drawn as it is, {motion.frames.covered(times)}")
    )


def _swapped(camera: Array) -> str:
    """Return how a camera (3, 3) mirrors: by the exchange of two coordinates or a sign, or "" if it is none
    of these.
    """
    whole = np.rint(camera)
    if np.abs(camera - whole).max() > PARALLEL:
        return ""
    moved = [k for k in range(3) if not whole[k, k]]
    return (
        f": {' and '.join('xyz'[k] for k in moved)} are swapped"
        if len(moved) == 2
        else ": the sign of a coordinate is wrong"
    )


def _own_camera(picture: Picture, motion: Motion, laws: Array) -> Own | None:
    """Return a camera found from a drawn axis or from the points of a body."""
    for look in (_of_axis, _in_perspective) if motion.axis is not None and len(laws) else ():
        if own := next(filter(None, (look(path, motion, laws) for path in picture.paths)), None):
            return own
    nine = np.concatenate([motion.R.reshape(-1, 1, 9), np.ones((len(motion.R), 1, 1))], axis=2)
    for paths in _bodies(picture):
        values = np.stack([path.places for path in paths], axis=1)
        fit = together(nine, values.reshape(len(values), 1, -1), laws)
        if fit and (camera := _of_body(fit.coefficients, motion.R[fit.grid], values)) is not None:
            return camera, fit.times
    return None


def _of_axis(path: Path, motion: Motion, laws: Array) -> Own | None:
    """Return a camera (d, 3) if the path is the tip of the axis."""
    fit = together(motion.tip[:, None], path.places[:, None], laws)
    camera = cameras.straightened(fit.coefficients.T) if fit else None
    return None if fit is None or camera is None else (camera, fit.times)


def _in_perspective(path: Path, motion: Motion, laws: Array) -> Own | None:
    """Return a camera (2, 3) if the path is the tip p of the axis, drawn as M p / (1 − q·p).

    q points towards the viewer, which excludes mirror images. On the cone p·L is constant, so a multiple of L
    may be added to q and M scaled.
    """
    drawn, tips, unit = path.places, motion.tip[:, None], motion.unit
    if unit is None or not path.bound or drawn.shape[1] == 3:
        return None
    law = times = laws[int(np.argmin(frame_times.screened(tips, drawn[:, None], laws).sum(axis=1)))]
    for _ in range(ROUNDS):
        tip = motion.tip[frame_times.on_grid(times, len(tips))]
        _, q = cameras.in_perspective(tip, drawn)
        if not (own := _of_axis(path._replace(places=drawn * (1 - tip @ q)[:, None]), motion, law[None])):
            return None
        camera, times = own
    design = np.column_stack([unit, np.cross(*camera)])
    along, near = np.linalg.lstsq(design, q, rcond=None)[0]
    scale = 1 - along * float(np.mean(motion.tip @ unit))
    upright = np.linalg.norm(design @ [along, near] - q) <= cameras.SKEW * np.linalg.norm(q)
    return own if upright and 0 < near / scale < NEAREST else None


def _of_body(coefficients: Array, R: Array, drawn: Array) -> Array | None:
    """Return the camera M (d, 3) by which v points of the body are drawn as c + M R p, or None.

    M and −M differ by a body turned inside out; the one that does not mirror is returned. ``coefficients``
    (10, v·d) belong to the nine elements of R and a constant, ``R`` (f, 3, 3) are the attitudes in the
    frames, ``drawn`` is (f, v, d). M and p are found in turn, from the dyad nearest to the coefficients.
    """
    _, v, d = drawn.shape
    tensor = coefficients[:9].reshape(3, 3, v, d)  # [a, b, v, i] = M[i, a] p[v, b]
    left, sizes, _ = np.linalg.svd(tensor.transpose(3, 0, 2, 1).reshape(3 * d, 3 * v), full_matrices=False)
    M = (left[:, 0] * sizes[0]).reshape(d, 3)
    R, moved = R - R.mean(axis=0), drawn - drawn.mean(axis=0)
    for _ in range(20):
        p = np.linalg.lstsq((M @ R).reshape(-1, 3), moved.transpose(0, 2, 1).reshape(-1, v), rcond=None)[0]
        turned = (R @ p).transpose(0, 2, 1).reshape(-1, 3)
        M = np.linalg.lstsq(turned, moved.reshape(-1, d), rcond=None)[0].T
    left_over = moved.reshape(-1, d) - turned @ M.T
    if np.mean(left_over**2) > cameras.CROOKED**2 * np.mean(moved**2):
        return None
    return cameras.straightened(-M if d == 3 and np.linalg.det(M) < 0 else M)


def _bodies(picture: Picture) -> list[list[Path]]:
    """Return groups of three or more paths that may belong to one body: of one artist, or of all artists with
    one or two paths.
    """
    free, groups = [path for path in picture.paths if not path.bound], defaultdict[int, list[Path]](list)
    owned = Counter(path.artist for path in free)
    for path in free:
        groups[path.artist if owned[path.artist] > 2 else -owned[path.artist]].append(path)
    return [paths for paths in groups.values() if len(paths) > 2]
