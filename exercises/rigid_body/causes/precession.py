"""The likely cause behind a wrong precession rate: each mistake predicts a number for the given motion."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs

Array = NDArray[np.float64]

AGREEMENT = 1e-5
NEARLY = 0.01
MOST_SAID = 2  # mistakes that predict the same number
FACTORS = (
    ("units", "the right rate in turns per second: multiply by 2π", 1 / (2 * np.pi)),
    ("units", "the right rate in degrees per second: rad/s are due", 180 / np.pi),
    ("units", "the right rate in turns per minute (rpm): rad/s are due", 60 / (2 * np.pi)),
    ("units", "the right rate times 2π: the phase is in radians already", 2 * np.pi),
    ("constant-factor", "half the right rate: look for a factor that does not belong", 0.5),
    ("constant-factor", "twice the right rate: look for a factor that does not belong", 2.0),
)


def causes_of_rate(inputs: Inputs, rate: float) -> list[Diagnosis]:
    """For ``precession_rate`` of the motion ``inputs`` (t, w): every mistake that predicts ``rate``, if they are one or two."""
    t, w = np.asarray(inputs["t"], dtype=float), np.asarray(inputs["w"], dtype=float)
    truth = reference.precession_rate(t, w)
    if _near(rate, truth):
        return []
    found = {sentence: code for code, sentence, value in _mistakes(t, w, truth) if _near(rate, value)}
    if not found:
        found = {f"{said}, and of the opposite sign": code for code, said, value in _mistakes(t, w, truth) if _near(rate, -value)}
    if 0 < len(found) <= MOST_SAID:
        return [Diagnosis(code=code, sentence=sentence, confidence=1.0) for sentence, code in found.items()]
    if not found and abs(rate - truth) <= NEARLY * abs(truth):
        off = abs(rate / truth - 1)
        sentence = f"nearly right: within {off:.2g} of the mean rate; does it hold where the turning or the times are uneven?"
        return [Diagnosis(code="nearly-right", sentence=sentence, confidence=0.8)]
    return []


def _mistakes(t: Array, w: Array, truth: float) -> Iterator[tuple[str, str, float]]:
    """Code, sentence and number of each mistake."""
    backwards = "; or its sign was dropped" if truth < 0 else ""
    said = f"the opposite sign: Ω is positive where (ω₁, ω₂) turns from ê₁ to ê₂, so arctan2(ω₂, ω₁){backwards}"
    yield "sign-reversed", said, -truth
    for code, sentence, factor in FACTORS:
        yield code, sentence, factor * truth
    yield "wrong-quantity", "the period of the precession instead of its rate", 2 * np.pi / truth
    yield "wrong-quantity", "the inverse of the rate: is the phase fitted as a function of the time?", 1 / truth
    yield "wrong-quantity", "the inverse of the rate: is the phase fitted as a function of the time?", _slope(_phase(w, 1, 0), t)
    yield "returns-input", "the spin ω₃ itself instead of the rate at which (ω₁, ω₂) turns", float(w[2].mean())
    yield from _wrong_phases(t, w)
    yield from _wrong_times(t, _phase(w, 1, 0))


def _wrong_phases(t: Array, w: Array) -> Iterator[tuple[str, str, float]]:
    jumps = "the phase jumps by 2π and is not unwrapped before its slope is taken: see np.unwrap"
    halves = "arctan knows no quadrants, so the phase jumps by π: use arctan2(ω₂, ω₁), and np.unwrap"
    with np.errstate(all="ignore"):
        for sentence, phase in ((jumps, np.arctan2(w[1], w[0])), (jumps, np.arctan2(w[0], w[1])), (halves, np.arctan(w[1] / w[0]))):
            for value in (*_means(t, phase), _slope(np.unwrap(phase), t) if sentence == halves else np.nan):
                yield "not-unwrapped", sentence, value
    for a, b in ((2, 0), (0, 2), (2, 1), (1, 2)):
        pair = f"ω{'₁₂₃'[a]} and ω{'₁₂₃'[b]}"
        for value in _means(t, _phase(w, a, b)):
            yield "wrong-components", f"the phase of {pair} is taken: the precession turns (ω₁, ω₂)", value


def _wrong_times(t: Array, phase: Array) -> Iterator[tuple[str, str, float]]:
    n, whole, step, number = len(t), float(phase[-1] - phase[0]), t[1] - t[0], np.arange(float(len(t)))
    yield "wrong-quantity", "the angle turned by, not divided by the time", whole
    for middle in (n // 2, (n - 1) // 2):
        half = "the turn over half of the motion, divided by the time of all of it, or the other way round"
        yield "wrong-times", half, (phase[middle] - phase[0]) / (t[-1] - t[0])
        yield "wrong-times", half, whole / (t[middle] - t[0])
    yield "wrong-quantity", "the phase at time zero, the other coefficient of the fitted line", float(np.polyfit(t, phase, 1)[1])
    for value in (whole / n, whole / (n - 1), _slope(number, phase), float(np.median(np.diff(phase)))):
        yield "wrong-times", "the turn per sample: divide by the time between samples", value
    origin = "the time is taken to start at zero: divide by t[-1] − t[0], and the turn is phase[-1] − phase[0]"
    for value in (whole / t[-1], phase[-1] / t[-1], float(phase @ t / (t @ t)), float(np.mean(phase[1:] / t[1:]))):
        yield "wrong-times", origin, value
    even = "the times are taken to be evenly spaced: use t itself, np.polyfit(t, phase, 1) or np.gradient(phase, t)"
    for spacing in (step, t[-1] - t[-2], (t[-1] - t[0]) / n, (t[-1] - t[0]) / (n - 1), t[-1] / n, t[-1] / (n - 1)):
        for turn in (whole / n, whole / (n - 1), float(np.gradient(phase).mean()), _slope(number, phase)):
            if not _near(turn / spacing, whole / t[-1]):
                yield "wrong-times", even, turn / spacing
    rates = np.diff(phase) / np.diff(t)
    gradient = np.gradient(phase, t)
    yield "wrong-times", "the rate of the first step only: take the mean over the whole motion", rates[0]
    yield "wrong-times", "the rate of the last step only: take the mean over the whole motion", rates[-1]
    for value in (rates.max(), gradient.max(), rates.min(), gradient.min()):
        yield "wrong-times", "the fastest or slowest rate of turn: take the mean over the whole motion", value


def _phase(w: Array, a: int, b: int) -> Array:
    return np.asarray(np.unwrap(np.arctan2(w[a], w[b])))


def _means(t: Array, phase: Array) -> Iterator[float]:
    yield _slope(t, phase)
    yield float((phase[-1] - phase[0]) / (t[-1] - t[0]))
    yield float(np.mean(np.gradient(phase, t)))
    yield float(np.mean(np.diff(phase) / np.diff(t)))


def _slope(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0]) if np.all(np.isfinite(y)) else np.nan


def _near(a: float, b: float) -> bool:
    return bool(abs(a - b) <= AGREEMENT * abs(b))
