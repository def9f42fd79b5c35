"""Questions about one step of an integration method: its values, its order of convergence, and its stability limit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Annotated, Any

import numpy as np

from ecp.kinds import stepper as kit
from exercises.declared import (
    Absolute,
    Agree,
    Ask,
    Close,
    Expression,
    Family,
    Limit,
    Named,
    Positive,
    Rule,
    Truth,
    named_values,
    tolerance_data,
)
from exercises.kinds import kind
from exercises.kinds.ode import converged
from exercises.question import Part, Question, call_with
from exercises.question_errors import family_errors


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


@kind()
def stepper(
    solution: Callable[..., Any],
    ask: Ask,
    agree: Agree,
    *,
    truth: Truth | None = None,
    calls: Limit | None = None,
    order: tuple[Positive, Absolute] | None = None,
    rates: Named | None = None,
    stability: tuple[Annotated[float, Rule("a number > 0, or math.inf", lambda h: h > 0)], Close] | None = None,
    test: Expression | None = None,
    time: str = "t",
    step: str = "h",
    state: str = "y",
    label: str | None = None,
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
    states = {value: value for value in several} if isinstance(agree, Mapping) else {"value": state}
    data: dict[str, Any] = {"time": time, "step": step, "state": states, "test": test or f"-{family.over[-1]}"}
    measured = {"order": order, "stability": stability}
    data |= {part: [min(given[0], kit.LARGEST), tolerance_data(given[1])] for part, given in measured.items() if given}

    def ends(values: Mapping[str, Any]) -> dict[str, Any]:
        def derivatives(at: Mapping[str, Any]) -> Any:
            return call_with(rates, at) if rates else at[name](*(at[variable] for variable in family.over))

        at = values.get(time, 0.0) + values[step] * np.arange(kit.FIRST + 1)
        return {"ends": converged(derivatives, values, list(states.values()), time, at)[:, 1:].T}

    def errors() -> Iterator[str]:
        if not name:
            yield "a stepper needs a function argument: family(…)"
            return
        yield from (f"it has no parameter {given}" for given in [step, *states.values()] if given not in ask)
        yield from (f"the test problem: {error}" for error in family_errors(Family(data["test"], family.over, {})))

    parts = {"order": Part(ends), "stability": Part(lambda values: {}, 1)}
    return Question(
        kind="stepper",
        solution=solution,
        ask=ask,
        values=several,
        truth=truth,
        data=data | ({"calls": tolerance_data(calls)} if calls else {}),
        parts={part: parts[part] for part, given in measured.items() if given},
        errors=errors,
    )
