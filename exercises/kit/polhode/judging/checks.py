"""Check words: each returns a ``Check`` with a label, scenes, a measured quantity, an explicit tolerance and
its reason.

A check compares the arrays a student's function returned (``seen``) with the exact arrays (``truth``): one
mapping per scene, in the order of the scenes. It never sees the student's code.
"""

import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polhode.judging import comparisons
from polhode.judging.author_errors import LIBRARIES, AuthorError, has_truth, located, with_truth
from polhode.judging.outcome import Outcome, Tolerance
from polhode.judging.verdict import Judgement, Verdict

Arrays = Mapping[str, NDArray[Any]]
Measure = Callable[..., Any]
Locate = Callable[..., str]
MOST_POINTS = 1000  # of one check


@dataclass(frozen=True)
class Check:
    """One labelled claim about scenes. ``word(seen, truth)`` judges it; ``locate(index, *seen)`` names the
    place of the worst value.

    If ``allow`` is given, ``allow(*truth)`` is the tolerance of one grading, and ``tolerance`` describes how
    it is computed. A word that returns UNMEASURED does not apply to what it sees, and the outcome is not
    counted. ``hint(*seen)`` returns remarks that do not affect the verdict. ``points`` is what the check is
    worth. ``arrays`` names those of its scenes' arrays that it reads, if not all.
    """

    id: str
    label: str
    scenes: tuple[str, ...]
    word: Callable[[list[Arrays], list[Arrays]], Judgement]
    tolerance: Tolerance
    locate: Locate | None = None
    allow: Callable[..., Tolerance] | None = None
    hint: Callable[..., list[str]] | None = None
    points: int = 1
    arrays: tuple[str, ...] | None = None

    def judge(self, seen: list[Arrays], truth: list[Arrays]) -> Outcome:
        """Return the outcome for the arrays of the check's scenes.

        A value that is not finite fails before any comparison, unless it is the exact one, such as an
        argument. Numbers too large or small for arithmetic are unmeasured. Raises AuthorError if the check
        itself fails: for a cause other than the numbers, or also if the exact arrays stand in place of the
        returned ones.
        """
        for arrays in seen:
            for name, array in arrays.items():
                is_read = array.dtype.kind == "f" and (self.arrays is None or name in self.arrays)
                if (
                    is_read
                    and not np.all(np.isfinite(array))
                    and not any(_has(exact, name, array) for exact in truth)
                ):
                    return self._outcome(
                        Judgement(Verdict.FAIL, f"{name} holds values that are not finite numbers"), seen
                    )
        try:
            judgement = self.word(seen, truth)
        except MemoryError:
            raise
        except Exception as error:
            if self._is_at_fault(error, seen, truth):
                raise AuthorError(f"check {self.id}: {self._place(error)}") from error
            # Shapes are right and values finite, but arithmetic on them overflows: that is neither right nor
            # wrong.
            return self.unmeasured(f"the returned numbers are too large or too small to compare ({error})")
        if judgement.misshapen and self.word(with_truth(seen, truth), truth).misshapen:
            raise AuthorError(f"check {self.id}: {self._place(ValueError(judgement.detail))}")
        if judgement.verdict is Verdict.UNMEASURED:
            return replace(self.unmeasured(judgement.detail), counted=False)
        try:
            outcome = self._outcome(judgement, seen)
            outcome.hints = self.hint(*seen) if self.hint else []
            return replace(outcome, tolerance=self.allow(*truth)) if self.allow else outcome
        except Exception as error:
            raise AuthorError(f"check {self.id}: {self._place(error)}") from error

    def _is_at_fault(self, error: Exception, seen: list[Arrays], truth: list[Arrays]) -> bool:
        """Return whether an exception follows from the check itself, not from the student's finite numbers of
        the right shapes.
        """
        if not isinstance(error, ArithmeticError | ValueError | IndexError):
            return True
        if not has_truth(seen, truth):
            return isinstance(error, IndexError)
        try:
            self.word(with_truth(seen, truth), truth)
        except Exception:
            return True
        return False

    def _place(self, error: Exception) -> str:
        """Return file, line and message: of the code that raised the error, else of the function that the
        check calls.
        """
        frames = [
            f
            for f in traceback.extract_tb(error.__traceback__)
            if f.filename not in (__file__, comparisons.__file__)
        ]
        if own := [frame for frame in frames if not LIBRARIES & set(Path(frame.filename).parts)]:
            return located(error, own[-1])
        variables = dict(zip(self.word.__code__.co_freevars, self.word.__closure__ or (), strict=True))
        functions = [
            variables[name].cell_contents
            for name in ("expected", "measured", "series", "claim")
            if name in variables
        ]
        code = next((f.__code__ for f in functions if hasattr(f, "__code__")), None)
        return (
            f"{Path(code.co_filename).name} line {code.co_firstlineno}: " if code else ""
        ) + f"{type(error).__name__}: {error}"

    def failed(self, detail: str) -> Outcome:
        """Return a failed outcome, for answers that cannot be trusted."""
        return self._outcome(Judgement(Verdict.FAIL, detail), [])

    def unmeasured(self, cause: str) -> Outcome:
        """Return an unmeasured outcome, for a scene that returned no data."""
        return replace(
            self._outcome(Judgement(Verdict.UNMEASURED, f"not measured: {cause}"), []), cause=cause
        )

    def errors(self) -> list[str]:
        """Return the errors of the declaration as sentences, empty if there are none."""
        found = []
        if not self.tolerance.reason.strip():
            found.append(f"check {self.id}: its tolerance has no reason")
        if any(not (n >= 0 and np.isfinite(n)) for n in self.tolerance.numbers().values()):
            found.append(f"check {self.id}: a tolerance must be a finite number ≥ 0")
        if not self.label.strip() or "   " in self.label or "\n" in self.label:
            found.append(f"check {self.id}: a label must be one line without three spaces in a row")
        found += [f"check {self.id}: {error}" for error in points_errors(self.points)]
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
            points=self.points,
            partial=judgement.partial,
        )


def _has(exact: Arrays, name: str, array: NDArray[Any]) -> bool:
    return name in exact and np.array_equal(array, exact[name], equal_nan=True)


def points_errors(points: Any) -> list[str]:
    """Return the error of what a check is worth as a sentence, empty if there is none."""
    is_integer = isinstance(points, int) and not isinstance(points, bool)
    return (
        []
        if is_integer and 0 <= points <= MOST_POINTS
        else [f"points is {points!r}; it must be an integer from 0 to {MOST_POINTS}"]
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
    """Check that ``measured(*seen)`` equals ``expected`` to ``atol + rtol·|expected|``.

    ``expected`` is a value or a function of the truth. It has the shape of the measured array; nothing is
    broadcast. All are in the same unit. A shape that differs fails, or is an AuthorError if that of the truth
    differs too.

    >>> check = close(
    ...     "1-trace", "the trace is 3 kg m²", "tensor",
    ...     measured=lambda seen: seen["moments"].sum(), expected=3.0, rtol=1e-9, atol=0.0, reason="rounding",
    ... )
    >>> print(check.judge([{"moments": np.array([1.0, 1.0, 1.0])}], [{}]).line)
    ✓  the trace is 3 kg m²   [got 3 vs expected 3 (rtol=1e-09, atol=0)]
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        want = expected(*truth) if callable(expected) else expected
        return comparisons.close(measured(*seen), want, rtol, atol)

    return Check(id, label, scenes, word, Tolerance(rtol=rtol, atol=atol, reason=reason), locate)


def within(
    id: str,
    label: str,
    *scenes: str,
    measured: Measure,
    expected: Measure,
    scale: Measure,
    limit: float | Callable[..., Tolerance],
    reason: str,
    locate: Locate | None = None,
) -> Check:
    """Check that ``measured(*seen)`` equals ``expected(*truth)`` to ``limit · scale(*truth)``.

    ``scale`` returns one number or an array of the shape of ``expected``, in its unit; ``limit`` has no unit.
    A function ``limit(*truth)`` returns the Tolerance of one grading instead, with its ``limit`` and reason.
    A shape that differs is judged as by ``close``.

    >>> check = within(
    ...     "2-motion",
    ...     "ω(t) follows the exact motion",
    ...     "run",
    ...     measured=lambda seen: seen["w"],
    ...     expected=lambda truth: truth["w"],
    ...     scale=lambda truth: truth["w"].max(),
    ...     limit=1e-9,
    ...     reason="of the largest |ω|",
    ... )
    >>> print(check.judge([{"w": np.array([2.0, 4.0])}], [{"w": np.array([2.0, 5.0])}]).line)
    ✗  ω(t) follows the exact motion   [max|Δ|/scale = 0.2 (limit 1e-09)]
    """
    allow = limit if callable(limit) else None

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        allowed = allow(*truth).limit if allow else limit
        assert isinstance(allowed, float)
        return comparisons.within(measured(*seen), expected(*truth), scale(*truth), allowed)

    return Check(
        id,
        label,
        scenes,
        word,
        Tolerance(limit=None if callable(limit) else limit, reason=reason),
        locate,
        allow,
    )


def conserved(
    id: str,
    label: str,
    *scenes: str,
    series: Measure,
    limit: float,
    reason: str,
    locate: Locate | None = None,
) -> Check:
    """Check that ``series(*seen)`` (n,) stays at its first value to the relative ``limit``.

    A series that starts at zero must stay zero. Fewer than two values fail.

    >>> check = conserved(
    ...     "2-energy",
    ...     "T is conserved",
    ...     "run",
    ...     series=lambda seen: seen["w"][0] ** 2,
    ...     limit=1e-6,
    ...     reason="the course's limit",
    ... )
    >>> print(check.judge([{"w": np.array([[1.0, 1.0, 1.0]])}], [{}]).line)
    ✓  T is conserved   [max relative drift = 0 (limit 1e-06)]
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        return comparisons.conserved(series(*seen), limit)

    return Check(id, label, scenes, word, Tolerance(limit=limit, reason=reason), locate)


def below(
    id: str,
    label: str,
    *scenes: str,
    measured: Measure,
    limit: float,
    reason: str,
    locate: Locate | None = None,
) -> Check:
    """Check that ``measured(*seen)``, a number or an array of any shape, is at most ``limit`` everywhere, in
    its unit.

    An empty array fails.

    >>> check = below(
    ...     "6-momentum",
    ...     "L stays fixed",
    ...     "run",
    ...     measured=lambda seen: np.ptp(seen["L"]),
    ...     limit=1e-8,
    ...     reason="integration error",
    ... )
    >>> print(check.judge([{"L": np.array([4.0, 4.5])}], [{}]).line)
    ✗  L stays fixed   [got 0.5 (limit 1e-08)]
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        return comparisons.below(measured(*seen), limit)

    return Check(id, label, scenes, word, Tolerance(limit=limit, reason=reason), locate)


def holds(
    id: str,
    label: str,
    *scenes: str,
    claim: Callable[..., tuple[bool, str]],
    reason: str,
    hint: Callable[..., list[str]] | None = None,
) -> Check:
    """Check a claim that has no single number: ``claim(*seen)`` returns (true or false, the text for the
    brackets).

    Only a true bool passes; an array does not.

    >>> check = holds(
    ...     "5-growth", "only the second spin grows", "first", "second", reason="five times the nudge",
    ...     claim=lambda *runs: (bool(runs[0]["w"].max() < 0.1 < runs[1]["w"].max()), "two runs"),
    ... )
    >>> print(check.judge([{"w": np.array([0.02])}, {"w": np.array([1.1])}], [{}, {}]).line)
    ✓  only the second spin grows   [two runs]
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        ok, detail = claim(*seen)
        return comparisons.holds(ok, detail)

    return Check(id, label, scenes, word, Tolerance(reason=reason), hint=hint)


def shows(
    id: str, label: str, *scenes: str, claim: Callable[..., tuple[bool | None, str]], reason: str
) -> Check:
    """Check a claim against the truth: ``claim(*seen, *truth)`` returns (true, false or None, the text for
    the brackets). With two scenes it is called as ``claim(seen_1, seen_2, truth_1, truth_2)``.

    None means that the claim does not apply: the outcome is unmeasured and not counted.

    >>> check = shows(
    ...     "6-follows", "the drawing follows ê₃", "film", reason="to 3 % of the path",
    ...     claim=lambda seen, truth: (None, "nothing is drawn"),
    ... )
    >>> print(check.judge([{"tracks": np.zeros((1, 1, 3))}], [{}]).line)
    –  the drawing follows ê₃   [not measured: nothing is drawn]
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        ok, detail = claim(*seen, *truth)
        return Judgement(Verdict.UNMEASURED, detail) if ok is None else comparisons.holds(ok, detail)

    return Check(id, label, scenes, word, Tolerance(reason=reason))
