"""Whether something drawn in an animation follows a body.

There are many right ways to draw it. The times of the frames are free within limits (``frame_times``) and so
is the camera (``cameras``). At those times the drawing must show the exact motion: a point of the body up to
one constant shift, or a direction from one fixed place. L is drawn by the same camera (``momentum``).
"""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from polhode.judging.checks import Arrays
from polhode.kinds.animation import cameras
from polhode.kinds.animation.body import drawn_boxes
from polhode.kinds.animation.body.body_motion import NAMES, Body, Motion
from polhode.kinds.animation.body.direction import read, resembling
from polhode.kinds.animation.body.own_camera import View, by_own_camera
from polhode.kinds.animation.curve_matching import Mistake, instead, matched
from polhode.kinds.animation.drawn_paths import Picture, resting
from polhode.kinds.animation.frame_times import Array
from polhode.kinds.animation.visibility import Shown, judged, remembered

BODY = "the body"
CORNERS = 7  # that move, at least: one may stay if the box is seen along an edge
TRANSPOSED = (
    "the drawing follows the transposed R: R takes body components to space, so {} is R[:, :, {}], its {}"
    " column"
)


def body_shown(seen: Arrays, body: Body) -> Shown:
    """Return whether something follows the axis of ``body``, or for no axis any point of it.

    If L is given, a drawing along it must fit the same camera. The corners of a box may be drawn in any
    order, and a drawn box must have its proportions.
    """
    return judged(seen, len(body.t), [BODY], lambda drawn: {BODY: compared(seen, drawn, body)})[BODY]


def compared(seen: Arrays, drawn: list[Picture], body: Body) -> Shown:
    """Return what ``drawn``, the pictures of ``seen``, show of the body: as space is, or else by the
    student's own camera.
    """
    return remembered(seen, body, lambda: _compared(drawn, Motion(body, seen["at"], resting(seen))))


def _compared(drawn: list[Picture], motion: Motion) -> Shown:
    alike = (sentence for picture in drawn if (sentence := resembling(picture, motion)))
    for look in (_as_it_is, by_own_camera):
        views = [look(picture, motion) for picture in drawn]
        found = tuple(camera for camera, _ in views)
        if right := next((shown for _, shown in views if shown and shown.found), None):
            return (_wrong_elsewhere(drawn, views, motion) or right)._replace(cameras=found)
        wrong: Iterator[Shown] = (shown for _, shown in views if shown)
        if look is _as_it_is:
            omega, *others = _mistakes(motion).values()
            wrong = chain(
                instead(drawn, [omega], motion.frames), wrong, instead(drawn, others, motion.frames)
            )
        if first := next(wrong, None):
            closer = next(alike, None) if first.code == "wrong-axis" else None
            return (
                first._replace(cameras=found)
                if closer is None
                else Shown(False, "wrong-motion", closer, found)
            )
        if box := next(_box(drawn, motion, unsorted=look is _as_it_is), None):
            return box
    return Shown(False, "wrong-motion", next(alike, "nothing that moves follows the body"))


def _wrong_elsewhere(drawn: list[Picture], views: list[View], motion: Motion) -> Shown | None:
    """Return the first error in axes other than the right ones: in coordinates, or in the times of the body
    axis.
    """
    pairs = list(zip(drawn, (shown for _, shown in views), strict=True))
    labelled = any(picture.plane for picture, shown in pairs if shown and shown.found)
    for picture, shown in ((picture, shown) for picture, shown in pairs if not (shown and shown.found)):
        mirrored = (x for x in (shown, by_own_camera(picture, motion)[1]) if x and x.code == "mirrored")
        names = ("transposed", "late axis") if labelled and picture.plane else ("late axis",)
        others = [mistake for name, mistake in _mistakes(motion).items() if name in names]
        if found := next(chain(mirrored, instead([picture], others, motion.frames)), None):
            return found._replace(sentence=f"one of the axes is wrong: {found.sentence}")
    return None


def _mistakes(motion: Motion) -> dict[str, Mistake]:
    """Return what else may be drawn, by name: ω, whose tip is a point of the body too, another R, or other
    times.
    """
    R, frames, k = motion.R, motion.frames, 2 if motion.axis is None else motion.axis
    column = TRANSPOSED.format(NAMES[k], k, ("first", "second", "third")[k])
    back, late = "the motion is drawn backwards in time", f"{motion.name} is drawn, but {{}}"
    found = {
        "transposed": Mistake("transposed-rotation", column, np.swapaxes(R, 1, 2), frames.laws),
        "twice": Mistake("wrong-motion", "R is applied twice to the drawn points", R @ R, frames.laws),
        "backwards": Mistake("wrong-motion", back, R[::-1], frames.laws),
        "late": Mistake(
            "wrong-frames", late, R, frames.late, meant=lambda match: bool(read(match, motion).found)
        ),
    }
    if motion.axis is None:
        return found
    axis = Mistake("wrong-frames", late, motion.tip[:, :, None], frames.late, shift=False)
    omega = Mistake(
        "wrong-motion",
        f"the drawing follows ω, not {motion.name}",
        motion.w[:, :, None],
        frames.laws,
        shift=False,
    )
    del found["twice"]
    return {"ω": omega} | found | {"late axis": axis, "mistimed axis": axis._replace(laws=None)}


def _as_it_is(picture: Picture, motion: Motion) -> View:
    """Return the camera by which space is drawn as it is, and what is shown."""
    first: View = (None, None)
    for plain in cameras.plain(picture.dimensions, picture.plane):
        match, camera = matched(picture, plain @ motion.R, motion.frames.laws), plain
        if match is None:
            continue
        upside_down = (
            picture.dimensions == 2 and motion.axis is not None and np.all(match.points[motion.axis] < 0)
        )
        if upside_down and motion.unit is not None and picture.keeps(-plain @ motion.unit):
            camera, match = -plain, match._replace(points=-match.points)
        shown = read(match, motion)
        if shown.found and motion.half is not None and drawn_boxes.stays(picture, match, motion.half):
            shown = Shown(
                False, "static", "the box itself stays where it is: draw its corners with R[k] as well"
            )
        elif shown.found and motion.unit is not None and not _agrees(picture, camera, motion.unit):
            sentence = (
                f"{motion.name} and L are drawn in different coordinates: are x and y swapped in one of them?"
            )
            shown = Shown(False, "mirrored", sentence)
        elif shown.found and (wrong := cameras.mislabelled(picture.plane, plain)):
            shown = Shown(False, "mirrored", wrong)
        if shown.found:
            return camera, shown
        first = first if first[1] else (camera, shown)
    return first


def _agrees(picture: Picture, camera: Array, unit: Array) -> bool:
    """Return whether a drawing along L fits the camera. It does not if L is drawn by another camera and not
    by this one.
    """
    own, every = [camera], cameras.plain(picture.dimensions)
    some, others = (
        (picture.keeps(sign * view @ unit) for view in views for sign in (1, -1)) for views in (own, every)
    )
    return any(some) or not any(others)


def _box(drawn: list[Picture], motion: Motion, *, unsorted: bool) -> Iterator[Shown]:
    """Yield what points show of a box as a set: those that the artist leaves ``unsorted``,
    or all with paths.
    """
    if (half := motion.half) is None:
        return
    for picture in drawn:
        moving = [path.places + path.origin for path in picture.paths]
        sets = picture.sets if unsorted else [np.stack(moving, axis=1)] if len(moving) >= CORNERS else []
        plain, transposed = cameras.plain(picture.dimensions, picture.plane), _mistakes(motion)["transposed"]
        if found := drawn_boxes.box_seen(sets, plain, motion.R, half, motion.frames.laws):
            wrong = cameras.mislabelled(picture.plane, found[0])
            right = Shown(True, None, f"the box is drawn, {motion.frames.covered(found[1])}")
            yield Shown(False, "mirrored", wrong) if wrong else right
        elif drawn_boxes.box_seen(sets, plain, transposed.curves, half, motion.frames.laws):
            yield Shown(False, transposed.code, transposed.sentence)
