"""The likely cause behind wrong precession rates: each mistake predicts numbers for every given motion."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

import reference
from exercises.authoring.assignments.assignment import Answers
from exercises.rigid_body.causes.algebra import SPIN
from exercises.rigid_body.public.diagnosis import TURN, cause
from exercises.rigid_body.public.quantities import Array
from polhode.judging.outcome import Diagnosis

Numbers = tuple[str, str, Sequence[Any]]

AGREEMENT = 1e-5
NEARLY = 0.01
RIGHT = 1e-3  # the checks' tolerance
MOST_NAMED = 2  # mistakes that predict the same number
MOTIONS = {
    "rate": "uneven times",
    "rate-retrograde": "retrograde precession at evenly spaced times",
    "rate-coarse": "samples nearly half a turn apart",
    "rate-short": "less than one turn",
}


def causes_of_rate(answers: Answers) -> list[Diagnosis]:
    """Return the simplest mistake of ``precession_rate`` that predicts all its answers, or two mistakes of
    one code.
    """
    motions = [
        (np.asarray(inputs["t"], dtype=float), np.asarray(inputs["w"], dtype=float))
        for inputs, _ in answers.values()
    ]
    rates = np.array([float(seen["rate"]) for _, seen in answers.values()])
    truth = np.array([reference.precession_rate(t, w) for t, w in motions])
    if _near(rates, truth):
        return []
    if not rates.any():
        return [cause("returns-zero", "precession_rate returns zero for all arguments")]
    predicted = [
        [*_of_the_rate(*m, right), *_of_the_phase(*m), *_of_the_time(*m)]
        for m, right in zip(motions, truth, strict=True)
    ]
    found = _reproduced(predicted, rates, "") or _reproduced(predicted, -rates, ", with the opposite sign")
    if found:
        code = next(iter(found.values()))  # of the simplest mistake
        named = [sentence for sentence, its in found.items() if its == code]
        return [cause(code, "; or ".join(named))] if len(named) <= MOST_NAMED else []
    return _of_several(motions, rates, truth) or _near_or_partly(
        [MOTIONS[scene] for scene in answers], rates, truth
    )


def _reproduced(predicted: Sequence[Sequence[Numbers]], rates: Array, sense: str) -> dict[str, str]:
    """Return sentence and code of each mistake one of whose numbers is the rate, in all motions alike."""
    found = {}
    for rows in zip(*predicted, strict=True):
        if any(
            _near(rates, np.array(numbers, dtype=float))
            for numbers in zip(*(values for _, _, values in rows), strict=True)
        ):
            found[rows[0][1] + sense] = rows[0][0]
    return found


def _of_several(motions: Sequence[tuple[Array, Array]], rates: Array, truth: Array) -> list[Diagnosis]:
    """Return the diagnosis if the rates of several motions are in one ratio to ω₃ or to the right ones, or if
    each is a line of the record's Fourier spectrum.
    """
    if len(rates) < 2:
        return []
    body, factor = rates / [w[2].mean() for _, w in motions], rates / truth
    if body[0] and _near(body, body[0]):
        return [
            cause("hard-coded-moments", f"{body[0]:.6g} ω₃: the rate of one body; measure it from (ω₁, ω₂)")
        ]
    if factor[0] and _near(factor, factor[0]):
        return [cause("constant-factor", f"{factor[0]:.6g} times the right rate: look for an extra factor")]
    lengths = [
        (t[-1] - t[0], *(len(t) * step for step in (np.diff(t).mean(), t[1] - t[0], np.median(np.diff(t)))))
        for t, _ in motions
    ]
    turns = rates * np.transpose(lengths) / TURN  # in a record's length, by each way of taking its step
    whole = np.abs(turns - np.round(turns)) <= AGREEMENT * np.maximum(1.0, np.abs(turns))
    sentence = (
        "a line of the Fourier spectrum, which resolves the rate only to 2π over the record's length: use the"
        " phase"
    )
    return [cause("wrong-quantity", sentence)] if np.any(whole.all(axis=1)) else []


def _near_or_partly(names: Sequence[str], rates: Array, truth: Array) -> list[Diagnosis]:
    """Return the diagnosis if all rates are nearly right, or the motions whose rate is right, if there are
    any.
    """
    off = np.abs(rates / truth - 1)
    if off.max() <= NEARLY:
        hint = "check that it also works when the rate or the time steps vary"
        return [cause("nearly-right", f"nearly right: within {off.max():.2g} of the mean rate; {hint}", 0.8)]
    where = [
        " and ".join(name for name, each in zip(names, off, strict=True) if (each <= RIGHT) == sense)
        for sense in (True, False)
    ]
    return [cause("partly-right", f"right for {where[0]}, but wrong for {where[1]}")] if all(where) else []


def _of_the_rate(t: Array, w: Array, truth: float) -> Iterator[Numbers]:
    """Yield code, sentence and numbers of each mistake, the simplest first, in the same order for every
    motion.
    """
    opposite = "the opposite sign: Ω is positive if (ω₁, ω₂) turns from ê₁ to ê₂, so use arctan2(ω₂, ω₁)"
    yield "sign-reversed", opposite, [-truth]
    yield "absolute-value", "the sign is lost: Ω is negative if (ω₁, ω₂) turns from ê₂ to ê₁", [abs(truth)]
    yield "units", "the right rate in turns per second: multiply by 2π", [truth / TURN]
    yield "units", "the right rate in degrees per second: return rad/s", [np.degrees(truth)]
    yield "units", "the right rate in turns per minute (rpm): return rad/s", [truth * 60 / TURN]
    yield "units", "the right rate times 2π: the phase is in radians already", [truth * TURN]
    yield "constant-factor", "half the right rate: look for an extra factor", [truth / 2]
    yield "constant-factor", "twice the right rate: look for an extra factor", [truth * 2]
    yield "wrong-quantity", "the period of the precession instead of its rate", [TURN / truth]
    inverse = "the inverse of the rate: is the phase fitted as a function of time?"
    yield "wrong-quantity", inverse, [1 / truth, _slope(_phase(w[1], w[0]), t)]
    yield "returns-input", "the spin ω₃ itself instead of the rate at which (ω₁, ω₂) turns", [w[2].mean()]


def _of_the_phase(t: Array, w: Array) -> Iterator[Numbers]:
    (x, y), r = w[:2], np.hypot(w[0], w[1])
    raw, half = np.arctan2(y, x), np.arctan(y / x)
    jumps = "the phase jumps by 2π and is not unwrapped before its slope is taken: see np.unwrap"
    yield "not-unwrapped", jumps, [*_means(t, raw), *_means(t, np.arctan2(x, y))]
    halves = (
        "arctan does not distinguish quadrants, so the phase jumps by π: use arctan2(ω₂, ω₁), and np.unwrap"
    )
    yield (
        "not-unwrapped",
        halves,
        [*_means(t, half), *_means(t, np.unwrap(half)), *_means(t, np.unwrap(half, period=np.pi))],
    )
    degrees = (
        "the phase in degrees is unwrapped as if it were in radians: np.unwrap needs period=360, or radians"
    )
    yield "not-unwrapped", degrees, _means(t, np.radians(np.unwrap(np.degrees(raw))))
    parts = [np.clip(part / np.sqrt(np.mean(r**2)), -1, 1) for part in (x, y)]
    angles = [angle for part in parts for angle in (np.arccos(part), np.arcsin(part))]
    one = "the phase is computed from one component, which covers half of the circle: use arctan2(ω₂, ω₁)"
    yield (
        "wrong-components",
        one,
        [mean for angle in angles for p in (np.unwrap(angle), angle) for mean in _means(t, p)],
    )
    mixed = "samples and components are mixed: w.reshape(-1, 3) does not transpose, use w.T"
    yield "wrong-components", mixed, _means(t, _phase(*w.reshape(-1, 3).T[[1, 0]]))
    for a, b in ((2, 0), (0, 2), (2, 1), (1, 2)):
        sentence = f"the phase of {SPIN[a]} and {SPIN[b]} is used: the precession turns (ω₁, ω₂)"
        yield "wrong-components", sentence, _means(t, _phase(w[a], w[b]))
    sine = (x[:-1] * y[1:] - y[:-1] * x[1:]) / (r[:-1] * r[1:])
    forward, quarters = np.diff(raw) % TURN, np.arcsin(np.clip(sine, -1, 1))
    modulo = "the steps are computed modulo 2π, so that all of them turn the same way: see np.unwrap"
    yield "not-unwrapped", modulo, [*_steps(t, forward), *_steps(t, forward - TURN)]
    quarter = "arcsin gives angles up to a quarter of a turn only: use arctan2(ω₂, ω₁), and np.unwrap"
    yield "not-unwrapped", quarter, _steps(t, quarters)
    rates = (x * np.gradient(y, t) - y * np.gradient(x, t)) / r**2
    fine = (
        "ω₁ and ω₂ are differentiated by differences, which needs fine samples: use the phase arctan2(ω₂, ω₁)"
    )
    yield (
        "partly-right",
        fine,
        [*_steps(t, sine), rates.mean(), np.median(rates), np.trapezoid(rates, t) / (t[-1] - t[0])],
    )


def _of_the_time(t: Array, w: Array) -> Iterator[Numbers]:
    phase, n, number, middle = (
        _phase(w[1], w[0]),
        len(t),
        np.arange(float(len(t))),
        [len(t) // 2, (len(t) - 1) // 2],
    )
    angle, time, end = phase[-1] - phase[0], t[-1] - t[0], t[-1]
    rates, gradient, mean = np.diff(phase) / np.diff(t), np.gradient(phase, t), angle / time
    yield "wrong-quantity", "the total angle, not divided by the time", [angle]
    half = "the angle over half of the motion, divided by the time of all of it, or the reverse"
    yield "wrong-times", half, [*(phase[middle] - phase[0]) / time, *angle / (t[middle] - t[0])]
    yield (
        "wrong-quantity",
        "the phase at time zero, the other coefficient of the fitted line",
        [np.polyfit(t, phase, 1)[1]],
    )
    per_sample = np.array([angle / n, angle / (n - 1), _slope(number, phase), np.gradient(phase).mean()])
    sampled = "the angle per sample: divide by the time between samples"
    yield "wrong-times", sampled, [*per_sample[:3], np.median(np.diff(phase))]
    from_zero = "the time is assumed to start at zero: divide phase[-1] − phase[0] by t[-1] − t[0]"
    yield (
        "wrong-times",
        from_zero,
        [angle / end, phase[-1] / end, phase @ t / (t @ t), np.mean(phase[1:] / t[1:])],
    )
    yield (
        "wrong-times",
        "the first phase is assumed to be zero: the total angle is phase[-1] − phase[0]",
        [phase[-1] / time],
    )
    sums = [
        rates.sum() / n,
        gradient[1:-1].sum() / n,
        gradient.sum() / (n - 1),
        mean * (n - 1) / n,
        mean * n / (n - 1),
    ]
    yield "wrong-times", "a sum is not divided by the number of its terms: use np.mean", sums
    even = (
        "the times are assumed to be evenly spaced: use t itself, np.polyfit(t, phase, 1) or"
        " np.gradient(phase, t)"
    )
    spaced = [
        *per_sample / (t[1] - t[0]),
        *per_sample / (end - t[-2]),
        *per_sample[2:] * n / time,
        *per_sample[2:] * (n - 1) / time,
    ]
    yield "wrong-times", even, [*spaced, *per_sample[1:] * n / end, *per_sample[[0, 2, 3]] * (n - 1) / end]
    for which, step in (("first", 0), ("last", -1)):
        yield (
            "wrong-times",
            f"the rate of the {which} step only: take the mean over the whole motion",
            [rates[step]],
        )
    extreme = "the fastest or slowest rate of turn: take the mean over the whole motion"
    yield "wrong-times", extreme, [rates.max(), gradient.max(), rates.min(), gradient.min()]


def _phase(sine: Array, cosine: Array) -> Array:
    return np.asarray(np.unwrap(np.arctan2(sine, cosine)))


def _means(t: Array, phase: Array) -> list[Any]:
    return [_slope(t, phase), np.mean(np.gradient(phase, t)), *_steps(t, np.diff(phase))]


def _steps(t: Array, angles: Array) -> list[Any]:
    return [angles.sum() / (t[-1] - t[0]), np.mean(angles / np.diff(t)), np.median(angles / np.diff(t))]


def _slope(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0]) if np.all(np.isfinite(y)) else np.nan


def _near(rates: Array, expected: Array | float) -> bool:
    return bool(np.all(np.abs(rates - expected) <= AGREEMENT * np.abs(expected)))
