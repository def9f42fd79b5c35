"""Known slips: in ``euler_eqs``, each written as the numbers it gives at the probes; in animations, a picture that stands still."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.film import moving_share
from exercises.assignment import Inputs
from exercises.checks import Arrays
from exercises.diagnosis import Mistake, constant_factor, diagnose
from exercises.outcome import Diagnosis

Array = NDArray[np.float64]

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
COMPONENT = ("ω̇₁", "ω̇₂", "ω̇₃")
DIFFERENCE = ("(I₂ − I₃)", "(I₃ − I₁)", "(I₁ − I₂)")
MOMENT = ("I₁", "I₂", "I₃")


def diagnose_scene(scene: str, inputs: Inputs, seen: Arrays) -> list[Diagnosis]:
    """The likely cause behind the numbers of a scene: of the point-wise probes, or of an animation's stills."""
    if scene == "film" and moving_share(seen["frames"]) <= STILL:
        sentence = "the picture stays the same from frame to frame: does the update function change what is drawn?"
        return [Diagnosis(code="static", sentence=sentence, confidence=1.0)]
    if scene != "probes":
        return []
    w, moments = np.asarray(inputs["w"]), np.asarray(inputs["I"])
    truth, wdot = _rates(w, moments), seen["wdot"]
    if not np.all(np.isfinite(wdot)):
        sentence = "euler_eqs returns values that are not finite: look for a division by zero or an overflow"
        return [Diagnosis(code="not-finite", sentence=sentence, confidence=1.0)]
    if found := diagnose(wdot, _slips(w, moments, truth)):
        return found
    factor = constant_factor(wdot, truth)
    return [factor] if factor else []


def _slips(w: Array, moments: Array, truth: Array) -> Iterator[Mistake]:
    yield Mistake("returns-zero", "euler_eqs returns zeros whatever it is asked", lambda: np.zeros_like(truth))
    yield Mistake("returns-input", "euler_eqs returns ω itself instead of its rate of change", lambda: w)
    yield Mistake(
        "sign-reversed",
        "all three components have the opposite sign: the motion runs backwards in time; check (I₂ − I₃), (I₃ − I₁), (I₁ − I₂)",
        lambda: -truth,
    )
    yield Mistake("swapped-arguments", "w and I look exchanged: the order is euler_eqs(t, w, I)", lambda: _rates(moments, w))
    yield Mistake("missing-division", "no component is divided by its moment: ω̇ᵢ is torque-like here", lambda: truth * moments)
    for places in (1, 2):
        yield Mistake(
            "component-order",
            f"the right numbers in the wrong order: {COMPONENT[-places]} stands first",
            lambda places=places: np.roll(truth, places, axis=1),  # type: ignore[misc]
        )
    for k in range(3):
        yield from _slips_of_one_component(k, w, moments, truth)


def _slips_of_one_component(k: int, w: Array, moments: Array, truth: Array) -> Iterator[Mistake]:
    i, j = (k + 1) % 3, (k + 2) % 3

    def changed(column: Array) -> Array:
        answer = truth.copy()
        answer[:, k] = column
        return answer

    yield Mistake("sign-flipped", f"{COMPONENT[k]} has the opposite sign: check {DIFFERENCE[k]}", lambda: changed(-truth[:, k]))
    yield Mistake("missing-component", f"{COMPONENT[k]} is always zero", lambda: changed(np.zeros(len(truth))))
    yield Mistake("missing-division", f"{COMPONENT[k]} is not divided by {MOMENT[k]}", lambda: changed(truth[:, k] * moments[:, k]))
    yield Mistake(
        "moment-sum",
        f"{COMPONENT[k]} holds the sum of two moments where their difference {DIFFERENCE[k]} belongs",
        lambda: changed((moments[:, i] + moments[:, j]) * w[:, i] * w[:, j] / moments[:, k]),
    )
    for other in (i, j):
        yield Mistake(
            "wrong-divisor",
            f"{COMPONENT[k]} is divided by {MOMENT[other]} instead of {MOMENT[k]}",
            lambda other=other: changed(truth[:, k] * moments[:, k] / moments[:, other]),  # type: ignore[misc]
        )
        yield Mistake(
            "cyclic-order",
            f"{COMPONENT[k]} multiplies ω{'₁₂₃'[k]} where ω{'₁₂₃'[other]} belongs",
            lambda other=other: changed(truth[:, k] * w[:, k] / w[:, other]),  # type: ignore[misc]
        )


def _rates(w: Array, moments: Array) -> Array:
    return reference.euler_rhs(w.T, moments.T).T
