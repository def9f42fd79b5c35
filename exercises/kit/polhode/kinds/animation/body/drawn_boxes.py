"""A box drawn on the body: its proportions, centre and edges, and its corners if they are drawn in any order.

Faces may be sorted by depth, or only the visible ones drawn. Such points have no paths, because the artist
lists other points from frame to frame. As a set they are corners of the box in the attitude of their frame,
seen by one camera.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from polhode.kinds.animation import cameras, frame_times
from polhode.kinds.animation.curve_matching import MISFIT, Match
from polhode.kinds.animation.drawn_paths import Picture
from polhode.kinds.animation.frame_times import Array
from polhode.kinds.animation.visibility import Shown

TRIED, REFINED = 1500, 8  # cameras that are compared in COARSE frames, and the number of them that are fitted
COARSE = 12
ROUNDS = 6
PERSPECTIVE = 2  # of the fitted cameras are tried with perspective too
FLAT = 0.02  # of the longest edge: a point nearer to a plane of symmetry is not a corner
UNEVEN = 1.05  # largest ratio between the scales of two edges
ASTRAY = 0.1  # of the diagonal: a centre that moves further, or a corner further from its place, is wrong
CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))  # (8, 3), in half edges
CENTRE = "the box turns about a point other than its centre: the centre of a free body stays fixed"
EDGES = (
    "the edges of the box are not along the axes of the body: draw R[k] @ corner, with R[k] as it is given"
)


def wrong_box(match: Match, half: Array, R: Array) -> Shown | None:
    """Return what is wrong with the box that the points of ``match`` make, or None if it is right or there is
    none.

    ``half`` (3,) are the right half edges, ``R`` (G, 3, 3) the attitudes on the times' grid. The corners of a
    box in these proportions may be the points of all artists or of one.
    """
    groups = [match.points, *(points for points, _ in match.by_artist())]
    found = [_displaced(group, half, R[frame_times.on_grid(match.times, len(R))]) for group in groups]
    if "" not in found and (wrong := next(filter(None, found), None)):
        return Shown(False, "wrong-motion", wrong)
    edges = _edges(match.points)
    if edges is None or (edges / half).max() <= UNEVEN * (edges / half).min():
        return None
    ratios = [" : ".join(f"{x:.3g}" for x in lengths / lengths.max()) for lengths in (edges, half)]
    return Shown(
        False,
        "wrong-proportions",
        f"the box is drawn with edges in the ratio {ratios[0]}, but half has {ratios[1]}",
    )


def stays(picture: Picture, match: Match, half: Array) -> bool:
    """Return whether points that stay, of one artist or of all, are the corners of the box, and those of
    ``match`` are not.
    """
    if picture.dimensions != 3 or not picture.still or _edges(match.points) is not None:
        return False
    return any(
        len(_box_among(points.T, half)[0]) for points in (*picture.still, np.concatenate(picture.still))
    )


def _edges(points: Array) -> Array | None:
    """Return the half edges (3,) of the box whose corners are among body points (3, v), or None if they are
    not those of a box.
    """
    size = np.abs(points).max(initial=0.0)
    corners = points[:, np.abs(points).min(axis=0) > FLAT * size]
    if not corners.size:
        return None
    half = np.median(np.abs(corners), axis=1)
    box = np.unique(np.sign(corners), axis=1).shape[1] >= 4 and np.all(
        np.abs(np.abs(corners).T - half) <= MISFIT * size
    )
    return np.asarray(half) if box else None


def _displaced(points: Array, half: Array, R: Array) -> str | None:
    """Return how the centre of a box moves or its edges are off the body's axes, "" if they are right, None
    if there is no box.

    ``points`` (3, v) are those of the body, ``R`` (f, 3, 3) the attitudes in the frames. The edges may be off
    because the whole picture is turned.
    """
    corners, diagonal = _box_among(points, half)
    if not len(corners):
        return None
    centre = corners.mean(axis=0)
    if np.ptp(R @ centre, axis=0).max() > ASTRAY * diagonal:
        return CENTRE
    if np.ptp(np.abs(corners - centre), axis=0).max() <= ASTRAY * diagonal:
        return ""
    own = np.linalg.eigh((corners - centre).T @ (corners - centre))[1][
        :, np.argsort(np.argsort(half))
    ]  # edges along the columns
    own[:, 0] *= np.sign(np.linalg.det(own))
    turns = (own * signs for signs in CORNERS if np.prod(signs) > 0)
    return (
        EDGES if all(np.ptp(R @ turn @ np.swapaxes(R, 1, 2), axis=0).max() > ASTRAY for turn in turns) else ""
    )


def _box_among(points: Array, half: Array) -> tuple[Array, float]:
    """Return the corners (8, 3) and the diagonal of the box in the proportions of ``half`` that points (3, v)
    make, or none (0, 3).

    Several points may be at a corner; the fixed point zero completes seven.
    """
    near, places = 2 * MISFIT * np.abs(points).max(initial=0.0), list[Array]()
    for point in points.T:
        if len(places) <= len(CORNERS) and all(np.linalg.norm(point - place) > near for place in places):
            places.append(point)
    corners = np.array([*places, np.zeros(3)] if len(places) == 7 else places).reshape(-1, 3)
    if len(corners) == len(CORNERS):
        lengths, wanted = (
            np.sort(np.linalg.norm(x[:, None] - x, axis=2), axis=None) for x in (corners, CORNERS * half)
        )
        scale = lengths @ wanted / (wanted @ wanted)
        if np.abs(lengths - scale * wanted).max() <= 2 * MISFIT * lengths[-1]:
            return corners, float(lengths[-1])
    return corners[:0], 0.0


def box_seen(
    sets: list[Array], plain: list[Array], R: Array, half: Array, laws: Array
) -> tuple[Array, Array] | None:
    """Return the camera (d, 3) and times (f,) at which one of ``sets`` (f, s, d) shows corners of the box, or
    None.

    The cameras ``plain`` are tried first. ``R`` (G, 3, 3) on the times' grid.
    """
    corners = R @ (CORNERS * half).T  # (G, 3, 8)
    for points in sets if len(laws) else []:
        low, high = points.min(axis=1), points.max(axis=1)
        drawn = points - np.median((low + high) / 2, axis=0)
        tried = _tried(drawn, plain, corners, laws) if (high - low).min(axis=0).max() > 0 else ()
        if found := next(filter(None, (_fitted(drawn, corners, camera, law) for camera, law in tried)), None):
            return found
    return None


def _tried(drawn: Array, plain: list[Array], corners: Array, laws: Array) -> Iterator[tuple[Array, Array]]:
    """Yield cameras and laws for a set (f, s, d), compared in a few frames: as space is, or in 2-D from any
    side.

    In 3-D a rotated and a mirrored box are the same set. The cameras with perspective have the shape (3, 4).
    """
    from scipy.spatial.transform import Rotation

    few = frame_times.sparse(len(drawn), COARSE)

    def cost(camera: Array, law: Array) -> float:
        seen = camera @ corners[frame_times.on_grid(law[few], len(corners))]
        size = np.sqrt(np.mean(drawn[few] ** 2) / max(float(np.mean(seen**2)), 1e-300))
        return float(_distances(drawn[few], size * seen).min(axis=2).mean())

    for camera in plain:
        yield camera, min(laws, key=lambda law: cost(camera, law))
    off = np.abs(laws - np.linspace(0, laws.max(), len(drawn))).max(
        axis=1
    )  # from an even run through all samples
    again = [law for law in laws if np.any(np.diff(law) < 0)]
    for law in (laws[int(np.argmin(off))], *again[:1]) if drawn.shape[2] == 2 else ():
        sides = Rotation.random(TRIED, random_state=0).as_matrix()[:, :2]
        best = sorted(sides, key=lambda camera: cost(camera, law))[:REFINED]
        central = [np.block([[camera, np.zeros((2, 1))], [np.eye(4)[3:]]]) for camera in best[:PERSPECTIVE]]
        yield from ((camera, law) for camera in (*best, *central))


def _fitted(drawn: Array, corners: Array, camera: Array, law: Array) -> tuple[Array, Array] | None:
    """Fit camera and times in turn, first in a few frames and then in all. None if they do not fit."""
    d, whole, camera = drawn.shape[2], np.mean(drawn**2), camera.copy()
    camera[:d] *= np.sqrt(whole / np.mean(_seen(camera, corners) ** 2))
    for part in (frame_times.sparse(len(drawn)), np.arange(len(drawn))):
        grid = frame_times.on_grid(law[part], len(corners))
        near = frame_times.choices(law[part], len(corners))
        for _ in range(ROUNDS):
            camera = _refined(drawn[part], corners[grid], camera)
            seen = _seen(camera, corners)
            costs = [_distances(drawn[part], seen[choice]).min(axis=2).mean(axis=1) for choice in near.T]
            grid = frame_times.in_order(np.stack(costs, axis=1), near, law[part])
        off = _distances(drawn[part], seen[grid]).min(axis=2).mean(axis=1)
        if max(off.mean(), off.max() / frame_times.WORST**2) > MISFIT**2 * whole:
            return None
    straight = cameras.straightened(camera[:d, :3])
    if straight is None or any(
        np.abs(straight @ q).max() > cameras.SKEW * np.linalg.norm(q) for q in camera[d:, :3]
    ):
        return None
    return straight, grid / frame_times.PER


def _distances(drawn: Array, seen: Array) -> Array:
    """Return the squares (f, s, 8) of the distances of points (f, s, d) to corners (f, d, 8)."""
    return np.asarray(np.sum((drawn[:, :, :, None] - seen[:, None]) ** 2, axis=2))


def _seen(camera: Array, corners: Array) -> Array:
    """Return corners (f, 3, 8) as drawn (f, d, 8) by a camera (d, 3), or one of perspective (3, 4) in
    homogeneous coordinates.
    """
    if camera.shape[1] == 3:
        return camera @ corners
    seen = camera[:, :3] @ corners + camera[:, 3:]
    return np.asarray(seen[:, :2] / seen[:, 2:])


def _refined(drawn: Array, corners: Array, camera: Array) -> Array:
    """Return the camera that fits best if each point is the corner now nearest to it."""
    nearest = np.argmin(_distances(drawn, _seen(camera, corners)), axis=2)
    points = np.take_along_axis(corners, nearest[:, None, :], axis=2).transpose(0, 2, 1).reshape(-1, 3)
    places = drawn.reshape(-1, drawn.shape[2])
    if camera.shape[1] == 3:
        return np.asarray(np.linalg.lstsq(points, places, rcond=None)[0].T)
    M, q = cameras.in_perspective(np.column_stack([points, np.ones(len(points))]), places)
    return np.concatenate([M, [[*-q, 1.0]]])
