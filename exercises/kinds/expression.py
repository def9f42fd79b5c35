"""Questions about a sympy expression, by its values at random points."""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ecp.outcome import Tolerance
from exercises.question import Itself, Mistake, Question, Value, calling_line


@dataclass(frozen=True)
class Symbol:
    """A sympy symbol: where its points lie, on the real axis or in the complex square, and sympy's assumptions of it."""

    low: float
    high: float
    complex: bool = False
    assumptions: Mapping[str, bool] = field(default_factory=dict)

    def __call__(self, rng: np.random.Generator) -> Any:
        """Return a point: a number, or real and imaginary part."""
        return rng.uniform(self.low, self.high, 2 if self.complex else None)


def symbol(low: float, high: float, *, complex: bool = False, **assumptions: bool) -> Symbol:
    """Return a symbol whose points are drawn between ``low`` and ``high``, with ``complex`` in real and in imaginary part.

    ``assumptions`` are those of sympy, such as ``positive=True``. The expression must be exact at all of these points.
    """
    return Symbol(low, high, complex, assumptions)


def expression(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    truth: Callable[..., Any] | Itself,
    *,
    agree: Tolerance | Mapping[str, Value | Tolerance],
    variable: str | None = None,
    label: str | None = None,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (4, 16),
    budget_s: float = 10.0,
) -> Question:
    """Return the question for a sympy expression, a matrix of expressions, or several expressions, that ``solution`` returns.

    ``ask`` maps its parameters to symbols, constants and draws. ``truth`` gets numbers for the symbols and returns numbers, by
    numpy, sympy or another method. ``variable`` names the expression that a cell assigns, the body of ``solution``; its symbols
    are known by the names in ``ask``. ``agree`` is that of ``values``. The assignment declares ``packages=("sympy",)``.
    """
    several = (
        agree if isinstance(agree, Mapping) else {"value": Value(agree, label or (f"{variable} is right" if variable else None))}
    )
    symbols = {name: value for name, value in ask.items() if isinstance(value, Symbol)}
    return Question(
        kind="expression",
        solution=solution,
        ask=ask,
        values={name: value if isinstance(value, Value) else Value(value) for name, value in several.items()},
        truth=truth if isinstance(truth, Itself) else _numeric(truth, symbols),
        variables=(variable,) if variable else (),
        data={"symbols": {name: dict(value.assumptions) for name, value in symbols.items()}, "complex": True},
        mistakes=tuple(mistakes),
        rows=rows,
        budget_s=budget_s,
        line=calling_line(),
    )


def _numeric(truth: Callable[..., Any], symbols: Mapping[str, Symbol]) -> Callable[..., Any]:
    """Return ``truth`` called with numbers for symbols, which returns complex numbers."""

    @functools.wraps(truth)
    def exact(**given: Any) -> Any:
        answer = truth(**{n: complex(*v) if n in symbols and symbols[n].complex else v for n, v in given.items()})
        return tuple(map(_complex, answer)) if isinstance(answer, tuple) else _complex(answer)

    return exact


def _complex(answer: Any) -> Any:
    return np.array(answer.tolist() if hasattr(answer, "tolist") else answer, dtype=object).astype(complex)
