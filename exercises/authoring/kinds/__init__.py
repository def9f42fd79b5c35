"""The kinds of questions that ``Ask`` can ask, a module each, and what all of them take."""

import functools
import inspect
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from inspect import BoundArguments, Parameter
from types import GenericAlias
from typing import Any

from exercises.authoring.questions.author_arguments import Positive, Rows, type_errors
from exercises.authoring.questions.question import HIDDEN_ROWS, PUBLIC_ROWS, Question

SHARED = {"rows": Rows, "budget_s": Positive, "uses": Sequence[Any]}


def kind(
    rows: tuple[int, int] | None = (PUBLIC_ROWS, HIDDEN_ROWS), budget_s: float = 5.0, *, uses: bool = True
) -> Callable[[Callable[..., Question]], Callable[..., Question]]:
    """Return the decorator of a function that makes a question: it takes the arguments of all kinds too, and
    collects errors.

    All take ``budget_s``, the seconds that one scene may take, and unless excluded here ``rows``, the numbers
    of public and of hidden inputs, and ``uses``, solutions of earlier questions that the solution calls. An
    argument whose value does not fit its type hint, or an exception of the function, is an error of the
    question.
    """
    defaults: dict[str, Any] = {"budget_s": budget_s}
    defaults |= ({"rows": rows} if rows else {}) | ({"uses": ()} if uses else {})

    def decorate(make: Callable[..., Question]) -> Callable[..., Question]:
        own, hints = inspect.signature(make), typing.get_type_hints(make, include_extras=True) | SHARED
        shared = [Parameter(name, Parameter.KEYWORD_ONLY, default=value) for name, value in defaults.items()]
        every = [*own.parameters.values(), *(one for one in shared if one.name not in own.parameters)]
        signature = own.replace(parameters=sorted(every, key=lambda parameter: parameter.kind))
        hints |= {
            p.name: GenericAlias(Mapping, (str, hints[p.name])) for p in every if p.kind is p.VAR_KEYWORD
        }

        @functools.wraps(make)
        def made(*args: Any, **named: Any) -> Question:
            bound = signature.bind(*args, **named)
            bound.apply_defaults()
            given = bound.arguments
            found = {name: list(type_errors(name, value, hints[name])) for name, value in given.items()}
            wrong = {name: errors for name, errors in found.items() if errors}
            call = BoundArguments(own, {name: given[name] for name in own.parameters})
            try:
                question = make(*call.args, **call.kwargs)
            except Exception as error:
                question = Question(make.__name__, given["solution"], {}, {})
                wrong = wrong or {
                    "": [str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"]
                }
            taken = {name: given[name] for name in defaults if name not in wrong}
            return replace(question, **taken, wrong=wrong)

        made.__signature__ = signature  # type: ignore[attr-defined]
        return made

    return decorate
