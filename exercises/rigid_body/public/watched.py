"""What an animation shows: whether something drawn follows the body, and whether L stays where it is.

There are many right ways to draw it, so nothing is asked of the drawing but that some point, or the direction between two points of
one artist, moves as the body does: in space as it is, or scaled, shifted, turned as a whole, or projected onto a plane.
"""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays

Array = NDArray[np.float64]

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
MISFIT = 0.03  # root mean square, of the path's own: what interpolating between frames costs stays far below, noise far above
MOVES = 1e-3  # of its distance from the origin
LEAST_FRAMES, LEAST_PART = 10, 0.25  # of the motion's samples
LARGEST = 1e100
OWN = 0.05  # part of a point's place that must be along the axis asked for
SPACE = (0, 1, 2)
PLANES = tuple(itertools.permutations(range(3), 2))


class Shown(NamedTuple):
    """``found``: True where the body is followed, False where it is not, None where a picture is painted that has no points.

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
    if not _sound(seen):
        return Shown(False, None, "what came back does not fit together")
    paths, painted = moving(seen), seen["cost"][4] > 0
    if not len(paths.places):
        return Shown(None if painted else False, None, "nothing that moves was found in lines, arrows, polygons and markers")
    attitudes = list(_attitudes(seen, t, R))
    if not attitudes:
        return Shown(False, None, f"too short to show the motion: {len(seen['at'])} frames, or too small a part of it")
    shown = _compared(paths, attitudes, axis)
    if painted and not shown.found:
        return Shown(None, None, "what moves beside the painted picture says nothing about the body")
    return shown


def _compared(paths: Paths, attitudes: list[Array], axis: int | None) -> Shown:
    if any(_attached(paths, A, axis) for A in attitudes):
        return Shown(True, None, "drawn as it is")
    for code, sentence, wrong in _otherwise(attitudes, axis):
        if any(_attached(paths, A, k) for A, k in wrong):
            return Shown(False, code, sentence)
    axes = range(3) if axis is None else (axis,)
    if any(_fits(paths, A[:, :, k]).any() for A in attitudes for k in axes):
        return Shown(True, None, "seen from another side, or projected")
    return Shown(False, "wrong-motion", "what moves does not move with the body")


def momentum_shown(seen: Arrays, t: Array, R: Array, L: Array) -> Shown:
    """Whether a direction drawn along L stays there, in space or in a plane of two coordinates.

    Only what is drawn as it is, unshifted, is said to move.
    """
    if not _sound(seen):
        return Shown(None, None, "what came back does not fit together")
    paths = _paths(seen)
    if any(_static_along(_drawn_in(paths, plane), L[list(plane)]) for plane in (SPACE, *PLANES)):
        return Shown(True, None, "a direction along L stays the same")
    for A in _attitudes(seen, t, R):
        for turned in (A @ L, np.einsum("fji,j->fi", A, L)):
            if any(_along(_drawn_in(paths, plane), turned[:, list(plane)]) for plane in (SPACE, *PLANES)):
                return Shown(
                    False, "moving-angular-momentum", "L moves with the body: it is fixed in space, and R belongs to the body"
                )
    return Shown(None, None, "no direction along L was found in the lines and arrows of the axes")


def moving(seen: Arrays) -> Paths:
    """The paths that do not stand still."""
    paths = _paths(seen)
    extent = np.ptp(paths.places, axis=1).max(axis=1, initial=0.0)
    chosen = extent > np.maximum(MOVES * np.abs(paths.places).max(axis=(1, 2), initial=0.0), 1e-9)
    return Paths(*(x[chosen] for x in paths))


def _sound(seen: Arrays) -> bool:
    """Whether the arrays agree with each other: each may be forged by itself."""
    tracks, owners, at = seen["tracks"], seen["owners"], seen["at"]
    small = np.all(np.abs(tracks) < LARGEST) and np.all(np.abs(at) < LARGEST) and np.all(at[:, 2] >= 1)
    return bool(tracks.shape[:2] == (len(at), len(owners)) and small)


def _drawn_in(paths: Paths, plane: tuple[int, ...]) -> Array:
    return paths.places[~paths.flat] if len(plane) == 3 else paths.places[paths.flat][:, :, :2]


def _static_along(places: Array, direction: Array) -> bool:
    """Whether one of ``places`` (q, f, d) stays, and stays along ``direction`` (d,)."""
    if not len(places):
        return False
    length = np.linalg.norm(places[:, 0], axis=1)
    stays = np.ptp(places, axis=1).max(axis=1) <= MOVES * length
    along = places[:, 0] @ direction >= (1 - 1e-6) * length * np.linalg.norm(direction)
    return bool(np.any((length > 0) & stays & along))


def _along(places: Array, direction: Array) -> bool:
    """Whether one of ``places`` (q, f, d) is ``direction`` (f, d), scaled."""
    if not len(places):
        return False
    scale = np.einsum("qfd,fd->q", places, direction) / np.sum(direction**2)
    left = np.mean((places - scale[:, None, None] * direction) ** 2, axis=(1, 2))
    spread = np.mean((places - places.mean(axis=1, keepdims=True)) ** 2, axis=(1, 2))
    return bool(np.any((scale > 0) & (spread > 0) & (left <= MISFIT**2 * spread)))


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
    """R (f, 3, 3) at the frames, for each way in which frames may count time: evenly, by a whole stride, by index, by the time;
    held at the end or begun anew. Only those that show enough of the motion to tell it from another."""
    from scipy.interpolate import CubicSpline

    number, value, many = seen["at"].T
    n, total, spline = len(t), int(many[0]), CubicSpline(np.arange(len(t)), R.reshape(len(t), 9))
    ways = [number * (n - 1) / max(total - 1, 1)]
    ways += [number * stride for stride in range(1, n) if total in (-(-n // stride), n // stride)]
    if np.all(value >= 0) and np.ptp(value) > 0:
        ways += [value, np.interp(value, t, np.arange(n)), value * (n - 1) / value.max()]
    for way in ways:
        for indices in (way,) if way.max() <= n - 1 + 1e-9 else (np.minimum(way, n - 1), way % n):
            if len(np.unique(indices)) >= LEAST_FRAMES and np.ptp(indices) >= LEAST_PART * (n - 1):
                yield spline(np.clip(indices, 0, n - 1)).reshape(-1, 3, 3)


def _otherwise(attitudes: list[Array], axis: int | None) -> Iterator[tuple[str, str, list[tuple[Array, int | None]]]]:
    if axis is not None:
        for other in (k for k in range(3) if k != axis):
            said = f"what is drawn follows ê{'₁₂₃'[other]}, not ê{'₁₂₃'[axis]}: the axes of the body are the columns of R"
            yield "wrong-axis", said, [(A, other) for A in attitudes]
    said = "what is drawn follows the transposed R: R takes body components to space, so ê₃ is R[:, :, 2], its third column"
    yield "transposed-rotation", said, [(np.swapaxes(A, 1, 2), None) for A in attitudes]
    yield "wrong-motion", "the motion is drawn backwards in time", [(A[::-1], axis) for A in attitudes]


def _attached(paths: Paths, A: Array, axis: int | None) -> bool:
    """Whether paths are those of points of the body, c + A p, that have a part along ``axis`` or span the plane across it.

    Flat ones are seen in a plane of two coordinates.
    """
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
