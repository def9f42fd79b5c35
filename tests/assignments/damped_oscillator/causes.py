"""Diagnoses: known mistakes written out. One is reported if it alone reproduces the student's numbers to
rounding.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Inputs
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis

Array = NDArray[np.float64]
Wrong = Callable[[Array, Array, Array, Array], tuple[Array, Array]]

AGREEMENT = 1e-12  # of the largest value
# Code, sentence for the student, and (dx/dt, dv/dt) of x, v, ω, γ with the mistake.
MISTAKES: tuple[tuple[str, str, Wrong], ...] = (
    ("returns-zero", "oscillator returns zeros for all arguments", lambda x, v, w, g: (0 * x, 0 * v)),
    (
        "component-order",
        "the components are returned as (dv/dt, dx/dt)",
        lambda x, v, w, g: (-(w**2) * x - 2 * g * v, v),
    ),
    (
        "sign-flipped",
        "the spring pushes away from rest: its term is −ω²x",
        lambda x, v, w, g: (v, w**2 * x - 2 * g * v),
    ),
    (
        "sign-flipped",
        "the damping adds energy: its term is −2γv",
        lambda x, v, w, g: (v, -(w**2) * x + 2 * g * v),
    ),
    ("missing-term", "the damping term −2γv is missing", lambda x, v, w, g: (v, -(w**2) * x)),
    (
        "constant-factor",
        "the damping is half as large: its term is −2γv",
        lambda x, v, w, g: (v, -(w**2) * x - g * v),
    ),
    ("wrong-quantity", "ω is used instead of ω²", lambda x, v, w, g: (v, -w * x - 2 * g * v)),
)
CODES = (
    *dict.fromkeys(code for code, _, _ in MISTAKES),
    "not-finite",
    "returns-nothing",
    "wrong-shape",
    "signature",
)


def diagnose(scene: str, inputs: Inputs, seen: Arrays) -> list[Diagnosis]:
    """Return the diagnosis of a scene's numbers, or an empty list."""
    if scene != "probes":
        return []
    rate, (x, v), (w, g) = (
        seen["rate"],
        np.asarray(inputs["y"]).T,
        (np.asarray(inputs[name]) for name in ("omega", "gamma")),
    )
    matches = [
        (code, sentence)
        for code, sentence, wrong in MISTAKES
        if _same(rate, np.column_stack(wrong(x, v, w, g)))
    ]
    return (
        [Diagnosis(code=code, sentence=sentence, confidence=1.0) for code, sentence in matches]
        if len(matches) == 1
        else []
    )


def _same(rate: Array, wrong: Array) -> bool:
    return bool(np.abs(rate - wrong).max() <= AGREEMENT * max(np.abs(wrong).max(), np.abs(rate).max()))
