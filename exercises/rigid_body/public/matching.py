"""Finding the body in a picture: points that follow it, a direction, or the camera it is seen by."""

from collections import Counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import cameras, timing
from .pictures import MOVES, Path, Picture

Array = NDArray[np.float64]

MISFIT = 0.03  # root mean square, relative to the path's: 1 % of ê₃'s length here; linear interpolation costs a tenth of it
HOPEFUL = 0.5  # the same before times are fitted: 1.5 samples of the fastest turn here cost a third
TRIES = 6  # paths whose times are fitted, the best first
REFINED = 3  # rounds in which times and perspective are fitted in turn
NEAREST = 0.5  # inverse of the distance of a camera from the centre, in lengths of the axis
SKEW = 0.1  # sine of the angle between the line of sight and the normal of the drawing
MOST_SAMPLES = 400  # of a motion: laws grow with their square
MOST_PATHS = 64  # that are compared with a curve at any time, which only explains a verdict


class Motion:
    """R (n, 3, 3) at times ``t`` (n,), with the curves and laws that an animation is compared with.

    L (3,) and the half edges ``half`` (3,) of the box are given if they are drawn.
    """

    def __init__(self, at: Array, t: Array, R: Array, L: Array | None, axis: int | None, *, half: Array | None = None) -> None:
        from scipy.interpolate import CubicSpline

        n = len(t)
        spline, samples = CubicSpline(np.arange(n), R.reshape(n, 9)), np.arange((n - 1) * timing.PER + 1) / timing.PER
        self.L, self.axis, self.half, self.n = L, axis, half, n
        self.R = spline(samples).reshape(-1, 3, 3)
        spin = np.swapaxes(self.R, 1, 2) @ spline(samples, 1).reshape(-1, 3, 3)
        self.w = np.einsum("gij,gj->gi", self.R, spin[:, [2, 0, 1], [1, 2, 0]])  # in space, up to its unit
        self.turned = self._turns(R[:, :, axis], L) if L is not None and axis is not None else self._angle()
        self.laws = timing.laws(at, t, self.turned)

    def _turns(self, tips: Array, L: Array) -> Array:
        """Return the turns of the axis about L since the start (n,)."""
        z = L / np.linalg.norm(L)
        across = tips - np.outer(tips @ z, z)
        if np.linalg.norm(across, axis=1).min() < 1e-6:
            return self._angle()
        x = across[0] / np.linalg.norm(across[0])
        angle = np.unwrap(np.arctan2(across @ np.cross(z, x), across @ x))
        return np.asarray(np.maximum.accumulate(np.abs(angle)) / (2 * np.pi))

    def _angle(self) -> Array:
        """Return the turns of the body since the start (n,)."""
        speed = np.linalg.norm(self.w, axis=1)
        angle = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])[:: timing.PER]
        return np.asarray(angle / (2 * np.pi * timing.PER))


class Match(NamedTuple):
    """Body points p (3, v) that ``paths`` follow, at ``times`` (f,)."""

    times: Array
    points: Array
    paths: list[Path]


def fewer(at: Array, t: Array, R: Array) -> tuple[Array, Array, Array]:
    """Return a motion of at most MOST_SAMPLES at even steps of its sample numbers, and the frames counted in these."""
    from scipy.interpolate import CubicSpline

    n = len(t)
    if n <= MOST_SAMPLES:
        return at, t, R
    kept, share = np.linspace(0, n - 1, MOST_SAMPLES), (MOST_SAMPLES - 1) / (n - 1)
    number, value, total = at.T
    indices = bool(np.all(value == np.rint(value)))
    counted = np.column_stack([number * share, value * share if indices else value, 1 + (total - 1) * share])
    return counted, np.interp(kept, np.arange(n), t), CubicSpline(np.arange(n), R.reshape(n, 9))(kept).reshape(-1, 3, 3)


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


def own_camera(picture: Picture, motion: Motion, laws: Array) -> tuple[Array, Array, list[Array]] | None:
    """Return a camera, the times of the frames and the origins, found from a drawn direction or from the points of a body."""
    for path in picture.paths if motion.axis is not None else []:
        fit = _timed(motion.R[:, None, :, motion.axis], path.places[:, None, :], laws)
        camera = cameras.straightened(fit.coefficients.T) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, [path.origin] if path.bound else []
    for path in picture.paths if motion.axis is not None and picture.dimensions == 2 else []:
        if path.bound and (seen := _in_perspective(motion, path.places, laws)):
            return *seen, [path.origin]
    nine = np.concatenate([motion.R.reshape(-1, 1, 9), np.ones((len(motion.R), 1, 1))], axis=2)
    for paths in _bodies(picture):
        values = np.stack([path.places for path in paths], axis=1)
        fit = _timed(nine, values.reshape(len(values), 1, -1), laws)
        camera = cameras.of_body(fit.coefficients, nine[fit.grid, 0, :9], values) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, []
    return None


def _in_perspective(motion: Motion, drawn: Array, laws: Array) -> tuple[Array, Array] | None:
    """Return a camera (2, 3) and the times of the axis, whose tip p is ``drawn`` (f, 2) as M p / (1 − q·p).

    q points towards the viewer, which excludes mirror images. On the cone p·L is constant, so a multiple of L
    may be added to q and M scaled.
    """
    if motion.L is None:
        return None
    curve = motion.R[:, :, motion.axis]
    law = laws[int(np.argmin(timing.screened(curve[:, None], drawn[:, None, :], laws).sum(axis=1)))]
    times, none = law, np.zeros((len(drawn), 3))
    camera: Array | None = None
    for _ in range(REFINED):
        tip = curve[timing.on_grid(times, len(curve))]
        rows = [np.column_stack([*(tip if k == row else none for k in (0, 1)), drawn[:, [row]] * tip]) for row in (0, 1)]
        q = np.linalg.lstsq(np.concatenate(rows), drawn.T.ravel(), rcond=None)[0][6:]
        fit = _timed(curve[:, None], (drawn * (1 - tip @ q)[:, None])[:, None, :], law[None])
        camera = cameras.straightened(fit.coefficients.T) if fit else None
        if fit is None or camera is None:
            return None
        times = fit.times
    assert camera is not None
    L = motion.L / np.linalg.norm(motion.L)
    design = np.column_stack([L, np.cross(camera[0], camera[1])])
    along, near = np.linalg.lstsq(design, q, rcond=None)[0]
    scale = 1 - along * float(np.mean(curve @ L))
    if np.linalg.norm(design @ [along, near] - q) > SKEW * np.linalg.norm(q) or not 0 < near / scale < NEAREST:
        return None
    return camera, times


def _bodies(picture: Picture) -> list[list[Path]]:
    """Return groups of three or more paths that may belong to one body: of one artist, or of all artists with
    one or two paths.
    """
    groups: dict[tuple[str, int], list[Path]] = {}
    free = [path for path in picture.paths if not path.bound]
    owned = Counter(path.artist for path in free)
    for path in free:
        count = owned[path.artist]
        groups.setdefault(("artist", path.artist) if count > 2 else ("each", count), []).append(path)
    return [paths for paths in groups.values() if len(paths) > 2]


def _timed(basis: Array, drawn: Array, laws: Array) -> timing.Fit | None:
    share, whole = timing.screened(basis, drawn, laws), np.linalg.norm(timing.spread(drawn))
    k = int(np.argmin(np.linalg.norm(share, axis=1)))
    if np.linalg.norm(share[k]) > HOPEFUL * whole:
        return None
    return timing.found(basis, drawn, laws[k], float(MISFIT * whole))
