"""Lines of validation cells: what the author declares about each, and the check that judges the claims made
at its place.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

from exercises.authoring.importing.validation_calls import Call
from exercises.authoring.questions.author_arguments import Rule, is_numeric
from polhode.judging.checks import Check
from polhode.judging.claims import Claim
from polhode.judging.outcome import Outcome, Tolerance
from polhode.judging.verdict import Judgement, Verdict

NOTEBOOK = "the notebook's own"
TRUTH = Rule(
    "numbers, or a function without parameters that computes them",
    lambda truth: callable(truth) or is_numeric(truth, "fiuc"),
)


class Status(StrEnum):
    """Whether a line carries points; the value is the sentence for the reader of a report."""

    COUNTS = ""
    SHOWN = "the expected value stands in the notebook, so the line carries no points"
    SELF_REPORTED = "self-reported: the student's code computes both sides"
    GIVEN = "the given cells alone make this line ✓, so it carries no points"


IN_WORDS = {
    Status.COUNTS: "count",
    Status.SHOWN: "value shown",
    Status.SELF_REPORTED: "self-reported",
    Status.GIVEN: "cannot count",
}
"""The words that tables and counts of lines have for a status."""


@dataclass(frozen=True)
class Line:
    """The declaration of a line: its ``label``, and what makes it count.

    One whose expected value is ``shown`` in the notebook counts if the author says ``accept``. A ``given``
    line, which is ✓ without any student's code, never counts.
    """

    label: str
    truth: Any = None
    trust: bool = False
    points: int = 1
    line: int = 0
    shown: bool = False
    accept: bool = False
    given: bool = False

    @property
    def status(self) -> Status:
        """Whether the line carries points, and why not."""
        if self.given:
            return Status.GIVEN
        if self.truth is not None:
            return Status.SHOWN if self.shown and not self.accept else Status.COUNTS
        return Status.COUNTS if self.trust else Status.SELF_REPORTED

    @property
    def counts(self) -> bool:
        """Whether the line carries points."""
        return self.status is Status.COUNTS


@dataclass(frozen=True)
class ReportedLine(Check):
    """A check of the claims that a published cell made at one place of its source."""

    cell: str = ""
    call: Call = field(default_factory=lambda: Call((0, 0), "", ""))
    declared: Line = Line("")

    def errors(self) -> list[str]:
        """Return the errors of the declaration. A line without points has none of its own."""
        return super().errors() if self.declared.counts else []

    def reported(
        self, claims: Sequence[Claim], cause: str, *, stopped: bool = False, solution: int = 0
    ) -> Outcome:
        """Return the outcome of the ``claims`` made at its place; without one it is unmeasured for this
        ``cause``.

        Where the call was made several times, all of them must hold, and the first that does not is shown. If
        its cell ``stopped``, the loop around it may not have ended. A loop must make as many claims as with
        the author's ``solution``.
        """
        judged = [(fixed, self._judged(fixed)) for claim in claims if (fixed := self._fixed(claim))]
        claim, found = next(
            (pair for pair in judged if pair[1].verdict is not Verdict.PASS),
            judged[-1] if judged else (None, None),
        )
        if (
            claim is None
            or found is None
            or (stopped and self.call.repeated and found.verdict is Verdict.PASS)
        ):
            return self._marked(self.unmeasured(cause), {})
        if self.call.repeated and len(judged) < solution and found.verdict is Verdict.PASS:
            few = (
                f"the loop made {len(judged)} of the {solution} checks that it makes with the right solution"
            )
            return self._marked(self.unmeasured(few), {})
        outcome = self._outcome(found, [])
        outcome.label = self.label if self.call.is_plain else claim.label or self.label
        if found.verdict is Verdict.UNMEASURED:
            outcome.cause = found.detail
        return self._marked(outcome, claim.numbers)

    def _fixed(self, claim: Claim) -> Claim | None:
        """Return the claim with the numbers of the published call. None if that call cannot have made it."""
        if claim.kind != self.call.kind:
            return None
        return replace(claim, numbers={**claim.numbers, **dict(self.call.numbers)})

    def _judged(self, claim: Claim) -> Judgement:
        if self.declared.truth is None or claim.left_out or claim.found is not None:
            return claim.judged()
        if claim.unjudged:  # what the package said of its own expected value is no judgement of the truth
            return replace(claim, left_out=claim.unjudged).judged()
        return replace(claim, arrays={**claim.arrays, "expected": self.truth()}, mark="").judged()

    def truth(self) -> Any:
        """Return the declared truth. Raises ValueError if it is not finite."""
        truth = np.asarray(self.declared.truth() if callable(self.declared.truth) else self.declared.truth)
        if not np.all(np.isfinite(truth)):
            raise ValueError(f"truth of the line {self.label!r} is not finite")
        return truth

    def _marked(self, outcome: Outcome, numbers: Mapping[str, float]) -> Outcome:
        allowed = {"rel_drift": "limit"}
        known = {allowed.get(name, name): value for name, value in numbers.items()}
        outcome.tolerance = Tolerance(**known, reason=self.tolerance.reason)
        if not self.declared.counts:
            outcome.counted, outcome.points = False, 0
            outcome.self_reported = self.declared.status is Status.SELF_REPORTED
        return outcome


def reported_lines(checks: Iterable[Check]) -> list[ReportedLine]:
    """Return the lines of validation cells among the checks of an assignment or exercise."""
    return [check for check in checks if isinstance(check, ReportedLine)]


def is_self_reported(check: Check) -> bool:
    """Return whether a check is a line of which the student's code computes both sides."""
    return isinstance(check, ReportedLine) and check.declared.status is Status.SELF_REPORTED
