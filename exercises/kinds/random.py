"""Questions about random output: samples of a distribution, and Monte Carlo estimates."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ecp.outcome import Tolerance
from exercises.question import Mistake, Question, Value, calling_line, tolerance_data

RATE = 1e-6
"""The rate at which all tests of a question together reject a right solution, at most."""
RESERVE = 10  # the tests are computed for a rate this much smaller: numbers are normally distributed only nearly


@dataclass(frozen=True)
class Seed:
    """A drawn seed, passed as an integer or as numpy's generator."""

    generator: bool

    def __call__(self, rng: np.random.Generator) -> Any:
        """Return a seed."""
        return rng.integers(2**31)


def generator() -> Seed:
    """Return the argument ``numpy.random.default_rng(seed)``, of another seed for each call."""
    return Seed(generator=True)


def seed() -> Seed:
    """Return an integer argument, another for each call."""
    return Seed(generator=False)


def samples(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    distribution: str,
    *,
    call: str | None = None,
    repetitions: int = 20,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (1, 2),
    budget_s: float = 10.0,
    uses: Sequence[Callable[..., Any]] = (),
    **parameters: Any,
) -> Question:
    """Return the question for a function that returns independent samples, an array or a single number.

    ``distribution`` is a name of scipy.stats, discrete or continuous, and ``parameters`` are its parameters: numbers, or functions
    of the arguments ``ask``. An argument ``generator()`` or ``seed()`` is a new one for each call; without one the function uses a
    generator of its own. Each row of arguments is asked ``repetitions`` times: about 1e5 samples detect a difference of the
    cumulative distributions of 1 %. ``call`` is an expression to evaluate instead, such as ``"walk(100, rng)[-1]"``.
    """
    question = _question(
        solution, ask, call=call, repetitions=repetitions, mistakes=mistakes, rows=rows, budget_s=budget_s, uses=tuple(uses)
    )
    data = {"distribution": distribution, "shape_parameters": list(parameters)}
    return replace(question, known=parameters, data={**question.data, **data}, line=calling_line())


def estimate(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    truth: Callable[..., Any] | float,
    *,
    sd: Callable[..., Any] | float,
    error: Tolerance | None = None,
    bias: Tolerance | None = None,
    call: str | None = None,
    repetitions: int = 400,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (1, 2),
    budget_s: float = 10.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question for a function that returns an estimate, nearly normally distributed, of a known standard deviation.

    ``truth`` is the expected value of the estimate and ``sd`` its standard deviation, computed or measured: numbers, or functions
    of the arguments ``ask``. The mean and the spread of the ``repetitions`` are tested against both. A systematic error up to
    ``bias``, ``atol`` and ``rtol``, is allowed. With ``error`` the function returns an estimate and its error: the root mean square
    of error/sd − 1 is at most the ``limit`` of that tolerance, for N samples in an estimate at least 5/√N.
    """
    question = _question(
        solution, ask, call=call, repetitions=repetitions, mistakes=mistakes, rows=rows, budget_s=budget_s, uses=tuple(uses)
    )
    allowed = tolerance_data(bias) if bias else {}
    reason = "; ".join(filter(None, (allowed.get("reason"), question.data["tolerance"]["reason"])))
    data = {"tolerance": {**allowed, "reason": reason}}
    if error:
        data["error"] = {"limit": error.limit, "reason": error.reason}
    returned = dict.fromkeys(("value", "error"), question.values["value"]) if error else question.values
    known = {"value": truth, "sd": sd}
    return replace(question, values=returned, known=known, data={**question.data, **data}, line=calling_line())


def _question(
    solution: Callable[..., Any], ask: Mapping[str, Any], *, repetitions: int, rows: tuple[int, int], **given: Any
) -> Question:
    seeds = {name: value for name, value in ask.items() if isinstance(value, Seed)}
    reason = f"a right solution fails one of these tests in fewer than one of {1 / RATE:,.0f} gradings"
    return Question(
        kind="random",
        solution=solution,
        ask=ask,
        values={"value": Value(Tolerance(limit=RATE, reason=reason))},
        data={
            "generators": [name for name, value in seeds.items() if value.generator],
            "seeds": [name for name, value in seeds.items() if not value.generator],
            "repetitions": repetitions,
            "rate": RATE / RESERVE / (2 * sum(rows)),
            "tolerance": {"reason": reason},
        },
        rows=rows,
        **{**given, "mistakes": tuple(given["mistakes"])},
    )
