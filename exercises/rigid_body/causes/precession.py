"""The likely cause behind a wrong precession rate: a sense, a unit, or a phase that was not unwrapped."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs

Array = NDArray[np.float64]

AGREEMENT = 1e-5


def causes_of_rate(inputs: Inputs, rate: float) -> list[Diagnosis]:
    """For ``precession_rate`` of the motion ``inputs`` (t, w)."""
    t, w = np.asarray(inputs["t"]), np.asarray(inputs["w"])
    truth = reference.precession_rate(t, w)
    if _near(rate, truth):
        return []
    found = {code: sentence for code, sentence, value in _slips(t, w, truth) if _near(rate, value)}
    return [Diagnosis(code=code, sentence=said, confidence=1.0) for code, said in found.items()] if len(found) == 1 else []


def _slips(t: Array, w: Array, truth: float) -> Iterator[tuple[str, str, float]]:
    yield "sign-reversed", "the opposite sign: Ω is positive where (ω₁, ω₂) turns from ê₁ to ê₂, so arctan2(ω₂, ω₁)", -truth
    for sign in (1, -1):
        and_ = "" if sign > 0 else ", and of the opposite sign"
        yield "units", f"the right rate in turns per second{and_}: multiply by 2π", sign * truth / (2 * np.pi)
        yield "units", f"the right rate in degrees per second{and_}: rad/s are asked for", sign * np.degrees(truth)
        yield "wrong-quantity", f"the period of the precession{and_} instead of its rate", sign * 2 * np.pi / truth
        phase = np.arctan2(w[1], w[0]) if sign > 0 else np.arctan2(w[0], w[1])
        for value in _not_unwrapped(t, phase):
            yield "not-unwrapped", "the phase jumps by 2π and is not unwrapped before its slope is taken: see np.unwrap", value
    yield "returns-input", "the spin ω₃ itself instead of the rate at which (ω₁, ω₂) turns", float(w[2].mean())
    whole = float(np.unwrap(np.arctan2(w[1], w[0]))[-1] - np.arctan2(w[1, 0], w[0, 0]))
    yield "constant-factor", "the angle turned by, not divided by the time", whole


def _not_unwrapped(t: Array, phase: Array) -> Iterator[float]:
    yield float(np.polyfit(t, phase, 1)[0])
    yield float((phase[-1] - phase[0]) / (t[-1] - t[0]))
    yield float(np.mean(np.gradient(phase, t)))
    yield float(np.mean(np.diff(phase) / np.diff(t)))


def _near(a: float, b: float) -> bool:
    return abs(a - b) <= AGREEMENT * abs(b)
