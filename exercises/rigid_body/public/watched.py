"""What an animation shows: whether something drawn follows the body, and whether L stays where it is.

There are many right ways to draw it. The times of the frames are free within limits (``timing``) and so is the camera
(``cameras``); at those times what is drawn must be the exact motion: a point of the body up to one constant shift, or a direction
from one fixed place. L is drawn by the same camera.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays

from . import boxes, cameras, timing
from .matching import Match, Motion, along, at_any_time, fewer, matched, matched_at, own_camera
from .pictures import Picture, changed, directions, pictures, sound
from .resembling import resembling

Array = NDArray[np.float64]

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
PARALLEL = 0.03  # sine of the angle from the body axis
SPAN = 0.1  # of the length of two directions that show the body's attitude together
RARELY = 0.03  # share of the frames or samples: what changes at fewer shows no motion
UNAMBIGUOUS = 0.45  # of the motion: a shorter arc of any curve looks like one of ê₃'s by some camera
NAMES = "₁₂₃"
SIGNS, SWAPS = ((-1, 1, 1), (1, -1, 1), (1, 1, -1)), ([1, 0, 2], [2, 1, 0], [0, 2, 1])
MIRRORS = [np.diag(signs) for signs in SIGNS] + [np.eye(3)[swap] for swap in SWAPS]
TRANSPOSED = "what is drawn follows the transposed R: R takes body components to space, so ê₃ is R[:, :, 2], its third column"


class Shown(NamedTuple):
    """``found``: True where the body is followed, False where it is not, None where what is drawn cannot be judged.

    ``code`` and ``sentence`` say what is followed instead; ``cameras``: for each picture the one found, if any."""

    found: bool | None
    code: str | None
    sentence: str
    cameras: tuple[Array | None, ...] = ()


def body_shown(seen: Arrays, t: Array, R: Array, axis: int | None, L: Array | None = None, *, half: Array | None = None) -> Shown:
    """Return whether something follows body axis ``axis``, or for None any point of the body; ``R`` (n, 3, 3) at times ``t`` (n,).

    With L (3,) given, what is drawn along it must fit the same camera. Where the body is a box with half edges ``half`` (3,), its
    corners may be drawn in any order, and what is drawn as a box has the proportions of this one.
    """
    if not sound(seen):
        return Shown(False, None, "what came back does not fit together")
    drawn, painted = pictures(seen), seen["cost"][4] > 0
    if not any(picture.paths for picture in drawn):
        code = "static" if any(picture.still for picture in drawn) and not painted else None
        found = None if painted else False
        return Shown(found, code, "nothing drawn moves but text: does update change lines, arrows, polygons or markers?")
    if len(seen["at"]) < timing.LEAST_FRAMES:
        return Shown(False, "wrong-frames", f"too short to show the motion: {len(seen['at'])} frames")
    at, t, R = fewer(seen["at"], t, R)
    shown = _compared(drawn, Motion(at, t, R, L, axis, half=half), at)
    if shown.found is False and not painted and (changes := changed(drawn)) <= RARELY * min(len(at), len(t)):
        sentence = f"what is drawn changes at {changes} of {len(at)} frames only: is each frame drawn from its own sample?"
        return Shown(False, "static", sentence)
    if painted and not shown.found:
        return Shown(None, None, "what moves beside the painted picture says nothing about the body")
    return shown


def _compared(drawn: list[Picture], motion: Motion, at: Array) -> Shown:
    for look in (_as_it_is, _by_own_camera):
        views = [look(picture, motion, at) for picture in drawn]
        found = tuple(camera for camera, _ in views)
        right = [shown for _, shown in views if shown and shown.found]
        if right:
            return right[0]._replace(cameras=found)
        wrong = [shown for _, shown in views if shown]
        if look is _as_it_is:
            wrong = [shown for picture in drawn for shown in _spin(picture, motion)] + wrong
            wrong += [shown for picture in drawn for shown in _otherwise(picture, motion, at)]
        if wrong:
            return wrong[0]._replace(cameras=found)
        if look is _as_it_is and (box := _box(drawn, motion)):
            return box
    some = (said for picture in drawn if (said := resembling(picture, motion)))
    return Shown(False, "wrong-motion", next(some, "what moves does not move with the body"))


def _as_it_is(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """The camera without which space is drawn as it is, and what is shown."""
    if not len(motion.laws):
        return None, None
    wrong: tuple[Array | None, Shown | None] = (None, None)
    for plain in cameras.plain(picture.dimensions):
        match = matched(picture, np.einsum("ia,gab->gib", plain, motion.R), motion.laws)
        if match is None:
            continue
        camera = plain
        if picture.dimensions == 2 and np.all(match.points[motion.axis] < 0) and _draws_momentum(picture, -plain, motion, match):
            camera, match = -plain, match._replace(points=-match.points)  # the paper upside down
        shown = _read(match, motion)
        if shown.found and not _agrees(picture, camera, motion, match):
            sentence = "ê₃ and L are drawn in different coordinates: are x and y swapped in one of them?"
            shown = Shown(False, "mirrored", sentence)
        if shown.found:
            return camera, shown
        wrong = wrong if wrong[1] else (camera, shown)
    return wrong


def _read(match: Match, motion: Motion) -> Shown:
    """What the points say: the axis or the body, or another direction."""
    axis, seen = motion.axis, _range(match.times, motion.n)
    units = match.points / np.maximum(np.linalg.norm(match.points, axis=0), 1e-300)
    edges = None if axis is not None or motion.half is None else boxes.edges(match.points)
    if axis is None and motion.half is not None and (astray := boxes.displaced(match, motion.half, motion.R)):
        return Shown(False, "wrong-motion", astray)
    if edges is not None and motion.half is not None and boxes.disproportionate(edges, motion.half):
        sentence = f"the box is drawn with edges as {_ratio(edges)}, but half says {_ratio(motion.half)}"
        return Shown(False, "wrong-proportions", sentence)
    if axis is None or np.any(units[axis] >= np.sqrt(1 - PARALLEL**2)):
        return Shown(True, None, f"drawn as it is, {seen}")
    sizes = np.linalg.svd(units, compute_uv=False)
    if len(sizes) > 1 and sizes[1] >= SPAN * sizes[0]:
        stray = _stray_line(match, axis)
        return Shown(True, None, f"the body is drawn as it is, {seen}") if stray is None else _other_direction(stray, motion)
    return _other_direction(units[:, 0], motion)


def _stray_line(match: Match, axis: int) -> Array | None:
    """The direction (3,) of a line from a fixed end that is oblique to the axis, where no artist shows the axis itself: by a
    direction along it, or by three points and more in a plane across it."""
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


def _box(drawn: list[Picture], motion: Motion) -> Shown | None:
    """What points drawn in no order show of a box."""
    if motion.half is None or not len(motion.laws):
        return None
    for picture in drawn:
        if found := boxes.box_seen(picture, motion.R, motion.half, motion.laws):
            return Shown(True, None, f"the box is drawn, {_range(found[1], motion.n)}")
        if boxes.box_seen(picture, np.swapaxes(motion.R, 1, 2), motion.half, motion.laws):
            return Shown(False, "transposed-rotation", TRANSPOSED)
    return None


def _other_direction(unit: Array, motion: Motion) -> Shown:
    assert motion.axis is not None
    k, asked = int(np.argmax(np.abs(unit))), NAMES[motion.axis]
    if np.abs(unit[k]) >= np.sqrt(1 - PARALLEL**2):
        name = f"{'−' if unit[k] < 0 else ''}ê{NAMES[k]}"
        return Shown(False, "wrong-axis", f"what is drawn follows {name}, not ê{asked}: the axes of the body are the columns of R")
    if motion.L is not None and cameras.parallel(unit[None], motion.L):
        sentence = f"what is drawn is R·L, not ê{asked}: L is fixed in space, R belongs to the body"
        return Shown(False, "moving-angular-momentum", sentence)
    inside = ", ".join(f"{round(float(x), 2) + 0.0:.2f}" for x in unit)
    return Shown(False, "wrong-axis", f"what is drawn follows the direction ({inside}) of the body, not ê{asked}")


def _draws_momentum(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Whether something drawn stays along L as ``camera`` sees it."""
    if motion.L is None:
        return False
    L = camera @ motion.L / np.linalg.norm(motion.L)
    some, sure = directions(picture, [path.origin for path in match.paths if path.bound])
    return bool(np.linalg.norm(L) > PARALLEL) and _points_along(some, sure, L)


def _agrees(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Whether what is drawn along L fits the camera: only where L is drawn by another and not by this one it does not."""
    signed = [sign * other for other in cameras.plain(picture.dimensions) for sign in (1, -1)]
    own = [camera, -camera]
    return any(_draws_momentum(picture, M, motion, match) for M in own) or not any(
        _draws_momentum(picture, M, motion, match) for M in signed
    )


def _spin(picture: Picture, motion: Motion) -> Iterator[Shown]:
    """ω in place of the axis: its tip is a point of the body as well, up to a constant shift."""
    if motion.axis is None or not len(motion.laws):
        return
    for camera in cameras.plain(picture.dimensions):
        if along(picture, motion.w @ camera.T, motion.laws):
            yield Shown(False, "wrong-motion", f"what is drawn follows ω, not ê{NAMES[motion.axis]}")


def _otherwise(picture: Picture, motion: Motion, at: Array) -> Iterator[Shown]:
    """What the paths show where it is not the body at its times, drawn as it is."""
    axis = motion.axis
    name = "the body" if axis is None else f"ê{NAMES[axis]}"
    for camera in cameras.plain(picture.dimensions):
        curves = np.einsum("ia,gab->gib", camera, motion.R)
        if len(motion.laws) and matched(picture, np.einsum("ia,gba->gib", camera, motion.R), motion.laws):
            yield Shown(False, "transposed-rotation", TRANSPOSED)
        if len(motion.laws) and matched(picture, curves, (motion.n - 1) - motion.laws):
            yield Shown(False, "wrong-motion", "the motion is drawn backwards in time")
        late = timing.wrong_laws(at, motion.n)
        tip = None if axis is None else curves[:, :, axis]
        fit = None if tip is None else along(picture, tip, late)
        match = None if fit else matched(picture, curves, late)
        if found := fit or (match if match and _read(match, motion).found else None):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but {timing.said(found.times, at, motion.n)}")
        elif tip is not None and (shows := at_any_time(picture, tip, at)):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but its samples are mistimed: {shows}")


def _by_own_camera(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """The student's own camera, and what it shows."""
    for laws in (motion.laws, timing.wrong_laws(at, motion.n)):
        if len(laws) and (own := own_camera(picture, motion, laws)):
            if laws is motion.laws and motion.axis is None:
                return own[0], _checked_box(picture, motion, own[0], own[1])
            if laws is motion.laws:
                return _checked(picture, motion, *own)
            if np.ptp(own[1]) > UNAMBIGUOUS * motion.n or np.any(np.diff(own[1]) < 0):
                return None, Shown(False, "wrong-frames", f"the body is drawn, but {timing.said(own[1], at, motion.n)}")
    return None, None


def _checked(picture: Picture, motion: Motion, camera: Array, times: Array, origins: list[Array]) -> tuple[Array | None, Shown]:
    """A camera is right if it does not mirror, if it draws L too, and if it does not turn about an L that stays."""
    seen = _range(times, motion.n)
    if len(camera) == 3 and np.linalg.det(camera) < 0:
        return None, Shown(False, "mirrored", f"what is drawn is a mirror image of the motion{_swapped(camera)}")
    if motion.L is not None:
        L = motion.L / np.linalg.norm(motion.L)
        some, sure = directions(picture, origins)
        for plain in cameras.plain(len(camera)):
            if np.linalg.norm(camera @ L - plain @ L) <= PARALLEL:
                sentence = "what is drawn is turned about L, as at another time: frame and sample do not belong together"
                return None, Shown(False, "wrong-frames", sentence)
            kept = np.linalg.norm(plain @ L) > PARALLEL and cameras.parallel(some, plain @ L)
            if kept and not cameras.parallel(some, camera @ L) and np.linalg.norm(camera @ L) > PARALLEL:
                return None, Shown(False, "mirrored", "the body is drawn in other coordinates than L")
        if len(camera) == 2 and np.linalg.norm(camera @ L) > PARALLEL and not _points_along(some, sure, camera @ L):
            if cameras.parallel(some, -camera @ L):
                return None, Shown(False, "wrong-axis", "ê₃ and L are drawn on opposite sides: one of them has the wrong sign")
            return camera, Shown(None, None, "seen from another side: draw L in the same way, so that the view can be checked")
    return camera, Shown(True, None, f"seen from another side, {seen}")


def _checked_box(picture: Picture, motion: Motion, camera: Array, times: Array) -> Shown:
    """A box is centrally symmetric: its mirror image by a camera −M looks the same as the box turned by M."""
    if len(camera) == 3 and any(np.abs(camera + mirror).max() <= PARALLEL for mirror in MIRRORS):
        sentence = f"a mirror image{_swapped(-camera)}? The box turned by 180° looks the same: draw x, y and z as they are"
        return Shown(None, "mirrored", sentence)
    return _read(matched_at(picture, np.einsum("ia,gab->gib", camera, motion.R), times), motion)


def _swapped(camera: Array) -> str:
    whole = np.rint(camera)
    if np.abs(camera - whole).max() > PARALLEL:
        return ""
    moved = [k for k in range(3) if not whole[k, k]]
    return f": {' and '.join('xyz'[k] for k in moved)} are swapped" if len(moved) == 2 else ": the sign of a coordinate is wrong"


def _range(times: Array, n: int) -> str:
    step = max(timing.SLACK, float(np.diff(np.sort(times)).max()) + 0.5)
    low, high = times.min(), times.max()
    return f"all {n} samples" if low <= step and high >= n - 1 - step else f"samples {low:.0f}–{high:.0f} of {n}"


def momentum_shown(seen: Arrays, t: Array, R: Array, L: Array, axis: int | None = 2) -> Shown:
    """Return whether a direction drawn along L stays there, by the camera that draws the body or else as it is."""
    if not sound(seen):
        return Shown(None, None, "what came back does not fit together")
    drawn, unit = pictures(seen), L / np.linalg.norm(L)
    enough = len(seen["at"]) >= timing.LEAST_FRAMES and any(picture.paths for picture in drawn)
    at, t, R = fewer(seen["at"], t, R)
    motion = Motion(at, t, R, L, axis)
    found = _compared(drawn, motion, at).cameras if enough else ()
    reversed_ = False
    for picture, camera in zip(drawn, found or (None,) * len(drawn), strict=True):
        some, sure = directions(picture, [path.origin for path in picture.paths if path.bound])
        for view in [camera] if camera is not None else cameras.plain(picture.dimensions):
            if np.linalg.norm(view @ unit) <= PARALLEL:
                if _end_on(picture):
                    return Shown(True, None, "L points at the viewer, and a point stays where it is drawn")
                continue
            if _points_along(some, sure, view @ unit):
                return Shown(True, None, "a direction along L stays the same")
            reversed_ = reversed_ or cameras.parallel(sure, -(view @ unit))
    if reversed_:
        return Shown(False, "reversed-angular-momentum", "what is drawn points along −L")
    if enough and (instead := next(_instead_of_momentum(drawn, motion, unit), None)):
        return instead
    return Shown(None, None, "no direction along L was found in the lines and arrows of the axes: draw L as a line or an arrow")


def _points_along(some: Array, sure: Array, wanted: Array) -> bool:
    """Whether a direction points along ``wanted`` (d,): a known tail decides, since matplotlib lists an arrow from its tip."""
    return cameras.parallel(sure, wanted) or (cameras.parallel(some, wanted) and not cameras.parallel(sure, -wanted))


def _instead_of_momentum(drawn: list[Picture], motion: Motion, unit: Array) -> Iterator[Shown]:
    """What moves as L does in the body, or by R, and what is fixed along another direction."""
    by_R = motion.R @ unit
    views = [(picture, view) for picture in drawn for view in cameras.plain(picture.dimensions)]
    for picture, view in views if len(motion.laws) else []:
        for turned in (by_R, np.einsum("gji,j->gi", motion.R, unit)):
            if along(picture, turned @ view.T, motion.laws):
                said = "L moves with the body: it is fixed in space, and R belongs to the body"
                if turned is not by_R and motion.axis is not None and _stays(picture, view[:, motion.axis]):
                    said = "drawn in the body's own axes, where L moves and they stay: R is not applied to what is drawn"
                yield Shown(False, "moving-angular-momentum", said)
    for picture, view in views:
        _, sure = directions(picture, [path.origin for path in picture.paths if path.bound])
        sure = sure[np.any(sure != 0, axis=1)]
        if said := _fixed_elsewhere(sure, view, motion, unit):
            yield Shown(None, "wrong-angular-momentum", f"{said}: draw L as it is given")


def _stays(picture: Picture, direction: Array) -> bool:
    some, _ = directions(picture, [path.origin for path in picture.paths if path.bound])
    return bool(np.linalg.norm(direction) > PARALLEL) and cameras.parallel(some, direction)


def _end_on(picture: Picture) -> bool:
    """Whether a point stays at the centre of a circle on which another one runs."""
    still = np.concatenate([np.zeros((0, picture.dimensions)), *picture.still])
    for path in picture.paths:
        places = path.places + path.origin
        design = np.concatenate([2 * places, np.ones((len(places), 1))], axis=1)
        centre = np.linalg.lstsq(design, np.sum(places**2, axis=1), rcond=None)[0][:-1]
        radii = np.linalg.norm(places - centre, axis=1)
        near = np.linalg.norm(still - centre, axis=1) <= PARALLEL * radii.mean()
        if np.ptp(radii) <= 2 * PARALLEL * radii.mean() and near.any():
            return True
    return False


def _fixed_elsewhere(sure: Array, view: Array, motion: Motion, unit: Array) -> str:
    """Where a single fixed line points that is not L: of several, as axes of coordinates, any may be meant as L or none."""
    single = len(sure) > 0 and all(cameras.parallel(np.array([one, -one]), sure[0]) for one in sure)
    along = [name for name, direction in zip("xyz", view.T, strict=True) if cameras.parallel(sure, direction)]
    if single and len(along) == 1:
        return f"a fixed line points along {along[0]}, but L points along ({', '.join(f'{x:.2f}' for x in unit)})"
    body = view @ (motion.R[0].T @ unit)
    if not along and np.linalg.norm(body) > PARALLEL and cameras.parallel(sure, body):
        return "a fixed line points along the body components of L, which are not those in space"
    return ""
