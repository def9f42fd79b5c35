"""Whether something drawn follows given trajectories, as they are up to one scale and origin in each axes.

A trajectory in space may also be drawn in a plane: in two of its coordinates, or by the student's own
projection. The times of the frames are free within limits (``timing``).
"""

import functools
import itertools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays
from ecp.kinds.animation import cameras, timing
from ecp.kinds.animation.matching import HOPEFUL, TRIES, at_any_time, fewer, finely
from ecp.kinds.animation.pictures import Path, Picture
from ecp.kinds.animation.shown import Shown, judged, samples

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

SOME = 0.03  # of a trajectory's extent along its longest direction: it extends along another one
_last: list[tuple[Arrays, dict[str, Shown]]] = []  # the last result of ``followed``, which several checks need


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
    for of, known in _last:
        if of is seen:
            return known
    once: list[tuple[int, dict[str, Shown]]] = []

    def compared(name: str, drawn: list[Picture]) -> tuple[int, Shown]:
        if not once:
            once.append(_compared(drawn, seen["at"], t, trajectories, limit))
        return once[0][0], once[0][1][name]

    found = {name: judged(seen, name, functools.partial(compared, name)) for name in trajectories}
    _last[:] = [(seen, found)]
    return found


def _compared(drawn: list[Picture], at: Array, t: Array, trajectories: Curves, limit: float) -> tuple[int, dict[str, Shown]]:
    """Return the number of samples, and for each trajectory what the pictures show of it."""
    at, t, few = fewer(at, t, np.concatenate(list(trajectories.values()), axis=1))
    widths = np.cumsum([x.shape[1] for x in trajectories.values()])[:-1]
    curves = dict(zip(trajectories, np.split(finely(few)[0], widths, axis=1), strict=True))
    laws, found = timing.laws(at, t, np.linspace(0, 1, len(t))), dict[str, Shown]()
    free = [_with_free_paths(picture) for picture in drawn]
    for picture in free:
        for name, shown in _in_picture(picture, curves, laws, limit, len(t)).items():
            if name not in found or (shown.found and not found[name].found):
                found[name] = shown
    for name in curves:
        if name not in found:
            instead = (shown for picture in free for shown in _otherwise(picture, name, curves, at, len(t), laws=laws, limit=limit))
            found[name] = next(instead, Shown(False, "wrong-motion", f"nothing that moves follows {name}"))
    return len(t), found


def _with_free_paths(picture: Picture) -> Picture:
    """Return the picture with each path once, relative to the axes, and first the centres of artists of several points."""
    points = {
        (path.artist, np.round(place, 12).tobytes()): place for path in picture.paths for place in [path.places + path.origin]
    }
    free = [Path(artist, place, False, np.zeros(picture.dimensions)) for (artist, _), place in points.items()]
    groups = [np.stack([path.places for path in free if path.artist == artist]) for artist in dict.fromkeys(p.artist for p in free)]
    centres = [(some.min(axis=0) + some.max(axis=0)) / 2 for some in groups if len(some) > 2]
    moving = [place for place in centres if timing.spread(place[:, :, None])[0] > 0]
    return picture._replace(paths=[Path(0, place, False, np.zeros(picture.dimensions)) for place in moving] + free)


def _in_picture(picture: Picture, curves: Curves, laws: Array, limit: float, n: int) -> dict[str, Shown]:
    """Return the trajectories that the paths of one axes follow."""
    if not picture.paths or not len(laws):
        return {}
    places, best, mislabelled = np.stack([path.places for path in picture.paths], axis=2), Fit(np.zeros(0), {}), dict[str, Shown]()
    for view in _views(picture, curves):
        fit = _best(_by_view(places, {name: x @ view.T for name, x in curves.items()}, laws, limit), len(curves))
        if wrong := _mislabelled(picture, view):
            mislabelled |= {name: Shown(False, "mirrored", wrong) for name in fit.misfit}
            continue
        best = max(best, fit, key=_followed)
        if len(best.misfit) == len(curves):
            break
    if not best.misfit and not mislabelled and picture.dimensions == 2 and all(x.shape[1] == 3 for x in curves.values()):
        best = _best(_by_projection(places, curves, laws, limit), len(curves))
    return mislabelled | {name: Shown(True, None, samples(best.times, n), misfit=misfit) for name, misfit in best.misfit.items()}


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
    of = {x.shape[1] for x in curves.values()}
    if of == {picture.dimensions}:
        return [np.eye(picture.dimensions)]
    planes = cameras.plain(2, picture.plane)
    return planes if of == {3} else [plane.T for plane in planes]


def _mislabelled(picture: Picture, view: Array) -> str:
    """Return which coordinates are drawn instead of those that the labels of the axes name, or ""."""
    shown = tuple(int(k) for k in np.argmax(view, axis=1))
    if view.shape != (2, 3) or picture.plane in (None, shown):
        return ""
    names = [" and ".join("xyz"[k] for k in plane) for plane in (picture.plane or (), shown)]
    return f"axes labelled {names[0]} show {names[1]}"


def _by_view(places: Array, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how ``places`` (f, d, v) follow curves (G, d), with one scale and origin for all, found from one of them."""
    d, whole, paths = places.shape[1], timing.spread(places), np.moveaxis(places, 2, 0)[..., None]
    bases = {
        name: np.concatenate([x[:, :, None], np.broadcast_to(np.eye(d), (len(x), d, d))], axis=2) for name, x in curves.items()
    }
    for basis in sorted(bases.values(), key=lambda basis: -float(np.ptp(basis[:, :, 0], axis=0).max())):
        share = np.round(timing.screened(basis, places, laws) / whole, 6)
        for v in np.argsort(share.min(axis=0), kind="stable")[:TRIES]:
            k = int(np.argmin(share[:, v]))
            fit = timing.found(basis, paths[v], laws[k], float(limit * whole[v])) if share[k, v] <= HOPEFUL else None
            if fit and fit.coefficients[0, 0] > 0:
                yield _together(bases, paths, fit, laws[k], limit)


def _by_projection(places: Array, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how ``places`` (f, 2, v) follow curves (G, 3) by a projection of the student's own."""
    paths = np.moveaxis(places, 2, 0)[:, :, None]
    bases = {name: np.concatenate([x, np.ones((len(x), 1))], axis=1)[:, None] for name, x in curves.items()}
    for name, path in itertools.product(curves, paths[:TRIES]):
        k = int(np.argmin(np.linalg.norm(timing.screened(bases[name], path, laws), axis=1)))
        fit = timing.found(bases[name], path, laws[k], float(limit * np.linalg.norm(timing.spread(path))))
        if fit and _is_projection(fit.coefficients[:3].T, curves[name]):
            yield _together(bases, paths, fit, laws[k], limit)


def _together(bases: Curves, paths: Array, fit: timing.Fit, law: Array, limit: float) -> Fit:
    """Return the trajectories that ``paths`` (v, f, e, c) follow together, beginning with the coefficients and times of one."""
    chosen = {}
    for name, basis in bases.items():
        drawn = basis[fit.grid] @ fit.coefficients
        off = np.sqrt(np.mean((paths - drawn) ** 2, axis=(1, 2, 3)))
        if off.min() <= HOPEFUL * _extent(drawn):
            chosen[name] = paths[int(np.argmin(off))]
    while chosen:
        basis = np.concatenate([bases[name] for name in chosen], axis=1)
        fit = timing.fitted(basis, np.concatenate(list(chosen.values()), axis=1), law)
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
    each = np.mean((path - drawn) ** 2, axis=(1, 2))
    off, extent = max(np.sqrt(each.mean()), np.sqrt(each.max()) / timing.WORST), _extent(drawn)
    return float(off / extent) if extent > 0 else np.inf


def _is_projection(matrix: Array, curve: Array) -> bool:
    """Return whether a fitted ``matrix`` (2, 3) may be a camera; only its effect on the directions of the curve is known."""
    _, sizes, directions = np.linalg.svd(curve - curve.mean(axis=0), full_matrices=False)
    along = directions[sizes > SOME * sizes[0]]
    return cameras.straightened(matrix) is not None if len(along) == 3 else np.linalg.matrix_rank(matrix @ along.T, SOME) > 0


def _otherwise(picture: Picture, name: str, curves: Curves, at: Array, n: int, *, laws: Array, limit: float) -> Iterator[Shown]:
    """Yield what the paths show of a trajectory that none of them follows: in other coordinates, or at other times."""
    if not picture.paths:
        return
    places, curve = np.stack([path.places for path in picture.paths], axis=2), curves[name]

    def fit(view: Array, times: Array) -> Fit | None:
        some = _by_view(places, {name: curve @ view.T}, times, limit) if len(times) else ()
        return next((one for one in some if one.misfit), None)

    for view in _views(picture, {name: curve}):
        if fit(view, laws):
            yield Shown(
                False, "wrong-proportions", f"{name} is drawn at another scale or place than the others: draw all as they are"
            )
        for changed, how in _mirrors(view):
            if fit(changed, laws):
                yield Shown(False, "mirrored", f"{name} is drawn with {how}")
        if len(laws) and fit(view, (n - 1) - laws):
            yield Shown(False, "wrong-frames", f"the motion of {name} is drawn backwards in time")
        if late := fit(view, timing.wrong_laws(at, n)):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but {timing.describe(late.times, at, n)}")
        if shows := at_any_time(picture, curve @ view.T, at):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but its samples are mistimed: {shows}")


def _mirrors(view: Array) -> Iterator[tuple[Array, str]]:
    """Yield the view with a coordinate of the drawing reversed or with two exchanged, in words."""
    if view.shape[0] != view.shape[1]:
        return
    for k in range(len(view)):
        yield np.diag([-1.0 if i == k else 1.0 for i in range(len(view))]), f"the sign of {'xyz'[k]} reversed"
    for i, k in itertools.combinations(range(len(view)), 2):
        order = list(range(len(view)))
        order[i], order[k] = k, i
        yield view[order], f"{'xyz'[i]} and {'xyz'[k]} exchanged"
