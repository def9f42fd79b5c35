"""Questions about a fit of a model to data: the parameters and their covariance."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from ecp.outcome import Tolerance
from exercises.question import Draw, Mistake, Question, Value, calling_line, named_values

STARTS = 8
Array = NDArray[np.float64]


def fit(
    solution: Callable[..., Any],
    model: Callable[..., Any],
    *,
    x: ArrayLike,
    sigma: ArrayLike,
    drawn: Mapping[str, Draw],
    agree: tuple[Tolerance | Value, Tolerance | Value],
    absolute_sigma: bool = True,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (2, 8),
    budget_s: float = 10.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question for a function ``(x, y, sigma)``, by any names, that returns fitted parameters and their covariance.

    A data set is ``model(x, *parameters)`` plus normal noise of standard deviations ``sigma``, with ``drawn`` parameters in the
    order of the model. Exact are the weighted least-squares parameters p of these data, by an optimizer of scipy from several
    starts, and the covariance (JᵀJ)⁻¹ of the weighted residuals' Jacobian J at p: as ``curve_fit`` defines it, times χ²/(n − p)
    unless ``absolute_sigma``. ``agree`` are the tolerances of parameters and covariance: a ``limit`` relative to the standard
    deviation σᵢ of each parameter, and to σᵢσⱼ.
    """
    given, deviations = np.asarray(x, float), np.broadcast_to(np.asarray(sigma, float), np.shape(x))
    names = list(inspect.signature(solution).parameters)[:3]

    def data(rng: np.random.Generator) -> Array:
        parameters = [drawn[name](rng) for name in list(inspect.signature(model).parameters)[1:]]
        return np.asarray(model(given, *parameters) + deviations * rng.normal(size=given.shape))

    def exact(**row: Any) -> tuple[Array, Array]:
        return _fitted(model, given, row[names[1]], deviations, drawn, absolute_sigma=absolute_sigma)

    exact.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(names[1], inspect.Parameter.KEYWORD_ONLY)]
    )
    return Question(
        kind="fit",
        solution=solution,
        ask=dict(zip(names, (given, data, np.array(deviations)), strict=True)),
        values=named_values(dict(zip(("parameters", "covariance"), agree, strict=True))),
        truth=exact,
        data={"fitted": list(inspect.signature(model).parameters)[1:]},
        mistakes=tuple(mistakes),
        rows=rows,
        budget_s=budget_s,
        uses=tuple(uses),
        line=calling_line(),
    )


def _fitted(
    model: Callable[..., Any], x: Array, y: Array, sigma: Array, drawn: Mapping[str, Draw], *, absolute_sigma: bool
) -> tuple[Array, Array]:
    """Return parameters and covariance of the best of the fits from several starts, refined by Newton's steps."""
    rng, names = np.random.default_rng(0), list(inspect.signature(model).parameters)[1:]

    def residuals(p: Array) -> Any:
        return (model(x, *p) - y) / sigma

    starts = [np.array([drawn[name](rng) for name in names], float) for _ in range(STARTS)]
    found = [least_squares(residuals, p, "3-point", method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15) for p in starts]
    best = min(found, key=lambda result: float(result.cost))
    jacobian = np.asarray(best.jac)
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    return best.x, covariance if absolute_sigma else covariance * 2 * best.cost / (len(x) - len(names))
