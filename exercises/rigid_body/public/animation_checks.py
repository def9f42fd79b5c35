"""Whether something drawn in an animation follows the body.

There are many right ways to draw it. The times of the frames are free within limits (``timing``) and so is
the camera (``cameras``). At those times the drawing must show the exact motion: a point of the body up to one
constant shift, or a direction from one fixed place. L is drawn by the same camera (``momentum``).
"""

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays
from ecp.kinds.animation import cameras
from ecp.kinds.animation.matching import Match, fewer, matched
from ecp.kinds.animation.pictures import Picture, directions, origins
from ecp.kinds.animation.shown import Shown, judged, samples

from . import boxes
from .compared_motion import Motion
from .followed_direction import PARALLEL, read
from .mistakes import TRANSPOSED, mistimed, otherwise, spin, transposed
from .own_view import by_own_camera, unlabelled
from .resembling import resembling

Array = NDArray[np.float64]

_last: list[tuple[Arrays, list[object], tuple[Motion, Shown]]] = []  # of ``comparison``: arrays, the other arguments, result


def body_shown(seen: Arrays, t: Array, R: Array, axis: int | None, L: Array | None = None, *, half: Array | None = None) -> Shown:
    """Return whether something follows body axis ``axis``, or for None any point of the body; ``R`` (n, 3, 3)
    at times ``t`` (n,).

    If L (3,) is given, a drawing along it must fit the same camera. If the body is a box with half edges
    ``half`` (3,), its corners may be drawn in any order, and a drawn box must have its proportions.
    """

    def compare(drawn: list[Picture]) -> tuple[int, Shown]:
        motion, shown = comparison(seen, drawn, t, R, L, axis=axis, half=half)
        return motion.n, shown

    return judged(seen, "the body", compare)


def comparison(
    seen: Arrays, drawn: list[Picture], t: Array, R: Array, L: Array | None, *, axis: int | None, half: Array | None = None
) -> tuple[Motion, Shown]:
    """Return the motion that ``drawn``, the pictures of ``seen``, are compared with, and what they show.

    The last result is kept, because two checks and their diagnosis need the same one.
    """
    asked: list[object] = [axis, *(None if array is None else np.asarray(array).tobytes() for array in (t, R, L, half))]
    for of, known, result in _last:
        if of is seen and known == asked:
            return result
    at, t, R = fewer(seen["at"], t, R)
    motion = Motion(at, t, R, L, axis, half=half)
    result = motion, compared(drawn, motion, at)
    _last[:] = [(seen, asked, result)]
    return result


def compared(drawn: list[Picture], motion: Motion, at: Array) -> Shown:
    """Return what the pictures show of the body, as space is or else by the student's own camera, at frames
    ``at`` (f, 3).
    """
    some = (sentence for picture in drawn if (sentence := resembling(picture, motion)))
    for look in (_as_it_is, by_own_camera):
        views = [look(picture, motion, at) for picture in drawn]
        found = tuple(camera for camera, _ in views)
        right = [shown for _, shown in views if shown and shown.found]
        if right:
            return (_wrong_elsewhere(drawn, views, motion, at) or right[0])._replace(cameras=found)
        wrong = [shown for _, shown in views if shown]
        if look is _as_it_is:
            wrong = [shown for picture in drawn for shown in spin(picture, motion)] + wrong
            wrong += [shown for picture in drawn for shown in otherwise(picture, motion, at)]
        if wrong:
            closer = next(some, None) if wrong[0].code == "wrong-axis" else None
            return wrong[0]._replace(cameras=found) if closer is None else Shown(False, "wrong-motion", closer, found)
        if box := _box(drawn, motion, known=look is by_own_camera):
            return box
    return Shown(False, "wrong-motion", next(some, "nothing that moves follows the body"))


def _wrong_elsewhere(
    drawn: list[Picture], views: list[tuple[Array | None, Shown | None]], motion: Motion, at: Array
) -> Shown | None:
    """Return the first error in axes other than the right ones: in coordinates, or in the times of the body axis."""
    labelled = any(picture.plane for picture, (_, shown) in zip(drawn, views, strict=True) if shown and shown.found)
    for picture, (_, shown) in zip(drawn, views, strict=True):
        if shown and shown.found:
            continue
        wrong = [x for x in (shown, by_own_camera(picture, motion, at)[1]) if x and x.code == "mirrored"]
        if not wrong and picture.plane and labelled and transposed(picture, motion):
            wrong = [Shown(False, "transposed-rotation", TRANSPOSED)]
        if found := wrong[0] if wrong else mistimed(picture, motion, at):
            return found._replace(sentence=f"one of the axes is wrong: {found.sentence}")
    return None


def _as_it_is(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """Return the camera by which space is drawn as it is, and what is shown."""
    if not len(motion.laws):
        return None, None
    wrong: tuple[Array | None, Shown | None] = (None, None)
    for plain in cameras.plain(picture.dimensions, picture.plane):
        match = matched(picture, np.einsum("ia,gab->gib", plain, motion.R), motion.laws)
        if match is None:
            continue
        camera = plain
        if picture.dimensions == 2 and np.all(match.points[motion.axis] < 0) and _draws_momentum(picture, -plain, motion, match):
            camera, match = -plain, match._replace(points=-match.points)  # the drawing upside down
        shown = read(match, motion)
        if shown.found and motion.half is not None and boxes.edges(match.points) is None and boxes.rests(picture, motion.half):
            shown = Shown(False, "static", "the box itself stays where it is: draw its corners with R[k] as well")
        if shown.found and not _agrees(picture, camera, motion, match):
            sentence = "ê₃ and L are drawn in different coordinates: are x and y swapped in one of them?"
            shown = Shown(False, "mirrored", sentence)
        if shown.found and picture.plane and (other := tuple(np.argmax(plain, axis=1))) != picture.plane:
            names = [" and ".join("xyz"[k] for k in plane) for plane in (picture.plane, other)]
            shown = Shown(False, "mirrored", f"axes labelled {names[0]} show {names[1]}")
        if shown.found:
            return camera, shown
        wrong = wrong if wrong[1] else (camera, shown)
    return wrong


def _draws_momentum(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Return whether something drawn stays along L as ``camera`` sees it."""
    if motion.L is None:
        return False
    L = camera @ motion.L / np.linalg.norm(motion.L)
    some, sure = directions(picture, origins(match.paths))
    return bool(np.linalg.norm(L) > PARALLEL) and cameras.points_along(some, sure, L)


def _agrees(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Return whether a drawing along L fits the camera. It does not only if L is drawn by another camera and
    not by this one.
    """
    signed = [sign * other for other in cameras.plain(picture.dimensions) for sign in (1, -1)]
    own = [camera, -camera]
    return any(_draws_momentum(picture, M, motion, match) for M in own) or not any(
        _draws_momentum(picture, M, motion, match) for M in signed
    )


def _box(drawn: list[Picture], motion: Motion, *, known: bool) -> Shown | None:
    """Return what points without order show of a box; ``known``: those with paths together, as of an unfitted
    perspective.
    """
    if motion.half is None or not len(motion.laws):
        return None
    for picture in drawn:
        sets = boxes.together(picture) if known else picture.sets
        if found := boxes.box_seen(sets, motion.R, motion.half, motion.laws):
            if other := unlabelled(picture, found[0]):
                return Shown(False, "mirrored", other)
            return Shown(True, None, f"the box is drawn, {samples(found[1], motion.n)}")
        if boxes.box_seen(sets, np.swapaxes(motion.R, 1, 2), motion.half, motion.laws):
            return Shown(False, "transposed-rotation", TRANSPOSED)
    return None
