"""Questions about the values of a function at points."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ecp.outcome import Tolerance
from exercises.question import HIDDEN_ROWS, PUBLIC_ROWS, Itself, Mistake, Question, Value, calling_line


def values(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    agree: Tolerance | Mapping[str, Value | Tolerance],
    *,
    truth: Callable[..., Any] | Itself | None = None,
    label: str | None = None,
    up_to: str | None = None,
    calls: Tolerance | None = None,
    call: str | None = None,
    keys: bool = False,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS),
    budget_s: float = 5.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question what ``solution`` returns for the arguments ``ask``.

    ``agree`` is the tolerance of the returned value, or those of several values by name: of a tuple in order, of a dict with
    ``keys=True``. ``up_to`` names what a single value leaves open (ecp.kinds.alignment). ``calls`` limits the calls of the function
    arguments. ``call`` is an expression to evaluate instead of calling ``solution`` with its parameters, such as
    ``"Pendulum(l, g).period()"``. ``rows`` are the numbers of public and of hidden inputs. ``uses`` are solutions of
    earlier questions that ``solution`` calls.
    """
    several = agree if isinstance(agree, Mapping) else {"value": Value(agree, label, up_to)}
    limit = {"calls": {"limit": calls.limit, "reason": calls.reason}} if calls else {}
    return Question(
        kind="values",
        solution=solution,
        ask=ask,
        values={name: value if isinstance(value, Value) else Value(value) for name, value in several.items()},
        truth=truth,
        call=call,
        keys=keys,
        data=limit,
        mistakes=tuple(mistakes),
        rows=rows,
        budget_s=budget_s,
        uses=tuple(uses),
        line=calling_line(),
    )
