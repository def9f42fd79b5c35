"""Questions about the values of a function at points."""

import inspect
from collections.abc import Callable, Iterable
from typing import Any

from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import (
    Agree,
    Family,
    Given,
    Limit,
    Source,
    Truth,
    named_values,
    tolerance_data,
)
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.kinds import student_calls


@kind()
def values(
    solution: NotebookSolution,
    inputs: Given,
    agree: Agree,
    *,
    truth: Truth | None = None,
    calls: Limit | None = None,
    call: Source | None = None,
    keys: bool = False,
) -> Question:
    """Return the question what ``solution`` returns for the arguments ``inputs``.

    ``agree`` is the tolerance of the returned value, or those of several values by name: of a tuple in order,
    of a dict with ``keys=True``. ``calls`` limits the calls of the function arguments. ``call`` is an
    expression to evaluate instead of calling ``solution`` with its parameters, such as
    ``"Pendulum(l, g).period()"``.
    """
    has_function = any(isinstance(value, Family) for value in inputs.values())
    return Question(
        kind="values",
        solution=solution,
        inputs=inputs,
        values=named_values(agree),
        truth=truth,
        call=call,
        keys=keys,
        data={"calls": tolerance_data(calls)} if calls else {},
        errors=lambda: iter(
            ["calls= needs a function argument: expression(…)"] if calls and not has_function else []
        ),
    )


def of_expression(call: str, name: str, truth: Any, given: Iterable[str]) -> Callable[..., Any]:
    """Return the truth of an expression of the function ``name`` and the arguments ``given``: its value with
    the function's ``truth`` in place of the function.
    """

    def exact(**values: Any) -> Any:
        return student_calls.evaluate(call, values | {name: truth})

    exact.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(one, inspect.Parameter.KEYWORD_ONLY) for one in given]
    )
    return exact
