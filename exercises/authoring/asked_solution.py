"""What an exercise asks for: one solution of the notebook, in one or several cases, and all that concerns
it.
"""

import functools
import inspect
import itertools
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from exercises.authoring.draws import JointDraw
from exercises.authoring.kinds.values import of_expression
from exercises.authoring.portable_source import WrittenMistake, source_of
from exercises.authoring.questions.author_arguments import Itself, Mistake, Value
from exercises.authoring.questions.question import HIDDEN_ROWS, PUBLIC_ROWS, Question
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.outcome import Tolerance

Function = Callable[..., Any]


@dataclass(frozen=True)
class Case:
    """Inputs that a solution is asked with; ``name`` follows "is right for" in the label of its checks.

    ``call`` is an expression to evaluate instead of calling the solution with its parameters, or the source
    of a function of the solution and of the inputs ``taken``. ``rows`` are the numbers of public and of
    hidden inputs, by default those of the question's kind. ``agree`` replaces the tolerance of a single
    value.
    """

    name: str
    line: int
    joint: JointDraw | None
    given: Mapping[str, Any] = field(default_factory=dict)
    call: str | None = None
    rows: tuple[int, int] | None = None
    agree: Tolerance | Value | None = None
    taken: Sequence[str] | None = None

    def inputs(self, parameters: Sequence[str], defaults: Mapping[str, Any]) -> dict[str, Any]:
        """Return the inputs by parameter, in order: those given by name, ``defaults``, others from the joint
        draw.
        """
        if self.call is not None and self.given and self.taken is None:
            return dict(self.given)
        parameters = parameters if self.taken is None else self.taken
        joint = {name: self.joint[name] for name in self.joint.names} if self.joint else {}
        drawn = {name: draw for name, draw in joint.items() if name in parameters}
        found = {**defaults, **drawn, **self.given}
        return {name: found[name] for name in [*parameters, *found] if name in found}

    def observed_by(self, function: FunctionType, solution: str) -> "Case":
        """Return the case in which a ``function`` of the solution and of inputs is called instead."""
        _, *taken = inspect.signature(function).parameters
        given = ", ".join([solution, *taken])
        call = f"def observed({given}):\n    return {function.__name__}({given})"
        return replace(self, call=f"{source_of(function)}\n{call}", taken=taken)


class DeclarationError(ValueError):
    """An error of the author's declaration at a ``line`` of the file."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


@dataclass(eq=False)
class AskedSolution:
    """A solution that an exercise asks for at a ``line`` of the file, with its mistakes.

    ``share`` is its share of the exercise's points.
    """

    solution: NotebookSolution
    line: int
    share: float
    mistakes: list[Mistake | WrittenMistake] = field(default_factory=list, kw_only=True)
    errors: list[DeclarationError] = field(default_factory=list, kw_only=True)

    @property
    def solution_name(self) -> str:
        """The name of the solution, by which the source of mistakes refers to it."""
        return self.solution.__name__

    def mistake(
        self,
        code: str | None = None,
        sentence: str | Callable[..., str] = "",
        *,
        change: str | None = None,
        **family: Sequence[Any],
    ) -> Any:
        """Declare a wrong answer with its diagnosis ``code`` and the ``sentence`` that says what the student
        did.

        ``change="old -> new"`` is the solution with one place replaced. Otherwise decorate a function that
        takes the solution's parameters; it may call the solution. ``family`` makes it a family of mistakes:
        each parameter with its values, which the sentence names in braces, or which a function that makes the
        sentence takes. Without a code it is a sample only.
        """
        line = sys._getframe(1).f_lineno
        if change is not None:
            self._replace(change, code, str(sentence), line)
            return None

        def decorate(function: FunctionType) -> FunctionType:
            for given in _members(family):
                named = sentence(**given) if callable(sentence) else sentence
                named = named.format(**given) if given else named
                self.mistakes.append(
                    WrittenMistake(function, self.solution_name, code, named, line, given, self._known)
                )
            return function

        return decorate

    def _replace(self, change: str, code: str | None, sentence: str, line: int) -> None:
        old, arrow, new = change.partition(" -> ")
        count = self.solution.source.count(old)
        if not arrow:
            self._error(f'change={change!r} must be "old -> new"', line)
        elif count != 1:
            where = "is not in" if count == 0 else f"occurs {count} times in"
            self._error(f"{old!r} {where} {self.solution_name}: it must occur once", line)
        else:
            self.mistakes.append(Mistake(old, new, code, sentence, line))

    def _error(self, message: str, line: int) -> None:
        """Keep an error, so that all errors of a declaration are reported at once."""
        self.errors.append(DeclarationError(message, line))

    def _known(self) -> frozenset[str]:
        return self.solution.solutions.bound


@dataclass(eq=False)
class Asked(AskedSolution):
    """A function or class that an exercise asks for. The author adds cases, a truth, tolerances and mistakes.

    ``kind`` is a function of ``exercises.authoring.kinds``, called with these ``options`` for each case.
    ``values`` are the names of what the solution returns: none for a single value, None if the question
    compares no values. ``defaults`` are inputs that cases need not give. ``label`` stands for "NAME is right"
    in the labels of checks, or for NAME in those of random output. ``alike`` is an earlier question about the
    same solution, whose mistakes are mistakes of this one too.
    """

    kind: Callable[..., Question]
    options: Mapping[str, Any]
    joint: JointDraw | None
    values: tuple[str, ...] | None
    partial: bool
    label: str | None = None
    alike: "Asked | None" = None
    cases: list[Case] = field(default_factory=list, kw_only=True)
    tolerances: dict[str, Tolerance | Value] = field(default_factory=dict, kw_only=True)
    exact: Function | Itself | None = field(default=None, kw_only=True)
    drawn_by: Mapping[str, Any] = field(default_factory=dict, kw_only=True)
    unit: Function | None = field(default=None, kw_only=True)
    together: bool = field(default=False, kw_only=True)
    role: str | None = field(default=None, kw_only=True)
    closed_form: Function | None = field(default=None, kw_only=True)
    derivatives: Function | None = field(default=None, kw_only=True)
    defaults: dict[str, Any] = field(default_factory=dict, kw_only=True)
    observation: Any = field(default=None, kw_only=True)

    def case(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        call: str | FunctionType | None = None,
        public: int | None = None,
        hidden: int | None = None,
        agree: Tolerance | Value | None = None,
        **given: Any,
    ) -> None:
        """Add a case: the inputs by parameter, or those of a joint draw.

        ``call`` is an expression to evaluate instead, such as ``"Pendulum(l, g).period()"``; then the inputs
        are its names, all that are drawn by default. It may be a function that takes the solution first, and
        inputs by name. Exact is what either returns with the truth in place of the solution. ``public`` and
        ``hidden`` are the numbers of inputs, by default those of the question's kind; a draw that yields all
        inputs is for a hidden scene alone. ``agree`` is the tolerance of this case.
        """
        joint, rows = inputs or self.joint, None
        if (public, hidden) != (None, None):
            rows = (PUBLIC_ROWS if public is None else public, HIDDEN_ROWS if hidden is None else hidden)
        line = sys._getframe(1).f_lineno
        case = Case(name, line, joint, given, None if callable(call) else call, rows, agree)
        self.cases.append(case.observed_by(call, self.solution_name) if callable(call) else case)

    def observe(self, function: FunctionType) -> FunctionType:
        """Decorate a function that takes the solution first, and inputs by name. What it returns is compared
        with the truth, in place of what the solution returns.
        """
        self.observation = function
        return function

    def truth(
        self,
        function: Function | None = None,
        *,
        agree: Tolerance | Value | None = None,
        each: str | None = None,
        together: bool = False,
    ) -> Any:
        """Decorate the function that computes the exact answer from the inputs and drawn names that it takes.

        ``agree`` is the tolerance of every returned value. With ``each`` the function gets single numbers of
        that argument, an array. With ``together`` it is called once, with all inputs along the first index.
        """

        def decorate(truth: Function) -> Function:
            self.exact, self.together = for_each(truth, each) if each else truth, together
            if agree is not None:
                self.agree(agree)
            return truth

        return decorate if function is None else decorate(function)

    def scale(self, function: Function) -> Function:
        """Decorate the function that returns what a relative tolerance is relative to, for each input: it
        takes inputs, drawn names, and exact values, of which a single one is ``value``.
        """
        self.unit = function
        return function

    def motion(self, function: Function) -> Function:
        """Decorate the closed form of a right-hand side's motion: called with times (n,), the state at t = 0
        and the other inputs that it takes, it returns the first k components of the state (k, n).
        """
        self.closed_form = function
        return function

    def rates(self, function: Function) -> Function:
        """Decorate the function that returns the derivatives of a step's state in order, if the function
        argument does not.
        """
        self.derivatives = function
        return function

    def is_its_own_truth(self, *, because: str) -> None:
        """Declare that nothing but the right solution can be its truth, and why."""
        self.exact = Itself(because)

    def agree(self, every: Tolerance | Value | None = None, **by_name: Tolerance | Value) -> None:
        """Set the tolerance of every returned value, or of some by their names."""
        names = self.values or ("value",)
        if every is not None:
            self.tolerances |= dict.fromkeys(names, every)
        if unknown := [name for name in by_name if name not in names]:
            message = f"{self.solution_name} returns {', '.join(names)}, not {', '.join(unknown)}"
            self._error(message, sys._getframe(1).f_lineno)
        self.tolerances |= by_name

    def figure(self, name: str, title: str, alt: str, draw: Function, shown: ModuleType) -> None:
        """Add the figure that ``draw(canvas, seen, truth)`` of the module ``shown`` draws of the first case's
        arrays.
        """
        about = {"name": name, "title": title, "alt": alt, "scenes": [], "draw": draw.__name__}
        self.drawn_by = {"figures": [about], "shown": Path(inspect.getfile(shown)).read_text("utf-8")}

    def questions(self, uses: Sequence[NotebookSolution]) -> list[Question]:
        """Return the question of each case; ``uses`` are the earlier solutions that this one calls."""
        cases = self.cases or [Case("", self.line, self.joint)]
        first, *others = [self._question(case, uses, several=len(cases) > 1) for case in cases]
        return [replace(first, data={**first.data, **self.drawn_by}), *others]

    def _question(self, case: Case, uses: Sequence[NotebookSolution], several: bool) -> Question:
        parameters = list(inspect.signature(self.solution).parameters)
        label = self.label or f"{self.solution_name} is right"
        label += f" for {case.name}" if several and case.name else ""
        truth = self.exact
        if self.observation is not None:
            case = case.observed_by(self.observation, self.solution_name)
        elif case.call is not None and callable(truth):
            asked = case.inputs(parameters, self.defaults)
            truth = of_expression(case.call, self.solution_name, truth, asked)
        offered: dict[str, Any] = {
            "inputs": case.inputs(parameters, self.defaults),
            "agree": self._agreement(label, case.agree),
            "truth": truth,
            "motion": self.closed_form,
            "rates": self.derivatives,
            "uses": list(uses),
            "call": case.call,
        }
        if self.values is None:
            name = case.name if several or not self.label else None
            offered["label"] = " for ".join(filter(None, (self.label or self.solution_name, name)))
        if case.joint is not None and case.joint.count is not None:
            offered["rows"] = (0, case.joint.count)
        elif case.rows is not None:
            offered["rows"] = case.rows
        taken = inspect.signature(self.kind).parameters
        given = {name: value for name, value in offered.items() if name in taken}
        question = self.kind(self.solution, **{**given, **self.options})
        return replace(
            question,
            mistakes=(*(self.alike.mistakes if self.alike else ()), *self.mistakes),
            line=case.line,
            scale=self.unit,
            together=self.together,
            role=self.role,
            partial=self.partial and self.values is not None,
        )

    def _agreement(self, label: str, own: Tolerance | Value | None) -> Value | dict[str, Value] | None:
        """Return the tolerance of the single value, or of each value by name, with labels that begin with
        ``label``. A case has its ``own`` tolerance of a single value.
        """
        if self.values is None:
            return None
        if own is not None:
            value = labelled(own, label)
            return {self.values[0]: value} if self.values else value
        if missing := [name for name in self.values or ("value",) if name not in self.tolerances]:
            what = ", ".join(missing) if self.values else self.solution_name
            raise DeclarationError(
                f"{what} has no tolerance: give agree= to the truth, or call {self.solution_name}.agree(…)",
                self.line,
            )
        if not self.values:
            return labelled(self.tolerances["value"], label)
        return {name: labelled(self.tolerances[name], f"{label}: {name}") for name in self.values}


def labelled(value: Tolerance | Value, label: str) -> Value:
    """Return a tolerance with the label of its check, unless it has one."""
    one = value if isinstance(value, Value) else Value(value)
    return replace(one, label=one.label or label)


def for_each(truth: Function, name: str) -> Function:
    """Return the truth for an array ``name``, from one for a single number."""

    @functools.wraps(truth)
    def of_array(**given: Any) -> Any:
        numbers = np.asarray(given[name])
        answers = [truth(**{**given, name: number}) for number in numbers.ravel().tolist()]
        if answers and isinstance(answers[0], tuple):
            return tuple(np.array(one).reshape(numbers.shape) for one in zip(*answers, strict=True))
        return np.array(answers).reshape(numbers.shape)

    return of_array


def _members(family: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return the parameters of each member of a family; of no family one without parameters."""
    return [dict(zip(family, member, strict=True)) for member in itertools.product(*family.values())]
