"""Finding curves in a picture: the paths that follow them, and the times of the frames."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import timing
from ecp.kinds.animation.pictures import MOVES, Path, Picture

Array = NDArray[np.float64]

MISFIT = 0.03  # root mean square, relative to the path's: 1 % of ê₃'s length here; linear interpolation costs a tenth of it
HOPEFUL = 0.5  # the same before times are fitted: 1.5 samples of the fastest turn here cost a third
TRIES = 6  # paths whose times are fitted, the best first
MOST_SAMPLES = 400  # of a motion: laws grow with their square
MOST_PATHS = 64  # that are compared with a curve at any time, which only explains a verdict


class Match(NamedTuple):
    """Points p (3, v) of a body that ``paths`` follow, at ``times`` (f,)."""

    times: Array
    points: Array
    paths: list[Path]


def finely(values: Array) -> tuple[Array, Array]:
    """Return values (n, …) on the grid of times, and their rates of change per sample."""
    from scipy.interpolate import CubicSpline

    n = len(values)
    spline, samples = CubicSpline(np.arange(n), values.reshape(n, -1)), np.arange((n - 1) * timing.PER + 1) / timing.PER
    return spline(samples).reshape(-1, *values.shape[1:]), spline(samples, 1).reshape(-1, *values.shape[1:])


def fewer(at: Array, t: Array, values: Array) -> tuple[Array, Array, Array]:
    """Return a motion, ``values`` (n, …) at times (n,), at MOST_SAMPLES even steps of its sample numbers if it has more, and the
    frames counted in these.
    """
    from scipy.interpolate import CubicSpline

    n = len(t)
    if n <= MOST_SAMPLES:
        return at, t, values
    kept, share = np.linspace(0, n - 1, MOST_SAMPLES), (MOST_SAMPLES - 1) / (n - 1)
    number, value, total = at.T
    indices = bool(np.all(value == np.rint(value)))
    counted = np.column_stack([number * share, value * share if indices else value, 1 + (total - 1) * share])
    few = CubicSpline(np.arange(n), values.reshape(n, -1))(kept).reshape(-1, *values.shape[1:])
    return counted, np.interp(kept, np.arange(n), t), few


def matched(picture: Picture, curves: Array, laws: Array) -> Match | None:
    """Return the points of the body among the paths, if ``curves`` (G, d, 3) times p is how body point p is drawn."""
    fits, (kinds, shift) = [], _kinds(picture, curves)
    for bound, paths in kinds:
        if not paths:
            continue
        basis = curves if bound else np.concatenate([curves, shift], axis=2)
        values = np.stack([path.places for path in paths], axis=2)
        share = timing.screened(basis, values, laws) / timing.spread(values)
        fits += [(share[k, v], k, v, basis, values) for v in range(len(paths)) for k in [int(np.argmin(share[:, v]))]]
    fits.sort(key=lambda fit: float(fit[0]))
    for share, k, v, basis, values in fits[:TRIES]:
        if share > HOPEFUL:
            break
        fit = timing.found(basis, values[:, :, [v]], laws[k], MISFIT * timing.spread(values[:, :, [v]])[0])
        if fit:
            return _all_at(fit.grid, kinds, curves, shift)
    return None


def matched_at(picture: Picture, curves: Array, times: Array) -> Match:
    """Return the points of the body among the paths at ``times`` (f,)."""
    kinds, shift = _kinds(picture, curves)
    return _all_at(timing.on_grid(times, len(curves)), kinds, curves, shift)


def _kinds(picture: Picture, curves: Array) -> tuple[list[tuple[bool, list[Path]]], Array]:
    """Return the paths from a fixed end and the others, and the functions of time that are the others'
    constant shift.
    """
    d = picture.dimensions
    kinds = [(bound, [path for path in picture.paths if path.bound == bound]) for bound in (True, False)]
    return kinds, np.broadcast_to(np.eye(d), (len(curves), d, d))


def _all_at(grid: timing.Indices, kinds: list[tuple[bool, list[Path]]], curves: Array, shift: Array) -> Match:
    """Return which of the paths are points of the body at the times of ``grid``."""
    points, followed = [np.zeros((3, 0))], []
    for bound, paths in kinds:
        if not paths:
            continue
        basis = curves if bound else np.concatenate([curves, shift], axis=2)
        values = np.stack([path.places for path in paths], axis=2)
        coefficients = timing.coefficients_at(basis, values, grid)
        left = np.einsum("fem,mv->fev", basis[grid], coefficients) - values
        whole, worst = timing.misfits(left)
        ok = timing.Fit(grid / timing.PER, grid, coefficients, whole, worst).within(MISFIT * timing.spread(values))
        points.append(coefficients[:3, ok])
        followed += [path for path, good in zip(paths, ok, strict=True) if good]
    return Match(grid / timing.PER, np.concatenate(points, axis=1), followed)


def along(picture: Picture, curve: Array, laws: Array) -> timing.Fit | None:
    """Return the times of a path that is ``curve`` (G, d), scaled."""
    if not picture.paths:
        return None
    basis, values = curve[:, :, None], np.stack([path.places for path in picture.paths], axis=2)
    whole = timing.spread(values)
    share = timing.screened(basis, values, laws) / whole
    for v in np.argsort(share.min(axis=0))[:TRIES]:
        k = int(np.argmin(share[:, v]))
        if share[k, v] > HOPEFUL:
            break
        fit = timing.found(basis, values[:, :, [v]], laws[k], MISFIT * whole[v])
        if fit and fit.coefficients[0, 0] > 0:
            return fit
    return None


def at_any_time(picture: Picture, curve: Array, at: Array) -> str | None:
    """Return what the most mistimed frame shows, if a path keeps to ``curve`` (G, d) but at no times that a
    law allows.
    """
    from scipy.spatial import KDTree

    even = at[:, 0] / np.maximum(at[:, 2] - 1, 1) * (len(curve) - 1)
    total, tree = at[0, 2], KDTree(curve)
    for path in picture.paths[:MOST_PATHS]:
        scale, spread = np.sqrt(np.mean(path.places**2) / np.mean(curve**2)), np.std(path.places - path.places.mean(axis=0))
        left = np.inf
        for turn in range(4):
            if scale <= 0:
                break
            nearest = tree.query(path.places / scale)[1]
            scale = np.sum(path.places * curve[nearest]) / np.sum(curve[nearest] ** 2)
            left = np.sqrt(np.mean((path.places - scale * curve[nearest]) ** 2))
            if turn and left > HOPEFUL * spread:
                break
        if scale > 0 and left <= MISFIT * spread:
            distance = np.linalg.norm(path.places[:, None] - scale * curve, axis=2)
            same = distance <= distance.min(axis=1, keepdims=True) + 2 * MISFIT * scale * np.linalg.norm(curve[0])
            off = np.where(same, np.abs(np.arange(len(curve)) - even[:, None]), np.inf)  # the curve may return to a place
            moves = np.any(np.abs(np.diff(path.places, axis=0)) > MOVES * np.abs(path.places).max(), axis=1)
            if (until := at[int(np.flatnonzero(moves)[-1]) + 1, 0]) < (1 - timing.HELD) * (total - 1):
                return f"from frame {until:.0f} of {total:.0f} on the picture stands still"
            k = int(np.argmax(off.min(axis=1)))
            return f"frame {at[k, 0]:.0f} of {total:.0f} shows sample {np.argmin(off[k]) / timing.PER:.0f}"
    return None


def timed(basis: Array, drawn: Array, laws: Array) -> timing.Fit | None:
    """Return the fit of all paths (f, e, v) together, at the best of the times that ``laws`` allow; None if there is none."""
    share, whole = timing.screened(basis, drawn, laws), np.linalg.norm(timing.spread(drawn))
    k = int(np.argmin(np.linalg.norm(share, axis=1)))
    if np.linalg.norm(share[k]) > HOPEFUL * whole:
        return None
    return timing.found(basis, drawn, laws[k], float(MISFIT * whole))
