"""Lines of a published notebook's validation cells, as checks.

The server runs the published cells in place of the student's copies. The arguments of each ``validate`` call
leave the sandbox as data and are judged again. The student's code computed them, so a line is self-reported
and carries no points until the author names a truth or trusts it.
"""

import builtins
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.importing.validation_calls import Call, calls
from exercises.authoring.importing.words import Words
from exercises.authoring.questions.author_notebook import INSTALL, Cell
from exercises.authoring.questions.declared import Rule, is_numeric
from polhode.judging.checks import Check
from polhode.judging.claims import Claim
from polhode.judging.exercise import Exercise
from polhode.judging.judge import Judgement, Verdict
from polhode.judging.outcome import Outcome, Tolerance
from polhode.notebook.cell_source import python_of, statements_of

VALIDATION = re.compile(r"validation\b", re.IGNORECASE)
LINE = "-line-"  # in the id of each line's check
NOTEBOOK = "the notebook's own"
TRUTH = Rule(
    "numbers, or a function without parameters that computes them",
    lambda truth: callable(truth) or is_numeric(truth, "fiuc"),
)
SELF_REPORTED = "self-reported: the student's code computes both sides"


@dataclass(frozen=True)
class Line:
    """The declaration of a line: its ``label``, and what makes it count."""

    label: str
    truth: Any = None
    trust: bool = False
    points: int = 1
    line: int = 0

    @property
    def counts(self) -> bool:
        """Whether the line carries points."""
        return self.trust or self.truth is not None


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
            outcome.counted, outcome.points, outcome.self_reported = False, 0, True
        return outcome


def is_self_reported(check: Check) -> bool:
    """Return whether a check is a line that carries no points."""
    return isinstance(check, ReportedLine) and not check.declared.counts


def published_cells(cells: Sequence[Cell], names: Sequence[str], words: Words) -> tuple[PublishedCell, ...]:
    """Return the code cells of the published notebook. Those that the student fills in are tagged as
    solutions or bind a name of ``names``.
    """
    code = [cell for cell in cells if cell.kind == "code" and INSTALL not in cell.tags]
    return tuple(
        PublishedCell(
            f"published cell {number}",
            cell.source,
            _is_given(cell, names),
            cell.id,
            bool(calls(cell.source, words)),
        )
        for number, cell in enumerate(code, 1)
    )


def _is_given(cell: Cell, names: Sequence[str]) -> bool:
    """Return whether the student leaves the cell as it is: it is no solution, and contains more than
    comments.
    """
    is_comment = python_of(cell.source) is not None and not statements_of(cell.source)
    return not (is_comment or cell.is_solution(names))


class Placed(NamedTuple):
    """A call in a published cell, with the text of the heading above it."""

    cell: PublishedCell
    call: Call
    heading: str


def placed_calls(cells: Sequence[Cell], published: Sequence[PublishedCell], words: Words) -> Iterator[Placed]:
    """Yield the validation calls of the given cells in order.
    Headings such as "Validation 2" do not count.
    """
    heading, code = "", iter(published)
    for cell in cells:
        heading = next((text for _, text in reversed(cell.headings) if not VALIDATION.match(text)), heading)
        if cell.kind == "code" and INSTALL not in cell.tags and (one := next(code)).is_given:
            yield from (Placed(one, call, heading) for call in calls(one.source, words))


def line_errors(cells: Sequence[Cell], sections: Sequence[Any], words: Words) -> Iterator[str]:
    """Yield an error for each line that the notebook does not have in that order, or that cannot count."""
    lines = [line for section in sections for line in section.lines]
    published = published_cells(cells, (), words) if lines else ()
    left = [placed.call for placed in placed_calls(cells, published, words)] if lines else []
    for line in lines:
        call = next((call for call in left if call.label == line.label), None)
        if call is None:
            yield (
                f"line {line.line}: no validation cell has, after the lines before, the label {line.label!r}"
            )
            continue
        left = left[left.index(call) + 1 :]
        if not (line.truth is None or TRUTH.holds(line.truth)):
            yield f"line {line.line}: truth is {line.truth!r}; it must be {TRUTH.text}"
        if line.truth is not None and call.kind != "close":
            remedy = "use trust=True, or ask a question"
            yield (
                f"line {line.line}: validate.{call.kind} has no expected value that truth= could replace:"
                f" {remedy}"
            )
        elif line.truth is not None and call.computed:
            remedy = "write it there as a number, or ask a question"
            widened = f"the validation cell computes {call.computed[0]}, which the student's code could widen"
            yield f"line {line.line}: {widened}: {remedy}"


def reported_exercises(
    exercises: Iterable[Exercise], cells: Sequence[Cell], sections: Sequence[Any], words: Words
) -> Iterator[Exercise]:
    """Yield the exercises with their lines as checks. The student defines the names that their cells read."""
    if not any(section.lines for section in sections):
        yield from exercises
        return
    names = [name for section in sections for name in section.names]
    published = published_cells(cells, names, words)
    left = list(placed_calls(cells, published, words))
    for exercise, section in zip(exercises, sections, strict=True):
        checks, used = list[Check](), list[PublishedCell]()
        for k, line in enumerate(section.lines, 1):
            at = next(k for k, placed in enumerate(left) if placed.call.label == line.label)
            (cell, call, _), left = left[at], left[at + 1 :]
            used.append(cell)
            checks.append(_check(f"{exercise.number}{LINE}{k}", line, cell, call))
        read = tuple(name for name in read_names(published, used) if name not in exercise.functions)
        yield replace(
            exercise,
            functions=(*exercise.functions, *read),
            variables=(*exercise.variables, *read),
            checks=(*exercise.checks, *checks),
        )


def _check(id: str, line: Line, cell: PublishedCell, call: Call) -> ReportedLine:
    def word(seen: Any, truth: Any) -> Judgement:
        raise NotImplementedError

    reason = NOTEBOOK if line.counts else f"{NOTEBOOK}; {SELF_REPORTED}"
    points = line.points if line.counts else 0
    return ReportedLine(
        id,
        line.label,
        (),
        word,
        Tolerance(reason=reason),
        points=points,
        cell=cell.name,
        call=call,
        declared=line,
    )


def read_names(cells: Sequence[PublishedCell], used: Sequence[PublishedCell]) -> list[str]:
    """Return the names that the cells ``used`` read and that no given cell binds: the student must define
    them.
    """
    given = {
        name for cell in cells if cell.is_given for s in statements_of(cell.source) for name in s.names.bound
    }
    read = [
        name
        for cell in used
        for s in statements_of(cell.source)
        for name in sorted(s.names.now | s.names.later)
    ]
    return [name for name in dict.fromkeys(read) if name not in given and not hasattr(builtins, name)]
