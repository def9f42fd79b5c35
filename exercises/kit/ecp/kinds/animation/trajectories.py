"""Whether something drawn follows given trajectories, as they are up to one scale and origin in each axes.

A trajectory in space may also be drawn in a plane: in two of its coordinates, or by the student's own
projection. The times of the frames are free within limits (``timing``).
"""

import itertools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ecp.checks import Arrays
from ecp.kinds.animation import cameras, timing
from ecp.kinds.animation.matching import HOPEFUL, TRIES, Mistake, finely, instead, matches, stacked, together
from ecp.kinds.animation.pictures import Path, Picture
from ecp.kinds.animation.shown import Shown, judged, remembered
from ecp.kinds.animation.timing import Array, Frames

Curves = Mapping[str, Array]

SOME = 0.03  # of a trajectory's extent along its longest direction: it extends along another one


class Fit(NamedTuple):
    """The times (f,) at which trajectories are followed, and the ``misfit`` of each of these by name.

    ``as_given``: whether they are drawn in the coordinates in which they are given.
    """

    times: Array
    misfit: dict[str, float]
    as_given: bool = False


def followed(seen: Arrays, t: Array, trajectories: Curves, limit: float) -> dict[str, Shown]:
    """Return for each of the ``trajectories`` (n, 2) or (n, 3), at times (n,), whether something drawn follows it.

    The misfit of a path is its root mean square distance from the drawn trajectory, relative to the
    trajectory's extent, or that of the worst frame over timing.WORST if this is more. It is at most ``limit``.
    """

    def compared(drawn: list[Picture]) -> dict[str, Shown]:
        return _compared(drawn, seen["at"], t, trajectories, limit)

    return remembered(seen, (t, dict(trajectories), limit), lambda: judged(seen, len(t), trajectories, compared))


def _compared(drawn: list[Picture], at: Array, t: Array, trajectories: Curves, limit: float) -> dict[str, Shown]:
    """Return for each trajectory what the pictures show of it."""
    at, t, fine, _ = finely(at, t, np.stack(list(trajectories.values()), axis=2))
    curves = dict(zip(trajectories, np.moveaxis(fine, 2, 0), strict=True))
    frames, found = Frames(at, t, np.linspace(0, 1, len(t))), dict[str, Shown]()
    free = [_with_free_paths(picture) for picture in drawn]
    for picture in free:
        shown = _in_picture(picture, curves, frames, limit)
        found |= {name: one for name, one in shown.items() if name not in found or (one.found and not found[name].found)}
    for name in (name for name in curves if name not in found):
        wrong = (one for picture in free for one in instead(picture, *_mistakes(picture, name, curves, frames), frames, limit))
        found[name] = next(wrong, Shown(False, "wrong-motion", f"nothing that moves follows {name}"))
    return found


def _with_free_paths(picture: Picture) -> Picture:
    """Return the picture with each path once, relative to the axes, and first the centres of artists of several points."""
    points = {(path.artist, np.round(at, 12).tobytes()): at for path in picture.paths for at in [path.places + path.origin]}
    artists = [np.stack([at for (of, _), at in points.items() if of == artist]) for artist in dict.fromkeys(of for of, _ in points)]
    centres = [(some.min(axis=0) + some.max(axis=0)) / 2 for some in artists if len(some) > 2]
    moving = [at for at in centres if timing.spread(at[:, :, None])[0] > 0]
    return picture._replace(paths=[Path(0, at, False, np.zeros(picture.dimensions)) for at in (*moving, *points.values())])


def _in_picture(picture: Picture, curves: Curves, frames: Frames, limit: float) -> dict[str, Shown]:
    """Return the trajectories that the paths of one axes follow, by the view that shows most of them."""
    best, mislabelled, views = Fit(np.zeros(0), {}), dict[str, Shown](), _views(picture, curves)
    for view in views:
        fit = _best(_by_view(picture, {name: x @ view.T for name, x in curves.items()}, frames.laws, limit), len(curves))
        if view.shape == (2, 3) and (wrong := cameras.mislabelled(picture.plane, view)):
            mislabelled |= {name: Shown(False, "mirrored", wrong) for name in fit.misfit}
            continue
        best = max(best, fit, key=_followed)
        if len(best.misfit) == len(curves):
            break
    if not best.misfit and not mislabelled and views[0].shape == (2, 3):
        best = _best(_by_projection(picture, curves, frames.laws, limit), len(curves))
    seen = frames.covered(best.times) if best.misfit else ""
    return mislabelled | {name: Shown(True, None, seen, misfit=misfit) for name, misfit in best.misfit.items()}


def _best(fits: Iterator[Fit], trajectories: int) -> Fit:
    """Return the fit of most trajectories: the first of all of them if there is one, else rather as given."""
    best = Fit(np.zeros(0), {})
    for fit in fits:
        best = max(best, fit, key=_followed)
        if len(best.misfit) == trajectories:
            break
    return best


def _followed(fit: Fit) -> tuple[int, bool]:
    return len(fit.misfit), fit.as_given


def _views(picture: Picture, curves: Curves) -> list[Array]:
    """Return the matrices that draw coordinates as they are, in a plane any two of three."""
    d = next(iter(curves.values())).shape[1]
    if d == picture.dimensions:
        return [np.eye(d)]
    return [plane if d == 3 else plane.T for plane in cameras.plain(2, picture.plane)]


def _by_view(picture: Picture, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how the paths follow curves (G, d), with one scale and origin for all, found from one of them."""
    constant = np.broadcast_to(np.eye(picture.dimensions), (len(next(iter(curves.values()))), *[picture.dimensions] * 2))
    bases = {name: np.concatenate([x[:, :, None], constant], axis=2) for name, x in curves.items()}
    for curve in sorted(curves.values(), key=lambda x: -float(np.ptp(x, axis=0).max())):
        for match in matches(picture, curve[:, :, None], laws, limit=limit):
            yield _together(bases, np.moveaxis(stacked(picture.paths), 2, 0)[..., None], match.fit, limit)


def _by_projection(picture: Picture, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how the paths follow curves (G, 3) by a projection of the student's own."""
    bases = {name: np.concatenate([x, np.ones((len(x), 1))], axis=1)[:, None] for name, x in curves.items()}
    for (name, basis), path in itertools.product(bases.items(), picture.paths[:TRIES]):
        fit = together(basis, path.places[:, None], laws, limit)
        if fit and _is_projection(fit.coefficients[:3].T, curves[name]):
            yield _together(bases, np.moveaxis(stacked(picture.paths), 2, 0)[:, :, None], fit, limit)


def _together(bases: Curves, paths: Array, fit: timing.Fit, limit: float) -> Fit:
    """Return the trajectories that ``paths`` (v, f, e, c) follow together, beginning with the coefficients and times of one."""
    chosen = {}
    for name, basis in bases.items():
        drawn = basis[fit.grid] @ fit.coefficients
        off = np.sqrt(np.mean((paths - drawn) ** 2, axis=(1, 2, 3)))
        if off.min() <= HOPEFUL * _extent(drawn):
            chosen[name] = paths[int(np.argmin(off))]
    while chosen:
        basis = np.concatenate([bases[name] for name in chosen], axis=1)
        fit = timing.fitted(basis, np.concatenate(list(chosen.values()), axis=1), fit.law)
        misfit = {name: _misfit(path, bases[name][fit.grid] @ fit.coefficients) for name, path in chosen.items()}
        worst = max(misfit, key=lambda name: misfit[name])
        if misfit[worst] <= limit:
            given = fit.coefficients[:, 0] - np.eye(len(fit.coefficients))[0]
            return Fit(fit.times, misfit, bool(np.abs(given).max() <= limit))
        del chosen[worst]
    return Fit(fit.times, {})


def _extent(drawn: Array) -> float:
    return float(np.sqrt(np.mean((drawn - drawn.mean(axis=0)) ** 2)))


def _misfit(path: Array, drawn: Array) -> float:
    off, extent = timing.misfits((path - drawn).reshape(len(path), -1, 1))[0], _extent(drawn)
    return float(off / extent) if extent > 0 else np.inf


def _is_projection(matrix: Array, curve: Array) -> bool:
    """Return whether a fitted ``matrix`` (2, 3) may be a camera; only its effect on the directions of the curve is known."""
    _, sizes, directions = np.linalg.svd(curve - curve.mean(axis=0), full_matrices=False)
    along = directions[sizes > SOME * sizes[0]]
    return cameras.straightened(matrix) is not None if len(along) == 3 else np.linalg.matrix_rank(matrix @ along.T, SOME) > 0


def _mistakes(picture: Picture, name: str, curves: Curves, frames: Frames) -> tuple[list[Array], list[Mistake]]:
    """Return the views of a trajectory that nothing follows, and how it may be drawn: in other coordinates, or at other times."""
    curve, xyz = curves[name], "xyz"[: curves[name].shape[1]]
    elsewhere = f"{name} is drawn at another scale or place than the others: draw all as they are"
    mirrors = {f"the sign of {x} reversed": np.where(np.array(list(xyz)) == x, -1, 1) * curve for x in xyz}
    for i, k in itertools.combinations(range(len(xyz)), 2):
        order = [{i: k, k: i}.get(j, j) for j in range(len(xyz))]
        mirrors[f"{xyz[i]} and {xyz[k]} exchanged"] = curve[:, order]
    wrong: list[tuple[str, str, Array, Array | None]] = [("wrong-proportions", elsewhere, curve, frames.laws)]
    wrong += [("mirrored", f"{name} is drawn with {how}", mirrored, frames.laws) for how, mirrored in mirrors.items()]
    wrong += [("wrong-frames", f"the motion of {name} is drawn backwards in time", curve, (frames.n - 1) - frames.laws)]
    wrong += [("wrong-frames", f"{name} is drawn, but {{}}", curve, laws) for laws in (frames.late, None)]
    return _views(picture, curves), [Mistake(code, sentence, x[:, :, None], laws) for code, sentence, x, laws in wrong]
