"""A question of an author's declaration: the right solution, what it is asked, what is exact, and how it expands to scenes."""

import ast
import functools
import inspect
import sys
import textwrap
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ecp.author_errors import AuthorError
from ecp.checks import Arrays
from ecp.kinds import asking, kind_module
from ecp.outcome import Tolerance
from exercises.assignment import ArraySpec, Inputs, Scene, Sweep

PUBLIC_ROWS, HIDDEN_ROWS = 3, 16
Draw = Callable[[np.random.Generator], Any]
T = TypeVar("T")


@dataclass(frozen=True)
class Family:
    """A function argument: an expression ``text`` over some variables, with parameters that are constant or drawn."""

    text: str
    over: tuple[str, ...]
    given: Mapping[str, Any]


@dataclass(frozen=True)
class Mistake:
    """A known wrong answer: ``old`` in the right solution's source replaced by ``new``.

    With a ``code`` it is a diagnosis, whose ``sentence`` says what the student did. ``line`` is its place in the declaration.
    """

    old: str
    new: str
    code: str | None = None
    sentence: str = ""
    line: int = 0

    def source(self, right: str) -> str:
        """Return the source with the mistake, from that of the right solution."""
        return right.replace(self.old, self.new)


@dataclass(frozen=True)
class Itself:
    """The declaration that the right solution is its own truth, and why nothing else can be."""

    reason: str


@dataclass(frozen=True)
class Value:
    """A value that a function returns: its tolerance, its label, and what it leaves ``up_to`` (ecp.kinds.alignment).

    ``points`` is what each of its checks is worth, the public and the hidden one. With ``partial`` a ✗ earns the points times the
    fraction of inputs that are right, rounded down.
    """

    tolerance: Tolerance
    label: str | None = None
    up_to: str | None = None
    points: int = 1
    partial: bool = False


Agree = Tolerance | Value | Mapping[str, Value | Tolerance]
"""A tolerance, or one with its label and points, of a single value, or those of several values by name."""


def named_values(
    agree: Agree, label: str | None = None, up_to: str | None = None, points: int = 1, partial: bool = False
) -> dict[str, Value]:
    """Return the values that a question agrees on by name; a single one has the name "value"."""
    if (points, partial) != (1, False) and not isinstance(agree, Tolerance):
        raise ValueError("points= and partial= are for a single Tolerance: give them to each Value(…) instead")
    if isinstance(agree, Mapping):
        return {name: value if isinstance(value, Value) else Value(value) for name, value in agree.items()}
    return {"value": agree if isinstance(agree, Value) else Value(agree, label, up_to, points, partial)}


def _located(method: Callable[..., T]) -> Callable[..., T]:
    """Let a method that runs the author's code raise AuthorError with the question's line if no frame is of the author's file."""

    @functools.wraps(method)
    def run(self: "Question", *args: Any, **named: Any) -> T:
        try:
            return method(self, *args, **named)
        except Exception as error:
            file = inspect.getsourcefile(self.solution) or ""
            if isinstance(error, AuthorError) or file in [f.filename for f in traceback.extract_tb(error.__traceback__)]:
                raise
            raise AuthorError(f"{Path(file).name} line {self.line}: question {self.id}: {type(error).__name__}: {error}") from error

    return run


@dataclass(frozen=True)
class Part:
    """A further public scene of a question, such as a motion: ``exact(values)`` returns its exact arrays for one row.

    ``values`` are the row's arguments and drawn values by name.
    """

    exact: Callable[[dict[str, Any]], Mapping[str, Any]]
    rows: int = PUBLIC_ROWS


@dataclass(frozen=True, eq=False)
class Question:
    """One question: ``solution`` (a function or class of the author's file) asked with ``ask``, and its exact answers.

    ``ask`` maps parameters to constants, draws (functions of a random generator) and families of functions. ``truth`` is called
    with the arguments and drawn parameters that it names. ``values`` are the returned values by name; a single one has the name
    "value". ``known`` are further exact numbers by name: constants, or functions called like ``truth``. ``data`` holds what the
    checks of the kind need, as JSON; ``errors`` yields errors of what belongs to the kind. ``variables`` names what the body of
    ``solution``, a cell, assigns: then the question asks for these variables instead of a function. ``parts`` are further public
    scenes, played after the public one. ``sweep(question)`` is a chart of speed against accuracy.
    """

    kind: str
    solution: Callable[..., Any]
    ask: Mapping[str, Any]
    values: Mapping[str, Value]
    truth: Callable[..., Any] | Itself | None = None
    call: str | None = None
    keys: bool = False
    known: Mapping[str, Any] = field(default_factory=dict)
    variables: tuple[str, ...] = ()
    data: Mapping[str, Any] = field(default_factory=dict)
    mistakes: tuple[Mistake, ...] = ()
    parts: Mapping[str, Part] = field(default_factory=dict)
    errors: Callable[[], Iterator[str]] = lambda: iter(())
    sweep: Callable[["Question"], Sweep] | None = None
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS)
    budget_s: float = 5.0
    uses: tuple[Callable[..., Any], ...] = ()
    line: int = 0
    id: str = ""

    @property
    def function(self) -> str:
        """The name of the student's function, or of the first variable."""
        return self.variables[0] if self.variables else self.solution.__name__

    @property
    def names(self) -> tuple[str, ...]:
        """The names that a student's cells must define."""
        return self.variables or (self.function,)

    @functools.cached_property
    def source(self) -> str:
        """The source of the right solution: of a function or class, or of a cell."""
        source = textwrap.dedent(inspect.getsource(self.solution))
        return cell(source) if self.variables else source

    @functools.cached_property
    def student(self) -> Mapping[str, Any]:
        """The names that the right solution defines."""
        return self.defined_by(self.source) if self.variables else {self.function: self.solution}

    def defined_by(self, source: str) -> Mapping[str, Any]:
        """Return the names that a source such as that of a mistake defines in the author's file."""
        names = dict(vars(sys.modules[self.solution.__module__]))
        exec(compile(source, f"<{self.function}>", "exec"), names)
        return names

    @functools.cached_property
    def parameters(self) -> list[str]:
        """The arguments in the order of the call."""
        return list(self.ask)

    @functools.cached_property
    def drawn(self) -> dict[str, Draw]:
        """The draws of the question by name: parameters, and parameters of function arguments."""
        return {name: value for name, value in self._given.items() if callable(value)}

    @functools.cached_property
    def _given(self) -> dict[str, Any]:
        """The constants and draws by name: parameters, and parameters of function arguments."""
        return {n: v for name, v in self.ask.items() for n, v in (v.given if isinstance(v, Family) else {name: v}).items()}

    @_located
    def draw(self, rng: np.random.Generator, rows: int) -> dict[str, Any]:
        """Return ``rows`` drawn values by name, rows along the first index."""
        each = [{name: draw(rng) for name, draw in self.drawn.items()} for _ in range(rows)]
        return {name: np.array([row[name] for row in each]) for name in self.drawn}

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """The question as data, with nothing of its solution and without the shapes of its answer."""
        functions = {name: v for name, v in self.ask.items() if isinstance(v, Family)}
        families = {name: {"text": v.text, "over": list(v.over), "given": list(v.given)} for name, v in functions.items()}
        return {
            "kind": self.kind,
            "id": self.id,
            "function": self.function,
            "parameters": self.parameters,
            "constants": {name: _json(value) for name, value in self._given.items() if not callable(value)},
            "families": families,
            "variables": list(self.variables),
            "drawn": list(self.drawn),
            "call": self.call,
            "keys": self.keys,
            "scenes": {"public": f"{self.id}-public", "hidden": f"{self.id}-hidden" if self.drawn and self.rows[1] else None},
            "parts": list(self.parts),
            "returns": [self._returned(name, value) for name, value in self.values.items()],
            **({"uses": [earlier.__name__ for earlier in self.uses]} if self.uses else {}),
            **self.data,
        }

    @functools.cached_property
    @_located
    def asked(self) -> dict[str, Any]:
        """The question as data, with the shapes of its answer: calls the right solution once."""
        row = next(asking.each_row(self.draw(np.random.default_rng(0), 1)), {})
        answer = asking.call(self.document, self.student, asking.arguments(self.document, row))
        if len(self.values) == 1 and not self.keys:
            parts = [answer]
        else:
            parts = [answer[name] for name in self.values] if self.keys else list(answer)
        shaped = [
            value | {"shape": list(np.shape(part)), "complex": np.iscomplexobj(part) or self.data.get("complex", False)}
            for value, part in zip(self.document["returns"], parts, strict=True)
        ]
        return self.document | {"returns": shaped}

    def _returned(self, name: str, value: Value) -> dict[str, Any]:
        label = value.label or f"{self.function} is right" + (f": {name}" if len(self.values) > 1 else "")
        credit = {"points": value.points, "partial": value.partial}
        return {"name": name, "tolerance": tolerance_data(value.tolerance), "label": label, "up_to": value.up_to, **credit}

    def play(self, student: Any, rows: Mapping[str, Any], part: str | None = None) -> Arrays:
        """Return what a function, or a ``student`` with these names, answers, as the sandbox would.

        ``part`` is one of ``parts``, or the kind's own.
        """
        asked = self.asked if part is None else self.asked | {"part": part}
        names = student if isinstance(student, Mapping) else {self.function: student}
        answers: Arrays = kind_module(asked).play(asked, names, rows)
        return answers

    @_located
    def exact(self, rows: Mapping[str, Any], part: Part | None = None) -> dict[str, Any]:
        """Return the exact values of every row by name, those ``known`` among them, and the drawn values as ``at_NAME``."""
        drawn, answers = {f"at_{name}": np.asarray(rows[name]) for name in self.drawn}, []
        for row in asking.each_row(rows):
            asked = asking.arguments(self.asked, row)
            # a truth may call a function as often as it likes
            given = {n: v.function if isinstance(v, asking.Counted) else v for n, v in asked.items()} | row
            if part is not None:
                answers.append(part.exact(given))
                continue
            known = {n: _real(call_with(v, given) if callable(v) else v) for n, v in self.known.items()}
            exact = asking.returned(self.asked, call_with(self.truth, given)) if callable(self.truth) else {}
            answers.append(exact | known)
        is_own = isinstance(self.truth, Itself) or (self.truth is None and not self.known)
        own = self.play(self.student, rows) if part is None and is_own else {}
        return {**asking.stacked(answers), **own, **drawn}

    def scenes(self) -> Iterator[Scene]:
        """Yield the public scene, those of the parts, and the hidden one."""
        public, hidden = self.rows if self.drawn else (1, 0)
        one = Scene(
            name=f"{self.id}-public",
            play="play",
            function=self.function,
            inputs=Later(lambda: self.draw(np.random.default_rng(0), public)),
            returns=self._specs(public),
            truth=self.exact,
            budget_s=self.budget_s,
            known=tuple(f"at_{name}" for name in self.drawn),
            needs=self.variables[1:],
            question=Later(lambda: self.asked),
        )
        yield one
        for name, part in self.parts.items():
            yield self.part_scene(one, name, part)
        if hidden:
            yield replace(
                one,
                name=f"{self.id}-hidden",
                inputs=lambda rng: self.draw(rng, hidden),
                returns=self._specs(hidden),
            )

    def part_scene(self, public: Scene, name: str, part: Part) -> Scene:
        """Return the scene of a part, played if the ``public`` scene finished."""
        return replace(
            public,
            name=f"{self.id}-{name}",
            inputs=Later(lambda: self.draw(np.random.default_rng(0), part.rows)),
            returns=self._specs(part.rows, name),
            truth=functools.partial(self.exact, part=part),
            after=public.name,
            question=Later(lambda: self.asked | {"part": name}),
        )

    def _specs(self, rows: int, part: str | None = None) -> "Later":
        def specs() -> dict[str, ArraySpec]:
            one = self.play(self.student, self.draw(np.random.default_rng(0), 1), part)
            return {name: ArraySpec((rows, *array.shape[1:])) for name, array in one.items()}

        return Later(specs)


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


def cell(source: str) -> str:
    """Return the body of a function as the source of a cell, without its return statement.

    >>> cell("def answer():\\n    g = 9.81\\n    return g\\n")
    'g = 9.81'
    """
    (function,) = ast.parse(source).body
    assert isinstance(function, ast.FunctionDef)
    body = [part for part in function.body if not isinstance(part, ast.Return)]
    lines = source.splitlines()[body[0].lineno - 1 : body[-1].end_lineno]
    return textwrap.dedent("\n".join(lines))


def calling_line() -> int:
    """Return the line of the author's file that calls the function which calls this one."""
    return sys._getframe(2).f_lineno


def _real(value: Any) -> Any:
    """Return numbers as float64, complex ones as real and imaginary parts in a last index."""
    array = np.asarray(value)
    return np.stack([array.real, array.imag], axis=-1) if np.iscomplexobj(array) else array.astype(float)


def tolerance_data(tolerance: Tolerance) -> dict[str, Any]:
    """Return a tolerance as JSON: the arguments of Tolerance."""
    return {key: number for key, number in vars(tolerance).items() if number is not None}


def _json(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
