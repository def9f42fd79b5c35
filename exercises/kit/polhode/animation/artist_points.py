"""The points of a figure's artists: lines, arrows, polygons and markers of 2-D and 3-D axes, in data
coordinates.
"""

import re
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple
from weakref import ref

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_POINTS = 32  # of one artist: a box has 24
MOST_AXES = 64  # whose labels are read


class Drawn(NamedTuple):
    """An artist's points (n, 3), the first and last one first, n ≥ 0, in 2 or 3 ``dimensions``.

    ``key`` identifies it in the next frame: its axes, kind, and number among these from the newest on;
    ``oldest`` counts from the oldest. ``artist()`` is the artist, or None once it is gone.
    """

    key: tuple[int, str, int]
    oldest: int
    dimensions: int
    points: Array
    artist: Callable[[], Any]


def drawn(figure: Any) -> list[Drawn]:
    """Return the artists in the figure's axes; those of polar axes as x and y.

    Artists are counted from the newest of their kind: old ones may remain.
    """
    from matplotlib.spines import Spine

    found = []
    for number, axes in enumerate(figure.axes):
        if not axes.get_visible() or axes.get_xscale() != "linear" or axes.get_yscale() != "linear":
            continue
        dimensions = 3 if axes.name == "3d" else 2
        seen: Counter[str] = Counter()
        for artist in reversed(axes.get_children()):
            if not _shows(artist) or artist is axes.patch or isinstance(artist, Spine):
                continue
            try:
                points, itself = _points(artist), ref(artist)
            except Exception:  # noqa: S112 -- an artist that polhode cannot read is not the student's mistake
                continue
            if points is None or points.ndim != 2 or not 2 <= points.shape[1] <= 3:
                continue
            kind = type(artist).__name__
            seen[kind] += 1
            if dimensions == 2 and points.shape[1] == 2:
                points = _transformed(artist, axes, points)
            full = np.zeros((len(points), 3))
            full[:, : points.shape[1]] = points
            if axes.name == "polar":
                full[:, 0], full[:, 1] = full[:, 1] * np.cos(full[:, 0]), full[:, 1] * np.sin(full[:, 0])
            found.append(Drawn((number, kind, seen[kind]), 0, dimensions, _few(full), itself))
        counted = [
            d._replace(oldest=seen[d.key[1]] + 1 - d.key[2]) if d.key[0] == number else d for d in found
        ]
        found = counted
    return found


def _transformed(artist: Any, axes: Any, points: Array) -> Array:
    """Return the points (n, 2) after the artist's own transform, such as a patch's rotation, in data
    coordinates.
    """
    from matplotlib.artist import Artist

    own = Artist.get_transform(artist)
    if own == axes.transData or not own.contains_branch(axes.transData):
        return points
    return np.asarray((own - axes.transData).transform(points))


def labelled(figure: Any) -> Array:
    """Return the coordinates that the labels of 2-D axes name, as rows (number of the axes, horizontal,
    vertical): 0, 1, 2 for x, y, z.

    A label names a coordinate if its first word is that letter; −1 if not, −2 for polar axes. One row of −1
    if there are no 2-D axes.
    """
    rows = [
        [
            number,
            *((-2, -2) if axes.name == "polar" else map(_coordinate, (axes.get_xlabel(), axes.get_ylabel()))),
        ]
        for number, axes in enumerate(figure.axes)
        if axes.name != "3d"
    ]
    return np.array(rows[:MOST_AXES] or [[-1, -1, -1]], dtype=float)


def _coordinate(label: str) -> int:
    first = re.match(r"[\W_]*([xyz])(?![\w'′])", label.lower())
    return "xyz".index(first[1]) if first else -1


def unordered(frames: list[list[Drawn]]) -> dict[tuple[int, str], list[Drawn]]:
    """Return, for artists of a kind whose points may change order or number, the distinct points of all of
    them in each frame.

    They are equally many in each frame, the first one repeated; by axes and kind, for 3 to MOST_POINTS
    points.
    """
    found: dict[tuple[int, str], list[Drawn]] = {}
    for key in dict.fromkeys(d.key[:2] for d in frames[0]):
        alike = [[d for d in frame if d.key[:2] == key] for frame in frames]
        points = [
            _distinct(np.concatenate([np.zeros((0, 3)), *(d.points for d in artists)])) for artists in alike
        ]
        counts = [[len(d.points) for d in artists] for artists in alike]
        changes = "Poly" in key[1] or any(count != counts[0] for count in counts)
        most, least = max(map(len, points)), min(map(len, points))
        if changes and least >= 3 and most < MOST_POINTS:
            same = [np.concatenate([p, np.repeat(p[:1], most - len(p), axis=0)]) for p in points]
            found[key] = [alike[0][0]._replace(points=p) for p in same]
    return found


def _distinct(points: Array) -> Array:
    finite = points[np.all(np.isfinite(points), axis=1)]
    size = np.abs(finite).max(initial=0.0)
    return (
        finite[np.unique(np.rint(finite / size * 1e6), axis=0, return_index=True)[1]] if size else finite[:1]
    )


def painted(figure: Any) -> int:
    """Return the number of images without points in the figure, plus axes with uneven coordinates."""
    from matplotlib.collections import QuadMesh
    from matplotlib.image import _ImageBase

    shown = [a for axes in figure.axes for a in axes.get_children() if isinstance(a, _ImageBase | QuadMesh)]
    uneven = [
        axes
        for axes in figure.axes
        if axes.name not in ("rectilinear", "3d", "polar") or axes.get_xscale() != "linear"
    ]
    return len(shown) + len(figure.images) + len(uneven)


def _shows(artist: Any) -> bool:
    return bool(artist.get_visible()) and not (np.isscalar(artist.get_alpha()) and artist.get_alpha() == 0)


def _few(points: Array) -> Array:
    """Return at most MOST_POINTS of the points: the first, the last (of one point the same), then evenly
    between.
    """
    between = np.arange(1, len(points) - 1)
    if len(between) > MOST_POINTS - 2:
        between = np.linspace(1, len(points) - 2, MOST_POINTS - 2).round().astype(int)
    return points[[0, -1, *between]] if len(points) else points


def _points(artist: Any) -> Array | None:
    for read in (_line, _segments, _faces, _markers, _arrows, _patch):
        found = read(artist)
        if found is not None:
            return np.asarray(np.ma.filled(found, np.nan), dtype=float)
    return None


def _line(artist: Any) -> Any:
    if hasattr(artist, "get_data_3d"):
        return np.column_stack([np.ravel(x) for x in artist.get_data_3d()])
    return artist.get_xydata() if hasattr(artist, "get_xydata") else None


def _segments(artist: Any) -> Any:
    found = getattr(artist, "_segments3d", None)
    if found is None and hasattr(artist, "get_segments"):
        found = artist.get_segments()
    if found is None:
        return None
    dimensions = 3 if len(found) and np.shape(found[0])[-1] == 3 else 2
    return np.concatenate([np.empty((0, dimensions)), *found])


def _faces(artist: Any) -> Any:
    found = getattr(artist, "_faces", None)
    if found is None and hasattr(artist, "_vec"):
        found = np.asarray(artist._vec).T[:, :3]
    return None if found is None else np.ma.filled(np.ma.asarray(found, dtype=float), np.nan).reshape(-1, 3)


def _markers(artist: Any) -> Any:
    found = getattr(artist, "_offsets3d", None)
    if found is not None:
        return np.column_stack([np.ma.filled(np.ma.ravel(x).astype(float), np.nan) for x in found])
    return (
        artist.get_offsets()
        if hasattr(artist, "get_offsets") and not hasattr(artist, "U") and _has_own(artist)
        else None
    )


def _has_own(artist: Any) -> bool:
    offsets = np.asarray(artist.get_offsets())
    return offsets.ndim == 2 and bool(offsets.any())


def _arrows(artist: Any) -> Any:
    """Return a 2-D quiver's tails and tips."""
    if not hasattr(artist, "U"):
        return None
    tails = np.asarray(artist.get_offsets(), dtype=float)
    return np.concatenate([tails, tails + np.column_stack([np.ravel(artist.U), np.ravel(artist.V)])])


def _patch(artist: Any) -> Any:
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import FancyArrowPatch, Patch

    if isinstance(artist, FancyArrowPatch):
        return (
            _remembered(artist)
            if getattr(artist.axes, "name", "") == "3d"
            else getattr(artist, "_posA_posB", None)
        )
    if isinstance(artist, Patch):
        path = artist.get_patch_transform().transform_path(artist.get_path())
        return path.vertices
    if isinstance(artist, PolyCollection):
        return np.concatenate([path.vertices for path in artist.get_paths()] or [np.empty((0, 2))])
    return getattr(artist, "xyann", None) and np.array([artist.xyann, artist.xy])


def _remembered(artist: Any) -> Any:
    """Return the ends of a 3-D arrow defined by the student: matplotlib has none, so each stores them under
    its own name.
    """
    from matplotlib.patches import FancyArrowPatch

    own = set(vars(artist)) - set(vars(FancyArrowPatch((0, 0), (1, 1))))
    points = []
    for name in sorted(own):
        try:
            value = np.array(vars(artist)[name], dtype=float)
        except (TypeError, ValueError):
            continue
        if value.shape in ((2, 3), (3,)):
            points.append(value.reshape(-1, 3))
        elif value.shape == (3, 2):
            points.append(value.T)
    return np.concatenate(points) if points else None
