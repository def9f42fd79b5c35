"""The likely causes that ``ecp.check`` reports: those that follow from comparing the answers of ``euler_eqs``
with the exact ones.

The server reports more causes; they need the equations, which are not part of the kit.
"""

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays
from ecp.outcome import Diagnosis

Array = NDArray[np.float64]

AGREEMENT = 1e-9  # of the largest value at a point
ROUNDING = 1e-13  # of the largest product Iω²/I at a point
NEARLY = 0.01  # of the largest value at a point
COMPONENT = ("ω̇₁", "ω̇₂", "ω̇₃")
UNITS = {
    180 / np.pi: "180/π converts radians into degrees",
    np.pi / 180: "π/180 converts degrees into radians",
    2 * np.pi / 60: "2π/60 converts revolutions per minute into rad/s",
    60 / (2 * np.pi): "60/2π converts rad/s into revolutions per minute",
}


def diagnose(scene: str, inputs: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return the likely causes of what a scene returned, none if nothing singles one out.

    They exist for the scene ``probes``: rates ``wdot`` (n, 3) in rad/s² at points ``w`` and ``I`` (n, 3) of
    ``inputs``.
    """
    if scene != "probes":
        return []
    w, moments = (np.asarray(inputs[name], dtype=float) for name in ("w", "I"))
    got, exact = np.asarray(seen["wdot"]), np.asarray(truth["wdot"])
    if not np.all(np.isfinite(got)):
        return [_cause("not-finite", "euler_eqs returns values that are not finite: look for a division by zero or an overflow")]
    rounding = ROUNDING * np.asarray(truth["scale"])
    if _agree(got, exact, rounding):
        return []
    for name, given in (("ω", w), ("I", moments), ("L = Iω", moments * w)):
        if _agree(got, given, rounding):
            return [_cause("returns-input", f"euler_eqs returns {name} itself instead of the rate of change of ω")]
    if _agree(got, exact * moments, rounding * moments):
        return [_cause("missing-division", "no component is divided by its moment: the result is a torque, not ω̇")]
    return _factors(got, exact, rounding) or _exchanged(got, exact, rounding) or _nearly(got, exact)


def _factors(got: Array, exact: Array, rounding: Array) -> list[Diagnosis]:
    """Return the causes if each component is a constant times the right value."""
    if not got.any():
        return [_cause("returns-zero", "euler_eqs returns zeros for all arguments")]
    found = [_factor(*column) for column in zip(got.T, exact.T, rounding.T, strict=True)]
    factors = [factor for factor in found if factor is not None]
    if len(factors) < len(found):
        return []
    if np.allclose(factors, -1.0, rtol=AGREEMENT):
        return [_cause("sign-reversed", "all three components have the opposite sign: the motion runs backwards in time")]
    if np.ptp(factors) <= AGREEMENT * abs(factors[0]):
        return [_times("every component", factors[0])]
    return [_times(COMPONENT[k], factor) for k, factor in enumerate(factors) if abs(factor - 1.0) > AGREEMENT]


def _factor(got: Array, exact: Array, rounding: Array) -> float | None:
    """Return the constant ``got`` / ``exact`` (n,), None if it varies."""
    factor = float(np.median(got[exact != 0] / exact[exact != 0]))
    allowed = AGREEMENT * np.abs(got) + rounding * (1.0 + abs(factor))
    return factor if np.all(np.abs(got - factor * exact) <= allowed) else None


def _times(what: str, factor: float) -> Diagnosis:
    if factor == 0.0:
        return _cause("missing-component", f"{what} is always zero")
    if abs(factor + 1.0) <= AGREEMENT:
        return _cause("sign-flipped", f"{what} has the opposite sign")
    for unit, converts in UNITS.items():
        if abs(factor / unit - 1.0) <= AGREEMENT:
            return _cause("units", f"{what} is {factor:.6g} times the right value: {converts}")
    return _cause("constant-factor", f"{what} is {factor:.10g} times the right value: look for an extra factor")


def _exchanged(got: Array, exact: Array, rounding: Array) -> list[Diagnosis]:
    for order in itertools.permutations(range(3)):
        if _agree(got, exact[:, order], rounding):
            stands = ", ".join(COMPONENT[k] for k in order)
            return [_cause("component-order", f"the components are returned in the wrong order: {stands}")]
    return []


def _nearly(got: Array, exact: Array) -> list[Diagnosis]:
    off = np.abs(got - exact).max(axis=1) / np.maximum(np.abs(exact).max(axis=1), np.finfo(float).tiny)
    if off.max() > NEARLY:
        return []
    remedy = "compute the rates from Euler's equations, not by numerical differentiation or integration"
    sentence = f"nearly right: within {off.max():.2g} of the right values: {remedy}"
    return [Diagnosis(code="nearly-right", sentence=sentence, confidence=0.8)]


def _agree(got: Array, expected: Array, rounding: Array) -> bool:
    largest = np.maximum(np.abs(got), np.abs(expected)).max(axis=1, keepdims=True)
    return bool(np.all(np.abs(got - expected) <= AGREEMENT * largest + rounding))


def _cause(code: str, sentence: str) -> Diagnosis:
    return Diagnosis(code=code, sentence=sentence, confidence=1.0)
