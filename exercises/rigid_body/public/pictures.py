"""What an animation draws in each of its axes: paths of points that move, and points that stay."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays

Array = NDArray[np.float64]

MOVES = 1e-3  # of its distance from the origin
LARGEST = 1e100
FEW = 10  # points of an artist: more make a curve or a surface, no arrow
FIRST_STILL = 3  # points of an artist that may be the fixed end of what moves


class Path(NamedTuple):
    """``places`` (f, d) of a point of ``artist``; ``bound``: from ``origin`` (d,), a point of the same artist that stays."""

    artist: int
    places: Array
    bound: bool
    origin: Array


class Picture(NamedTuple):
    """One axes of ``dimensions`` 2 or 3: its paths, for each artist the points (s, d) that stay, and sets (f, s, d)."""

    dimensions: int
    paths: list[Path]
    still: list[Array]
    sets: list[Array]


def sound(seen: Arrays) -> bool:
    """Return whether the arrays agree with each other: each may be forged by itself."""
    tracks, owners, at = seen["tracks"], seen["owners"], seen["at"]
    small = np.all(np.abs(tracks) < LARGEST) and np.all(np.abs(at) < LARGEST) and np.all(at[:, 2] >= 1)
    return bool(tracks.shape[:2] == (len(at), len(owners)) and small)


def pictures(seen: Arrays) -> list[Picture]:
    """Sort the points of ``seen`` by axes and artist; 2-D and 3-D axes never share a picture."""
    tracks, owners = np.swapaxes(seen["tracks"], 0, 1), seen["owners"]
    found = []
    for axes, dimensions in np.unique(np.abs(owners[owners[:, 1] != 0][:, [2, 1]]), axis=0):
        paths: list[Path] = []
        still: list[Array] = []
        here = (owners[:, 2] == axes) & (owners[:, 1] == dimensions)
        d = 3 if dimensions == 3 else 2
        for artist in np.unique(owners[here, 0]):
            points = tracks[here & (owners[:, 0] == artist)][:, :, :d]
            moves = np.ptp(points, axis=1).max(axis=1) > np.maximum(MOVES * np.abs(points).max(axis=(1, 2)), 1e-9)
            fixed = np.unique(points[~moves, 0], axis=0) if not moves.all() else points[:0, 0]
            if len(fixed):
                still.append(points[~moves, 0])
            for place in points[moves]:
                trail = bool(np.any(np.all(np.abs(fixed - place[0]) <= MOVES * np.ptp(place, axis=0).max(), axis=1)))
                if trail or not len(fixed):
                    paths.append(Path(int(artist), place, False, np.zeros(d)))
                else:
                    paths += [Path(int(artist), place - end, True, end) for end in points[~moves, 0][:FIRST_STILL]]
        ends = [path.places + path.origin for path in paths if path.bound]
        paths = [path for path in paths if path.bound or not any(_same(path.places, end) for end in ends)]
        sets = (owners[:, 2] == axes) & (owners[:, 1] == -dimensions)
        unordered = [np.swapaxes(tracks[sets & (owners[:, 0] == n)], 0, 1)[:, :, :d] for n in np.unique(owners[sets, 0])]
        found.append(Picture(d, paths, still, unordered))
    return found


def _arrow(points: Array) -> Array:
    """The one point (1, d) furthest from the tail at zero, where that is one of ``points`` (s, d), as of an arrow with a head."""
    lengths = np.linalg.norm(points, axis=1)
    far = points[lengths >= 0.99 * lengths.max()]
    single = lengths.min() <= MOVES * lengths.max() and np.ptp(far, axis=0).max() <= MOVES * lengths.max()
    return far[:1] if single else points[:0]


def _same(places: Array, others: Array) -> bool:
    """Whether two paths (f, d) are one: the tip of an arrow drawn once more, which then is no free point."""
    return bool(np.abs(places - others).max() <= MOVES * np.ptp(places, axis=0).max())


def changed(drawn: list[Picture]) -> int:
    """Return at how many frames a point of ``drawn`` is at another place than in the frame before."""
    everything = [path.places[:, None] for picture in drawn for path in picture.paths]
    everything += [points for picture in drawn for points in picture.sets]
    steps = [np.abs(np.diff(points, axis=0)).max(axis=(1, 2)) > MOVES * np.abs(points).max() for points in everything]
    return int(np.sum(np.any(steps, axis=0)))


def directions(picture: Picture, origins: list[Array]) -> tuple[Array, Array]:
    """Directions (k, d) that stay: those drawn by few points or along a line, and of these lines and arrows with a known tail.

    A tail is known at one of ``origins``, where what moves has its fixed end, or at the zero of the axes.
    """
    some, sure = [np.zeros((0, picture.dimensions))], [np.zeros((0, picture.dimensions))]
    tails = [np.zeros(picture.dimensions), *origins]
    for points in picture.still:
        steps = points - points[0]
        straight = len(points) > 1 and np.linalg.svd(steps, compute_uv=False)[1:].max(initial=0.0) <= MOVES * np.abs(steps).max()
        if not straight and len(points) > FEW:
            continue
        between = (points[None, :] - points[:, None])[np.triu_indices(len(points), 1)]
        some += [between, *(points - tail for tail in tails)]
        if straight:
            near = MOVES * np.abs(points).max()
            sure += [points - tail for tail in tails if np.linalg.norm(points - tail, axis=1).min() <= near]
        else:
            sure += [_arrow(points - tail) for tail in tails]
    return np.concatenate(some), np.concatenate(sure)
