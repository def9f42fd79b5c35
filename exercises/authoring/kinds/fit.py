"""Questions about a fit of a model to data: the parameters and their covariance."""

import inspect
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import (
    Draw,
    LimitOrValue,
    Named,
    Rule,
    is_numeric,
    named_values,
)
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution

STARTS = 8
Data = Annotated[Any, Rule("an array (n,) of real numbers", lambda x: np.ndim(x) == 1 and is_numeric(x))]
Deviations = Annotated[
    Any, Rule("a number > 0, or an array of such numbers", lambda a: is_numeric(a) and np.min(a) > 0)
]
Array = NDArray[np.float64]


@kind(rows=(2, 8), budget_s=10.0)
def fit(
    solution: NotebookSolution,
    model: Named,
    *,
    x: Data,
    sigma: Deviations,
    drawn: Mapping[str, Draw],
    parameters: LimitOrValue,
    covariance: LimitOrValue,
    absolute_sigma: bool = True,
) -> Question:
    """Return the question for a function ``(x, y, sigma)``, by any names, that returns fitted parameters and
    their covariance.

    A data set is ``model(x, *parameters)`` plus normal noise of standard deviations ``sigma``, with ``drawn``
    parameters in the order of the model. Exact are the weighted least-squares parameters p of these data, by
    an optimizer of scipy from several starts, and the covariance (JᵀJ)⁻¹ of the weighted residuals' Jacobian
    J at p: as ``curve_fit`` defines it, times χ²/(n − p) unless ``absolute_sigma``. The tolerances of
    ``parameters`` and ``covariance`` are relative to the standard deviation σᵢ of each parameter, and to
    σᵢσⱼ.
    """
    given, deviations = np.asarray(x, float), np.broadcast_to(np.asarray(sigma, float), np.shape(x))
    names, fitted = (
        list(inspect.signature(solution).parameters),
        list(inspect.signature(model).parameters)[1:],
    )
    if len(names) != 3:
        raise ValueError(
            f"{solution.__name__} takes ({', '.join(names)}): it must take the data x, y and sigma, by any"
            " names"
        )
    if set(fitted) != set(drawn):
        raise ValueError(
            f"drawn has {', '.join(drawn)}: it must have the parameters of the model, {', '.join(fitted)}"
        )

    def drawn_parameters(rng: np.random.Generator) -> Array:
        return np.array([drawn[name](rng) for name in fitted], float)

    def data(rng: np.random.Generator) -> Array:
        return np.asarray(model(given, *drawn_parameters(rng)) + deviations * rng.normal(size=given.shape))

    def exact(**row: Any) -> tuple[Array, Array]:
        rng, y = np.random.default_rng(0), row[names[1]]
        starts = [drawn_parameters(rng) for _ in range(STARTS)]
        p, covariance, cost = _fitted(lambda p: (model(given, *p) - y) / deviations, starts)
        return p, covariance if absolute_sigma else covariance * 2 * cost / (len(given) - len(fitted))

    exact.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(names[1], inspect.Parameter.KEYWORD_ONLY)]
    )
    return Question(
        kind="fit",
        solution=solution,
        inputs=dict(zip(names, (given, data, np.array(deviations)), strict=True)),
        values=named_values({"parameters": parameters, "covariance": covariance}),
        truth=exact,
        data={"fitted": fitted},
    )


def _fitted(residuals: Callable[[Array], Array], starts: list[Array]) -> tuple[Array, Array, float]:
    """Return parameters, covariance and half the sum of squares of the best of the fits from several starts.

    Of equally good ones, such as those with both signs of a width, the nearest to the starts is the best.
    """
    from scipy.optimize import least_squares  # 1 s, which a server without such a question saves

    found = [
        least_squares(residuals, p, "3-point", method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15)
        for p in starts
    ]
    least = min(float(result.cost) for result in found)
    equal = [result for result in found if result.cost <= least * (1 + 1e-9)]
    middle, spread = np.mean(starts, axis=0), np.std(starts, axis=0) + np.finfo(float).tiny
    best = min(equal, key=lambda result: float(np.linalg.norm((result.x - middle) / spread)))
    jacobian = np.asarray(best.jac)
    return best.x, np.linalg.inv(jacobian.T @ jacobian), float(best.cost)
