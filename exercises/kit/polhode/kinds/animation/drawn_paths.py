"""The content of each axes of an animation: paths of points that move, and points that stay."""

from typing import NamedTuple

import numpy as np

from polhode.judging.checks import Arrays
from polhode.kinds.animation.cameras import PARALLEL, parallel
from polhode.kinds.animation.frame_times import Array

MOVES = 1e-3  # of its distance from the origin
POLAR = -2.0  # in place of the labels of polar axes
WIDE = 0.05  # of its length: half the width of an arrow's shaft
LARGEST = 1e100
FEW = 10  # points of an artist: more make a curve or a surface, no arrow
FIRST_STILL = 3  # points of an artist that may be the fixed end of what moves


class Path(NamedTuple):
    """The ``places`` (f, d) of a point of ``artist``; if ``bound``, relative to ``origin`` (d,), a fixed
    point of that artist.
    """

    artist: int
    places: Array
    bound: bool
    origin: Array


class Picture(NamedTuple):
    """One axes of ``dimensions`` 2 or 3: paths, each artist's points (s, d) that stay, and sets (f, s, d)
    without order.

    ``plane``: of 2-D axes the two coordinates that the labels name, 0, 1, 2 for x, y, z, or None.
    """

    dimensions: int
    paths: list[Path]
    still: list[Array]
    sets: list[Array]
    plane: tuple[int, int] | None

    def directions(self) -> tuple[Array, Array]:
        """Return directions (k, d) that stay: those of few points or of a line, and of these the ones with a
        known tail.

        A tail is known at the fixed end of a path or at the zero of the axes.
        """
        some, sure = [np.zeros((0, self.dimensions))], [np.zeros((0, self.dimensions))]
        tails = [np.zeros(self.dimensions), *(path.origin for path in self.paths if path.bound)]
        for points in self.still:
            steps, away = points - points[0], [points - tail for tail in tails]
            straight = (
                len(points) > 1
                and np.linalg.svd(steps, compute_uv=False)[1:].max(initial=0.0) <= MOVES * np.abs(steps).max()
            )
            if straight:
                known = [x for x in away if np.linalg.norm(x, axis=1).min() <= MOVES * np.abs(points).max()]
            else:
                known = [arrow for x in away if len(points) <= FEW and len(arrow := _arrow(x))]
            sure += known
            if straight or (not known and len(points) <= FEW):
                some += [(points[None, :] - points[:, None])[np.triu_indices(len(points), 1)], *away]
        return np.concatenate(some + sure), np.concatenate(sure)

    def keeps(self, direction: Array) -> bool:
        """Return whether something drawn stays along ``direction`` (d,), which is not seen end on.

        A known tail decides, since matplotlib lists an arrow from its tip.
        """
        some, sure = self.directions()
        known = parallel(sure, direction) or (parallel(some, direction) and not parallel(sure, -direction))
        return known and bool(np.linalg.norm(direction) > PARALLEL)


def is_consistent(seen: Arrays) -> bool:
    """Return whether the arrays fit together. They come from the sandbox, where a submission could forge each
    of them.
    """
    tracks, owners, at = seen["tracks"], seen["owners"], seen["at"]
    small = np.all(np.abs(tracks) < LARGEST) and np.all(np.abs(at) < LARGEST) and np.all(at[:, 2] >= 1)
    return bool(tracks.shape[:2] == (len(at), len(owners)) and small)


def resting(seen: Arrays) -> tuple[int, int]:
    """Return how many frames after the first repeat its picture, and how many before the last repeat that;
    0 if nothing moves.
    """
    tracks = seen["tracks"]
    first, last = (np.any(tracks != tracks[k], axis=(1, 2)) for k in (0, -1))
    return (int(np.argmax(first)) - 1, int(np.argmax(last[::-1])) - 1) if first.any() else (0, 0)


def pictures(seen: Arrays) -> list[Picture]:
    """Sort the points of ``seen`` by axes and artist; 2-D and 3-D axes never share a picture.

    Polar axes make two pictures: as they are, and as a map of directions whose radius is the angle from z.
    """
    tracks, owners, labels = np.swapaxes(seen["tracks"], 0, 1), seen["owners"], seen["labels"]
    found = []
    for axes, dimensions in np.unique(np.abs(owners[owners[:, 1] != 0][:, [2, 1]]), axis=0):
        here = (owners[:, 2] == axes) & (np.abs(owners[:, 1]) == dimensions)
        points, artists = (
            tracks[here][:, :, : 3 if dimensions == 3 else 2],
            (owners[here, 0] + 1) * np.sign(owners[here, 1]),
        )
        first, second = next((row[1:] for row in labels if row[0] == axes), (-1.0, -1.0))
        named = first != second and {first, second} <= {0.0, 1.0, 2.0}
        found.append(_picture(points, artists, (int(first), int(second)) if named else None))
        if first == second == POLAR:
            found.append(_picture(_directions(points), artists, None))
    return found


def _directions(points: Array) -> Array:
    """Return unit vectors (p, f, 3) of points (p, f, 2) on a map with the angle from z as radius, in degrees
    if above a turn.
    """
    radius = np.linalg.norm(points, axis=2, keepdims=True)
    angle = np.radians(radius) if radius.max() > 2 * np.pi else radius
    return np.concatenate([np.sin(angle) * points / np.where(radius > 0, radius, 1.0), np.cos(angle)], axis=2)


def _picture(tracks: Array, artists: Array, plane: tuple[int, int] | None) -> Picture:
    """Return the picture of points (p, f, d) of the ``artists`` (p,), negative for points without order."""
    d, paths, still = tracks.shape[2], list[Path](), list[Array]()
    for artist in np.unique(artists[artists > 0]):
        points = tracks[artists == artist]
        moves = np.ptp(points, axis=1).max(axis=1) > np.maximum(MOVES * np.abs(points).max(axis=(1, 2)), 1e-9)
        fixed = points[~moves, 0]
        starts = [
            np.all(np.abs(fixed - place[0]) <= MOVES * np.ptp(place, axis=0).max(), axis=1)
            for place in points[moves]
        ]
        if len(fixed) and not np.any(starts):
            still.append(fixed)
        for place, trail in zip(points[moves], starts, strict=True):
            bound = (
                []
                if np.any(trail)
                else [Path(int(artist), place - end, True, end) for end in fixed[:FIRST_STILL]]
            )
            paths += bound or [Path(int(artist), place, False, np.zeros(d))]
    ends = [path.places + path.origin for path in paths if path.bound]

    def is_end(places: Array) -> bool:  # the tip of an arrow drawn twice is not a free point
        return any(np.abs(places - end).max() <= MOVES * np.ptp(places, axis=0).max() for end in ends)

    paths = [path for path in paths if path.bound or not is_end(path.places)]
    sets = [np.swapaxes(tracks[artists == artist], 0, 1) for artist in np.unique(artists[artists < 0])]
    return Picture(d, paths, still, sets, plane)


def _arrow(points: Array) -> Array:
    """Return the one point (1, d) furthest from the tail at zero, if ``points`` (s, d) hold that, as an arrow
    with a head does.
    """
    lengths = np.linalg.norm(points, axis=1)
    far = points[lengths >= 0.99 * lengths.max()]
    single = lengths.min() <= WIDE * lengths.max() and np.ptp(far, axis=0).max() <= MOVES * lengths.max()
    return far[:1] if single else points[:0]


def changed(drawn: list[Picture]) -> int:
    """Return at how many frames a point of ``drawn`` is at another place than in the frame before."""
    everything = [path.places[:, None] for picture in drawn for path in picture.paths]
    everything += [points for picture in drawn for points in picture.sets]
    steps = [
        np.abs(np.diff(points, axis=0)).max(axis=(1, 2)) > MOVES * np.abs(points).max()
        for points in everything
    ]
    return int(np.sum(np.any(steps, axis=0)))
