"""Whether something drawn follows given trajectories, as they are up to one scale and origin in each axes.

A trajectory in space may also be drawn in a plane: in two of its coordinates, or by the student's own
projection. The times of the frames are free within limits (``frame_times``).
"""

import itertools
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from polhode.judging.checks import Arrays
from polhode.kinds.animation import cameras, frame_times
from polhode.kinds.animation.curve_matching import HOPEFUL, TRIES, Mistake, finely, instead, matches, together
from polhode.kinds.animation.drawn_paths import Path, Picture, resting
from polhode.kinds.animation.frame_times import Array, Frames
from polhode.kinds.animation.visibility import Shown, judged, remembered

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
    """Return for each of the ``trajectories`` (n, 2) or (n, 3), at times (n,), whether something drawn
    follows it.

    The misfit of a path is its root mean square distance from the drawn trajectory, relative to the
    trajectory's extent, or that of the worst frame over frame_times.WORST if this is more. It is at most
    ``limit``.
    """

    def compared(drawn: list[Picture]) -> dict[str, Shown]:
        return _compared(drawn, seen, t, trajectories, limit)

    return remembered(
        seen, (t, dict(trajectories), limit), lambda: judged(seen, len(t), trajectories, compared)
    )


def _compared(
    drawn: list[Picture], seen: Arrays, t: Array, trajectories: Curves, limit: float
) -> dict[str, Shown]:
    """Return for each trajectory what the pictures show of it."""
    at, t, fine, _ = finely(seen["at"], t, np.stack(list(trajectories.values()), axis=2))
    curves = dict(zip(trajectories, np.moveaxis(fine, 2, 0), strict=True))
    frames, found = Frames(at, t, np.linspace(0, 1, len(t)), resting(seen)), dict[str, Shown]()
    free = [_with_free_paths(picture) for picture in drawn]
    for picture in free:
        shown = _in_picture(picture, curves, frames, limit)
        found |= {
            name: one
            for name, one in shown.items()
            if name not in found or (one.found and not found[name].found)
        }
    for name in (name for name in curves if name not in found):
        wrong = instead(free, _mistakes(name, curves[name], frames), frames, limit)
        found[name] = next(wrong, Shown(False, "wrong-motion", f"nothing that moves follows {name}"))
    return found


def _with_free_paths(picture: Picture) -> Picture:
    """Return the picture with each path once, relative to the axes, and first the centres of artists of
    several points.
    """
    points = {
        (path.artist, np.round(at, 12).tobytes()): at
        for path in picture.paths
        for at in [path.places + path.origin]
    }
    artists = [
        np.stack([at for (of, _), at in points.items() if of == artist])
        for artist in dict.fromkeys(of for of, _ in points)
    ]
    centres = [(some.min(axis=0) + some.max(axis=0)) / 2 for some in artists if len(some) > 2]
    moving = [at for at in centres if frame_times.spread(at[:, :, None])[0] > 0]
    return picture._replace(
        paths=[Path(0, at, False, np.zeros(picture.dimensions)) for at in (*moving, *points.values())]
    )


def _in_picture(picture: Picture, curves: Curves, frames: Frames, limit: float) -> dict[str, Shown]:
    """Return the trajectories that the paths of one axes follow: the most that one view shows, rather as
    given.
    """
    best, found = Fit(np.zeros(0), {}), dict[str, Shown]()
    for mislabelled, fit in _looks(picture, curves, frames.laws, limit):
        if mislabelled:
            found |= {name: Shown(False, "mirrored", mislabelled) for name in fit.misfit}
        else:
            best = max(best, fit, key=lambda fit: (len(fit.misfit), fit.as_given))
        if len(fit.misfit) == len(curves):
            break
    return found | {
        name: Shown(True, None, frames.covered(best.times), misfit=misfit)
        for name, misfit in best.misfit.items()
    }


def _looks(picture: Picture, curves: Curves, laws: Array, limit: float) -> Iterator[tuple[str, Fit]]:
    """Yield how the paths follow curves (G, c), in coordinates as they are or by a projection, and what the
    labels have wrong.
    """
    c = next(iter(curves.values())).shape[1]
    for view in cameras.plain(picture.dimensions, picture.plane, c):
        wrong = cameras.mislabelled(picture.plane, view) if view.shape == (2, 3) else ""
        for fit in _by_view(picture, {name: x @ view.T for name, x in curves.items()}, laws, limit):
            yield wrong, fit
    for fit in _by_projection(picture, curves, laws, limit) if (picture.dimensions, c) == (2, 3) else ():
        yield "", fit


def _by_view(picture: Picture, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how the paths follow curves (G, d), with one scale and origin for all, found from one of them."""
    constant = np.broadcast_to(
        np.eye(picture.dimensions), (len(next(iter(curves.values()))), *[picture.dimensions] * 2)
    )
    bases = {name: np.concatenate([x[:, :, None], constant], axis=2) for name, x in curves.items()}
    for curve in sorted(curves.values(), key=lambda x: -float(np.ptp(x, axis=0).max())):
        for match in matches(picture, curve[:, :, None], laws, limit=limit):
            yield _together(
                bases, np.stack([path.places for path in picture.paths])[..., None], match.fit, limit
            )


def _by_projection(picture: Picture, curves: Curves, laws: Array, limit: float) -> Iterator[Fit]:
    """Yield how the paths follow curves (G, 3) by a projection of the student's own."""
    bases = {name: np.concatenate([x, np.ones((len(x), 1))], axis=1)[:, None] for name, x in curves.items()}
    for (name, basis), path in itertools.product(bases.items(), picture.paths[:TRIES]):
        fit = together(basis, path.places[:, None], laws, limit)
        if fit and _is_projection(fit.coefficients[:3].T, curves[name]):
            yield _together(bases, np.stack([path.places for path in picture.paths])[:, :, None], fit, limit)


def _together(bases: Curves, paths: Array, fit: frame_times.Fit, limit: float) -> Fit:
    """Return the trajectories that ``paths`` (v, f, e, c) follow together, beginning with the coefficients
    and times of one.
    """
    chosen = {}
    for name, basis in bases.items():
        off = _misfits(paths, basis[fit.grid] @ fit.coefficients)
        if off.min() <= HOPEFUL:
            chosen[name] = paths[int(np.argmin(off))]
    while chosen:
        basis = np.concatenate([bases[name] for name in chosen], axis=1)
        fit = frame_times.fitted(basis, np.concatenate(list(chosen.values()), axis=1), fit.law)
        misfit = {
            name: float(_misfits(x[None], bases[name][fit.grid] @ fit.coefficients)[0])
            for name, x in chosen.items()
        }
        worst = max(misfit, key=lambda name: misfit[name])
        if misfit[worst] <= limit:
            given = fit.coefficients[:, 0] - np.eye(len(fit.coefficients))[0]
            return Fit(fit.times, misfit, bool(np.abs(given).max() <= limit))
        del chosen[worst]
    return Fit(fit.times, {})


def _misfits(paths: Array, drawn: Array) -> Array:
    """Return the misfits (v,) of ``paths`` (v, f, e, c) to a trajectory as it is ``drawn`` (f, e, c),
    relative to its extent.
    """
    extent = np.sqrt(np.mean((drawn - drawn.mean(axis=0)) ** 2))
    return frame_times.misfits(np.moveaxis((paths - drawn).reshape(*paths.shape[:2], -1), 0, 2)) / max(
        extent, 1e-300
    )


def _is_projection(matrix: Array, curve: Array) -> bool:
    """Return whether a fitted ``matrix`` (2, 3) may be a camera; only its effect on the directions of the
    curve is known.
    """
    _, sizes, directions = np.linalg.svd(curve - curve.mean(axis=0), full_matrices=False)
    along = directions[sizes > SOME * sizes[0]]
    return (
        cameras.straightened(matrix) is not None
        if len(along) == 3
        else np.linalg.matrix_rank(matrix @ along.T, SOME) > 0
    )


def _mistakes(name: str, curve: Array, frames: Frames) -> list[Mistake]:
    """Return how a trajectory that nothing follows may be drawn: in other coordinates, or at other times."""
    xyz = "xyz"[: curve.shape[1]]
    mirrors = {f"the sign of {x} reversed": np.where(np.array(list(xyz)) == x, -1, 1) * curve for x in xyz}
    for i, k in itertools.combinations(range(len(xyz)), 2):
        order = [{i: k, k: i}.get(j, j) for j in range(len(xyz))]
        mirrors[f"{xyz[i]} and {xyz[k]} exchanged"] = curve[:, order]
    elsewhere = f"{name} is drawn at another scale or place than the others: draw all as they are"
    late = Mistake("wrong-frames", f"{name} is drawn, but {{}}", curve[:, :, None], frames.late)
    return [
        Mistake("wrong-proportions", elsewhere, curve[:, :, None], frames.laws),
        *(
            Mistake("mirrored", f"{name} is drawn with {how}", x[:, :, None], frames.laws)
            for how, x in mirrors.items()
        ),
        Mistake(
            "wrong-frames",
            f"the motion of {name} is drawn backwards in time",
            curve[::-1, :, None],
            frames.laws,
        ),
        late,
        late._replace(laws=None),
    ]
