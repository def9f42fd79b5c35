"""The box of ``animate_tumble``: its proportions, centre and axes, and its corners if they are drawn in any
order.

Faces may be sorted by depth, or only the visible ones drawn. Such points have no paths, because the artist
lists other points from frame to frame. As a set they are corners of the box in the attitude of their frame,
seen by one camera.
"""

from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import cameras, timing
from ecp.kinds.animation.matching import MISFIT, Match
from ecp.kinds.animation.pictures import Picture

Array = NDArray[np.float64]

TRIED, REFINED = 1500, 8  # cameras that are compared in COARSE frames, and the number of them that are fitted
COARSE = 12
ROUNDS = 6
CORNERS = 7  # least number of moving corners: one may stay if the box is seen along an edge
PERSPECTIVE = 2  # of the fitted cameras are tried with perspective too
SKEW = 0.1  # sine of the angle between the line of sight and the normal of the drawing
FLAT = 0.02  # of the longest edge: a point nearer to a plane of symmetry is not a corner
UNEVEN = 1.05  # largest ratio between the scales of two edges
ASTRAY = 0.1  # of the diagonal: a centre that moves further, or a corner further from its place, is wrong


def edges(points: Array) -> Array | None:
    """Return the half edges (3,) of the box whose corners are among body points (3, v), or None if they are
    not those of a box.
    """
    size = np.abs(points).max(initial=0.0)
    corners = points[:, np.abs(points).min(axis=0) > FLAT * size]
    if not corners.size:
        return None
    half = np.median(np.abs(corners), axis=1)
    signs = {tuple(corner) for corner in np.sign(corners).T}
    box = len(signs) >= 4 and np.all(np.abs(np.abs(corners).T - half) <= MISFIT * size)
    return np.asarray(half) if box else None


def disproportionate(drawn: Array, half: Array) -> bool:
    """Return whether half edges ``drawn`` (3,) differ from ``half`` by more than a common scale."""
    scale = drawn / half
    return bool(scale.max() > UNEVEN * scale.min())


def displaced(match: Match, half: Array, R: Array) -> str | None:
    """Return what is wrong with the box that the points of ``match`` make: its centre moves or its edges are
    not the body's axes.

    ``R`` (G, 3, 3) on the times' grid. The points of all artists or of one may be the eight corners of a box
    in the proportions of ``half`` (3,), one of them perhaps at the fixed point zero. None if one of these
    boxes is right or there is none.
    """
    artists = np.array([path.artist for path in match.paths])
    groups = [match.points, *(match.points[:, artists == artist] for artist in np.unique(artists))]
    R = R[timing.on_grid(match.times, len(R))]
    wrong = []
    for corners in (_distinct(group) for group in groups):
        diagonal = _diagonal(corners, half)
        if not diagonal:
            continue
        centre, near = corners.mean(axis=0), ASTRAY * diagonal
        if np.ptp(R @ centre, axis=0).max() > near:
            wrong.append("the box turns about a point other than its centre: the centre of a free body stays fixed")
        elif _inclined(corners - centre, half, R, near):
            wrong.append("the edges of the box are not along the axes of the body: draw R[k] @ corner, with R[k] as it is given")
        else:
            return None
    return wrong[0] if wrong else None


def rests(picture: Picture, half: Array) -> bool:
    """Return whether points that stay, of one artist or of all, are the corners of a box in the proportions
    of ``half`` (3,).
    """
    if picture.dimensions != 3 or not picture.still:
        return False
    return any(_diagonal(_distinct(points.T), half) > 0 for points in (*picture.still, np.concatenate(picture.still)))


def _diagonal(corners: Array, half: Array) -> float:
    """Return the diagonal of the box that ``corners`` (k, 3) make in the proportions of ``half``, 0 if they
    are not a box.
    """
    box = _corners(half)
    if len(corners) != len(box):
        return 0.0
    lengths, wanted = (np.sort(np.linalg.norm(some[:, None] - some, axis=2), axis=None) for some in (corners, box))
    scale = lengths @ wanted / (wanted @ wanted)
    return float(lengths[-1]) if np.abs(lengths - scale * wanted).max() <= 2 * MISFIT * lengths[-1] else 0.0


def _corners(half: Array) -> Array:
    """Return the corners (8, 3) of a box with half edges ``half`` (3,)."""
    return np.array(list(product((-1, 1), repeat=3))) * half


def _distinct(points: Array) -> Array:
    """Return the places (k, 3) of points (3, v), at most nine; the fixed point zero completes seven."""
    near, places = 2 * MISFIT * np.abs(points).max(initial=0.0), list[Array]()
    for point in points.T:
        if len(places) <= 8 and all(np.linalg.norm(point - place) > near for place in places):
            places.append(point)
    if len(places) == 7:
        places.append(np.zeros(3))
    return np.array(places).reshape(-1, 3)


def _inclined(corners: Array, half: Array, R: Array, near: float) -> bool:
    """Return whether corners (8, 3) about zero are off the body axes, and not because the whole picture is turned."""
    if np.ptp(np.abs(corners), axis=0).max() <= near:
        return False
    own = np.linalg.eigh(corners.T @ corners)[1][:, np.argsort(np.argsort(half))]  # edges along the columns
    own[:, 0] *= np.sign(np.linalg.det(own))
    turns = (own * signs for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)))
    return all(np.ptp(R @ turn @ np.swapaxes(R, 1, 2), axis=0).max() > ASTRAY for turn in turns)


def box_seen(sets: list[Array], R: Array, half: Array, laws: Array) -> tuple[Array, Array] | None:
    """Return the camera (d, 3) and times (f,) at which one of ``sets`` (f, s, d) shows corners of the box.

    R (G, 3, 3) on the times' grid. Returns None if there is none.
    """
    corners = R @ _corners(half).T  # (G, 3, 8)
    for drawn in sets:
        span = drawn.max(axis=1) - drawn.min(axis=1)
        centre = np.median(drawn.min(axis=1) + span / 2, axis=0)
        if span.min(axis=0).max() > 0 and (found := _of_set(drawn - centre, corners, laws)):
            return found
    return None


def together(picture: Picture) -> list[Array]:
    """Return the moving points of all artists as one set (f, s, d), if they may be the corners of a box."""
    moving = [path.places + path.origin for path in picture.paths]
    return [np.stack(moving, axis=1)] if len(moving) >= CORNERS else []


def _of_set(drawn: Array, corners: Array, laws: Array) -> tuple[Array, Array] | None:
    few = np.unique(np.rint(np.linspace(0, len(drawn) - 1, COARSE)).astype(int))
    for plain in cameras.plain(drawn.shape[2]):
        seen = _seen(plain, corners)
        costs = [_off(drawn[few], seen[timing.on_grid(law[few], len(corners))], free=True).mean() for law in laws]
        if found := _fitted(drawn, corners, plain, laws[int(np.argmin(costs))]):
            return found
    if drawn.shape[2] == 3:
        return None  # a rotated and a mirrored box are the same set
    again = [law for law in laws if np.any(np.diff(law) < 0)]
    for law in (_even(laws), *again[:1]):
        some = corners[timing.on_grid(law[few], len(corners))]
        costs = [_off(drawn[few], _seen(camera, some), free=True).mean() for camera in _all_sides()]
        best = [_all_sides()[k] for k in np.argsort(costs)[:REFINED]]
        central = [np.block([[camera, np.zeros((2, 1))], [np.zeros((1, 3)), np.ones((1, 1))]]) for camera in best[:PERSPECTIVE]]
        if found := next((fit for camera in (*best, *central) if (fit := _fitted(drawn, corners, camera, law))), None):
            return found
    return None


@cache
def _all_sides() -> Array:
    """Return cameras (TRIED, 2, 3) from all sides."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.random(TRIED, random_state=0).as_matrix()[:, :2])


def _even(laws: Array) -> Array:
    """Return the law (f,) nearest to an even run through all samples."""
    return np.asarray(laws[int(np.argmin(np.abs(laws - np.linspace(0, laws.max(), laws.shape[1])).max(axis=1)))])


def _off(drawn: Array, seen: Array, free: bool = False) -> Array:
    """Return the mean square distance (f,) of points (f, s, d) to the nearest corners (f, d, 8), with
    ``free`` in any size.
    """
    if free:
        seen = seen * np.sqrt(np.mean(drawn**2) / max(float(np.mean(seen**2)), 1e-300))
    distances = np.sum((drawn[:, :, :, None] - seen[:, None]) ** 2, axis=2)
    return np.asarray(distances.min(axis=2).mean(axis=1))


def _fitted(drawn: Array, corners: Array, camera: Array, law: Array) -> tuple[Array, Array] | None:
    """Fit camera and times in turn, first in a few frames and then in all. None if they do not fit."""
    few, camera = timing.sparse(len(drawn)), camera.copy()
    camera[: drawn.shape[2]] *= np.sqrt(np.mean(drawn**2) / np.mean(_seen(camera, corners) ** 2))
    whole = np.sqrt(np.mean(drawn**2))
    for part in (few, np.arange(len(drawn))):
        grid = timing.on_grid(law[part], len(corners))
        for _ in range(ROUNDS):
            camera = _refined(drawn[part], corners[grid], camera)
            grid = _timed(drawn[part], _seen(camera, corners), law[part])
        off = np.sqrt(_off(drawn[part], _seen(camera, corners[grid])))
        if np.sqrt(np.mean(off**2)) > MISFIT * whole or off.max() > timing.WORST * MISFIT * whole:
            return None
    straight = cameras.straightened(camera[: drawn.shape[2], :3])
    if straight is None or (camera.shape[1] == 4 and np.abs(straight @ camera[2, :3]).max() > SKEW * np.linalg.norm(camera[2, :3])):
        return None
    return straight, grid / timing.PER


def _seen(camera: Array, corners: Array) -> Array:
    """Return corners (f, 3, 8) as drawn (f, d, 8) by a camera (d, 3), or by one of perspective (3, 4) in
    homogeneous coordinates.
    """
    if camera.shape[1] == 3:
        return np.einsum("ia,gak->gik", camera, corners)
    seen = np.einsum("ia,gak->gik", camera[:, :3], corners) + camera[:, 3:]
    return np.asarray(seen[:, :2] / seen[:, 2:])


def _refined(drawn: Array, corners: Array, camera: Array) -> Array:
    """Return the camera that fits best if each point is the corner now nearest to it."""
    seen = _seen(camera, corners)
    nearest = np.argmin(np.sum((drawn[:, :, :, None] - seen[:, None]) ** 2, axis=2), axis=2)
    own = np.take_along_axis(corners, nearest[:, None, :], axis=2)
    points, places = own.transpose(0, 2, 1).reshape(-1, 3), drawn.reshape(-1, drawn.shape[2])
    if camera.shape[1] == 3:
        return np.asarray(np.linalg.lstsq(points, places, rcond=None)[0].T)
    points = np.column_stack([points, np.ones(len(points))])
    none = np.zeros_like(points)
    rows = [
        np.column_stack([*(points if k == row else none for k in range(2)), -places[:, [row]] * points[:, :3]]) for row in (0, 1)
    ]
    fit = np.linalg.lstsq(np.concatenate(rows), places.T.ravel(), rcond=None)[0]
    return np.append(fit, 1.0).reshape(3, 4)


def _timed(drawn: Array, seen: Array, law: Array) -> timing.Indices:
    choices = timing.choices(law, len(seen))
    costs = np.stack([_off(drawn, seen[choice]) for choice in choices.T], axis=1)
    return timing.in_order(costs, choices, law)
