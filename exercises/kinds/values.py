"""Questions about the values of a function at points."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ecp.outcome import Tolerance
from exercises.question import HIDDEN_ROWS, PUBLIC_ROWS, Agree, Itself, Mistake, Question, calling_line, named_values


def values(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    agree: Agree,
    *,
    truth: Callable[..., Any] | Itself | None = None,
    label: str | None = None,
    up_to: str | None = None,
    points: int = 1,
    partial: bool = False,
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
    ``keys=True``. ``label``, ``up_to``, ``points`` and ``partial`` are those of ``Value``, for a single value. ``calls`` limits
    the calls of the function arguments. ``call`` is an expression to evaluate instead of calling ``solution`` with its
    parameters, such as ``"Pendulum(l, g).period()"``. ``rows`` are the numbers of public and of hidden inputs. ``uses`` are
    solutions of earlier questions that ``solution`` calls.
    """
    limit = {"calls": {"limit": calls.limit, "reason": calls.reason}} if calls else {}
    return Question(
        kind="values",
        solution=solution,
        ask=ask,
        values=named_values(agree, label, up_to, points, partial),
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
