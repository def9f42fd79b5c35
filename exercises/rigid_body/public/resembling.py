"""What an arrow that is not ê₃ shares with it: its turning about L, a cone about another line, or its path up
to noise.
"""

import numpy as np
from numpy.typing import NDArray

from ecp.kinds.animation import timing
from ecp.kinds.animation.pictures import Picture

from .compared_motion import Motion

Array = NDArray[np.float64]

STEADY = 0.02  # spread of a cosine that stays the same
DIFFERENT = 0.04  # of two cosines
IN_STEP = 0.3  # rad that an azimuth may be off
SCATTERED = 1.0  # of the path's own spread: more noise hides the path


def resembling(picture: Picture, motion: Motion) -> str | None:
    """Return what the 3-D arrows of ``picture`` from a fixed end do instead of following the axis; None if it
    is not known.
    """
    if motion.L is None or motion.axis is None or picture.dimensions != 3:
        return None
    z = motion.L / np.linalg.norm(motion.L)
    for path in (path for path in picture.paths if path.bound):
        lengths = np.linalg.norm(path.places, axis=1, keepdims=True)
        if lengths.min() <= 0:
            continue
        unit = path.places / lengths
        grid = timing.on_grid(np.linspace(0, motion.n - 1, len(unit)), len(motion.R))
        exact = motion.R[grid, :, motion.axis]
        if sentence := _cone(unit, exact, z) or _level(path.places / lengths.mean(), exact) or _noise(unit, exact):
            return sentence
    return None


def _cone(unit: Array, exact: Array, z: Array) -> str | None:
    angle, right = unit @ z, exact @ z
    if np.std(angle) <= STEADY and np.abs(np.mean(angle - right)) > DIFFERENT:
        x = exact[0] - right[0] * z
        azimuths = [np.unwrap(np.arctan2(v @ np.cross(z, x), v @ x)) for v in (unit, exact)]
        if np.abs(azimuths[0] - azimuths[1]).max() <= IN_STEP:
            drawn, wanted = (np.degrees(np.arccos(np.clip(np.mean(c), -1, 1))) for c in (angle, right))
            return f"the drawing turns about L with ê₃, but on a cone of {drawn:.0f}° about L; ê₃ makes an angle of {wanted:.0f}°"
    return None


def _level(tips: Array, exact: Array) -> str | None:
    """Return the coordinate that stays while the others change; ``tips`` (f, 3) in units of their mean length."""
    k = int(np.argmin(np.std(tips, axis=0)))
    if np.std(tips[:, k]) <= STEADY / 4 and np.std(tips, axis=0).max() > STEADY < np.std(exact[:, k]):
        constant = f"the {'xyz'[k]} coordinate of the drawing is constant"
        return f"{constant}, but ê₃ circles L, which does not point along {'xyz'[k]}: draw R[:, :, 2]"
    return None


def _noise(unit: Array, exact: Array) -> str | None:
    """Return that the path scatters: the deviation changes its sign from frame to frame, and the path without
    it is that of ê₃.
    """
    left, spread = unit - exact, np.sqrt(np.mean((exact - exact.mean(axis=0)) ** 2))
    size = np.sqrt(np.mean(left**2))
    rough = np.sqrt(np.mean(np.diff(left, axis=0) ** 2)) > size
    if rough and size <= SCATTERED * spread:
        return f"the drawing follows ê₃ but scatters about its path, by {size / spread:.0%} of it: is noise added?"
    return None
