"""Motions (t, ω) for ``precession_rate``, for which every correct way to compute the mean rate of turn gives
the same number.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import reference
from exercises.assignment import Inputs

Array = NDArray[np.float64]
Rng = np.random.Generator

TURN_SAMPLES, UNEVEN = 600, 0.5  # of a given precession; the longest of its uneven steps is four times the shortest
SWAY, SWAYS = 0.006, 2.5  # relative variation of an uneven rate of turn, and its number of periods, a half-integer
COARSE_SAMPLES, COARSE_STEP = 21, (0.46, 0.468)  # of a turn from sample to sample, less than half with a margin for fits
SHORT_SAMPLES, SHORT_TURNS = 100, (0.6, 0.9)


def uneven_times(rng: Rng) -> Inputs:
    """Draw even turning at uneven times: the last steps are several times as long as the first, or the first
    as the last.
    """
    rate, samples = _top(rng, rng.uniform(1.1, 1.9)), np.linspace(0.0, 1.0, TURN_SAMPLES)
    uneven = (1 - UNEVEN) * samples + UNEVEN * samples**3
    return _turning(rng, rate, uneven if rng.random() < 0.5 else 1 - uneven[::-1], 0.0)


def backward(rng: Rng) -> Inputs:
    """Draw backward turning at even times with a varying rate; its mean, slope and median are the same."""
    rate = _top(rng, rng.uniform(0.3, 0.8))
    return _turning(rng, rate, np.linspace(0.0, 1.0, TURN_SAMPLES), rng.choice([-1.0, 1.0]) * SWAY)


def coarse(rng: Rng) -> Inputs:
    """Draw even turning in steps of nearly half a turn: ten of the twenty steps jump past ±π."""
    turns = (COARSE_SAMPLES - 1) * rng.uniform(*COARSE_STEP)
    return _even(rng, turns, rng.uniform(0.1, 0.9) * (turns - 9), COARSE_SAMPLES)


def short(rng: Rng) -> Inputs:
    """Draw even turning through less than one turn, past ±π."""
    turns = rng.uniform(*SHORT_TURNS)
    return _even(rng, turns, rng.uniform(0.1, 0.9) * turns, SHORT_SAMPLES)


def _even(rng: Rng, turns: float, before: float, samples: int) -> Inputs:
    """Return ω (3, n) turning at an even rate, forward or backward, at even times (n,) that do not start at
    zero.

    It passes ±π for the first time after ``before`` of its ``turns``.
    """
    part, transverse, w3 = np.linspace(0.0, 1.0, samples), rng.uniform(0.1, 0.8), rng.uniform(1.0, 4.0)
    duration, angle = turns * rng.uniform(2.0, 6.0), rng.choice([-1.0, 1.0]) * np.pi * (1 - 2 * before + 2 * turns * part)
    w = np.array([transverse * np.cos(angle), transverse * np.sin(angle), np.full_like(part, w3)])
    return {"t": duration * (rng.uniform(0.5, 1.5) + part), "w": w}


def _top(rng: Rng, i3: float) -> tuple[float, float]:
    """Return precession rate and ω₃ of a symmetric top with I₃ = ``i3`` I₁."""
    w3 = rng.uniform(1.0, 4.0)
    return reference.free_precession_rate((1.0, 1.0, i3), w3), w3


def _turning(rng: Rng, top: tuple[float, float], part: Array, sway: float) -> Inputs:
    """Return ω (3, n) over two to three turns, so that a phase that is not unwrapped jumps, at times (n,)
    that do not start at zero.

    ``part`` (n,) runs from 0 to 1. The rate of turn varies by ``sway`` in two and a half periods about the
    middle. It is odd there, so every way of taking the mean (slope, total, median) gives the same number.
    """
    (rate, w3), transverse, phase, turns = top, rng.uniform(0.1, 0.8), rng.uniform(0.0, 6.0), rng.uniform(2.2, 2.9)
    duration = turns * 2 * np.pi / abs(rate)
    ahead = sway * rate * duration / (2 * np.pi * SWAYS) * np.cos(2 * np.pi * SWAYS * (part - 0.5))
    angle = phase + rate * duration * part + ahead
    w = np.array([transverse * np.cos(angle), transverse * np.sin(angle), np.full_like(part, w3)])
    return {"t": duration * (rng.uniform(0.5, 1.5) + part), "w": w}


TURNING: dict[str, Callable[[Rng], Inputs]] = {
    "rate": uneven_times,
    "rate-retrograde": backward,
    "rate-coarse": coarse,
    "rate-short": short,
}
