"""Likely causes: a wrong answer is compared with known slips, and one is named only if it alone reproduces the numbers."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exercises.outcome import Diagnosis

Array = NDArray[np.float64]

# A hypothesis is the same algebra as the student's slip, so it agrees to rounding or not at all.
AGREEMENT = 1e-10


@dataclass(frozen=True)
class Mistake:
    """A known slip: a public ``code``, a ``sentence`` that says where to look, and the numbers it would give."""

    code: str
    sentence: str
    answer: Callable[[], Array]


def diagnose(seen: Array, mistakes: Iterable[Mistake]) -> list[Diagnosis]:
    """The one mistake whose numbers are ``seen`` to rounding; nothing when none or several of different codes agree."""
    found = [m for m in mistakes if _same(seen, m.answer())]
    if len({m.code for m in found}) != 1:
        return []
    return [Diagnosis(code=found[0].code, sentence=found[0].sentence, confidence=1.0)]


def constant_factor(seen: Array, truth: Array) -> Diagnosis | None:
    """The diagnosis for an answer that is the truth times one constant other than 0, 1 and −1, with its value."""
    scale = float(np.sum(truth * truth))
    factor = float(np.sum(seen * truth)) / scale if scale > 0 else 0.0
    if min(abs(factor), abs(factor - 1), abs(factor + 1)) < AGREEMENT or not _same(seen, factor * truth):
        return None
    sentence = f"every component is {factor:.10g} times the right value: look for a factor that does not belong"
    return Diagnosis(code="constant-factor", sentence=sentence, confidence=1.0)


def _same(seen: Array, expected: Array) -> bool:
    if seen.shape != expected.shape or not np.all(np.isfinite(expected)):
        return False
    scale = max(float(np.abs(expected).max()), float(np.abs(seen).max()))
    return bool(np.all(np.abs(seen - expected) <= AGREEMENT * scale))
