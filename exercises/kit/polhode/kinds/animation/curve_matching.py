"""Finding curves in a picture: the paths that follow them, the times of the frames, and known mistakes."""

import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from polhode.kinds.animation import cameras, frame_times
from polhode.kinds.animation.drawn_paths import MOVES, Path, Picture
from polhode.kinds.animation.frame_times import Array, Frames
from polhode.kinds.animation.visibility import Shown

# root mean square, relative to the path's: 1 % of an arrow's length here; linear interpolation costs a tenth
# of it
MISFIT = 0.03
HOPEFUL = 0.5  # the same before times are fitted: 1.5 samples of the fastest turn here cost a third
TRIES = 6  # paths whose times are fitted, the best first
MOST_SAMPLES = 400  # of a motion: laws grow with their square
MOST_PATHS = 64  # that are compared with a curve at any time, which only explains a verdict


class Match(NamedTuple):
    """Points p (m, v) of a body, or multiples of a direction or trajectory, that ``paths`` follow at
    ``times`` (f,).

    ``fit`` is that of the one path from which the times were found.
    """

    times: Array
    points: Array
    paths: list[Path]
    fit: frame_times.Fit

    def by_artist(self) -> list[tuple[Array, bool]]:
        """Return the points (m, k) of each artist, and whether they are seen from a fixed end."""
        artists = np.array([path.artist for path in self.paths])
        bound = {path.artist: path.bound for path in reversed(self.paths)}
        return [(self.points[:, artists == artist], bound[artist]) for artist in sorted(bound)]


def finely(at: Array, t: Array, values: Array) -> tuple[Array, Array, Array, Array]:
    """Return frames ``at`` (f, 3), times t (n,), and a motion, ``values`` (n, …), on the grid of times, with
    its rates.

    At most MOST_SAMPLES samples are kept, in even steps; frames and rates are then counted in these.
    """
    from scipy.interpolate import CubicSpline

    n, kept = len(t), min(len(t), MOST_SAMPLES)
    share, grid = (kept - 1) / (n - 1), np.linspace(0, n - 1, (kept - 1) * frame_times.PER + 1)
    number, value, total = at.T
    counted = np.column_stack(
        [number * share, value * (share if np.all(value == np.rint(value)) else 1), 1 + (total - 1) * share]
    )
    spline = CubicSpline(np.arange(n), values.reshape(n, -1))
    curve, rate = (x.reshape(-1, *values.shape[1:]) for x in (spline(grid), spline(grid, 1) / share))
    return counted, np.interp(grid[:: frame_times.PER], np.arange(n), t), curve, rate


def matches(
    picture: Picture, curves: Array, laws: Array, *, shift: bool = True, limit: float = MISFIT
) -> Iterator[Match]:
    """Yield the paths that are ``curves`` (G, d, m) times points p (m,), with times found from one of them,
    the best first.

    Paths from a fixed end are not shifted, others by a constant if ``shift``. A single curve (m = 1) is not
    reversed.
    """
    (G, d, m), kinds, tried = curves.shape, [], []
    shifted = np.concatenate([curves, np.broadcast_to(np.eye(d), (G, d, d))], axis=2) if shift else curves
    for bound, basis in ((True, curves), (False, shifted)):
        paths = [path for path in picture.paths if path.bound == bound]
        if paths and len(laws):
            places = np.stack([path.places for path in paths], axis=2)
            kinds.append((paths, places, basis))
            share = np.round(frame_times.screened(basis, places, laws) / frame_times.spread(places), 6)
            tried += [
                (share[k, v], laws[k], places[:, :, [v]], basis)
                for v, k in enumerate(np.argmin(share, axis=0))
            ]
    for share, law, one, functions in sorted(tried, key=lambda fit: float(fit[0]))[:TRIES]:
        fit = frame_times.found(functions, one, law, limit) if share <= HOPEFUL else None
        if fit is None or (m == 1 and fit.coefficients[0, 0] <= 0):
            continue
        points, followed = [], list[Path]()
        for paths, places, basis in kinds:
            coefficients = frame_times.coefficients_at(basis, places, fit.grid)
            misfits = frame_times.misfits(basis[fit.grid] @ coefficients - places)
            ok = misfits <= limit * frame_times.spread(places)
            points.append(coefficients[:m, ok])
            followed += [path for path, good in zip(paths, ok, strict=True) if good]
        yield Match(fit.times, np.concatenate(points, axis=1), followed, fit)


def matched(
    picture: Picture, curves: Array, laws: Array, *, shift: bool = True, limit: float = MISFIT
) -> Match | None:
    """Return the first of ``matches``, or None."""
    return next(matches(picture, curves, laws, shift=shift, limit=limit), None)


def together(basis: Array, drawn: Array, laws: Array, limit: float = MISFIT) -> frame_times.Fit | None:
    """Return the fit of all paths (f, e, v) together, at the best of the times that ``laws`` allow; None if
    there is none.
    """
    if not len(laws):
        return None
    share, whole = (
        np.linalg.norm(frame_times.screened(basis, drawn, laws), axis=1),
        np.linalg.norm(frame_times.spread(drawn)),
    )
    k = int(np.argmin(share))
    return frame_times.found(basis, drawn, laws[k], limit) if share[k] <= HOPEFUL * whole else None


class Mistake(NamedTuple):
    """A known mistake: ``curves`` (G, k, m) of k coordinates are drawn at the times of ``laws`` (l, f), or
    for None at any times.

    The ``sentence`` may have one place {} for what is wrong with the times. Curves that are points of a body
    (m = 3) or have ``shift`` may be drawn anywhere. ``meant(match)`` returns whether a match counts.
    """

    code: str
    sentence: str
    curves: Array
    laws: Array | None
    shift: bool = True
    meant: Callable[[Match], bool] = lambda match: True


def instead(
    drawn: list[Picture], mistakes: Iterable[Mistake], frames: Frames, limit: float = MISFIT
) -> Iterator[Shown]:
    """Yield the ``mistakes`` that the pictures show, in coordinates as they are."""
    for picture, (code, sentence, x, laws, shift, meant) in itertools.product(drawn, mistakes):
        for curves in (view @ x for view in cameras.plain(picture.dimensions, picture.plane, x.shape[1])):
            if laws is None:
                how = _at_any_time(picture, curves[:, :, 0], frames.at)
            else:
                match = matched(picture, curves, laws, shift=shift, limit=limit)
                how = frames.wrong(match.times) if match and meant(match) else ""
            if how:
                yield Shown(False, code, sentence.format(how))


def _at_any_time(picture: Picture, curve: Array, at: Array) -> str:
    """Return what the most mistimed frame shows, if a path keeps to ``curve`` (G, d) but at no times that a
    law allows; else "".
    """
    from scipy.spatial import KDTree

    even = at[:, 0] / np.maximum(at[:, 2] - 1, 1) * (len(curve) - 1)
    total, tree = at[0, 2], KDTree(curve)
    for path in picture.paths[:MOST_PATHS]:
        scale, spread = (
            np.sqrt(np.mean(path.places**2) / np.mean(curve**2)),
            np.std(path.places - path.places.mean(axis=0)),
        )
        for turn in range(4):
            nearest = curve[tree.query(path.places / scale)[1]]
            scale = np.sum(path.places * nearest) / np.sum(nearest**2)
            left = np.sqrt(np.mean((path.places - scale * nearest) ** 2))
            if scale <= 0 or (turn and left > HOPEFUL * spread):
                break
        if scale > 0 and left <= MISFIT * spread:
            distance = np.linalg.norm(path.places[:, None] - scale * curve, axis=2)
            same = distance <= distance.min(axis=1, keepdims=True) + 2 * MISFIT * scale * np.linalg.norm(
                curve[0]
            )
            off = np.where(
                same, np.abs(np.arange(len(curve)) - even[:, None]), np.inf
            )  # the curve may return to a place
            moves = np.any(np.abs(np.diff(path.places, axis=0)) > MOVES * np.abs(path.places).max(), axis=1)
            if (until := at[int(np.flatnonzero(moves)[-1]) + 1, 0]) < (1 - frame_times.HELD) * (total - 1):
                return (
                    f"its samples are mistimed: from frame {until:.0f} of {total:.0f} on the picture stands"
                    " still"
                )
            k = int(np.argmax(off.min(axis=1)))
            return (
                f"its samples are mistimed: frame {at[k, 0]:.0f} of {total:.0f} shows sample"
                f" {np.argmin(off[k]) / frame_times.PER:.0f}"
            )
    return ""
