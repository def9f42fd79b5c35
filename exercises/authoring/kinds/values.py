"""Questions about the values of a function at points."""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from exercises.authoring.kinds import kind
from exercises.authoring.questions.declared import (
    Agree,
    Ask,
    Family,
    Limit,
    Points,
    Source,
    Truth,
    UpTo,
    named_values,
    tolerance_data,
)
from exercises.authoring.questions.question import Question
from polhode.kinds import asking


@kind()
def values(
    solution: Callable[..., Any],
    ask: Ask,
    agree: Agree,
    *,
    truth: Truth | None = None,
    label: str | None = None,
    up_to: UpTo | None = None,
    points: Points = 1,
    partial: bool = False,
    calls: Limit | None = None,
    call: Source | None = None,
    keys: bool = False,
) -> Question:
    """Return the question what ``solution`` returns for the arguments ``ask``.

    ``agree`` is the tolerance of the returned value, or those of several values by name: of a tuple in order,
    of a dict with ``keys=True``. ``label``, ``up_to``, ``points`` and ``partial`` are those of ``Value``, for
    a single value. ``calls`` limits the calls of the function arguments. ``call`` is an expression to
    evaluate instead of calling ``solution`` with its parameters, such as ``"Pendulum(l, g).period()"``.
    """
    has_function = any(isinstance(value, Family) for value in ask.values())
    return Question(
        kind="values",
        solution=solution,
        ask=ask,
        values=named_values(agree, label, up_to=up_to, points=points, partial=partial),
        truth=truth,
        call=call,
        keys=keys,
        data={"calls": tolerance_data(calls)} if calls else {},
        errors=lambda: iter(
            ["calls= needs a function argument: family(…)"] if calls and not has_function else []
        ),
    )


def other_inputs(question: Question, call: str, label: str, **ask: Any) -> Question:
    """Return a ``question`` asked again with the arguments ``ask``, which need not be those of its function.

    ``call`` is an expression of the function and these arguments, such as an array of constant size that
    contains its answer for a drawn size. Exact is its value with the truth in place of the solution.
    ``label`` follows "NAME is right".
    """
    name = question.function
    several, labelled = len(question.values) > 1, f"{name} is right {label}"
    found = {
        n: replace(value, label=f"{labelled}: {n}" if several else labelled)
        for n, value in question.values.items()
    }
    exact = of_expression(call, name, question.truth, ask)
    return replace(question, ask=ask, values=found, truth=exact, call=call)


def of_expression(call: str, name: str, truth: Any, given: Iterable[str]) -> Callable[..., Any]:
    """Return the truth of an expression of the function ``name`` and the arguments ``given``: its value with
    the function's ``truth`` in place of the function.
    """

    def exact(**values: Any) -> Any:
        return asking.evaluate(call, values | {name: truth})

    exact.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(one, inspect.Parameter.KEYWORD_ONLY) for one in given]
    )
    return exact
