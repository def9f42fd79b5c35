"""Questions about one step of an integration method: its values, its order of convergence, and its stability limit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from ecp.kinds import stepper as kit
from ecp.outcome import Tolerance
from exercises.question import (
    HIDDEN_ROWS,
    PUBLIC_ROWS,
    Agree,
    Family,
    Itself,
    Mistake,
    Part,
    Question,
    call_with,
    calling_line,
    named_values,
    tolerance_data,
)
from exercises.question_errors import family_errors, tolerance_errors


def tableau(A: Sequence[Sequence[float]], b: Sequence[float], c: Sequence[float]) -> Callable[..., Any]:
    """Return ``step(f, t, y, h)`` of the explicit Runge–Kutta method with this Butcher tableau.

    Row i of ``A`` holds the weights of the slopes 0 to i − 1.
    """

    def step(f: Callable[..., Any], t: float, y: Any, h: float) -> Any:
        k: list[Any] = []
        for row, at in zip(A, c, strict=True):
            k.append(np.asarray(f(t + at * h, y + h * sum(a * slope for a, slope in zip(row, k, strict=False)))))
        return y + h * sum(weight * slope for weight, slope in zip(b, k, strict=True))

    return step


euler = tableau([[]], [1], [0])
midpoint = tableau([[], [1 / 2]], [0, 1], [0, 1 / 2])
heun = tableau([[], [1]], [1 / 2, 1 / 2], [0, 1])
rk4 = tableau([[], [1 / 2], [0, 1 / 2], [0, 0, 1]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0, 1 / 2, 1 / 2, 1])


def stepper(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    agree: Agree,
    *,
    truth: Callable[..., Any] | Itself | None = None,
    calls: Tolerance | None = None,
    order: tuple[float, Tolerance] | None = None,
    rates: Callable[..., Any] | None = None,
    stability: tuple[float, Tolerance] | None = None,
    test: str | None = None,
    time: str = "t",
    step: str = "h",
    state: str = "y",
    label: str | None = None,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS),
    budget_s: float = 5.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question for one step, such as ``step(f, t, y, h)`` or ``verlet(force, x, v, h)``.

    The step returns the new ``state``, or several values (``agree``) with the names of the parameters that they replace. ``truth``
    may be a ``tableau``. ``calls`` limits the calls of the function argument.

    ``order`` is the order of convergence; its tolerance ``atol`` is how far below it the observed order may be. It is observed
    for runs of four steps of each row's size, halved six times, against the integrated ``rates``: a function of the arguments
    that returns the derivatives of the state in order, by default the function argument. ``stability`` is the largest step for
    which the ``test`` problem does not grow, or ``math.inf``. The test problem is the expression of the function argument, by
    default minus its last variable: y' = −y, or x'' = −x.
    """
    several = named_values(agree, label)
    name, family = next(((name, value) for name, value in ask.items() if isinstance(value, Family)), ("", Family("0", ("",), {})))
    states = {name: name for name in several} if isinstance(agree, Mapping) else {"value": state}
    data: dict[str, Any] = {"time": time, "step": step, "state": states, "test": test or f"-{family.over[-1]}"}
    measured = {"order": order, "stability": stability}
    data |= {part: [min(given[0], kit.LARGEST), tolerance_data(given[1])] for part, given in measured.items() if given}

    def derivatives(values: Mapping[str, Any]) -> Any:
        return call_with(rates, values) if rates else values[name](*(values[variable] for variable in family.over))

    def errors() -> Iterator[str]:
        if not name:
            yield "a stepper needs a function argument: family(…)"
            return
        yield from (f"it has no parameter {given}" for given in [step, *states.values()] if given not in ask)
        yield from (f"the test problem: {error}" for error in family_errors(Family(data["test"], family.over, {})))
        for part, given in measured.items():
            yield from (f"{part}: {error}" for error in (tolerance_errors(given[1]) if given else ()))

    parts = {"order": Part(lambda values: {"ends": _converged(data, values, derivatives)}), "stability": Part(lambda values: {}, 1)}
    return Question(
        kind="stepper",
        solution=solution,
        ask=ask,
        values=several,
        truth=truth,
        data=data | ({"calls": tolerance_data(calls)} if calls else {}),
        parts={part: parts[part] for part, given in measured.items() if given},
        errors=errors,
        mistakes=tuple(mistakes),
        rows=rows,
        budget_s=budget_s,
        uses=tuple(uses),
        line=calling_line(),
    )


def _converged(data: Mapping[str, Any], values: Mapping[str, Any], rates: Callable[..., Any]) -> Any:
    """Return the states (FIRST, d) at the ends of the first steps, integrated to rounding."""
    at = values.get(data["time"], 0.0) + values[data["step"]] * np.arange(kit.FIRST + 1)

    def rate(t: float, y: Any) -> Any:
        found = rates({**values, data["time"]: t, **kit.split(data, values, y)})
        return np.concatenate([np.ravel(part) for part in (found if isinstance(found, tuple) else (found,))])

    start = kit.flat(data, values)
    return solve_ivp(rate, (at[0], at[-1]), start, method="DOP853", t_eval=at[1:], rtol=3e-14, atol=1e-16).y.T
