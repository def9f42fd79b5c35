"""A question of an author's declaration: the right solution, what it is asked, what is exact, and how it
expands to scenes.
"""

import functools
import inspect
import io
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec, Inputs, Scene, Sweep
from exercises.authoring.draws import JointDraw, JointlyDrawn, ListDraw
from exercises.authoring.portable_source import WrittenMistake
from exercises.authoring.questions.author_arguments import (
    ARGUMENTS,
    SHORT,
    Draw,
    Family,
    Itself,
    Mistake,
    Value,
    tolerance_data,
)
from exercises.authoring.solutions import NotebookSolution
from polhode import kinds
from polhode.judging.author_errors import AuthorError
from polhode.judging.checks import Arrays
from polhode.judging.return_value import WrongAnswer
from polhode.kinds import student_calls
from polhode.kinds.equivalent_values import alignment_error

PUBLIC_ROWS, HIDDEN_ROWS = 3, 16
ARGUMENT = (
    "arguments are real numbers, strings, and arrays of them: a complex one can be made in call= from two"
    " real ones"
)
CONSTANT = (
    "shape and type must be the same for all inputs: ask one question for each size, return complex numbers"
    " always or never"
)
T = TypeVar("T")


def _located(method: Callable[..., T]) -> Callable[..., T]:
    """Let a method that runs the author's code raise AuthorError with the question's line if no frame is of
    the author's file.
    """

    @functools.wraps(method)
    def run(self: "Question", *args: Any, **named: Any) -> T:
        try:
            return method(self, *args, **named)
        except Exception as error:
            frames = traceback.extract_tb(error.__traceback__)
            if isinstance(error, AuthorError) or self.file in [frame.filename for frame in frames]:
                raise
            lines = [frame.lineno for frame in frames if frame.filename == f"<{self.function}>"]
            where = f" (line {lines[-1]} of the solution {self.function})" if lines else ""
            raise AuthorError(
                f"{Path(self.file).name} line {self.line}: question {self.id}:"
                f" {type(error).__name__}: {error}{where}"
            ) from error

    return run


@dataclass(frozen=True)
class Part:
    """A further public scene of a question, such as a motion: ``exact(values)`` returns its exact arrays for
    one row.

    ``values`` are the row's arguments and drawn values by name. ``rows`` are drawn, if anything is.
    """

    exact: Callable[[dict[str, Any]], Mapping[str, Any]]
    rows: int = PUBLIC_ROWS


@dataclass(frozen=True, eq=False)
class Question:
    """One question: ``solution`` of the notebook asked with ``inputs``, and its exact answers.

    ``inputs`` maps parameters to constants, draws (functions of a random generator) and families of
    functions. ``truth`` is called with the arguments and drawn parameters that it names. ``values`` are the
    returned values by name; a single one has the name "value". ``known`` are further exact numbers by name:
    constants, or functions called like ``truth``. ``scale`` is called like ``truth``, and with its values by
    name: a ``limit`` is relative to what it returns for each input. With ``together`` both are called once,
    with the inputs of all rows along the first index, and so are ``terms``, which a wrong answer may have in
    addition, by their description. ``role`` is "optional" if the exercise can be done without the function,
    "prerequisite" if it is another exercise's. ``data`` holds what the checks of the kind need, as JSON;
    ``errors`` yields errors of what belongs to the kind. ``variables`` names what ``solution``, a cell,
    assigns: then the question asks for these variables instead of a function. With ``partial`` a ✗ earns the
    part of its points that the fraction of right inputs is. ``parts`` are further public scenes, played after
    the public one. ``sweep(questions)`` is a chart of speed against accuracy of the assignment's questions of
    this kind that have one, in order. ``wrong`` are the errors of arguments of a wrong type, by their names.
    """

    kind: str
    solution: NotebookSolution
    inputs: Mapping[str, Any]
    values: Mapping[str, Value]
    truth: Callable[..., Any] | Itself | None = None
    call: str | None = None
    keys: bool = False
    known: Mapping[str, Any] = field(default_factory=dict)
    scale: Callable[..., Any] | None = None
    together: bool = False
    terms: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    role: str | None = None
    variables: tuple[str, ...] = ()
    partial: bool = False
    data: Mapping[str, Any] = field(default_factory=dict)
    mistakes: Sequence[Mistake | WrittenMistake] = ()
    parts: Mapping[str, Part] = field(default_factory=dict)
    errors: Callable[[], Iterator[str]] = lambda: iter(())
    sweep: Callable[[Sequence["Question"]], Sweep] | None = None
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS)
    budget_s: float = 5.0
    uses: Sequence[Callable[..., Any]] = ()
    wrong: Mapping[str, Sequence[str]] = field(default_factory=dict)
    line: int = 0
    id: str = ""
    number: str = ""

    @property
    def function(self) -> str:
        """The name of the student's function, or of the first variable."""
        return self.variables[0] if self.variables else self.solution.__name__

    @property
    def file(self) -> str:
        """The path of the file that declares the question."""
        return str(self.solution.solutions.folder / "assignment.py")

    @property
    def names(self) -> tuple[str, ...]:
        """The names that a student's cells must define."""
        return self.variables or (self.function,)

    @property
    def source(self) -> str:
        """The source of the right solution: of a function or class, or of a cell."""
        return self.solution.source

    @functools.cached_property
    def student(self) -> Mapping[str, Any]:
        """The names that the right solution defines."""
        return self.defined_by(self.source)

    def defined_by(self, source: str) -> Mapping[str, Any]:
        """Return the names that a source such as that of a mistake defines beside the right solutions."""
        names = dict(self.solution.names)
        with redirect_stdout(io.StringIO()):  # what a cell prints is not for the output of a command
            exec(compile(source, f"<{self.function}>", "exec"), names)
        return names

    @functools.cached_property
    def drawn(self) -> dict[str, Draw]:
        """The draws of the question by name: parameters, and parameters of function arguments."""
        return {name: value for name, value in self._given.items() if callable(value)}

    @functools.cached_property
    def _given(self) -> dict[str, Any]:
        """The constants and draws by name: parameters, and parameters of function arguments."""
        return {
            n: v
            for name, v in self.inputs.items()
            for n, v in (v.given if isinstance(v, Family) else {name: v}).items()
        }

    @_located
    def draw(self, rng: np.random.Generator, rows: int) -> dict[str, Any]:
        """Return ``rows`` drawn values by name, rows along the first index."""
        each = self._listed(rng)[: rows or None] or [self._draw_row(rng, row) for row in range(rows)]
        columns = {name: [row[name] for row in each] for name in each[0]} if each else {}
        for name, column in ((name, columns[name]) for name in self.drawn if columns):
            if wrong := [value.dtype for value in column if value.dtype.kind not in ARGUMENTS]:
                raise TypeError(f"{name} is drawn with dtype {wrong[0]}; {ARGUMENT}")
            one, *others = dict.fromkeys(value.shape for value in column)
            if others:
                raise ValueError(
                    f"{name} is drawn with shape {one} for one input and {others[0]} for another: {CONSTANT}"
                )
        return {name: np.array(column) for name, column in columns.items()}

    def _listed(self, rng: np.random.Generator) -> list[dict[str, Any]]:
        """Return the drawn values of all inputs by a list draw, none if the question has no such draw."""
        lists = {draw.joint for draw in self.drawn.values() if isinstance(draw, JointlyDrawn)}
        found = next((draw.all(rng) for draw in lists if isinstance(draw, ListDraw)), [])
        return [{name: np.asarray(value) for name, value in row.items()} for row in found]

    def _draw_row(self, rng: np.random.Generator, row: int) -> dict[str, Any]:
        """Return the drawn values of one input by name, and behind them what joint draws return besides."""
        joint: dict[JointDraw, dict[str, Any]] = {}
        found = {}
        for name, draw in self.drawn.items():
            if isinstance(draw, JointlyDrawn):
                if draw.joint not in joint:
                    joint[draw.joint] = draw.joint(rng, row)
                found[name] = np.asarray(draw.of(joint[draw.joint]))
            else:
                found[name] = np.asarray(draw(rng))
        besides = {n: v for values in joint.values() for n, v in values.items() if n not in self._given}
        return found | {name: np.asarray(value) for name, value in besides.items()}

    @functools.cached_property
    def withheld(self) -> tuple[str, ...]:
        """The names of joint draws that only truths see."""
        if not any(isinstance(draw, JointlyDrawn) for draw in self.drawn.values()):
            return ()
        return tuple(name for name in self._draw_row(np.random.default_rng(0), 0) if name not in self.drawn)

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """The question as data, with nothing of its solution and without the shapes of its answer."""
        functions = {name: v for name, v in self.inputs.items() if isinstance(v, Family)}
        families = {
            name: {"text": v.text, "over": list(v.over), "given": list(v.given)}
            for name, v in functions.items()
        }
        return {
            "kind": self.kind,
            "id": self.id,
            "function": self.function,
            "parameters": list(self.inputs),
            "constants": {
                name: np.asarray(value).tolist() for name, value in self._given.items() if not callable(value)
            },
            "families": families,
            "apart": self._apart,
            "variables": list(self.variables),
            "drawn": list(self.drawn),
            "call": self.call,
            "keys": self.keys,
            "number": self.number,
            "scenes": {
                "public": f"{self.id}-public" if self.rows[0] or not self.drawn else None,
                "hidden": f"{self.id}-hidden" if self.drawn and self.rows[1] else None,
            },
            "parts": list(self.parts),
            "returns": [self._returned(name, value) for name, value in self.values.items()],
            **({"uses": [earlier.__name__ for earlier in self.uses]} if self.uses else {}),
            **({"role": self.role} if self.role else {}),
            **self.data,
        }

    @functools.cached_property
    def _apart(self) -> list[str]:
        """The function arguments that must not be in the submission's process: those whose calls are counted,
        and those with numbers from which a truth is computed.

        An expression is called with symbols and so shows its numbers. A function that takes functions is
        called many times, and each call would pass between the processes several times; its numbers save a
        submission no call of it.
        """
        families = {name: value for name, value in self.inputs.items() if isinstance(value, Family)}
        if self.data.get("calls"):
            return list(families)
        exact = [one for one in (self.truth, *self.known.values()) if inspect.isroutine(one)]
        used = {name for one in exact for name in inspect.signature(one).parameters}
        return [
            name
            for name, family in families.items()
            if self.kind != "expression" and used.intersection(family.given) and not family.takes_functions
        ]

    @functools.cached_property
    @_located
    def asked(self) -> dict[str, Any]:
        """The question as data, with the shapes of its answer: calls the right solution once."""
        row = next(student_calls.each_row(self.draw(np.random.default_rng(0), 1)), {})
        shaped = [
            value | form for value, form in zip(self.document["returns"], self._forms(row), strict=True)
        ]
        for value in shaped:
            if value["up_to"] and (
                error := alignment_error(value["up_to"], value["shape"], value["complex"])
            ):
                raise ValueError(f"{error}, but the right solution returned shape {tuple(value['shape'])}")
        played = {name: part for name, part in self.document.items() if name not in ("figures", "shown")}
        return played | {"returns": shaped}

    def _forms(self, row: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return shape and type of each value that the right solution returns for a row of drawn values."""
        answer = student_calls.call(self.document, self.student, student_calls.arguments(self.document, row))
        forms, is_symbolic = [], self.data.get("complex", False)
        for part in student_calls.parts(self.document, answer):
            kind = np.asarray(part).dtype.kind
            if kind not in "fiubc" and not is_symbolic:
                raise TypeError(
                    f"{self.function} returned {SHORT.repr(part)}; it must return numbers, booleans, or"
                    " arrays of them"
                )
            if not is_symbolic and not np.all(np.isfinite(part)):
                raise ValueError(
                    f"{self.function} returned {SHORT.repr(part)}; ask it for inputs where its answer is"
                    " finite"
                )
            forms.append(
                {"shape": list(np.shape(part)), "complex": is_symbolic or kind == "c", "boolean": kind == "b"}
            )
        return forms

    def _returned(self, name: str, value: Value) -> dict[str, Any]:
        label = value.label or f"{self.function} is right" + (f": {name}" if len(self.values) > 1 else "")
        return {
            "name": name,
            "tolerance": tolerance_data(value.tolerance),
            "label": label,
            "up_to": value.up_to,
            **({"statistic": True} if value.statistic else {}),
            **({"partial": True} if self.partial else {}),
            **({"check": value.check} if value.check else {}),
            **({"scaled": True} if self.scale else {}),
            **({"components": list(value.components)} if value.components else {}),
        }

    def play(self, student: Any, rows: Mapping[str, Any], part: str | None = None) -> Arrays:
        """Return what a function, or a ``student`` with these names, answers, as the sandbox would.

        ``part`` is one of ``parts``, or the kind's own.
        """
        asked = self.asked if part is None else self.asked | {"part": part}
        names = student if isinstance(student, Mapping) else {self.function: student}
        return kinds.play(asked, names, rows)

    @_located
    def exact(self, rows: Mapping[str, Any], part: Part | None = None) -> dict[str, Any]:
        """Return the exact values of every row by name, those ``known`` among them, and the drawn values as
        ``at_NAME``.
        """
        drawn, answers = {f"at_{name}": np.asarray(rows[name]) for name in self.drawn}, []
        is_own = isinstance(self.truth, Itself) or (self.truth is None and not self.known)
        if self.together and part is None:
            return self._exact_together(rows) | drawn
        try:
            own = self.play(self.student, rows) if part is None and is_own else {}
            for row in student_calls.each_row(rows):
                asked = student_calls.arguments(self.asked, row)
                # a truth may call a function as often as it likes
                given = {
                    n: v.function if isinstance(v, student_calls.Counted) else v for n, v in asked.items()
                } | row
                if part is not None:
                    answers.append(part.exact(given))
                    continue
                known = {n: _real(call_with(v, given) if callable(v) else v) for n, v in self.known.items()}
                exact = (
                    student_calls.returned(self.asked, call_with(self.truth, given))
                    if callable(self.truth)
                    else {}
                )
                answers.append(exact | known | self._scales(given, exact))
        except WrongAnswer as error:
            whose = "the right solution" if is_own else "the truth"
            raise ValueError(
                f"{whose} does not answer as the right solution does for the first input: {error}; {CONSTANT}"
            ) from error
        return {**student_calls.stacked(answers), **own, **drawn}

    def _scales(self, given: Mapping[str, Any], exact: Mapping[str, Any]) -> dict[str, Any]:
        """Return the author's scale of each value."""
        if self.scale is None:
            return {}
        found = call_with(self.scale, {**given, **exact})
        return {f"{name}_scale": np.broadcast_to(found, np.shape(value)) for name, value in exact.items()}

    def _exact_together(self, rows: Mapping[str, Any]) -> dict[str, Any]:
        """Return the exact values of all rows from one call of the truth."""
        assert callable(self.truth)
        (name,), given = self.values, {key: np.asarray(column) for key, column in rows.items()}
        exact = {name: np.asarray(call_with(self.truth, given), dtype=float)}
        added = {f"term {text}": np.asarray(call_with(term, given)) for text, term in self.terms.items()}
        return exact | self._scales(given, exact) | added

    def scenes(self) -> Iterator[Scene]:
        """Yield the public scene, those of the parts, and the hidden one."""
        public, hidden = self.rows if self.drawn else (1, 0)
        if public:
            yield self.scene("public", public)
        for name, part in self.parts.items():
            yield self.scene(name, part.rows if self.drawn else 1, part)
        if hidden:
            yield self.scene("hidden", hidden)

    def scene(self, name: str, rows: int, part: Part | None = None) -> Scene:
        """Return the scene of the values for so many rows, new ones if it is "hidden",
        or that of a ``part``.
        """

        def inputs(rng: np.random.Generator) -> dict[str, Any]:
            return self.draw(rng, rows)

        return Scene(
            name=f"{self.id}-{name}",
            play="play",
            function=self.function,
            inputs=inputs if name == "hidden" else Later(lambda: inputs(np.random.default_rng(0))),
            returns=Later(lambda: self._specs(rows, name if part else None)),
            truth=functools.partial(self.exact, part=part),
            budget_s=self.budget_s,
            after=f"{self.id}-public" if part else None,
            known=tuple(f"at_{name}" for name in self.drawn),
            needs=self.variables[1:],
            withheld=self.withheld,
            question=Later(lambda: self.asked | ({"part": name} if part else {})),
        )

    @_located
    def _specs(self, rows: int, part: str | None = None) -> Mapping[str, ArraySpec]:
        one = self.play(self.student, self.draw(np.random.default_rng(0), 1), part)
        return {name: ArraySpec((rows, *array.shape[1:])) for name, array in one.items()}


class Later(Mapping[str, Any]):
    """A mapping that is computed when it is first read, so that loading an assignment runs no solution."""

    def __init__(self, compute: Callable[[], Mapping[str, Any]]) -> None:
        self._compute = functools.cache(compute)

    def __getitem__(self, name: str) -> Any:
        return self._compute()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._compute())

    def __len__(self) -> int:
        return len(self._compute())


def call_with(function: Callable[..., Any], values: Inputs) -> Any:
    """Call an author's function with those of the ``values`` that its parameters name."""
    return function(**{name: values[name] for name in inspect.signature(function).parameters})


def _real(value: Any) -> Any:
    """Return numbers as float64, complex ones as real and imaginary parts in a last index."""
    array = np.asarray(value)
    return np.stack([array.real, array.imag], axis=-1) if np.iscomplexobj(array) else array.astype(float)
