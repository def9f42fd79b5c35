"""The verdict of a check, and the judgement with its text."""

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """A check's verdict. UNMEASURED is neither right nor wrong:
    its cause says why nothing could be measured.
    """

    PASS = "pass"  # noqa: S105
    FAIL = "fail"
    UNMEASURED = "unmeasured"


MARKS = {Verdict.PASS: "✓", Verdict.FAIL: "✗", Verdict.UNMEASURED: "–"}


@dataclass(frozen=True)
class RowsRight:
    """How many of a scene's ``rows``, its inputs, are ``right``: the fraction that partial credit follows."""

    right: int
    rows: int


@dataclass(frozen=True)
class Judgement:
    """The judgement of one claim. ``detail`` is the text in the brackets.

    ``margin`` is allowed / measured, None if nothing deviates or there is no number. ``where`` is the index
    of the worst value in the compared array. ``misshapen``: the shapes exclude a comparison. ``partial`` is
    given for a ✗ with partial credit.
    """

    verdict: Verdict
    detail: str
    measured: float | None = None
    expected: float | None = None
    margin: float | None = None
    where: tuple[int, ...] | None = None
    misshapen: bool = False
    partial: RowsRight | None = None


def line(verdict: Verdict, label: str, detail: str) -> str:
    """Return the notebook's ✓/✗ line: mark, two spaces, label, and if there is a detail, three spaces and
    [detail].
    """
    return f"{MARKS[verdict]}  {label}" + (f"   [{detail}]" if detail else "")


def verdict_of(ok: bool) -> Verdict:
    """Return the verdict of a condition."""
    return Verdict.PASS if ok else Verdict.FAIL
