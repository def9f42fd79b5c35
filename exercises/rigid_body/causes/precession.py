"""The likely cause behind wrong precession rates: each mistake predicts a number for every given motion."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Answers, Inputs

Array = NDArray[np.float64]
Predicted = tuple[str, str, float]

AGREEMENT = 1e-5
NEARLY = 0.01
RIGHT = 1e-3  # the checks' tolerance
TURNS = {
    "rate": "uneven times",
    "rate-retrograde": "retrograde precession at evenly spaced times",
    "rate-coarse": "samples nearly half a turn apart",
    "rate-short": "less than one turn",
}
MOST_NAMED = 2  # mistakes that predict the same number
FACTORS = (
    ("units", "the right rate in turns per second: multiply by 2π", 1 / (2 * np.pi)),
    ("units", "the right rate in degrees per second: return rad/s", 180 / np.pi),
    ("units", "the right rate in turns per minute (rpm): return rad/s", 60 / (2 * np.pi)),
    ("units", "the right rate times 2π: the phase is in radians already", 2 * np.pi),
    ("constant-factor", "half the right rate: look for an extra factor", 0.5),
    ("constant-factor", "twice the right rate: look for an extra factor", 2.0),
)


class Motion(NamedTuple):
    """A motion given to ``precession_rate``: times (n,) in s, ω (3, n), the exact mean rate and the returned
    ``rate`` in rad/s.
    """

    name: str
    t: Array
    w: Array
    truth: float
    rate: float


def causes_of_rate(answers: Answers) -> list[Diagnosis]:
    """Return the simplest mistake of ``precession_rate`` that predicts all its answers, or two mistakes of
    one code.
    """
    motions = [_motion(scene, inputs, float(seen["rate"])) for scene, (inputs, seen) in answers.items()]
    if all(_near(m.rate, m.truth) for m in motions):
        return []
    if not any(m.rate for m in motions):
        return [_cause("returns-zero", "precession_rate returns zero for all arguments")]
    mistakes = list(zip(*(_mistakes(m.t, m.w, m.truth) for m in motions), strict=True))
    found = _reproduced(mistakes, [m.rate for m in motions])
    if not found:
        reversed_ = _reproduced(mistakes, [-m.rate for m in motions])
        found = {f"{sentence}, with the opposite sign": code for sentence, code in reversed_.items()}
    if found:
        code = next(iter(found.values()))  # of the simplest mistake
        named = [sentence for sentence, its in found.items() if its == code]
        return [_cause(code, "; or ".join(named))] if len(named) <= MOST_NAMED else []
    return _proportional(motions) or _of_spectrum(motions) or _nearly(motions) or _partly(motions)


def _motion(scene: str, inputs: Inputs, rate: float) -> Motion:
    t, w = np.asarray(inputs["t"], dtype=float), np.asarray(inputs["w"], dtype=float)
    return Motion(TURNS[scene], t, w, reference.precession_rate(t, w), rate)


def _reproduced(mistakes: list[tuple[Predicted, ...]], rates: list[float]) -> dict[str, str]:
    """Return sentence and code of each mistake whose numbers, one for each motion, are the ``rates``."""
    return {row[0][1]: row[0][0] for row in mistakes if all(_near(rate, each[2]) for rate, each in zip(rates, row, strict=True))}


def _proportional(motions: list[Motion]) -> list[Diagnosis]:
    """Return the diagnosis if the rates are in one ratio to ω₃, or to the right rates, in several motions."""
    if len(motions) < 2:
        return []
    for code, sentence, quantities in (
        ("hard-coded-moments", "{:.6g} ω₃: the rate of one body; measure it from (ω₁, ω₂)", [m.w[2].mean() for m in motions]),
        ("constant-factor", "{:.6g} times the right rate: look for an extra factor", [m.truth for m in motions]),
    ):
        ratios = [m.rate / quantity for m, quantity in zip(motions, quantities, strict=True)]
        if ratios[0] and all(_near(ratio, ratios[0]) for ratio in ratios):
            return [_cause(code, sentence.format(ratios[0]))]
    return []


def _of_spectrum(motions: list[Motion]) -> list[Diagnosis]:
    """Return the diagnosis if each rate is a line of the record's Fourier spectrum."""
    for spans in zip(*(_spans(m.t) for m in motions), strict=True):
        turns = np.array([m.rate * span / (2 * np.pi) for m, span in zip(motions, spans, strict=True)])
        if len(turns) > 1 and turns.any() and np.all(np.abs(turns - np.round(turns)) <= AGREEMENT * np.maximum(1.0, np.abs(turns))):
            sentence = "a line of the Fourier spectrum, which resolves the rate only to 2π over the record's length: use the phase"
            return [_cause("wrong-quantity", sentence)]
    return []


def _spans(t: Array) -> tuple[float, ...]:
    """Return the length in s of a record of times (n,), by each way of taking its step."""
    step, n = np.diff(t), len(t)
    return float(t[-1] - t[0]), float(step.mean() * n), float(step[0] * n), float(np.median(step) * n)


def _nearly(motions: list[Motion]) -> list[Diagnosis]:
    off = float(np.max([abs(m.rate / m.truth - 1) for m in motions]))
    if not off <= NEARLY:
        return []
    sentence = f"nearly right: within {off:.2g} of the mean rate; check that it also works when the rate or the time steps vary"
    return [Diagnosis(code="nearly-right", sentence=sentence, confidence=0.8)]


def _partly(motions: list[Motion]) -> list[Diagnosis]:
    """Return the diagnosis that names the motions whose rate is right, if there are any."""
    right = [m.name for m in motions if abs(m.rate - m.truth) <= RIGHT * abs(m.truth)]
    wrong = [m.name for m in motions if m.name not in right]
    sentence = f"right for {' and '.join(right)}, but wrong for {' and '.join(wrong)}"
    return [_cause("partly-right", sentence)] if right and wrong else []


def _mistakes(t: Array, w: Array, truth: float) -> Iterator[Predicted]:
    """Yield code, sentence and number of each mistake, the simplest first, in the same order for every motion."""
    sentence = "the opposite sign: Ω is positive if (ω₁, ω₂) turns from ê₁ to ê₂, so use arctan2(ω₂, ω₁)"
    yield "sign-reversed", sentence, -truth
    yield "absolute-value", "the sign is lost: Ω is negative if (ω₁, ω₂) turns from ê₂ to ê₁", abs(truth)
    for code, sentence, factor in FACTORS:
        yield code, sentence, factor * truth
    yield "wrong-quantity", "the period of the precession instead of its rate", 2 * np.pi / truth
    yield "wrong-quantity", "the inverse of the rate: is the phase fitted as a function of time?", 1 / truth
    yield "wrong-quantity", "the inverse of the rate: is the phase fitted as a function of time?", _slope(_phase(w, 1, 0), t)
    yield "returns-input", "the spin ω₃ itself instead of the rate at which (ω₁, ω₂) turns", float(w[2].mean())
    yield from _wrong_phases(t, w)
    yield from _wrong_steps(t, w)
    yield from _wrong_times(t, _phase(w, 1, 0))


def _wrong_phases(t: Array, w: Array) -> Iterator[Predicted]:
    jumps = "the phase jumps by 2π and is not unwrapped before its slope is taken: see np.unwrap"
    halves = "arctan does not distinguish quadrants, so the phase jumps by π: use arctan2(ω₂, ω₁), and np.unwrap"
    with np.errstate(all="ignore"):
        for sentence, phase in ((jumps, np.arctan2(w[1], w[0])), (jumps, np.arctan2(w[0], w[1])), (halves, np.arctan(w[1] / w[0]))):
            for value in _means(t, phase):
                yield "not-unwrapped", sentence, value
        for period in (2 * np.pi, np.pi):
            for value in _means(t, np.unwrap(np.arctan(w[1] / w[0]), period=period)):
                yield "not-unwrapped", halves, value
        degrees = "the phase in degrees is unwrapped as if it were in radians: np.unwrap needs period=360, or radians"
        for value in _means(t, np.radians(np.unwrap(np.degrees(np.arctan2(w[1], w[0]))))):
            yield "not-unwrapped", degrees, value
        half = "the phase is computed from one component, which covers half of the circle: use arctan2(ω₂, ω₁)"
        for part in (w[0], w[1]) / np.sqrt(np.mean(w[0] ** 2 + w[1] ** 2)):
            for angle in (np.arccos(np.clip(part, -1, 1)), np.arcsin(np.clip(part, -1, 1))):
                for value in (*_means(t, np.unwrap(angle)), *_means(t, angle)):
                    yield "wrong-components", half, value
    mixed = "samples and components are mixed: w.reshape(-1, 3) does not transpose, use w.T"
    for value in _means(t, _phase(w.reshape(-1, 3).T, 1, 0)):
        yield "wrong-components", mixed, value
    for a, b in ((2, 0), (0, 2), (2, 1), (1, 2)):
        pair = f"ω{'₁₂₃'[a]} and ω{'₁₂₃'[b]}"
        for value in _means(t, _phase(w, a, b)):
            yield "wrong-components", f"the phase of {pair} is used: the precession turns (ω₁, ω₂)", value


def _wrong_steps(t: Array, w: Array) -> Iterator[Predicted]:
    """Yield mistakes in the angle from one sample to the next."""
    (x, y), r = w[:2], np.hypot(w[0], w[1])
    sine = (x[:-1] * y[1:] - y[:-1] * x[1:]) / (r[:-1] * r[1:])
    forward = np.diff(np.arctan2(y, x)) % (2 * np.pi)
    modulo = "the steps are computed modulo 2π, so that all of them turn the same way: see np.unwrap"
    quarter = "arcsin gives angles up to a quarter of a turn only: use arctan2(ω₂, ω₁), and np.unwrap"
    fine = "ω₁ and ω₂ are differentiated by differences, which needs fine samples: use the phase arctan2(ω₂, ω₁)"
    for code, sentence, steps in (
        ("not-unwrapped", modulo, forward),
        ("not-unwrapped", modulo, forward - 2 * np.pi),
        ("not-unwrapped", quarter, np.arcsin(np.clip(sine, -1, 1))),
        ("partly-right", fine, sine),
    ):
        for value in (steps.sum() / (t[-1] - t[0]), np.mean(steps / np.diff(t)), np.median(steps / np.diff(t))):
            yield code, sentence, float(value)
    rates = (x * np.gradient(y, t) - y * np.gradient(x, t)) / r**2
    for value in (rates.mean(), np.median(rates), _mean_over_time(t, rates)):
        yield "partly-right", fine, float(value)


def _mean_over_time(t: Array, rates: Array) -> float:
    return float(np.sum((rates[1:] + rates[:-1]) / 2 * np.diff(t)) / (t[-1] - t[0]))


def _wrong_times(t: Array, phase: Array) -> Iterator[Predicted]:
    n, whole, step, number = len(t), float(phase[-1] - phase[0]), t[1] - t[0], np.arange(float(len(t)))
    yield "wrong-quantity", "the total angle, not divided by the time", whole
    for middle in (n // 2, (n - 1) // 2):
        half = "the angle over half of the motion, divided by the time of all of it, or the reverse"
        yield "wrong-times", half, (phase[middle] - phase[0]) / (t[-1] - t[0])
        yield "wrong-times", half, whole / (t[middle] - t[0])
    yield "wrong-quantity", "the phase at time zero, the other coefficient of the fitted line", float(np.polyfit(t, phase, 1)[1])
    for value in (whole / n, whole / (n - 1), _slope(number, phase), float(np.median(np.diff(phase)))):
        yield "wrong-times", "the angle per sample: divide by the time between samples", value
    origin = "the time is assumed to start at zero: divide phase[-1] − phase[0] by t[-1] − t[0]"
    for value in (whole / t[-1], phase[-1] / t[-1], float(phase @ t / (t @ t)), float(np.mean(phase[1:] / t[1:]))):
        yield "wrong-times", origin, value
    first = "the first phase is assumed to be zero: the total angle is phase[-1] − phase[0]"
    yield "wrong-times", first, phase[-1] / (t[-1] - t[0])
    rates = np.diff(phase) / np.diff(t)
    gradient = np.gradient(phase, t)
    mean = whole / (t[-1] - t[0])
    for value in (rates.sum() / n, gradient[1:-1].sum() / n, gradient.sum() / (n - 1), mean * (n - 1) / n, mean * n / (n - 1)):
        yield "wrong-times", "a sum is not divided by the number of its terms: use np.mean", float(value)
    even = "the times are assumed to be evenly spaced: use t itself, np.polyfit(t, phase, 1) or np.gradient(phase, t)"
    fitted = (float(np.gradient(phase).mean()), _slope(number, phase))
    steps = (whole / n, whole / (n - 1))
    for spacing, turns in (
        (step, (*steps, *fitted)),
        (t[-1] - t[-2], (*steps, *fitted)),
        ((t[-1] - t[0]) / n, fitted),
        ((t[-1] - t[0]) / (n - 1), fitted),
        (t[-1] / n, (*steps[1:], *fitted)),
        (t[-1] / (n - 1), (*steps[:1], *fitted)),
    ):
        for turn in turns:
            yield "wrong-times", even, turn / spacing
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
    yield float(np.median(np.diff(phase) / np.diff(t)))


def _slope(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0]) if np.all(np.isfinite(y)) else np.nan


def _near(a: float, b: float) -> bool:
    return bool(abs(a - b) <= AGREEMENT * abs(b))


def _cause(code: str, sentence: str) -> Diagnosis:
    return Diagnosis(code=code, sentence=sentence, confidence=1.0)
