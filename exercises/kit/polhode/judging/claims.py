"""A call of a course's validation word as data, and its judgement by the meaning that the course's package
gives the word: what ``numpy.allclose`` compares, a drift relative to the first value.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polhode.judging import comparisons
from polhode.judging.verdict import MARKS, Judgement, Verdict, line, verdict_of

Array = NDArray[np.float64] | NDArray[np.complex128]
MODULE, WORDS = "validate", "words.txt"
MOST_LABEL, MOST_DETAIL = 200, 500  # characters


class Kind(NamedTuple):
    """The names of the arrays and numbers that a kind of claim needs, and the judgement that takes them in
    this order.
    """

    arrays: tuple[str, ...]
    numbers: tuple[str, ...]
    judge: Callable[..., Judgement]


@dataclass(frozen=True)
class Claim:
    """A call of a validation word. Only arrays of kind "close" may be complex.

    ``detail`` is what the package printed in the brackets, after the ``mark``, and ``own`` the detail that
    the call passed. ``said`` is the verdict of the package itself, which ``raised`` if it was strict.
    ``unjudged`` says why the arrays are missing although the claim counts as the package said; ``left_out``
    why it counts for nothing. ``found`` is the judgement of arrays that came in blocks.
    """

    kind: str
    label: str
    arrays: Mapping[str, Array] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)
    detail: str = ""
    mark: str = ""
    own: str = ""
    said: bool = False
    raised: bool = False
    unjudged: str = ""
    left_out: str = ""
    found: Judgement | None = None

    def judged(self) -> Judgement:
        """Return the judgement, with the detail that was printed if its mark is that of the verdict."""
        if self.left_out:
            return Judgement(Verdict.UNMEASURED, f"not measured: {self.left_out}")
        if self.unjudged:
            reported = f"as your notebook reports it, not judged again: {self.unjudged}"
            return comparisons.holds(self.said, f"{self.detail}; {reported}" if self.detail else reported)
        found = self.found or self._found()
        printed = self.mark == MARKS[found.verdict]
        detail = self.detail if printed else self.own or found.detail
        return Judgement(found.verdict, detail, found.measured, found.expected, found.margin)

    def with_block(self, arrays: Mapping[str, Array]) -> "Claim":
        """Return the claim judged by one more block of its arrays."""
        found = replace(self, arrays={**self.arrays, **arrays})._found()
        return replace(self, found=found if self.found is None else _together(self.kind, self.found, found))

    def _found(self) -> Judgement:
        kind = kind_of(self.kind)
        with np.errstate(all="ignore"):
            return kind.judge(
                *(self.arrays[a] for a in kind.arrays), *(self.numbers[n] for n in kind.numbers)
            )

    def outcome(self, cell: str) -> "NotebookCheck":
        """Return the judged claim, made in ``cell``, as a report's NotebookCheck."""
        found = self.judged()
        return NotebookCheck(
            cell=cell, kind=self.kind, label=self.label, verdict=found.verdict, detail=found.detail
        )


@dataclass(kw_only=True)
class NotebookCheck:
    """A line of the notebook's own checks in a report, judged again from the numbers that the student's code
    passed.

    It is self-reported: the student's code chooses the numbers. It carries no points and changes no verdict.
    """

    cell: str
    kind: str
    label: str
    verdict: Verdict
    detail: str

    COMPUTED_FIELDS: ClassVar = ("line",)

    @property
    def line(self) -> str:
        """Return the ✓/✗ line as the notebook prints it."""
        return line(self.verdict, self.label, self.detail)


def _together(kind: str, one: Judgement, other: Judgement) -> Judgement:
    """Return the judgement of two blocks: ✓ if both are, with the detail of the block that is worse."""
    sign = -1.0 if kind == "positive" else 1.0
    measured = [np.inf if np.isnan(m) else sign * m for m in (one.measured or 0.0, other.measured or 0.0)]
    worse = other if measured[1] > measured[0] else one
    both = one.verdict is other.verdict is Verdict.PASS
    margins = [found.margin for found in (one, other) if found.margin is not None]
    return replace(worse, verdict=verdict_of(both), margin=min(margins, default=None))


def one_line(value: Any, most: int) -> str:
    """Return ``value`` as text without line breaks, at most ``most`` characters long. Blanks inside a line
    stay.
    """
    try:
        return " ".join(line.strip() for line in str(value).splitlines())[:most]
    except Exception:
        return type(value).__name__


def _close(got: Array, expected: Array, rtol: float, atol: float) -> Judgement:
    """Judge as ``numpy.allclose``: shapes are broadcast, and equal infinities are close."""
    tolerance = f"(rtol={rtol:g}, atol={atol:g})"
    try:
        np.broadcast_shapes(got.shape, expected.shape)
        fits = bool(got.size) == bool(expected.size)
    except ValueError:
        fits = False
    if not fits:
        shapes = f"shape {got.shape} vs expected shape {expected.shape} {tolerance}"
        return Judgement(Verdict.FAIL, shapes, misshapen=True)
    verdict = verdict_of(bool(np.allclose(got, expected, rtol=rtol, atol=atol)))
    delta = np.where(got == expected, 0.0, np.abs(got - expected))
    margin = comparisons.least_margin(delta, np.broadcast_to(atol + rtol * np.abs(expected), delta.shape))
    if got.size == expected.size == 1 and not np.iscomplexobj(got) and not np.iscomplexobj(expected):
        seen, want = float(got.real.item()), float(expected.real.item())
        return Judgement(verdict, f"got {seen:.6g} vs expected {want:.6g} {tolerance}", seen, want, margin)
    largest = float(delta.max()) if delta.size else 0.0
    return Judgement(verdict, f"max|Δ| = {largest:.6g} {tolerance}", largest, 0.0, margin)


def _conserved(series: NDArray[np.float64], limit: float) -> Judgement:
    """Judge the largest drift from the first value, relative to it, or absolute where it is 0."""
    values = np.atleast_1d(series)
    first = np.abs(values[:1])
    drift = np.abs(values - values[:1]) / np.where(first > 0, first, 1.0)
    largest = float(drift.max()) if drift.size else np.nan
    margin = comparisons.least_margin(drift, np.full_like(drift, limit))
    detail = f"max relative drift = {largest:.6g} (limit {limit:g})"
    return Judgement(verdict_of(largest < limit), detail, largest, 0.0, margin)


def _check(passed: NDArray[np.float64]) -> Judgement:
    return comparisons.holds(bool(np.array_equal(passed, 1.0)), "")


def _positive(value: NDArray[np.float64]) -> Judgement:
    smallest = float(value.min()) if value.size else np.nan
    return Judgement(verdict_of(smallest > 0), f"value = {smallest:.6g}", smallest)


def _below(value: NDArray[np.float64], limit: float) -> Judgement:
    largest = float(value.max()) if value.size else np.nan
    margin = comparisons.least_margin(value, np.full_like(value, limit))
    detail = f"{largest:.6g} < {limit:.6g}"
    return Judgement(verdict_of(largest < limit), detail, largest, None, margin)


KINDS: Mapping[str, Kind] = {
    "close": Kind(("got", "expected"), ("rtol", "atol"), _close),
    "conserved": Kind(("series",), ("rel_drift",), _conserved),
    "check": Kind(("passed",), (), _check),
    "positive": Kind(("value",), (), _positive),
    "below": Kind(("value",), ("limit",), _below),
}


def words_in(folder: Path) -> dict[str, list[str]]:
    """Return the names of a course's words by module: those of KINDS of each module ``validate`` in its
    folder, and those that its file WORDS names, a line for each module such as ``lab.order: converges``.
    """
    places = [*folder.glob(f"*/{MODULE}.py"), *folder.glob(f"{MODULE}.py")]
    modules = [".".join(place.relative_to(folder).with_suffix("").parts) for place in sorted(places)]
    found = {module: list(KINDS) for module in modules}
    text = (folder / WORDS).read_text(encoding="utf-8") if (folder / WORDS).is_file() else ""
    for module, _, listed in (one.partition(":") for one in text.splitlines() if ":" in one):
        found[module.strip()] = [*found.get(module.strip(), ()), *listed.replace(",", " ").split()]
    return found


def kind_of(word: str) -> Kind:
    """Return the kind of a word. One that a course adds is judged by what it says."""
    return KINDS.get(word, KINDS["check"])
