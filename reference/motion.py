"""The motion of a torque-free body from the simplest exact model."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.exact import Exact

Array = NDArray[np.float64]
Need = Literal["omega", "orientation"]


@dataclass(frozen=True)
class Motion:
    """A sampled motion: ``t`` (n,) s, ``w`` (3, n) rad/s in body axes, ``R`` (n, 3, 3) body → space or None.

    ``model`` names the closed form ("steady", "symmetric", "separatrix", "direct" or "dual"), ``why`` the
    reason for it.
    """

    t: Array
    w: Array
    R: Array | None
    model: str
    why: str


def motion(
    w0: ArrayLike, I: ArrayLike, t: ArrayLike, need: Need = "omega", R0: ArrayLike | None = None
) -> Motion:
    """Return the exact motion from ω(0) = ``w0`` (3,) rad/s and R(0) = ``R0`` (3, 3) (default 1) of a body
    with moments ``I`` (3,) kg m².

    ``t`` (n,) are times in s of either sign, in any order. ``need="omega"`` leaves out the orientation.
    Raises ValueError for moments that are not positive or break the triangle inequality beyond rounding,
    values that are not finite, and wrong shapes.
    """
    if need not in ("omega", "orientation"):
        raise ValueError(f'need is "omega" or "orientation", not {need!r}')
    times = np.asarray(t, dtype=float)
    if times.ndim != 1 or times.size == 0 or not np.all(np.isfinite(times)):
        raise ValueError(f"t is a non-empty list of finite times; got shape {times.shape}")
    exact = Exact(w0, I, R0)
    sampled = exact.sample(times, orientation=need == "orientation")
    return Motion(times, sampled.w, sampled.R, exact.model, exact.why)
