"""Questions about a sympy expression, by its values at random points."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import Agree, Given, Itself, Truth, named_values
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution


@dataclass(frozen=True)
class Symbol:
    """A sympy symbol: where its points lie, on the real axis or in the complex square, and sympy's
    assumptions of it.
    """

    low: float
    high: float
    complex: bool = False
    assumptions: Mapping[str, bool] = field(default_factory=dict)

    def __call__(self, rng: np.random.Generator) -> Any:
        """Return a point: a number, or real and imaginary part."""
        return rng.uniform(self.low, self.high, 2 if self.complex else None)


def symbol(low: float, high: float, *, complex: bool = False, **assumptions: bool) -> Symbol:
    """Return a symbol whose points are drawn between ``low`` and ``high``, with ``complex`` in real and in
    imaginary part.

    ``assumptions`` are those of sympy, such as ``positive=True``. The expression must be exact at all of
    these points.
    """
    return Symbol(low, high, complex, assumptions)


@kind(rows=(4, 16), budget_s=10.0, uses=False)
def expression(
    solution: NotebookSolution,
    inputs: Given,
    truth: Truth,
    *,
    agree: Agree,
    variable: str | None = None,
) -> Question:
    """Return the question for a sympy expression, a matrix of expressions, or several expressions, that
    ``solution`` returns.

    ``inputs`` maps its parameters to symbols, constants and draws. ``truth`` gets numbers for the symbols and
    returns numbers, by numpy, sympy or another method. ``variable`` names the expression that the
    ``solution``, a cell, assigns; its symbols are known by the names in ``inputs``. ``agree`` is that of
    ``values``.
    The assignment declares ``packages=("sympy",)``.
    """
    symbols = {name: value for name, value in inputs.items() if isinstance(value, Symbol)}
    return Question(
        kind="expression",
        solution=solution,
        inputs=inputs,
        values=named_values(agree),
        truth=truth if isinstance(truth, Itself) else _numeric(truth, symbols),
        variables=(variable,) if variable else (),
        data={"symbols": {name: dict(value.assumptions) for name, value in symbols.items()}, "complex": True},
    )


def _numeric(truth: Callable[..., Any], symbols: Mapping[str, Symbol]) -> Callable[..., Any]:
    """Return ``truth`` called with numbers for symbols, which returns complex numbers."""

    @functools.wraps(truth)
    def exact(**given: Any) -> Any:
        answer = truth(
            **{n: complex(*v) if n in symbols and symbols[n].complex else v for n, v in given.items()}
        )
        return tuple(map(_complex, answer)) if isinstance(answer, tuple) else _complex(answer)

    return exact


def _complex(answer: Any) -> Any:
    return np.array(answer.tolist() if hasattr(answer, "tolist") else answer, dtype=object).astype(complex)
