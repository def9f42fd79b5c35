"""Lost digits: single precision and rounding, recognized by applying the same to the truth."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.rigid_body.probes import scale

Array = NDArray[np.float64]

SMALL = 1e-6  # of the scale of a point: larger noise is not a loss of digits
ROUNDING = 1e-13
SINGLE = 1e-6  # agreement to expect in single precision


def precision_lost(wdot: Array, w: Array, moments: Array) -> list[Diagnosis]:
    """Return the diagnosis if the right equations were computed with too few digits, and with how many."""
    truth, size = reference.euler_rhs(w.T, moments.T).T, scale(w, moments)
    if not np.any(np.abs(wdot - truth) > ROUNDING * size):
        return []
    for name, answer in _hypotheses(w, moments):
        if np.all(np.abs(wdot - answer) <= ROUNDING * size):
            return [lost(name)]
    if np.all(np.abs(wdot - truth) < 10 * SINGLE * size) and in_single(wdot):
        return [lost("the answer is in single precision (float32)")]
    for what, cut in (
        ("cut to whole numbers: look for an array of integers", np.trunc),
        ("rounded to whole numbers", np.round),
        ("in half precision (float16)", lambda x: x.astype(np.float16).astype(float)),
    ):
        if np.all(np.abs(wdot - cut(truth)) <= ROUNDING * size):
            return [lost(f"the answer is {what}")]
    for places in range(1, 13):
        if np.all(np.abs(wdot - np.round(truth, places)) <= ROUNDING * size):
            return [lost(f"the answer is rounded to {places} decimal places")]
    return []


def digits_kept(wdot: Array, w: Array, moments: Array) -> list[Diagnosis]:
    """Return the diagnosis if the answers are right up to noise: how many digits agree."""
    truth, size = reference.euler_rhs(w.T, moments.T).T, scale(w, moments)
    with np.errstate(divide="ignore", invalid="ignore"):
        worst = float(np.where(wdot == truth, 0.0, np.abs(wdot - truth) / size).max())
    return [lost(f"only {int(-np.log10(worst))} digits are right")] if ROUNDING < worst < SMALL else []


def in_single(wdot: Array) -> bool:
    """Return whether no number has more digits than single precision holds."""
    with np.errstate(over="ignore"):
        return bool(np.array_equal(wdot, wdot.astype(np.float32)))


def lost(how: str) -> Diagnosis:
    """Return the diagnosis for digits lost in this way."""
    sentence = f"too few digits: {how}; keep everything in double precision"
    return Diagnosis(code="precision-loss", sentence=sentence, confidence=1.0)


def _hypotheses(w: Array, moments: Array) -> Iterator[tuple[str, Array]]:
    for name, cut in _cuts():
        for what, spin, body in (("ω and I are", cut(w), cut(moments)), ("ω is", cut(w), moments), ("I is", w, cut(moments))):
            yield f"{what} {name}", reference.euler_rhs(spin.T, body.T).T


def _cuts() -> Iterator[tuple[str, Callable[[Array], Array]]]:
    yield "cut to single precision (float32)", lambda x: x.astype(np.float32).astype(float)
    yield "cut to whole numbers", np.trunc
    yield "rounded to whole numbers", np.round
    for places in range(1, 11):
        yield f"rounded to {places} decimal places", lambda x, places=places: np.round(x, places)  # type: ignore[misc]
