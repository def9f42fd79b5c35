"""Questions about the right-hand side of an ordinary differential equation, and the motion that it drives."""

from collections.abc import Callable, Mapping
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
    Itself,
    Mistake,
    Part,
    Question,
    Value,
    call_with,
    calling_line,
    tolerance_data,
)
from exercises.sweep import BUDGET_S, SETTINGS, result


def ode(
    solution: Callable[..., Any],
    ask: Mapping[str, Any],
    agree: Tolerance,
    *,
    truth: Callable[..., Any] | Itself | None = None,
    motion: Callable[..., Any] | None = None,
    t_end: float | None = None,
    follow: Tolerance | None = None,
    conserved: Mapping[str, tuple[str, Tolerance]] | None = None,
    time: str = "t",
    state: str = "y",
    scale: float | tuple[float, ...] = 1.0,
    most_calls: int = 20_000,
    label: str | None = None,
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    rows: tuple[int, int] = (PUBLIC_ROWS, HIDDEN_ROWS),
    budget_s: float = 5.0,
) -> Question:
    """Return the question for a right-hand side: its values at points, and with ``t_end`` also its motion from t = 0 to ``t_end``.

    ``motion(t, y, parameters…)`` is the closed form for times t (n,) and the state y at t = 0; it returns (k, n), the first k
    components of the flat state. It certifies the solution, so ``truth`` of the points may be left out. Without it the exact
    motion is that of ``truth``. ``follow`` is the tolerance of the motion, a ``limit`` relative to each component's largest
    value. ``conserved`` maps names to an expression over state, time and parameters, and the limit of its relative drift.
    ``scale`` is the typical size of the state, or of each component. The integration stops after ``most_calls`` calls.

    Public inputs have a motion; the points certify the function for all others. A closed form also adds a chart of speed against
    accuracy.
    """
    data: dict[str, Any] = {"time": time, "state": state}
    parts = {}
    if t_end is not None:

        def exact(values: Mapping[str, Any]) -> Any:
            return call_with(truth, values) if callable(truth) else solution(*(values[name] for name in ask))

        assert follow is not None, "t_end needs follow, the tolerance of the motion"
        every = {name: [text, tolerance_data(tolerance)] for name, (text, tolerance) in (conserved or {}).items()}
        data |= {"t_end": t_end, "follow": tolerance_data(follow), "conserved": every, "scale": scale, "most_calls": most_calls}
        parts["motion"] = Part(lambda values: {"motion": _exact_motion(data, values, motion, exact)})
    return Question(
        kind="ode",
        solution=solution,
        ask=ask,
        values={"value": Value(agree, label)},
        truth=truth or (Itself("the closed form of its motion certifies it") if motion else None),
        data=data | ({"settings": SETTINGS} if motion else {}),
        mistakes=tuple(mistakes),
        parts=parts,
        sweep=_sweep if motion else None,
        rows=rows,
        budget_s=budget_s,
        line=calling_line(),
    )


def _exact_motion(
    data: Mapping[str, Any], values: Mapping[str, Any], closed_form: Callable[..., Any] | None, rates: Callable[..., Any]
) -> NDArray[np.float64]:
    """Return the closed form (k, TIMES), or the motion of the exact right-hand side, integrated to rounding."""
    t, start = kit.times(data), np.asarray(values[data["state"]], dtype=float)
    if closed_form is not None:
        found = np.atleast_2d(np.asarray(call_with(closed_form, {**values, data["time"]: t}), dtype=float))
        if found.ndim != 2 or found.shape[1] != len(t) or len(found) > start.size:
            raise ValueError(f"the closed form returned shape {found.shape}, not (k, {len(t)}) with k ≤ {start.size}")
        return found

    def rate(now: float, y: NDArray[np.float64]) -> Any:
        return np.ravel(rates({**values, data["time"]: now, data["state"]: y.reshape(start.shape)}))

    atol = 1e-16 * np.asarray(data["scale"])
    run = solve_ivp(rate, (0.0, t[-1]), start.ravel(), method="DOP853", t_eval=t, rtol=1e-13, atol=atol)
    return np.asarray(run.y)


def _sweep(question: Question) -> Sweep:
    """Return the chart of speed against accuracy for the question's first motion."""
    data = question.data
    part = Part(question.parts["motion"].exact, rows=1)
    scene = replace(question.part_scene(next(question.scenes()), "sweep", part), after=None, budget_s=BUDGET_S)
    name = f"motion of {question.function} to {data['time']} = {data['t_end']:g}"

    def read(seen: Arrays, truth: Arrays) -> SweepResult:
        runs = {name: array[0] for name, array in seen.items()}
        got, want, scale = kit.deviation(data, runs["motion"], truth["motion"])
        with np.errstate(all="ignore"):
            errors = (np.abs(got - want) / scale).max(axis=(-2, -1))
        return result(name, question.function, runs, errors, data["most_calls"] + 1)

    return Sweep(scene, read)
