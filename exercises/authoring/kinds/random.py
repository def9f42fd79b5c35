"""Questions about random output: samples of a distribution, and Monte Carlo estimates."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import (
    Close,
    Given,
    Limit,
    Named,
    Positive,
    Rows,
    Rule,
    Source,
    Value,
    tolerance_data,
)
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.outcome import Tolerance

RATE = 1e-6
"""The rate at which all tests of a question together reject a right solution, at most."""
RESERVE = (
    10  # the tests are computed for a rate this much smaller: numbers are normally distributed only nearly
)
ROWS, BUDGET_S = (1, 2), 20.0


def _is_distribution(name: str) -> bool:
    import scipy.stats  # 0.8 s, which a server without such a question saves

    return hasattr(getattr(scipy.stats, name, None), "cdf")


Distribution = Annotated[str, Rule("the name of a distribution of scipy.stats", _is_distribution)]
Several = Annotated[int, Rule("an integer ≥ 2", lambda n: n >= 2)]


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


@kind(budget_s=BUDGET_S)
def samples(
    solution: NotebookSolution,
    inputs: Given,
    distribution: Distribution,
    *,
    call: Source | None = None,
    repetitions: Several = 20,
    label: str | None = None,
    rows: Rows = ROWS,
    **parameters: Named | float,
) -> Question:
    """Return the question for a function that returns independent samples, an array or a single number.

    ``distribution`` is a name of scipy.stats, discrete or continuous, and ``parameters`` are its parameters:
    numbers, or functions of the arguments ``inputs``. ``rv_discrete`` takes ``values=``, numbers and their
    probabilities (2, k). An argument ``generator()`` or ``seed()`` is a new one for each call; without one
    the function uses a generator of its own. Each row of arguments is asked ``repetitions`` times: about 1e5
    samples detect a difference of the cumulative distributions of 1 %. ``call`` is an expression to evaluate
    instead, such as ``"walk(100, rng)[-1]"``. ``label`` stands for the function's name in the labels of the
    checks.
    """
    parameters = parameters or {"loc": 0.0}  # a standard distribution
    data = {"distribution": distribution, "shape_parameters": list(parameters), "repetitions": repetitions}
    return _question(solution, inputs, label, rows=rows, data=data, call=call, known=parameters)


@kind(budget_s=BUDGET_S)
def estimate(
    solution: NotebookSolution,
    inputs: Given,
    truth: Named | float,
    *,
    sd: Named | Positive,
    error: Limit | None = None,
    mean_error: Limit | None = None,
    bias: Close | None = None,
    call: Source | None = None,
    repetitions: Several = 400,
    label: str | None = None,
    rows: Rows = ROWS,
) -> Question:
    """Return the question for a function that returns an estimate, nearly normally distributed, of a known
    standard deviation.

    ``truth`` is the expected value of the estimate and ``sd`` its standard deviation, computed or measured:
    numbers, or functions of the ``inputs``. The mean and the spread of the ``repetitions`` are tested
    against both. A systematic error up to ``bias``, ``atol`` and ``rtol``, is allowed. With ``error`` the
    function returns an estimate and its error: the root mean square of error/sd − 1 is at most the ``limit``
    of that tolerance, for N samples in an estimate at least 5/√N. With ``mean_error`` the mean of all
    returned errors differs from sd by at most the fraction ``limit``: it can be much smaller. ``call`` and
    ``label`` are those of ``samples``.
    """
    given = {"error": error, "mean_error": mean_error, "bias": bias}
    allowed = {name: tolerance_data(tolerance) for name, tolerance in given.items() if tolerance}
    data = {"repetitions": repetitions, **allowed}
    return _question(
        solution, inputs, label, rows=rows, data=data, call=call, known={"value": truth, "sd": sd}
    )


def _question(
    solution: NotebookSolution,
    inputs: Given,
    label: str | None,
    *,
    rows: tuple[int, int],
    data: dict[str, Any],
    **given: Any,
) -> Question:
    seeds = {name: value for name, value in inputs.items() if isinstance(value, Seed)}
    bias = data.get("bias", {})
    rate = f"a right solution fails one of these tests in fewer than one of {1 / RATE:,.0f} gradings"
    value = Value(Tolerance(limit=RATE, reason=rate))
    common = {
        "generators": [name for name, value in seeds.items() if value.generator],
        "seeds": [name for name, value in seeds.items() if not value.generator],
        "label": label or solution.__name__,
        "rate": RATE / RESERVE / (2 * sum(rows)),
        "tolerance": {**bias, "reason": "; ".join(filter(None, (bias.get("reason"), rate)))},
    }
    values = {"value": value} | ({"error": value} if data.keys() & {"error", "mean_error"} else {})
    return Question(
        kind="random", solution=solution, inputs=inputs, values=values, data={**common, **data}, **given
    )
