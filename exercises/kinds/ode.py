"""Questions about the right-hand side of an ordinary differential equation, and the motion that it drives."""

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from ecp.checks import Arrays
from ecp.kinds import ode as kit
from ecp.outcome import SweepResult, Tolerance
from exercises.assignment import Sweep
from exercises.question import (
    HIDDEN_ROWS,
    PUBLIC_ROWS,
    Family,
    Itself,
    Mistake,
    Part,
    Question,
    Value,
    call_with,
    calling_line,
    named_values,
    tolerance_data,
)
from exercises.question_errors import family_errors, tolerance_errors
from exercises.sweep import BUDGET_S, SETTINGS, result


def ode(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    agree: Tolerance | Value,
    *,
    truth: Callable[..., Any] | Itself | None = None,
    t_end: float | None = None,
    follow: Tolerance | None = None,
    motion: Callable[..., Any] | None = None,
    conserved: Mapping[str, tuple[str, Tolerance]] | None = None,
    time: str = "t",
    state: str = "y",
    scale: float | tuple[float, ...] = 1.0,
    most_calls: int = 20_000,
    label: str | None = None,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS),
    budget_s: float = 5.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question for a right-hand side: its values at points, and with ``t_end`` also its motion from t = 0 to ``t_end``.

    ``follow`` is the tolerance of the motion, a ``limit`` relative to each component's largest value. ``motion(t, y, parameters…)``
    is the closed form for times t (n,) and the state y at t = 0; it returns (k, n), the first k components of the flat state. It
    certifies the solution, so ``truth`` of the points may be left out. Without it the exact motion is that of ``truth``.
    ``conserved`` maps names to an expression over state, time and parameters, and the ``limit`` of its relative drift. ``scale``
    is the typical size of the state, or of each component. The integration stops after ``most_calls`` calls.

    Only public inputs have a motion: the points certify the function for all others. A closed form also adds a chart of speed
    against accuracy.
    """
    kept = {name: [text, tolerance_data(tolerance)] for name, (text, tolerance) in (conserved or {}).items()}
    data = {"time": time, "state": state, "t_end": t_end, "scale": scale, "most_calls": most_calls, "conserved": kept}
    moves = {"follow": tolerance_data(follow), "settings": SETTINGS} if follow else {}

    def rates(values: Mapping[str, Any]) -> Any:
        return call_with(truth, values) if callable(truth) else solution(*(values[name] for name in ask))

    def exact(values: Mapping[str, Any]) -> Arrays:
        return {"motion": _closed_form(data, values, motion) if motion else _converged(data, values, rates)}

    def errors() -> Iterator[str]:
        if (t_end is None) != (follow is None) or (t_end is None and (motion or conserved)):
            yield "a motion needs t_end and follow, its tolerance"
        known = {**ask, **{name: 0.0 for family in ask.values() if isinstance(family, Family) for name in family.given}, time: 0.0}
        for name in inspect.signature(motion).parameters if motion else ():
            if name not in known:
                yield f"the closed form takes {name}, which is neither asked nor drawn"
        for name, (text, tolerance) in {**({"the motion": ("0", follow)} if follow else {}), **(conserved or {})}.items():
            yield from (f"{name}: {error}" for error in family_errors(Family(text, (time, state), known)))
            yield from (f"{name}: {error}" for error in tolerance_errors(tolerance))
            if tolerance.limit is None:
                yield f"{name}: its tolerance needs limit"

    return Question(
        kind="ode",
        solution=solution,
        ask=ask,
        values=named_values(agree, label),
        truth=truth or (Itself("the closed form of its motion certifies it") if motion else None),
        data=data | moves,
        parts={"motion": Part(exact)} if follow else {},
        sweep=functools.partial(_sweep, exact) if motion else None,
        errors=errors,
        mistakes=tuple(mistakes),
        rows=rows,
        budget_s=budget_s,
        uses=tuple(uses),
        line=calling_line(),
    )


def _closed_form(data: Mapping[str, Any], values: Mapping[str, Any], motion: Callable[..., Any]) -> NDArray[np.float64]:
    t, most = kit.times(data), np.size(values[data["state"]])
    found = np.atleast_2d(np.asarray(call_with(motion, {**values, data["time"]: t}), dtype=float))
    if found.ndim != 2 or found.shape[1] != len(t) or len(found) > most:
        raise ValueError(f"the closed form returned shape {found.shape}, not (k, {len(t)}) with k ≤ {most}")
    return found


def _converged(data: Mapping[str, Any], values: Mapping[str, Any], rates: Callable[..., Any]) -> NDArray[np.float64]:
    """Return the motion (d, TIMES) of the exact right-hand side, integrated to rounding."""
    t, start = kit.times(data), np.asarray(values[data["state"]], dtype=float)

    def rate(now: float, y: NDArray[np.float64]) -> Any:
        return np.ravel(rates({**values, data["time"]: now, data["state"]: y.reshape(start.shape)}))

    atol = 1e-16 * np.asarray(data["scale"])
    return np.asarray(solve_ivp(rate, (0.0, t[-1]), start.ravel(), method="DOP853", t_eval=t, rtol=1e-13, atol=atol).y)


def _sweep(exact: Callable[[Mapping[str, Any]], Arrays], question: Question) -> Sweep:
    """Return the chart of speed against accuracy for the question's first motion."""
    data = question.data
    scene = question.part_scene(next(question.scenes()), "sweep", Part(exact, rows=1))
    name = f"motion of {question.function} to {data['time']} = {data['t_end']:g}"

    def read(seen: Arrays, truth: Arrays) -> SweepResult:
        runs = {name: array[0] for name, array in seen.items()}
        got, want, scale = kit.deviation(data, runs["motion"], truth["motion"])
        with np.errstate(all="ignore"):
            errors = (np.abs(got - want) / scale).max(axis=(-2, -1))
        return result(name, question.function, runs, errors, data["most_calls"] + 1)

    return Sweep(replace(scene, after=None, budget_s=BUDGET_S), read)
