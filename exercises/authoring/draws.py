"""Draws: what a question is asked, new for each grading.

A draw is a function of a random generator. Draws that belong together are made by one function of the
author's, a joint draw: the solution gets those that its parameters name, and a truth may take every one of
them.
"""

import functools
import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FunctionType
from typing import Any

import numpy as np

from exercises.authoring.portable_source import source_of
from exercises.authoring.questions.author_arguments import SHORT, Draw, Family, Value
from polhode.judging.outcome import Tolerance


def between(low: float, high: float) -> Draw:
    """Return the draw of a number between ``low`` and ``high``."""
    return lambda rng: rng.uniform(low, high)


def with_ends(low: float, high: float, *, log: bool = False) -> Draw:
    """Return the draw of a number from ``low`` to ``high``, each end in a fifth of cases; with ``log``
    uniform in its logarithm.
    """

    def draw(rng: np.random.Generator) -> float:
        part = rng.uniform(-1 / 3, 4 / 3)
        inside = low * (high / low) ** part if log else low + (high - low) * part
        return min(max(inside, low), high)

    return draw


def integer(low: int, high: int) -> Draw:
    """Return the draw of an integer from ``low`` to ``high`` inclusive."""
    return lambda rng: rng.integers(low, high, endpoint=True)


def normal(rng: np.random.Generator) -> float:
    """Draw a standard normal number."""
    return rng.normal()


def one_of(*values: Any) -> Draw:
    """Return the draw of one of these ``values``."""
    return lambda rng: values[rng.integers(len(values))]


def array_of(shape: int | tuple[int, ...], each: Draw) -> Draw:
    """Return the draw of an array of this length or shape, whose numbers are drawn one by one."""

    def draw(rng: np.random.Generator) -> Any:
        return np.array([each(rng) for _ in range(math.prod(np.atleast_1d(shape)))]).reshape(shape)

    return draw


class Angle:
    """The draw of an angle in rad from −π to π; ``within`` is the tolerance of one, modulo 2π."""

    def __call__(self, rng: np.random.Generator) -> float:
        """Draw an angle."""
        return rng.uniform(-math.pi, math.pi)

    def within(self, limit: float, *, because: str) -> Value:
        """Return the tolerance of an angle or phase in rad: full turns do not count."""
        return Value(Tolerance(rtol=0.0, atol=limit, reason=because), up_to="full turns")


angle = Angle()


def expression(text: str, *, of: str, **given: Any) -> Family:
    """Return a function argument: the expression ``text`` of the variables ``of``, such as "t y".

    ``given`` are its parameters: constants, or draws. The expression may use the functions of
    ``polhode.kinds.student_calls.MATHEMATICS``.

    >>> expression("-k * x", of="t x", k=between(1, 2)).over
    ('t', 'x')
    """
    return Family(text, tuple(of.split()), given)


def function(defined: FunctionType, **given: Any) -> Family:
    """Return a function argument: the function ``defined`` in the author's file, of those of its parameters
    that are not ``given``, as constants or draws.

    What it uses (imports, constants, functions of the file) goes into the sandbox with it. Raises
    ``exercises.authoring.portable_source.NotPortable`` if something has no source.
    """
    over = [name for name in inspect.signature(defined).parameters if name not in given]
    return Family(source_of(defined), tuple(over), given)


class Drawing:
    """What a joint draw is called with: draws one value after the other from the generator ``rng``."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def __call__(self, draw: Draw) -> Any:
        """Return the value of a draw. Raises TypeError if it is none."""
        if isinstance(draw, Family):
            raise TypeError("an expression is not drawn: give it to a case, acc=expression(…)")
        if not callable(draw):
            raise TypeError(f"{SHORT.repr(draw)} is no draw, such as between(1, 2)")
        return draw(self.rng)

    def sign(self) -> float:
        """Return 1.0 or -1.0."""
        return self.rng.choice((-1.0, 1.0))


@dataclass(frozen=True, eq=False)
class JointDraw:
    """A function of the author's that draws names that belong together; ``draw["mu"]`` is one of them."""

    function: Callable[[Drawing], Mapping[str, Any]]

    def __call__(self, rng: np.random.Generator, row: int = 0) -> dict[str, Any]:
        """Return all drawn values by name of the input number ``row``. Raises TypeError if the function
        returns anything else.
        """
        found = self.function(Drawing(rng))
        if not isinstance(found, Mapping):
            raise TypeError(
                f"the draw {self.function.__name__} returned {type(found).__name__}: it must return a dict of"
                " the drawn values by name"
            )
        if expressions := [name for name, value in found.items() if isinstance(value, Family)]:
            raise TypeError(
                f"the draw {self.function.__name__} returned the expression {expressions[0]}: give it to a"
                f" case, {expressions[0]}=expression(…)"
            )
        return dict(found)

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """The names that it draws."""
        return tuple(self(np.random.default_rng(0)))

    @property
    def count(self) -> int | None:
        """The number of inputs that it draws at once, None if as many as are asked for."""
        return None

    def __getitem__(self, name: str) -> "JointlyDrawn":
        return JointlyDrawn(self, name)


class ListDraw(JointDraw):
    """A generator function of the author's that yields all inputs of a question, in order: cases that must
    not be missing, such as a body at rest, need no chance.
    """

    def __call__(self, rng: np.random.Generator, row: int = 0) -> dict[str, Any]:
        """Return the first of the inputs."""
        return self.all(rng)[0]

    def all(self, rng: np.random.Generator) -> list[dict[str, Any]]:
        """Return all inputs. Raises ValueError if there are none."""
        yielded: Any = self.function(Drawing(rng))
        found: list[dict[str, Any]] = list(yielded)
        if not found:
            raise ValueError(f"the draw {self.function.__name__} yields no input")
        return found

    @functools.cached_property
    def count(self) -> int:
        """The number of inputs."""
        return len(self.all(np.random.default_rng(0)))


@dataclass(frozen=True, eq=False)
class InTurn(JointDraw):
    """Joint ``cases`` that take turns: the first input is drawn by the first, and so on, again and again."""

    cases: tuple[JointDraw, ...]

    def __call__(self, rng: np.random.Generator, row: int = 0) -> dict[str, Any]:
        """Return all drawn values by name of the input number ``row``."""
        return self.cases[row % len(self.cases)](rng)


def in_turn(*cases: JointDraw) -> JointDraw:
    """Return the joint draw in which these ``cases`` take turns, so that every grading has inputs of each."""
    return InTurn(cases[0].function, cases)


@dataclass(frozen=True)
class JointlyDrawn:
    """One name of a joint draw, as an argument of a question."""

    joint: JointDraw
    name: str

    def __call__(self, rng: np.random.Generator) -> Any:
        """Return the value of a new joint draw. Raises LookupError if it lacks the name."""
        return self.of(self.joint(rng))

    def of(self, values: Mapping[str, Any]) -> Any:
        """Return the value among those that the joint draw returned. Raises LookupError if it is missing."""
        if self.name not in values:
            raise LookupError(
                f"the draw {self.joint.function.__name__} does not return {self.name}; it returns"
                f" {', '.join(values)}"
            )
        return values[self.name]
