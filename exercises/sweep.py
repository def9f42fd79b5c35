"""Speed against accuracy on one motion: of a right-hand side, by adaptive solvers over their tolerances, or
of steppers.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ecp.checks import Arrays
from ecp.outcome import SweepResult, SweptPoint

SOLVERS = ("DOP853", "RK45", "LSODA")
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
SETTINGS = [(solver, rtol) for solver in SOLVERS for rtol in TOLERANCES]
MOST_S = 80.0  # the longest that the sandbox plays a scene of this budget
BUDGET_S = 20.0
NOTEBOOKS = ("DOP853", 1e-11)
ENOUGH = 1e-8
ENOUGH_OF_STEPPERS = 1e-3
MOST_CALLS = 10**8  # of a run of a stepper


def result(scene: str, function: str, seen: Arrays, errors: Sequence[Any], most_calls: int) -> SweepResult:
    """Return the points of every setting and a summary line: the error at NOTEBOOKS, the cost of a call, the
    cheapest to ENOUGH.

    ``seen`` holds ``calls`` and ``seconds`` of every setting and ``per_call``, the seconds of one call. An
    error that is not finite is a run that diverged. Raises ValueError for calls and seconds that no run can
    have.
    """
    calls, seconds = seen["calls"], np.append(seen["seconds"], seen["per_call"])
    _require_possible(calls, seconds, most_calls)
    points = [
        SweptPoint(
            method=solver,
            rtol=rtol,
            calls=int(calls[k]),
            error=float(errors[k]) if math.isfinite(errors[k]) else None,
            seconds=float(seconds[k]),
        )
        for k, (solver, rtol) in enumerate(SETTINGS)
    ]
    return SweepResult(scene=scene, points=points, line=_line(points, float(seconds[-1]), function))


def result_of_steppers(
    scene: str, names: Sequence[str], steps: NDArray[np.float64], errors: NDArray[np.float64], seen: Arrays
) -> SweepResult:
    """Return the points of every run, and a line: what each stepper needs for an error of ENOUGH_OF_STEPPERS.

    ``steps``, ``errors``, and ``calls`` and ``seconds`` in ``seen`` have the shape (steppers, runs). A run
    without calls is left out; an error that is not finite is a run that diverged. Raises ValueError for calls
    and seconds that no run can have.
    """
    _require_possible(np.maximum(seen["calls"], 1), seen["seconds"], MOST_CALLS)
    points, parts = [], []
    for name, *runs in zip(names, steps, errors, seen["calls"], seen["seconds"], strict=True):
        own = [
            SweptPoint(
                name,
                None,
                int(calls),
                float(error) if math.isfinite(error) else None,
                float(seconds),
                float(h),
            )
            for h, error, calls, seconds in zip(*runs, strict=True)
            if calls
        ]
        points += own
        enough = min(
            (p for p in own if p.error is not None and p.error <= ENOUGH_OF_STEPPERS),
            key=lambda p: p.calls,
            default=None,
        )
        if enough:
            parts.append(f"{name} {enough.calls} calls and {enough.seconds * 1e3:.3g} ms")
        else:
            parts.append(
                f"{name} more than {max(p.calls for p in own)} calls" if own else f"{name} was not measured"
            )
    return SweepResult(
        scene=scene, points=points, line=f"for an error of {ENOUGH_OF_STEPPERS:g}: " + ", ".join(parts)
    )


def _require_possible(calls: NDArray[np.float64], seconds: NDArray[np.float64], most_calls: int) -> None:
    """Raise ValueError for calls and seconds that no run can have."""
    if not np.all((calls >= 1) & (calls <= most_calls) & (calls == np.trunc(calls))):
        raise ValueError(f"a number of calls is not a whole number from 1 to {most_calls}")
    if not np.all((seconds >= 0) & (seconds <= MOST_S)):
        raise ValueError(f"a time is not between 0 and {MOST_S:g} s")


def _line(points: list[SweptPoint], per_call: float, function: str) -> str:
    own = next(p for p in points if (p.method, p.rtol) == NOTEBOOKS)
    reached = "diverges" if own.error is None else f"reaches {own.error:.1e}"
    summary = (
        f"a call takes {per_call * 1e6:.3g} µs; {own.method} at rtol {own.rtol:g} {reached} in {own.calls}"
        " calls"
    )
    enough = [p for p in points if p.error is not None and p.error <= ENOUGH]
    if not enough:
        return f"{summary}; no solver reaches an error of {ENOUGH:g}: check {function}"
    best = min(enough, key=lambda p: p.calls)
    cheapest = f"{best.method} at rtol {best.rtol:g} ({best.calls} calls)"
    return f"{summary}; the solver that reaches {ENOUGH:g} with the fewest calls is {cheapest}"
