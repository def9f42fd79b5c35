"""Lines of a published notebook's validation cells, as checks.

The server runs the published cells in place of the student's copies. The arguments of each ``validate`` call
leave the sandbox as data and are judged again. The student's code computed them, so a line is self-reported and
carries no points until the author names a truth or trusts it.
"""

import ast
import builtins
import inspect
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ecp import validate
from ecp.checks import Check
from ecp.claims import KINDS, Claim
from ecp.exercise import Exercise
from ecp.judge import Judgement, Verdict
from ecp.notebook.cells import python_of, statements_of
from ecp.outcome import Outcome, Tolerance
from exercises.assignment import PublishedCell
from exercises.author_notebook import INSTALL, Cell

VALIDATION = re.compile(r"validation\b", re.IGNORECASE)
LABEL_AT = {"close": 2, "conserved": 1, "check": 1, "positive": 1, "below": 2}
"""The position of the argument ``label`` of each function of ``ecp.validate``."""
LOOPS = (ast.For, ast.AsyncFor, ast.While, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
LINE = "-line-"  # in the id of each line's check
NOTEBOOK = "the notebook's own"
SELF_REPORTED = "self-reported: the student's code computes both sides"


class Call(NamedTuple):
    """A call of ``ecp.validate`` in a cell: its line and column, its kind, its label, its first two arguments, and
    whether it is inside a function, or repeated: inside a loop.

    The expressions of a label that is not a plain string stand in braces; ``is_plain`` is then false. ``numbers`` are the
    tolerances and limits that its text gives as numbers, and ``computed`` the names of those that it computes.
    """

    place: tuple[int, int]
    kind: str
    label: str
    arguments: tuple[str, str] = ("", "")
    in_function: bool = False
    repeated: bool = False
    is_plain: bool = False
    numbers: tuple[tuple[str, float], ...] = ()
    computed: tuple[str, ...] = ()


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

    def reported(self, claims: Sequence[Claim], cause: str, *, stopped: bool = False) -> Outcome:
        """Return the outcome of the ``claims`` made at its place; without one it is unmeasured for this ``cause``.

        Where the call was made several times, all of them must hold, and the first that does not is shown. If its cell ``stopped``,
        the loop around it may not have ended.
        """
        judged = [(fixed, self._judged(fixed)) for claim in claims if (fixed := self._fixed(claim))]
        claim, found = next(
            (pair for pair in judged if pair[1].verdict is not Verdict.PASS), judged[-1] if judged else (None, None)
        )
        if claim is None or found is None or (stopped and self.call.repeated and found.verdict is Verdict.PASS):
            return self._marked(self.unmeasured(cause), {})
        outcome = self._outcome(found, [])
        outcome.label = self.label if self.call.is_plain else claim.label or self.label
        if found.verdict is Verdict.UNMEASURED:
            outcome.cause = found.detail
        return self._marked(outcome, claim.numbers)

    def _fixed(self, claim: Claim) -> Claim | None:
        """Return the claim with the numbers of the published call. None if that call cannot have made it."""
        if claim.kind != self.call.kind:
            return None
        detail = claim.detail if claim.kind == "check" else ""
        return replace(claim, numbers={**claim.numbers, **dict(self.call.numbers)}, detail=detail)

    def _judged(self, claim: Claim) -> Judgement:
        if self.declared.truth is None or claim.unfit or claim.left_out:
            return claim.judged()
        truth = np.asarray(self.declared.truth() if callable(self.declared.truth) else self.declared.truth, dtype=float)
        if not np.all(np.isfinite(truth)):
            raise ValueError(f"truth of the line {self.label!r} is not finite")
        return replace(claim, arrays={**claim.arrays, "expected": truth}).judged()

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


def calls(source: str) -> list[Call]:
    """Return the calls of ``validate`` in a code cell, in the order of the source."""
    tree = ast.parse(python_of(source) or "")
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)]
    inside = {id(node) for function in functions for node in ast.walk(function)}
    found = [(node, kind) for node in ast.walk(tree) if isinstance(node, ast.Call) and (kind := _kind(node))]
    loops = [n for n in ast.walk(tree) if isinstance(n, LOOPS)]
    repeated = {id(node) for loop in loops for node in ast.walk(loop)}
    return sorted(
        Call(
            (n.lineno, n.col_offset),
            kind,
            _label(n, kind),
            (_argument(n, 0), _argument(n, 1)),
            in_function=id(n) in inside,
            repeated=id(n) in repeated,
            is_plain=isinstance(_given(n, "label", LABEL_AT[kind]), ast.Constant),
            numbers=_numbers(n, kind),
            computed=tuple(name for name, node in _given_numbers(n, kind) if _number(node) is None),
        )
        for n, kind in found
    )


def _argument(node: ast.Call, at: int) -> str:
    return " ".join(ast.unparse(node.args[at]).split()) if len(node.args) > at else ""


def _kind(node: ast.Call) -> str | None:
    match node.func:
        case ast.Attribute(value=ast.Name(id="validate") | ast.Attribute(attr="validate"), attr=kind) if kind in KINDS:
            return kind
    return None


def _given(node: ast.Call, name: str, at: int) -> ast.expr | None:
    """Return the argument ``name`` of a call, which may stand at the position ``at``."""
    given = {keyword.arg: keyword.value for keyword in node.keywords}
    return given.get(name, node.args[at] if len(node.args) > at else None)


def _label(node: ast.Call, kind: str) -> str:
    return _text(_given(node, "label", LABEL_AT[kind]) or ast.Constant(""))


def _given_numbers(node: ast.Call, kind: str) -> Iterator[tuple[str, ast.expr]]:
    """Yield the tolerances and limits of a call by name, those that it does not name with their defaults."""
    if any(isinstance(one, ast.Starred) for one in node.args) or any(keyword.arg is None for keyword in node.keywords):
        yield from ((name, node) for name in KINDS[kind].numbers)  # only running the call shows them
        return
    parameters = inspect.signature(getattr(validate, kind)).parameters
    for at, (name, parameter) in enumerate(parameters.items()):
        if name in KINDS[kind].numbers:
            yield name, _given(node, name, at) or ast.Constant(parameter.default)


def _numbers(node: ast.Call, kind: str) -> tuple[tuple[str, float], ...]:
    return tuple((name, number) for name, given in _given_numbers(node, kind) if (number := _number(given)) is not None)


def _number(node: ast.expr) -> float | None:
    """Return the number that the text of an expression gives, None if the expression needs a name or a call."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.UnaryOp(op=ast.USub(), operand=inner) if (number := _number(inner)) is not None:
            return -number
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            factors = _number(left), _number(right)
            if factors[0] is None or factors[1] is None or (isinstance(op, ast.Div) and not factors[1]):
                return None
            return factors[0] * factors[1] if isinstance(op, ast.Mult) else factors[0] / factors[1]
    return None


def _text(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=str(text)):
            return " ".join(text.split())
        case ast.JoinedStr(values=parts):
            return " ".join("".join(_part(part) for part in parts).split())
    return f"{{{ast.unparse(node)}}}"


def _part(part: ast.expr) -> str:
    return str(part.value) if isinstance(part, ast.Constant) else ast.unparse(ast.JoinedStr([part]))[2:-1]


def published_cells(cells: Sequence[Cell], names: Sequence[str]) -> tuple[PublishedCell, ...]:
    """Return the code cells of the published notebook. Those that the student fills in are tagged as solutions or bind a name
    of ``names``.
    """
    code = [cell for cell in cells if cell.kind == "code" and INSTALL not in cell.tags]
    return tuple(
        PublishedCell(f"published cell {number}", cell.source, _is_given(cell, names), cell.id, bool(calls(cell.source)))
        for number, cell in enumerate(code, 1)
    )


def _is_given(cell: Cell, names: Sequence[str]) -> bool:
    """Return whether the student leaves the cell as it is: it is no solution, and contains more than comments."""
    is_comment = python_of(cell.source) is not None and not statements_of(cell.source)
    return not (is_comment or cell.is_solution(names))


class Placed(NamedTuple):
    """A call in a published cell, with the text of the heading above it."""

    cell: PublishedCell
    call: Call
    heading: str


def placed_calls(cells: Sequence[Cell], published: Sequence[PublishedCell]) -> Iterator[Placed]:
    """Yield the validation calls of the given cells in order. Headings such as "Validation 2" do not count."""
    heading, code = "", iter(published)
    for cell in cells:
        heading = next((text for _, text in reversed(cell.headings) if not VALIDATION.match(text)), heading)
        if cell.kind == "code" and INSTALL not in cell.tags and (one := next(code)).is_given:
            yield from (Placed(one, call, heading) for call in calls(one.source))


def line_errors(cells: Sequence[Cell], sections: Sequence[Any]) -> Iterator[str]:
    """Yield an error for each line that the notebook does not have in that order, or that cannot count."""
    left = [placed.call for placed in placed_calls(cells, published_cells(cells, ()))]
    for line in (line for section in sections for line in section.lines):
        call = next((call for call in left if call.label == line.label), None)
        if call is None:
            yield f"line {line.line}: no validation cell has, after the lines before, the label {line.label!r}"
            continue
        left = left[left.index(call) + 1 :]
        if not (line.truth is None or callable(line.truth) or _is_numeric(line.truth)):
            must = "it must be numbers, or a function without parameters that computes them"
            yield f"line {line.line}: truth is {line.truth!r}; {must}"
        if line.truth is not None and call.kind != "close":
            remedy = "use trust=True, or ask a question"
            yield f"line {line.line}: validate.{call.kind} has no expected value that truth= could replace: {remedy}"
        elif line.truth is not None and call.computed:
            remedy = "write it there as a number, or ask a question"
            widened = f"the validation cell computes {call.computed[0]}, which the student's code could widen"
            yield f"line {line.line}: {widened}: {remedy}"


def _is_numeric(value: Any) -> bool:
    try:
        return bool(np.all(np.isfinite(np.asarray(value, dtype=float))))
    except (TypeError, ValueError):
        return False


def reported_exercises(exercises: Iterable[Exercise], cells: Sequence[Cell], sections: Sequence[Any]) -> Iterator[Exercise]:
    """Yield the exercises with their lines as checks. The student defines the names that their cells read."""
    names = [name for section in sections for name in section.names]
    published = published_cells(cells, names)
    left = list(placed_calls(cells, published))
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
    return ReportedLine(id, line.label, (), word, Tolerance(reason=reason), points=points, cell=cell.name, call=call, declared=line)


def read_names(cells: Sequence[PublishedCell], used: Sequence[PublishedCell]) -> list[str]:
    """Return the names that the cells ``used`` read and that no given cell binds: the student must define them."""
    given = {name for cell in cells if cell.is_given for s in statements_of(cell.source) for name in s.names.bound}
    read = [name for cell in used for s in statements_of(cell.source) for name in sorted(s.names.now | s.names.later)]
    return [name for name in dict.fromkeys(read) if name not in given and not hasattr(builtins, name)]
