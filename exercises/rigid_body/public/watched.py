"""What an animation shows: whether something drawn follows the body, and whether L stays where it is.

There are many right ways to draw it. The times of the frames are free within limits (``timing``) and so is the camera
(``cameras``); at those times what is drawn must be the exact motion: a point of the body up to one constant shift, or a direction
from one fixed place. L is drawn by the same camera.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays

from . import cameras, timing
from .pictures import Path, Picture, directions, pictures, sound

Array = NDArray[np.float64]

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
MISFIT = 0.03  # root mean square, of the path's own: 1 % of ê₃'s length here; interpolating linearly costs a tenth of it
HOPEFUL = 0.5  # the same before times are fitted: 1.5 samples of the fastest turn here cost a third
TRIES = 6  # paths whose times are fitted, the most hopeful first
PARALLEL = 0.03  # sine of the angle from the body axis
SPAN = 0.1  # of the length of two directions that show the body's attitude together
UNAMBIGUOUS = 0.45  # of the motion: a shorter arc of any curve looks like one of ê₃'s by some camera
NAMES = "₁₂₃"
TRANSPOSED = "what is drawn follows the transposed R: R takes body components to space, so ê₃ is R[:, :, 2], its third column"


class Shown(NamedTuple):
    """``found``: True where the body is followed, False where it is not, None where what is drawn cannot be judged.

    ``code`` and ``sentence`` say what is followed instead; ``cameras``: for each picture the one found, if any."""

    found: bool | None
    code: str | None
    sentence: str
    cameras: tuple[Array | None, ...] = ()


class Motion:
    """R (n, 3, 3) at times ``t`` (n,), and L (3,) where it is drawn, with the curves and laws an animation is compared with."""

    def __init__(self, at: Array, t: Array, R: Array, L: Array | None, axis: int | None) -> None:
        from scipy.interpolate import CubicSpline

        n = len(t)
        spline, samples = CubicSpline(np.arange(n), R.reshape(n, 9)), np.arange((n - 1) * timing.PER + 1) / timing.PER
        self.L, self.axis, self.n = L, axis, n
        self.R = spline(samples).reshape(-1, 3, 3)
        spin = np.swapaxes(self.R, 1, 2) @ spline(samples, 1).reshape(-1, 3, 3)
        self.w = np.einsum("gij,gj->gi", self.R, spin[:, [2, 0, 1], [1, 2, 0]])  # in space, up to its unit
        self.turned = self._turns(R[:, :, axis], L) if L is not None and axis is not None else self._angle()
        self.laws = timing.laws(at, t, self.turned)

    def _turns(self, tips: Array, L: Array) -> Array:
        """Turns of the axis about L since the start (n,)."""
        z = L / np.linalg.norm(L)
        across = tips - np.outer(tips @ z, z)
        if np.linalg.norm(across, axis=1).min() < 1e-6:
            return self._angle()
        x = across[0] / np.linalg.norm(across[0])
        angle = np.unwrap(np.arctan2(across @ np.cross(z, x), across @ x))
        return np.asarray(np.maximum.accumulate(np.abs(angle)) / (2 * np.pi))

    def _angle(self) -> Array:
        """Turns of the body since the start (n,)."""
        speed = np.linalg.norm(self.w, axis=1)
        angle = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2)])[:: timing.PER]
        return np.asarray(angle / (2 * np.pi * timing.PER))


class Match(NamedTuple):
    """Body points p (3, v) that ``paths`` follow, at ``times`` (f,)."""

    times: Array
    points: Array
    paths: list[Path]


def body_shown(seen: Arrays, t: Array, R: Array, axis: int | None, L: Array | None = None) -> Shown:
    """Whether something follows body axis ``axis``, or for None any point of the body; ``R`` (n, 3, 3) at times ``t`` (n,).

    With L (3,) given, what is drawn along it must fit the same camera.
    """
    if not sound(seen):
        return Shown(False, None, "what came back does not fit together")
    drawn, painted = pictures(seen), seen["cost"][4] > 0
    if not any(picture.paths for picture in drawn):
        return Shown(None if painted else False, None, "nothing that moves was found in lines, arrows, polygons and markers")
    if len(seen["at"]) < timing.LEAST_FRAMES:
        return Shown(False, "wrong-frames", f"too short to show the motion: {len(seen['at'])} frames")
    motion = Motion(seen["at"], t, R, L, axis)
    shown = _compared(drawn, motion, seen["at"])
    if painted and not shown.found:
        return Shown(None, None, "what moves beside the painted picture says nothing about the body")
    return shown


def _compared(drawn: list[Picture], motion: Motion, at: Array) -> Shown:
    for look in (_as_it_is, _by_own_camera):
        views = [look(picture, motion, at) for picture in drawn]
        found = tuple(camera for camera, _ in views)
        right = [shown for _, shown in views if shown and shown.found]
        if right:
            return right[0]._replace(cameras=found)
        wrong = [shown for _, shown in views if shown]
        if look is _as_it_is:
            wrong += [shown for picture in drawn for shown in _otherwise(picture, motion, at)]
        if wrong:
            return wrong[0]._replace(cameras=found)
    return Shown(False, "wrong-motion", "what moves does not move with the body")


def _as_it_is(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """The camera without which space is drawn as it is, and what is shown."""
    if not len(motion.laws):
        return None, None
    wrong: tuple[Array | None, Shown | None] = (None, None)
    for plain in cameras.plain(picture.dimensions):
        match = _matched(picture, np.einsum("ia,gab->gib", plain, motion.R), motion.laws)
        if match is None:
            continue
        camera = plain
        if picture.dimensions == 2 and np.all(match.points[motion.axis] < 0) and _draws_momentum(picture, -plain, motion, match):
            camera, match = -plain, match._replace(points=-match.points)  # the paper upside down
        shown = _read(match, motion)
        if shown.found and not _agrees(picture, camera, motion, match):
            sentence = "ê₃ and L are drawn in different coordinates: are x and y swapped in one of them?"
            shown = Shown(False, "mirrored", sentence)
        if shown.found:
            return camera, shown
        wrong = wrong if wrong[1] else (camera, shown)
    return wrong


def _matched(picture: Picture, curves: Array, laws: Array) -> Match | None:
    """Points of the body among the paths, where ``curves`` (G, d, 3) times p is how body point p is drawn."""
    d, fits = picture.dimensions, []
    shift = np.broadcast_to(np.eye(d), (len(curves), d, d))
    kinds = [(bound, [path for path in picture.paths if path.bound == bound]) for bound in (True, False)]
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
        fit = timing.fitted(basis, values[:, :, [v]], laws[k])
        if fit.misfit[0] <= MISFIT * timing.spread(values[:, :, [v]])[0]:
            return _all_at(fit, kinds, curves, shift)
    return None


def _all_at(fit: timing.Fit, kinds: list[tuple[bool, list[Path]]], curves: Array, shift: Array) -> Match:
    """Which of the paths are points of the body at the times of ``fit``."""
    points, followed = [np.zeros((3, 0))], []
    for bound, paths in kinds:
        if not paths:
            continue
        basis = curves if bound else np.concatenate([curves, shift], axis=2)
        values = np.stack([path.places for path in paths], axis=2)
        coefficients = timing.coefficients_at(basis, values, fit.grid)
        left = np.einsum("fem,mv->fev", basis[fit.grid], coefficients) - values
        ok = np.sqrt(np.mean(left**2, axis=(0, 1))) <= MISFIT * timing.spread(values)
        points.append(coefficients[:3, ok])
        followed += [path for path, good in zip(paths, ok, strict=True) if good]
    return Match(fit.times, np.concatenate(points, axis=1), followed)


def _read(match: Match, motion: Motion) -> Shown:
    """What the points say: the axis or the body, or another direction."""
    axis, seen = motion.axis, _range(match.times, motion.n)
    units = match.points / np.maximum(np.linalg.norm(match.points, axis=0), 1e-300)
    if axis is None or np.any(units[axis] >= np.sqrt(1 - PARALLEL**2)):
        return Shown(True, None, f"drawn as it is, {seen}")
    sizes = np.linalg.svd(units, compute_uv=False)
    if len(sizes) > 1 and sizes[1] >= SPAN * sizes[0]:
        return Shown(True, None, f"the body is drawn as it is, {seen}")
    return _other_direction(units[:, 0], motion)


def _other_direction(unit: Array, motion: Motion) -> Shown:
    assert motion.axis is not None
    k, asked = int(np.argmax(np.abs(unit))), NAMES[motion.axis]
    if np.abs(unit[k]) >= np.sqrt(1 - PARALLEL**2):
        name = f"{'−' if unit[k] < 0 else ''}ê{NAMES[k]}"
        return Shown(False, "wrong-axis", f"what is drawn follows {name}, not ê{asked}: the axes of the body are the columns of R")
    if motion.L is not None and cameras.parallel(unit[None], motion.L):
        sentence = f"what is drawn is R·L, not ê{asked}: L is fixed in space, R belongs to the body"
        return Shown(False, "moving-angular-momentum", sentence)
    inside = ", ".join(f"{round(float(x), 2) + 0.0:.2f}" for x in unit)
    return Shown(False, "wrong-axis", f"what is drawn follows the direction ({inside}) of the body, not ê{asked}")


def _draws_momentum(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Whether something drawn stays along L as ``camera`` sees it."""
    if motion.L is None:
        return False
    some, _ = directions(picture, [path.origin for path in match.paths if path.bound])
    L = camera @ motion.L / np.linalg.norm(motion.L)
    return bool(np.linalg.norm(L) > PARALLEL) and cameras.parallel(some, L)


def _agrees(picture: Picture, camera: Array, motion: Motion, match: Match) -> bool:
    """Whether what is drawn along L fits the camera: only where L is drawn by another and not by this one it does not."""
    signed = [sign * other for other in cameras.plain(picture.dimensions) for sign in (1, -1)]
    own = [camera, -camera]
    return any(_draws_momentum(picture, M, motion, match) for M in own) or not any(
        _draws_momentum(picture, M, motion, match) for M in signed
    )


def _otherwise(picture: Picture, motion: Motion, at: Array) -> Iterator[Shown]:
    """What the paths show where it is not the body at its times, drawn as it is."""
    axis = motion.axis
    name = "the body" if axis is None else f"ê{NAMES[axis]}"
    for camera in cameras.plain(picture.dimensions):
        curves = np.einsum("ia,gab->gib", camera, motion.R)
        if len(motion.laws) and _matched(picture, np.einsum("ia,gba->gib", camera, motion.R), motion.laws):
            yield Shown(False, "transposed-rotation", TRANSPOSED)
        if len(motion.laws) and _matched(picture, curves, (motion.n - 1) - motion.laws):
            yield Shown(False, "wrong-motion", "the motion is drawn backwards in time")
        if axis is not None and len(motion.laws) and _along(picture, np.einsum("ia,ga->gi", camera, motion.w), motion.laws):
            yield Shown(False, "wrong-motion", f"what is drawn follows ω, not {name}")
        late = timing.wrong_laws(at, motion.n)
        tip = None if axis is None else curves[:, :, axis]
        fit = None if tip is None else _along(picture, tip, late)
        match = None if fit else _matched(picture, curves, late)
        if found := fit or (match if match and _read(match, motion).found else None):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but {timing.said(found.times, at, motion.n)}")
        elif tip is not None and (shows := _at_any_time(picture, tip, at)):
            yield Shown(False, "wrong-frames", f"{name} is drawn, but its samples are mistimed: {shows}")


def _along(picture: Picture, curve: Array, laws: Array) -> timing.Fit | None:
    """The times of a path that is ``curve`` (G, d), scaled."""
    if not picture.paths:
        return None
    basis, values = curve[:, :, None], np.stack([path.places for path in picture.paths], axis=2)
    whole = timing.spread(values)
    share = timing.screened(basis, values, laws) / whole
    for v in np.argsort(share.min(axis=0))[:TRIES]:
        k = int(np.argmin(share[:, v]))
        if share[k, v] > HOPEFUL:
            break
        fit = timing.fitted(basis, values[:, :, [v]], laws[k])
        if fit.coefficients[0, 0] > 0 and fit.misfit[0] <= MISFIT * whole[v]:
            return fit
    return None


def _at_any_time(picture: Picture, curve: Array, at: Array) -> str | None:
    """Which sample a frame shows where a path keeps to ``curve`` (G, d), but at no times that a law allows."""
    for path in picture.paths:
        scale = np.sqrt(np.mean(path.places**2) / np.mean(curve**2))
        for _ in range(4):
            nearest = np.argmin(np.sum((path.places[:, None] - scale * curve) ** 2, axis=2), axis=1)
            scale = np.sum(path.places * curve[nearest]) / np.sum(curve[nearest] ** 2)
        left = np.sqrt(np.mean((path.places - scale * curve[nearest]) ** 2))
        if scale > 0 and left <= MISFIT * np.sqrt(np.mean((path.places - path.places.mean(axis=0)) ** 2)):
            k = len(at) // 2
            return f"frame {at[k, 0]:.0f} of {at[k, 2]:.0f} shows sample {nearest[k] / timing.PER:.0f}"
    return None


def _by_own_camera(picture: Picture, motion: Motion, at: Array) -> tuple[Array | None, Shown | None]:
    """The student's own camera, and what it shows."""
    for laws in (motion.laws, timing.wrong_laws(at, motion.n)):
        if len(laws) and (own := _own_camera(picture, motion, laws)):
            if laws is motion.laws:
                return _checked(picture, motion, *own)
            if np.ptp(own[1]) > UNAMBIGUOUS * motion.n or np.any(np.diff(own[1]) < 0):
                return None, Shown(False, "wrong-frames", f"the body is drawn, but {timing.said(own[1], at, motion.n)}")
    return None, None


def _own_camera(picture: Picture, motion: Motion, laws: Array) -> tuple[Array, Array, list[Array]] | None:
    """A camera, the times of the frames and the origins, found from a drawn direction or from the points of one artist."""
    for path in picture.paths if motion.axis is not None else []:
        fit = _timed(motion.R[:, None, :, motion.axis], path.places[:, None, :], laws)
        camera = cameras.straightened(fit.coefficients.T) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, [path.origin] if path.bound else []
    nine = np.concatenate([motion.R.reshape(-1, 1, 9), np.ones((len(motion.R), 1, 1))], axis=2)
    for artist in dict.fromkeys(path.artist for path in picture.paths):
        paths = [path for path in picture.paths if path.artist == artist and not path.bound]
        if len(paths) < 3:
            continue
        values = np.stack([path.places for path in paths], axis=1)
        fit = _timed(nine, values.reshape(len(values), 1, -1), laws)
        camera = cameras.of_body(fit.coefficients, nine[fit.grid, 0, :9], values) if fit else None
        if fit is not None and camera is not None:
            return camera, fit.times, []
    return None


def _timed(basis: Array, drawn: Array, laws: Array) -> timing.Fit | None:
    share, whole = timing.screened(basis, drawn, laws), np.linalg.norm(timing.spread(drawn))
    k = int(np.argmin(np.linalg.norm(share, axis=1)))
    if np.linalg.norm(share[k]) > HOPEFUL * whole:
        return None
    fit = timing.fitted(basis, drawn, laws[k])
    return fit if np.linalg.norm(fit.misfit) <= MISFIT * whole else None


def _checked(picture: Picture, motion: Motion, camera: Array, times: Array, origins: list[Array]) -> tuple[Array | None, Shown]:
    """A camera is right if it does not mirror, if it draws L too, and if it does not turn about an L that stays."""
    seen = _range(times, motion.n)
    if len(camera) == 3 and np.linalg.det(camera) < 0:
        return None, Shown(False, "mirrored", f"what is drawn is a mirror image of the motion{_swapped(camera)}")
    if motion.L is not None:
        L = motion.L / np.linalg.norm(motion.L)
        some, _ = directions(picture, origins)
        for plain in cameras.plain(len(camera)):
            if np.linalg.norm(camera @ L - plain @ L) <= PARALLEL:
                sentence = "what is drawn is turned about L, as at another time: frame and sample do not belong together"
                return None, Shown(False, "wrong-frames", sentence)
            kept = np.linalg.norm(plain @ L) > PARALLEL and cameras.parallel(some, plain @ L)
            if kept and not cameras.parallel(some, camera @ L) and np.linalg.norm(camera @ L) > PARALLEL:
                return None, Shown(False, "mirrored", "the body is drawn in other coordinates than L")
        if len(camera) == 2 and np.linalg.norm(camera @ L) > PARALLEL and not cameras.parallel(some, camera @ L):
            if cameras.parallel(some, -camera @ L):
                return None, Shown(False, "wrong-axis", "ê₃ and L are drawn on opposite sides: one of them has the wrong sign")
            return camera, Shown(None, None, "seen from another side: draw L in the same way, so that the view can be checked")
    return camera, Shown(True, None, f"seen from another side, {seen}")


def _swapped(camera: Array) -> str:
    whole = np.rint(camera)
    if np.abs(camera - whole).max() > PARALLEL:
        return ""
    moved = [k for k in range(3) if not whole[k, k]]
    return f": {' and '.join('xyz'[k] for k in moved)} are swapped" if len(moved) == 2 else ": the sign of a coordinate is wrong"


def _range(times: Array, n: int) -> str:
    step = max(timing.SLACK, float(np.diff(np.sort(times)).max()) + 0.5)
    low, high = times.min(), times.max()
    return f"all {n} samples" if low <= step and high >= n - 1 - step else f"samples {low:.0f}–{high:.0f} of {n}"


def momentum_shown(seen: Arrays, t: Array, R: Array, L: Array, axis: int | None = 2) -> Shown:
    """Whether a direction drawn along L stays there, by the camera that draws the body or else as it is."""
    if not sound(seen):
        return Shown(None, None, "what came back does not fit together")
    drawn, unit = pictures(seen), L / np.linalg.norm(L)
    enough = len(seen["at"]) >= timing.LEAST_FRAMES and any(picture.paths for picture in drawn)
    found = _compared(drawn, Motion(seen["at"], t, R, L, axis), seen["at"]).cameras if enough else ()
    reversed_ = False
    for picture, camera in zip(drawn, found or (None,) * len(drawn), strict=True):
        some, sure = directions(picture, [path.origin for path in picture.paths if path.bound])
        for view in [camera] if camera is not None else cameras.plain(picture.dimensions):
            if np.linalg.norm(view @ unit) <= PARALLEL:
                continue
            if cameras.parallel(some, view @ unit):
                return Shown(True, None, "a direction along L stays the same")
            reversed_ = reversed_ or cameras.parallel(sure, -(view @ unit))
    if reversed_:
        return Shown(False, "reversed-angular-momentum", "what is drawn points along −L")
    if enough:
        motion = Motion(seen["at"], t, R, L, axis)
        for picture in drawn:
            for view in cameras.plain(picture.dimensions):
                for turned in (motion.R @ unit, np.einsum("gji,j->gi", motion.R, unit)):
                    if len(motion.laws) and _along(picture, turned @ view.T, motion.laws):
                        said = "L moves with the body: it is fixed in space, and R belongs to the body"
                        return Shown(False, "moving-angular-momentum", said)
    return Shown(None, None, "no direction along L was found in the lines and arrows of the axes: draw L as a line or an arrow")
