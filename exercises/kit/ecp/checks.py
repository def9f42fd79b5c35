"""The check words as declarations: label, scenes, what is measured, an explicit tolerance and its reason.

A check reads the arrays its scenes brought back (``seen``) and the same arrays of the exact motion (``truth``), one mapping
per scene, in the order the scenes are named. It never sees the student's code.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ecp import judge
from ecp.judge import Judgement, Verdict
from ecp.outcome import Outcome, Tolerance

Arrays = Mapping[str, NDArray[Any]]
Measure = Callable[..., Any]
Locate = Callable[..., str]


@dataclass(frozen=True)
class Check:
    """One labelled claim. ``word(seen, truth)`` judges; ``locate(index, *seen)`` names the place of the worst value.

    ``allow(*truth)`` is the tolerance of this attempt, where it follows from the scene; ``tolerance`` then says how. A word that
    answers UNMEASURED does not apply to what it sees: the outcome is not counted. ``hint(*seen)`` are remarks that cost nothing.
    """

    id: str
    label: str
    scenes: tuple[str, ...]
    word: Callable[[list[Arrays], list[Arrays]], Judgement]
    tolerance: Tolerance
    locate: Locate | None = None
    allow: Callable[..., Tolerance] | None = None
    hint: Callable[..., list[str]] | None = None

    def judge(self, seen: list[Arrays], truth: list[Arrays]) -> Outcome:
        """The outcome for arrays that came back; anything not finite fails before any number is compared."""
        for arrays in seen:
            for name, array in arrays.items():
                if array.dtype.kind == "f" and not np.all(np.isfinite(array)):
                    return self._outcome(Judgement(Verdict.FAIL, f"{name} holds values that are not finite numbers"), seen)
        try:
            judgement = self.word(seen, truth)
        except (ArithmeticError, LookupError, TypeError, ValueError, np.linalg.LinAlgError) as error:
            # The arrays have the right shape and are finite, but their size is beyond arithmetic: that says nothing either way.
            return self.unmeasured(f"the numbers that came back are beyond what can be judged ({error})")
        if judgement.verdict is Verdict.UNMEASURED:
            return replace(self.unmeasured(judgement.detail), counted=False)
        outcome = self._outcome(judgement, seen)
        outcome.hints = self.hint(*seen) if self.hint else []
        return replace(outcome, tolerance=self.allow(*truth)) if self.allow else outcome

    def failed(self, detail: str) -> Outcome:
        """The outcome when the answers themselves cannot be believed."""
        return self._outcome(Judgement(Verdict.FAIL, detail), [])

    def unmeasured(self, cause: str) -> Outcome:
        """The outcome when a scene it needs brought nothing back."""
        return replace(self._outcome(Judgement(Verdict.UNMEASURED, f"not measured: {cause}"), []), cause=cause)

    def errors(self) -> list[str]:
        """What is wrong with the declaration; empty if nothing is."""
        numbers = [n for n in (self.tolerance.rtol, self.tolerance.atol, self.tolerance.limit) if n is not None]
        found = []
        if not self.tolerance.reason.strip():
            found.append(f"check {self.id}: its tolerance gives no reason")
        if any(not (n >= 0 and np.isfinite(n)) for n in numbers):
            found.append(f"check {self.id}: a tolerance is a finite number ≥ 0")
        if not self.label.strip() or "   " in self.label or "\n" in self.label:
            found.append(f"check {self.id}: a label is one line without three spaces in a row")
        return found

    def _outcome(self, judgement: Judgement, seen: list[Arrays]) -> Outcome:
        at = judgement.where
        return Outcome(
            id=self.id,
            label=self.label,
            verdict=judgement.verdict,
            detail=judgement.detail,
            measured=judgement.measured,
            expected=judgement.expected,
            tolerance=self.tolerance,
            margin=judgement.margin,
            where=self.locate(at, *seen) if self.locate and at is not None else None,
        )


def close(
    id: str,
    label: str,
    *scenes: str,
    measured: Measure,
    expected: Measure | ArrayLike,
    rtol: float,
    atol: float,
    reason: str,
    locate: Locate | None = None,
) -> Check:
    """``measured(*seen)`` equals ``expected`` (a value, or a function of the truth) to ``atol + rtol·|expected|``."""

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        want = expected(*truth) if callable(expected) else expected
        return judge.close(measured(*seen), want, rtol, atol)

    return Check(id, label, scenes, word, Tolerance(rtol=rtol, atol=atol, reason=reason), locate)


def within(
    id: str,
    label: str,
    scene: str,
    *,
    measured: Measure,
    expected: Measure,
    scale: Measure,
    limit: float | Callable[[Arrays], Tolerance],
    reason: str,
    locate: Locate | None = None,
) -> Check:
    """``measured(seen)`` equals ``expected(truth)`` to ``limit · scale(truth)``; a ``limit`` that follows from the truth gives its
    product and the reason for this attempt."""
    allow = limit if callable(limit) else None

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        allowed = allow(truth[0]).limit if allow else limit
        assert isinstance(allowed, float)
        return judge.within(measured(seen[0]), expected(truth[0]), scale(truth[0]), allowed)

    return Check(id, label, (scene,), word, Tolerance(limit=None if callable(limit) else limit, reason=reason), locate, allow)


def conserved(id: str, label: str, *scenes: str, series: Measure, limit: float, reason: str, locate: Locate | None = None) -> Check:
    """``series(*seen)`` (n,) stays at its first value to the relative ``limit``."""

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        return judge.conserved(series(*seen), limit)

    return Check(id, label, scenes, word, Tolerance(limit=limit, reason=reason), locate)


def below(id: str, label: str, *scenes: str, measured: Measure, limit: float, reason: str, locate: Locate | None = None) -> Check:
    """``measured(*seen)`` is at most ``limit``."""

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        return judge.below(measured(*seen), limit)

    return Check(id, label, scenes, word, Tolerance(limit=limit, reason=reason), locate)


def holds(
    id: str,
    label: str,
    *scenes: str,
    claim: Callable[..., tuple[bool, str]],
    reason: str,
    hint: Callable[..., list[str]] | None = None,
) -> Check:
    """``claim(*seen)`` answers (true or false, the text for the brackets)."""

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        ok, detail = claim(*seen)
        return judge.holds(ok, detail)

    return Check(id, label, scenes, word, Tolerance(reason=reason), hint=hint)


def shows(id: str, label: str, scene: str, *, claim: Callable[[Arrays, Arrays], tuple[bool | None, str]], reason: str) -> Check:
    """``claim(seen, truth)`` answers (true, false, or None where there is nothing to judge by; the text for the brackets)."""

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        ok, detail = claim(seen[0], truth[0])
        return Judgement(Verdict.UNMEASURED, detail) if ok is None else judge.holds(ok, detail)

    return Check(id, label, (scene,), word, Tolerance(reason=reason))
