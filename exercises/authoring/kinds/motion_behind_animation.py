"""The exact motion behind an animation that a notebook's cell showed, found among the notebook's numbers and
verified.
"""

from collections.abc import Mapping, Sequence

import numpy as np

import reference
from polhode.judging.checks import Arrays
from polhode.judging.integration import Array

# largest difference of an element of R: below a drawing's tolerance, above any integrator's default tolerance
CLOSE = 0.02
MOST_ANGLE = 1e4  # rad
AS_FUNCTION = (
    "the motion behind the animation in your cell was not recognized; submit it as a function: "
    "def animate_precession(t, R, L): … return show(anim)"
)


def own_motion(
    seen: Arrays, moments: Sequence[float], names: Mapping[str, str]
) -> dict[str, Array] | str | None:
    """Return the exact t, R and L, by their ``names`` as arguments, of a symmetric top behind the notebook's
    R (n, 3, 3) at times t (n,).

    R(0) and ω(0) are free; the moments (3,) are among the notebook's numbers, or the course's. Returns None
    if a function was submitted, and a sentence if the notebook's R is not such a motion.
    """
    R, t = np.asarray(seen["own_R"]), np.asarray(seen["own_t"])[:, 0]
    if len(R) == 1:
        return None
    if (
        not np.all(np.isfinite(R))
        or not np.all(np.isfinite(t))
        or len(t) != len(R)
        or not np.all(np.diff(t) > 0)
    ):
        return AS_FUNCTION
    if np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max() > CLOSE or np.linalg.det(R[0]) < 0:
        return AS_FUNCTION
    if not MOST_ANGLE**-2 < t[-1] - t[0] < MOST_ANGLE**2:
        return AS_FUNCTION
    relative, known = R[0].T @ R, [np.array(moments)] if len(moments) else []
    for I in filter(_possible, (*np.asarray(seen["own_I"]), *known)):
        w0 = _first_rate(relative, t, I)
        if not 0 < np.linalg.norm(w0) * (t[-1] - t[0]) < MOST_ANGLE:
            continue
        exact = reference.motion(w0, I, t - t[0], need="orientation").R
        if exact is not None and np.abs(exact - relative).max() <= CLOSE:
            return {names["t"]: t, names["R"]: R[0] @ exact, names["L"]: R[0] @ (I * w0)}
    return AS_FUNCTION


def _possible(I: Array) -> bool:
    """Return whether a symmetric top can have these moments."""
    if not np.all(np.isfinite(I)) or not I.min() > 1e-6 or not I.max() < 1e6:
        return False
    return bool(np.isclose(I[0], I[1]) and np.all(I.sum() * (1 + 1e-9) >= 2 * I))


def _first_rate(R: Array, t: Array, I: Array) -> Array:
    """Return ω(0) (3,) of a symmetric top from the circle of ê₃ in R (n, 3, 3), with R(0) = 1."""
    tips = R[:, :, 2]
    x, y, z = np.linalg.svd(tips - tips.mean(axis=0), full_matrices=False)[2]
    z = z * np.linalg.det([x, y, z])
    rate = np.polyfit(t - t[0], np.unwrap(np.arctan2(tips @ y, tips @ x)), 1)[0]
    L = I[0] * rate * z
    return np.asarray(L / I[0] + (L @ tips[0]) * (1 / I[2] - 1 / I[0]) * tips[0])
