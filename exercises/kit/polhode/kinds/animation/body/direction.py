"""What the points that follow a body show: its axis, the body, or another direction; and what resembles the
axis.
"""

import numpy as np

from polhode.kinds.animation import cameras, frame_times
from polhode.kinds.animation.body import drawn_boxes
from polhode.kinds.animation.body.body_motion import NAMES, Motion
from polhode.kinds.animation.cameras import PARALLEL
from polhode.kinds.animation.curve_matching import Match
from polhode.kinds.animation.drawn_paths import Picture
from polhode.kinds.animation.frame_times import Array
from polhode.kinds.animation.visibility import Shown

ALONG = np.sqrt(1 - PARALLEL**2)  # cosine of the angle between directions that count as parallel
SPAN = 0.1  # of the length of two directions that show the body's attitude together
STEADY = 0.02  # spread of a cosine that stays the same
DIFFERENT = 0.04  # of two cosines
IN_STEP = 0.3  # rad that an azimuth may be off
SCATTERED = 1.0  # of the path's own spread: more noise hides the path


def read(match: Match, motion: Motion) -> Shown:
    """Return what the points of ``match`` show: the axis or the body, or another direction."""
    axis, seen = motion.axis, motion.frames.covered(match.times)
    if axis is None:
        wrong = None if motion.half is None else drawn_boxes.wrong_box(match, motion.half, motion.R)
        return wrong or Shown(True, None, f"drawn as it is, {seen}")
    units = match.points / np.maximum(np.linalg.norm(match.points, axis=0), 1e-300)
    if np.any(units[axis] >= ALONG):
        return Shown(True, None, f"drawn as it is, {seen}")
    sizes = np.linalg.svd(units, compute_uv=False)
    if len(sizes) > 1 and sizes[1] >= SPAN * sizes[0]:
        stray = _stray_line(match, axis)
        return (
            Shown(True, None, f"the body is drawn as it is, {seen}")
            if stray is None
            else _other_direction(stray, motion)
        )
    return _other_direction(units[:, 0], motion)


def _stray_line(match: Match, axis: int) -> Array | None:
    """Return the direction (3,) of a line from a fixed end that is oblique to the axis, if no artist shows
    the axis itself.

    An artist shows it by a direction along it, or by three or more points in a plane across it.
    """
    stray = None
    for points, bound in ((of_artist.T, bound) for of_artist, bound in match.by_artist()):
        steps = np.concatenate([(points[:, None] - points).reshape(-1, 3), points if bound else points[:0]])
        steps = steps[np.linalg.norm(steps, axis=1) > SPAN * np.abs(points).max()]
        units = steps / np.linalg.norm(steps, axis=1, keepdims=True)
        slant = np.abs(units[:, axis])
        across = len(points) > 2 and np.ptp(points[:, axis]) <= PARALLEL * np.abs(points).max()
        if across or np.any(slant >= ALONG):
            return None
        if (
            bound
            and len(units)
            and slant.min() > PARALLEL
            and np.abs(np.cross(units, units[-1])).max() <= PARALLEL
        ):
            stray = units[-1]
    return stray


def _other_direction(unit: Array, motion: Motion) -> Shown:
    k, wanted = int(np.argmax(np.abs(unit))), motion.name
    if np.abs(unit[k]) >= ALONG:
        name = f"{'−' if unit[k] < 0 else ''}{NAMES[k]}"
        return Shown(
            False,
            "wrong-axis",
            f"the drawing follows {name}, not {wanted}: the axes of the body are the columns of R",
        )
    if motion.unit is not None and cameras.parallel(unit[None], motion.unit):
        sentence = f"the drawing shows R·L, not {wanted}: L is fixed in space, do not apply R to it"
        return Shown(False, "moving-angular-momentum", sentence)
    inside = ", ".join(f"{round(float(x), 2) + 0.0:.2f}" for x in unit)
    return Shown(
        False, "wrong-axis", f"the drawing follows the direction ({inside}) of the body, not {wanted}"
    )


def resembling(picture: Picture, motion: Motion) -> str | None:
    """Return what the 3-D arrows of ``picture`` from a fixed end do instead of following the axis; None if it
    is not known.

    They turn about L in step with the axis but at another angle, one of their coordinates stays, or they
    scatter about the path of the axis: the deviation changes its sign from frame to frame.
    """
    name, z = motion.name, motion.unit
    if z is None or motion.axis is None or picture.dimensions != 3:
        return None
    for path in (path for path in picture.paths if path.bound):
        lengths = np.maximum(np.linalg.norm(path.places, axis=1, keepdims=True), 1e-300)
        unit, tips = path.places / lengths, path.places / lengths.mean()
        exact = motion.tip[frame_times.on_grid(np.linspace(0, motion.frames.n - 1, len(unit)), len(motion.R))]
        angle, right = unit @ z, exact @ z
        x = exact[0] - right[0] * z
        azimuths = [np.unwrap(np.arctan2(v @ np.cross(z, x), v @ x)) for v in (unit, exact)]
        in_step = np.std(angle) <= STEADY and np.abs(np.subtract(*azimuths)).max() <= IN_STEP
        if in_step and np.abs(np.mean(angle - right)) > DIFFERENT:
            drawn, wanted = (np.degrees(np.arccos(np.clip(np.mean(c), -1, 1))) for c in (angle, right))
            cone = f"the drawing turns about L with {name}, but on a cone of {drawn:.0f}° about L"
            return f"{cone}; {name} makes an angle of {wanted:.0f}°"
        k = int(np.argmin(np.std(tips, axis=0)))
        if np.std(tips[:, k]) <= STEADY / 4 and np.std(tips, axis=0).max() > STEADY < np.std(exact[:, k]):
            constant = f"the {'xyz'[k]} coordinate of the drawing is constant"
            return (
                f"{constant}, but {name} circles L, which does not point along {'xyz'[k]}: draw R[:, :,"
                f" {motion.axis}]"
            )
        left, spread = unit - exact, np.sqrt(np.mean((exact - exact.mean(axis=0)) ** 2))
        size = np.sqrt(np.mean(left**2))
        if np.sqrt(np.mean(np.diff(left, axis=0) ** 2)) > size and size <= SCATTERED * spread:
            return (
                f"the drawing follows {name} but scatters about its path, by {size / spread:.0%} of it: is"
                " noise added?"
            )
    return None
