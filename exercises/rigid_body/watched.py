"""What an animation shows: whether something drawn follows the body, and whether L stays where it is.

There are many right ways to draw it, so nothing is asked of the drawing but that some point, or the direction between two points of
one artist, moves as the body does: in space as it is, or scaled, shifted, turned as a whole, or projected onto a plane.
"""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from exercises.checks import Arrays

Array = NDArray[np.float64]

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
MISFIT = 0.03  # root mean square, of the path's own: what interpolating between frames costs stays far below, noise far above
MOVES = 1e-3  # of everything drawn
OWN = 0.05  # part of a point's place that must be along the axis asked for
PLANES = tuple(itertools.permutations(range(3), 2))


class Shown(NamedTuple):
    """``found``: True where the body is followed, False where something moves otherwise, None where nothing drawn moves at all.
    ``code`` and ``sentence`` say what is followed instead."""

    found: bool | None
    code: str | None
    sentence: str


class Paths(NamedTuple):
    """Points and differences of points (q, f, 3); ``flat`` (q,) where only two coordinates are drawn."""

    places: Array
    flat: NDArray[np.bool_]


def body_shown(seen: Arrays, t: Array, R: Array, axis: int | None) -> Shown:
    """Whether something follows body axis ``axis``, or for None any point of the body; ``R`` (n, 3, 3) at times ``t`` (n,)."""
    paths = moving(seen)
    if not len(paths.places):
        return Shown(None, None, "nothing that moves was found in the lines, arrows, polygons and markers of the axes")
    attitudes = list(_attitudes(seen, t, R))
    if any(_attached(paths, A, axis) for A in attitudes):
        return Shown(True, None, "drawn as it is")
    for code, sentence, wrong in _otherwise(attitudes, axis):
        if any(_attached(paths, A, k) for A, k in wrong):
            return Shown(False, code, sentence)
    if any(_seen_from_elsewhere(paths, A, 2 if axis is None else axis) for A in attitudes):
        return Shown(True, None, "seen from another side, or projected")
    return Shown(False, "wrong-motion", "what moves does not move with the body")


def momentum_shown(seen: Arrays, t: Array, R: Array, L: Array) -> Shown:
    """Whether a direction drawn along L stays there; True also of a point at the tip of L."""
    every = _paths(seen)
    solid = every.places[~every.flat]
    along = np.linalg.norm(np.cross(solid[:, 0], L / np.linalg.norm(L)), axis=1) <= 1e-3 * np.linalg.norm(solid[:, 0], axis=1)
    along &= solid[:, 0] @ L > 0
    if np.any(along & (np.ptp(solid, axis=1).max(axis=1) <= MOVES * np.linalg.norm(solid[:, 0], axis=1))):
        return Shown(True, None, "a direction along L stays the same")
    paths = moving(seen)
    for A in _attitudes(seen, t, R):
        for turned in (A @ L, np.einsum("fji,j->fi", A, L)):
            if len(paths.places) and _fits(paths, turned).any():
                return Shown(
                    False, "moving-angular-momentum", "L moves with the body: it is fixed in space, and R belongs to the body"
                )
    return Shown(None, None, "no direction along L was found in the lines and arrows of the axes")


def moving(seen: Arrays) -> Paths:
    """The paths that do not stand still."""
    paths = _paths(seen)
    extent = np.ptp(paths.places, axis=1).max(axis=1, initial=0.0)
    chosen = extent > MOVES * max(float(np.abs(paths.places).max(initial=0.0)), 1e-12)
    return Paths(*(x[chosen] for x in paths))


def _paths(seen: Arrays) -> Paths:
    tracks, owners = np.swapaxes(seen["tracks"], 0, 1), seen["owners"]
    real = owners[:, 1] > 0
    tracks, owners = tracks[real], owners[real]
    if not len(tracks):
        return Paths(np.zeros((0, 1, 3)), np.zeros(0, bool))
    same = owners[1:, 0] == owners[:-1, 0]
    steps = tracks[1:][same] - tracks[:-1][same]
    flat = owners[:, 1] == 2
    return Paths(np.concatenate([tracks, steps]), np.concatenate([flat, flat[1:][same]]))


def _attitudes(seen: Arrays, t: Array, R: Array) -> Iterator[Array]:
    """R (f, 3, 3) at the frames, for each way in which frames may count time: evenly, by a whole stride, by index, by the time."""
    number, value, many = seen["at"].T
    n, spline = len(t), CubicSpline(np.arange(len(t)), R.reshape(len(t), 9))
    ways = [number * (n - 1) / max(many[0] - 1, 1), number * max(1, n // many[0])]
    if np.all(value >= 0) and np.ptp(value) > 0:
        ways += [value, np.interp(value, t, np.arange(n)), value * (n - 1) / value.max()]
    for way in ways:
        if way.max() <= n - 1 + 1e-9:
            yield spline(np.clip(way, 0, n - 1)).reshape(-1, 3, 3)


def _otherwise(attitudes: list[Array], axis: int | None) -> Iterator[tuple[str, str, list[tuple[Array, int | None]]]]:
    if axis is not None:
        for other in (k for k in range(3) if k != axis):
            said = f"what is drawn follows ê{'₁₂₃'[other]}, not ê{'₁₂₃'[axis]}: the axes of the body are the columns of R"
            yield "wrong-axis", said, [(A, other) for A in attitudes]
    said = "what is drawn follows the transposed R: R takes body components to space, so ê₃ is R[:, :, 2], its third column"
    yield "transposed-rotation", said, [(np.swapaxes(A, 1, 2), None) for A in attitudes]
    yield "wrong-motion", "the motion is drawn backwards in time", [(A[::-1], axis) for A in attitudes]


def _attached(paths: Paths, A: Array, axis: int | None) -> bool:
    """Whether paths are those of points of the body, c + A p, that have a part along ``axis`` or span the plane across it; flat
    ones in a plane of two coordinates."""
    solid = paths.places[~paths.flat]
    if len(solid) and _points_of_body(A, solid, axis):
        return True
    flat = paths.places[paths.flat]
    return bool(len(flat)) and any(_points_of_body(A[:, list(plane)], flat[:, :, :2], axis) for plane in PLANES)


def _points_of_body(A: Array, places: Array, axis: int | None) -> bool:
    f, d = places.shape[1:]
    design = np.concatenate([A.reshape(f * d, 3), np.tile(np.eye(d), (f, 1))], axis=1)
    values = places.reshape(len(places), f * d).T
    fitted, ok = _least_squares(design, values, places)
    points = fitted[:3, ok]
    if axis is None or not points.size:
        return bool(np.any(points))
    points = points / np.maximum(np.linalg.norm(points, axis=0), 1e-300)
    across = np.delete(points, axis, axis=0)
    return bool(np.any(np.abs(points[axis]) >= OWN) or np.linalg.svd(across, compute_uv=False)[-1] >= OWN)


def _seen_from_elsewhere(paths: Paths, A: Array, axis: int) -> bool:
    return bool(_fits(paths, A[:, :, axis]).any())


def _fits(paths: Paths, direction: Array) -> NDArray[np.bool_]:
    """For each path whether it is ``direction`` (f, 3) turned as a whole and scaled, or projected onto a plane and shifted."""
    ok = np.zeros(len(paths.places), dtype=bool)
    for number, (place, flat) in enumerate(zip(paths.places, paths.flat, strict=True)):
        if flat:
            design = np.column_stack([direction, np.ones(len(direction))])
            ok[number] = bool(_least_squares(design, place[:, :2], place[None, :, :2], together=True)[1])
        else:
            turn, _, other = np.linalg.svd(place.T @ direction)
            proper = turn @ np.diag([1.0, 1.0, np.linalg.det(turn @ other)]) @ other
            turned = direction @ proper.T
            scale = float(np.sum(turned * place) / np.sum(turned * turned))
            misfit = np.sqrt(np.mean((place - scale * turned) ** 2))
            ok[number] = scale > 0 and misfit <= MISFIT * np.sqrt(np.mean((place - place.mean(axis=0)) ** 2))
    return ok


def _least_squares(design: Array, values: Array, places: Array, together: bool = False) -> tuple[Array, NDArray[np.bool_]]:
    """The fit, and for each column of ``values`` (or all of them together) whether the path of ``places`` (q, f, d) is met."""
    fitted = np.linalg.lstsq(design, values, rcond=None)[0]
    left = (design @ fitted - values) ** 2
    spread = np.mean((places - places.mean(axis=1, keepdims=True)) ** 2, axis=(1, 2))
    misfit = np.array([left.mean()]) if together else left.mean(axis=0)
    return np.asarray(fitted), misfit <= MISFIT**2 * spread
