"""Whether what is drawn along L stays there, and what it does instead."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays

from . import cameras, timing
from .animation_checks import compared
from .matching import Motion, along, fewer
from .pictures import Picture, directions, pictures, sound
from .reading import PARALLEL, Shown

Array = NDArray[np.float64]


def momentum_shown(seen: Arrays, t: Array, R: Array, L: Array, axis: int | None = 2) -> Shown:
    """Return whether a direction drawn along L stays there, by the camera that draws the body or else as it is."""
    if not sound(seen):
        return Shown(None, None, "what came back does not fit together")
    drawn, unit = pictures(seen), L / np.linalg.norm(L)
    enough = len(seen["at"]) >= timing.LEAST_FRAMES and any(picture.paths for picture in drawn)
    at, t, R = fewer(seen["at"], t, R)
    motion = Motion(at, t, R, L, axis)
    found = compared(drawn, motion, at).cameras if enough else ()
    reversed_ = False
    for picture, camera in zip(drawn, found or (None,) * len(drawn), strict=True):
        some, sure = directions(picture, [path.origin for path in picture.paths if path.bound])
        for view in [camera] if camera is not None else cameras.plain(picture.dimensions):
            if np.linalg.norm(view @ unit) <= PARALLEL:
                if _end_on(picture):
                    return Shown(True, None, "L points at the viewer, and a point stays where it is drawn")
                continue
            if cameras.points_along(some, sure, view @ unit):
                return Shown(True, None, "a direction along L stays the same")
            reversed_ = reversed_ or cameras.parallel(sure, -(view @ unit))
    if reversed_:
        return Shown(False, "reversed-angular-momentum", "what is drawn points along −L")
    if enough and (instead := next(_instead_of_momentum(drawn, motion, unit), None)):
        return instead
    return Shown(None, None, "no direction along L was found in the lines and arrows of the axes: draw L as a line or an arrow")


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
        if along(picture, motion.w @ view.T, motion.laws):
            yield Shown(False, "moving-angular-momentum", "what is drawn follows ω, which moves: L is fixed in space")
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
        return f"a fixed line points along {along[0]}, but L points along ({_components(unit)})"
    body = view @ (motion.R[0].T @ unit)
    if not along and np.linalg.norm(body) > PARALLEL and cameras.parallel(sure, body):
        return "a fixed line points along the body components of L, which are not those in space"
    if single and not along and len(view) == 3:
        line = sure[0] / np.linalg.norm(sure[0])
        return f"the only fixed line points along ({_components(line)}), but L points along ({_components(unit)})"
    return ""


def _components(direction: Array) -> str:
    return ", ".join(f"{x:.2f}" for x in direction)
