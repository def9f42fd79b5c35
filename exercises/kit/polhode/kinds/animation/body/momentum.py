"""Whether a drawing along L stays there, and what it does instead."""

from collections.abc import Iterator

import numpy as np

from polhode.judging.checks import Arrays
from polhode.kinds.animation import cameras
from polhode.kinds.animation.body.body_motion import Body, Motion
from polhode.kinds.animation.body.comparing import compared
from polhode.kinds.animation.cameras import PARALLEL
from polhode.kinds.animation.curve_matching import Mistake, instead
from polhode.kinds.animation.drawn_paths import Picture, is_consistent, pictures, resting
from polhode.kinds.animation.frame_times import LEAST_FRAMES, Array
from polhode.kinds.animation.visibility import INCONSISTENT, Shown

MOVES = "L moves with the body: L is fixed in space, do not apply R to it"
BODY_AXES = "drawn in body axes, where L moves and the axes stay: apply R to the body's points"
OMEGA = "the drawing follows ω, which moves: L is fixed in space"


def momentum_shown(seen: Arrays, body: Body) -> Shown:
    """Return whether a direction drawn along L of ``body`` stays there, by the camera that draws the body or
    else as space is.
    """
    assert body.L is not None
    if not is_consistent(seen):
        return Shown(None, None, INCONSISTENT)
    drawn, unit = pictures(seen), body.L / np.linalg.norm(body.L)
    enough = len(seen["at"]) >= LEAST_FRAMES and any(picture.paths for picture in drawn)
    found = compared(seen, drawn, body).cameras if enough else ()
    reversed_ = False
    for picture, camera in zip(drawn, found or (None,) * len(drawn), strict=True):
        for view in [camera] if camera is not None else cameras.plain(picture.dimensions):
            if np.linalg.norm(view @ unit) <= PARALLEL:
                if _end_on(picture):
                    return Shown(True, None, "L points at the viewer, and a point stays there")
            elif picture.keeps(view @ unit):
                return Shown(True, None, "a direction along L stays the same")
            else:
                reversed_ = reversed_ or cameras.parallel(picture.directions()[1], -(view @ unit))
    if reversed_:
        return Shown(False, "reversed-angular-momentum", "the line or arrow for L points along −L")
    if enough:
        motion = Motion(body, seen["at"], resting(seen))
        if wrong := next(_instead_of_momentum(drawn, motion, unit), None):
            return wrong
    return Shown(
        None,
        None,
        "no direction along L was found in the lines and arrows of the axes: draw L as a line or an arrow",
    )


def _instead_of_momentum(drawn: list[Picture], motion: Motion, unit: Array) -> Iterator[Shown]:
    """Yield what moves as L does in the body, or by R, and what is fixed along another direction."""
    views = [(picture, view) for picture in drawn for view in cameras.plain(picture.dimensions)]
    axes_stay = motion.axis is not None and any(
        cameras.parallel(picture.directions()[0], M[:, motion.axis]) for picture, M in views
    )
    moving = (
        (MOVES, motion.R @ unit),
        (BODY_AXES if axes_stay else MOVES, unit @ motion.R),
        (OMEGA, motion.w),
    )
    code, laws = "moving-angular-momentum", motion.frames.laws
    yield from instead(
        drawn, [Mistake(code, how, x[:, :, None], laws, shift=False) for how, x in moving], motion.frames
    )
    for picture, view in views:
        sure = picture.directions()[1]
        sentence, certain = _fixed_elsewhere(sure[np.any(sure != 0, axis=1)], view, motion, unit)
        if sentence:
            verdict = False if certain else None
            yield Shown(verdict, "wrong-angular-momentum", f"{sentence}: draw L as it is given")


def _end_on(picture: Picture) -> bool:
    """Return whether a point stays at the centre of a circle on which another one runs."""
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


def _fixed_elsewhere(sure: Array, view: Array, motion: Motion, unit: Array) -> tuple[str, bool]:
    """Return where the only fixed line points if that is not L, and whether it must be meant as L: an axis
    of coordinates need not be. Of several lines, none needs to be L.
    """
    single = len(sure) > 0 and all(cameras.parallel(np.array([one, -one]), sure[0]) for one in sure)
    along = [name for name, direction in zip("xyz", view.T, strict=True) if cameras.parallel(sure, direction)]
    body = view @ (motion.R[0].T @ unit)
    lines = [sure[0] / np.linalg.norm(sure[0]) if single else unit, unit]
    line, L = (", ".join(f"{x:.2f}" for x in direction) for direction in lines)
    if single and len(along) == 1:
        return f"a fixed line points along {along[0]}, but L points along ({L})", False
    if not along and np.linalg.norm(body) > PARALLEL and cameras.parallel(sure, body):
        return "the fixed line uses the body components of L: convert them with R·L_body", single
    if single and not along and len(view) == 3:
        return f"the only fixed line points along ({line}), but L points along ({L})", True
    return "", False
