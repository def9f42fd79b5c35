"""The likely causes that ``polhode.check`` reports: those that follow from comparing the answers of
``euler_eqs`` with the exact ones.

The server reports more causes; they need the equations, which are not part of the kit.
"""

import itertools
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis

from .quantities import Array

Mask = NDArray[np.bool_]
Mistake = tuple[str, str, Array]
"""A wrong answer: code, sentence and the numbers that it predicts."""

AGREEMENT = 1e-11  # of the largest value at a point: the same algebra agrees to rounding
ROUNDING = 1e-14  # of the largest product in the right equations at a point
NEARLY, MOST = 0.01, 0.9  # of the largest rate at each point; of the points
COMPONENT = ("ω̇₁", "ω̇₂", "ω̇₃")
DEGREE, RPM, TURN = np.pi / 180, 2 * np.pi / 60, 2 * np.pi
ROUNDED = 2e-4  # relative: what 57.3 or 3.14 for π is off by at most, or nearly so
BACKWARDS = "sign-reversed", "all three components have the opposite sign: the motion runs backwards in time"
TORQUE = "missing-division", "no component is divided by its moment: the result is a torque, not ω̇"
UNITS = {
    1 / DEGREE: "180/π = 57.2958 converts radians into degrees",
    DEGREE: "π/180 converts degrees into radians",
    1 / DEGREE**2: "(180/π)², as if ω were in degrees per second",
    DEGREE**2: "(π/180)², as if ω were converted from degrees into radians",
    RPM: "2π/60 converts revolutions per minute (rpm) into rad/s",
    1 / RPM: "60/2π converts rad/s into revolutions per minute (rpm)",
    RPM**2: "(2π/60)², as if ω were converted from revolutions per minute (rpm) into rad/s",
    1 / RPM**2: "(60/2π)², as if ω were in revolutions per minute (rpm)",
    TURN: "2π converts revolutions into radians",
    1 / TURN: "1/2π converts radians into revolutions",
    TURN**2: "(2π)², as if ω were converted from revolutions per second into rad/s",
    1 / TURN**2: "1/(2π)², as if ω were in revolutions per second",
}


def diagnose(scene: str, inputs: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return the likely causes of what a scene returned, none if nothing singles one out.

    They exist for the scene ``probes``: rates ``wdot`` (n, 3) in rad/s² at points ``w`` and ``I`` (n, 3) of
    ``inputs``.
    """
    if scene != "probes":
        return []
    w, moments = (np.asarray(inputs[name], dtype=float) for name in ("w", "I"))
    got, exact, scale = np.asarray(seen["wdot"]), np.asarray(truth["wdot"]), np.asarray(truth["scale"])
    if not np.all(np.isfinite(got)):
        return [not_finite()]
    right = agree(got, exact, scale)
    if right.all():
        return []
    return (
        known_rates(got, answers(w, moments, exact), scale)
        or _factors(got, exact, scale)
        or nearly_right(got, exact, scale)
    )


def cause(code: str, sentence: str, confidence: float = 1.0, *, component: int | None = None) -> Diagnosis:
    """Return a diagnosis, of one ``component`` (0, 1, 2) of the rates if it is about one."""
    return Diagnosis(code=code, sentence=sentence, confidence=confidence, component=component)


def not_finite(where: str = "") -> Diagnosis:
    """Return the diagnosis of values that are not finite."""
    sentence = (
        f"euler_eqs returns values that are not finite{where}: look for a division by zero or an overflow"
    )
    return cause("not-finite", sentence)


def agree(seen: Array, expected: Array, scale: Array) -> Mask:
    """Return whether each of the rates (n, 3) is the expected one to rounding, or both are not finite.

    ``scale`` (n, 3) is the largest product in the right equations: points differ by many orders of magnitude.
    """
    known, due = np.isfinite(seen), np.isfinite(expected)
    got, want = np.where(known, seen, 0.0), np.where(due, expected, 0.0)
    largest = np.maximum(np.abs(got), np.abs(want)).max(axis=1, keepdims=True)
    return np.asarray((known == due) & (np.abs(got - want) <= AGREEMENT * largest + ROUNDING * scale))


def known_rates(got: Array, mistakes: Iterable[Mistake], scale: Array) -> list[Diagnosis]:
    """Return the diagnosis of rates (n, 3) that are zero, or those of a mistake, or their negatives."""
    if not got.any():
        return [cause("returns-zero", "euler_eqs returns zeros for all arguments")]
    for code, sentence, values in mistakes:
        for sense, backwards in ((1, []), (-1, [cause(*BACKWARDS)])):
            if agree(got, sense * values, scale).all():
                return [cause(code, sentence), *backwards]
    return []


def answers(w: Array, moments: Array, exact: Array) -> list[Mistake]:
    """Return wrong answers (n, 3) that follow from ω, I and the exact rates alone."""
    given = {"ω": w, "I": moments, "L = Iω": moments * w}
    orders = list(itertools.permutations(range(3)))[1:]
    return [
        (*BACKWARDS, -exact),
        *(
            ("returns-input", f"euler_eqs returns {name} itself instead of the rate of change of ω", x)
            for name, x in given.items()
        ),
        (*TORQUE, exact * moments),
        *(
            ("component-order", f"the components are returned in the wrong order: {named(k)}", exact[:, k])
            for k in orders
        ),
    ]


def named(order: Iterable[int]) -> str:
    """Return the components in this order."""
    return ", ".join(COMPONENT[k] for k in order)


def multiple(what: str, factor: float) -> tuple[str, str]:
    """Return code and sentence if ``what`` is the right value times ``factor``."""
    for unit, converts in UNITS.items():
        if abs(abs(factor) / unit - 1.0) < ROUNDED:
            sense = " and the opposite sign" if factor < 0 else ""
            return (
                "units",
                (
                    f"{what} is {factor:.7g} times the right value: {converts}{sense}; ω is in rad/s, ω̇ in"
                    " rad/s²"
                ),
            )
    return "constant-factor", f"{what} is {factor:.10g} times the right value: look for an extra factor"


def nearly_right(got: Array, exact: Array, scale: Array) -> list[Diagnosis]:
    """Return the diagnosis if nearly all rates are within 1 % of the right ones but few are right."""
    largest, size = np.abs(exact).max(axis=1), scale.max(axis=1)
    off = np.abs(got - exact).max(axis=1) / np.where(largest > 0, largest, size)
    near, right = off <= NEARLY, agree(got, exact, scale).all(axis=1)
    if near.mean() < MOST or right.mean() > 1 - MOST / 2:
        return []
    where = "" if near.all() else f" at {near.sum()} of {len(near)} points"
    remedy = "compute the rates from Euler's equations, not by numerical differentiation or integration"
    return [
        cause(
            "nearly-right",
            f"nearly right: within {off[near].max():.2g} of the right values{where}: {remedy}",
            0.8,
        )
    ]


def _factors(got: Array, exact: Array, scale: Array) -> list[Diagnosis]:
    """Return the causes if each component is a constant times the right value."""
    factors = (got * exact).sum(axis=0) / (exact**2).sum(axis=0)
    if not agree(got, factors * exact, scale * (1.0 + np.abs(factors))).all():
        return []
    if np.ptp(factors) <= AGREEMENT * abs(factors[0]):
        return [cause(*multiple("every component", factors[0]))]
    return [_factor(k, factor) for k, factor in enumerate(factors) if abs(factor - 1.0) > AGREEMENT]


def _factor(k: int, factor: float) -> Diagnosis:
    what = COMPONENT[k]
    if factor == 0.0:
        return cause("missing-component", f"{what} is always zero", component=k)
    if abs(factor + 1.0) <= AGREEMENT:
        return cause("sign-flipped", f"{what} has the opposite sign", component=k)
    return cause(*multiple(what, factor), component=k)
