"""Questions about the right-hand side of an ordinary differential equation, and the motion that it drives."""

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Sweep
from exercises.authoring.assignments.speed_vs_accuracy import BUDGET_S, SETTINGS, result
from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import (
    Agree,
    Count,
    Expression,
    Family,
    Given,
    Itself,
    Limit,
    Named,
    Positive,
    Truth,
    named_values,
    tolerance_data,
)
from exercises.authoring.questions.question import Part, Question, call_with
from exercises.authoring.questions.question_errors import family_errors
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.checks import Arrays
from polhode.judging.integration import solve_ivp
from polhode.judging.outcome import SweepResult
from polhode.kinds import ode as kit
from polhode.kinds.student_calls import flat, split


@kind()
def ode(
    solution: NotebookSolution,
    inputs: Given,
    agree: Agree,
    *,
    truth: Truth | None = None,
    until: Positive | None = None,
    follow: Limit | None = None,
    motion: Named | None = None,
    conserved: Mapping[str, tuple[Expression, Limit]] | None = None,
    time: str = "t",
    state: str = "y",
    scale: Positive | tuple[Positive, ...] = 1.0,
    most_calls: Count = 20_000,
) -> Question:
    """Return the question for a right-hand side: its values at points, and with ``until`` also its motion
    from t = 0 to that time.

    ``follow`` is the tolerance of the motion, a ``limit`` relative to each component's largest value.
    ``motion(t, y, parameters…)`` is the closed form for times t (n,) and the state y at t = 0; it returns (k,
    n), the first k components of the flat state. It certifies the solution, so ``truth`` of the points may be
    left out. Without it the exact motion is that of ``truth``. ``conserved`` maps names to an expression over
    state, time and parameters, and the ``limit`` of its relative drift. ``scale`` is the typical size of the
    state, or of each component. The integration stops after ``most_calls`` calls.

    Only public inputs have a motion: the points certify the function for all others. It also adds a chart of
    speed against accuracy.
    """
    kept = {name: [text, tolerance_data(tolerance)] for name, (text, tolerance) in (conserved or {}).items()}
    data = {
        "time": time,
        "state": state,
        "t_end": until,
        "scale": scale,
        "most_calls": most_calls,
        "conserved": kept,
    }

    def exact(values: Mapping[str, Any]) -> Arrays:
        if motion:
            return {"motion": _closed_form(data, values, motion)}
        right = truth if callable(truth) else solution
        return {
            "motion": converged(
                lambda at: call_with(right, at), values, [state], time, kit.times(data), scale=scale
            )
        }

    def errors() -> Iterator[str]:
        if state not in inputs:
            yield f"there is no input {state}, the state: name it with state="
        if (until is None) != (follow is None) or (until is None and (motion or conserved)):
            yield "a motion needs until= and follow=, its tolerance"
        known = {
            **inputs,
            **{
                name: 0.0 for family in inputs.values() if isinstance(family, Family) for name in family.given
            },
            time: 0.0,
        }
        for name in inspect.signature(motion).parameters if motion else ():
            if name not in known:
                yield f"the closed form takes {name}, which is neither asked nor drawn"
        for name, (text, _) in (conserved or {}).items():
            yield from (f"{name}: {error}" for error in family_errors(Family(text, (time, state), known)))

    return Question(
        kind="ode",
        solution=solution,
        inputs=inputs,
        values=named_values(agree),
        truth=truth or (Itself("the closed form of its motion certifies it") if motion else None),
        data=data | ({"follow": tolerance_data(follow), "settings": SETTINGS} if follow else {}),
        parts={"motion": Part(exact)} if follow else {},
        sweep=functools.partial(_sweep, exact) if follow else None,
        errors=errors,
    )


def _closed_form(
    data: Mapping[str, Any], values: Mapping[str, Any], motion: Callable[..., Any]
) -> NDArray[np.float64]:
    t, most = kit.times(data), np.size(values[data["state"]])
    found = np.atleast_2d(np.asarray(call_with(motion, {**values, data["time"]: t}), dtype=float))
    if found.ndim != 2 or found.shape[1] != len(t) or len(found) > most:
        raise ValueError(f"the closed form returned shape {found.shape}, not (k, {len(t)}) with k ≤ {most}")
    return found


def converged(
    rates: Callable[[Mapping[str, Any]], Any],
    values: Mapping[str, Any],
    states: Sequence[str],
    time: str,
    at: NDArray[np.float64],
    *,
    scale: Any = 1.0,
) -> NDArray[np.float64]:
    """Return the flat state (d, n) at the times ``at`` (n,), integrated to rounding from that in ``values``
    at the first time.

    ``rates(values)`` returns the derivatives of the arguments ``states`` in order; ``scale`` is the size of
    the state.
    """

    def rate(t: float, y: NDArray[np.float64]) -> Any:
        found = rates({**values, time: t, **split(states, values, y)})
        return np.concatenate([np.ravel(part) for part in (found if isinstance(found, tuple) else (found,))])

    start, atol = flat(states, values), 1e-16 * np.asarray(scale)
    run = solve_ivp()(rate, (at[0], at[-1]), start, method="DOP853", t_eval=at, rtol=3e-14, atol=atol)
    if not run.success:
        raise ArithmeticError(
            f"the exact motion stops at {time} = {run.t[-1] if len(run.t) else at[0]:.3g}: {run.message}"
        )
    return np.asarray(run.y)


def _sweep(exact: Callable[[Mapping[str, Any]], Arrays], questions: Sequence[Question]) -> Sweep:
    """Return the chart of speed against accuracy for the first motion of the first question."""
    question = questions[0]
    data, name = (
        question.data,
        f"motion of {question.function} to {question.data['time']} = {question.data['t_end']:g}",
    )

    def read(seen: Arrays, truth: Arrays) -> SweepResult:
        runs = {name: array[0] for name, array in seen.items()}
        got, want, scale = kit.deviation(data, runs["motion"], truth["motion"])
        with np.errstate(all="ignore"):
            errors = (np.abs(got - want) / scale).max(axis=(-2, -1))
        return result(name, question.function, runs, errors, data["most_calls"] + 1)

    scene = replace(question.scene("sweep", 1, Part(exact)), after=None, budget_s=BUDGET_S)
    return Sweep(scene, read, tolerance=data["follow"]["limit"])
