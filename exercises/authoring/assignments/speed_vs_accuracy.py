"""Speed against accuracy on one motion: of a right-hand side, by adaptive solvers over their tolerances, or
of steppers.
"""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Sweep
from polhode.judging.checks import Arrays
from polhode.judging.outcome import SweepResult, SweptPoint

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
# RK45 would take tens of thousands of calls for the finest two.
FINEST = {"DOP853": 6, "RK45": 4, "LSODA": 6}
SETTINGS = [(solver, rtol) for solver, count in FINEST.items() for rtol in TOLERANCES[:count]]
MOST_S = 80.0  # the longest that the sandbox plays a scene of this budget
BUDGET_S = 20.0
NOTEBOOKS = ("DOP853", 1e-11)
ENOUGH = 1e-8
SINGLE = 2.0**-23
REPEATED = 3
ALIKE = (0.8, 1.25)  # ratios of times that say nothing on a machine with other work
LITTLE = 0.2  # a share of the time that is not worth saving
ENOUGH_OF_STEPPERS = 1e-3
MOST_CALLS = 10**8  # of a run of a stepper


def result(scene: str, function: str, seen: Arrays, errors: Sequence[Any], most_calls: int) -> SweepResult:
    """Return the points of every setting and the seconds of a call; ``compared`` adds the text.

    ``seen`` holds ``calls`` and ``seconds`` of every setting and ``per_call``, the seconds of one call. A run
    of ``most_calls`` was stopped; an error that is not finite is of a run that diverged or was stopped.
    Raises ValueError for calls and seconds that no run can have.
    """
    calls, seconds, per_call = seen["calls"], seen["seconds"], float(seen["per_call"])
    _require_possible(calls, np.append(seconds, per_call), most_calls)
    points = [
        SweptPoint(
            method=solver,
            rtol=rtol,
            calls=int(calls[k]),
            error=float(errors[k]) if math.isfinite(errors[k]) else None,
            seconds=float(seconds[k]),
            stopped=bool(calls[k] == most_calls),
        )
        for k, (solver, rtol) in enumerate(SETTINGS)
    ]
    return SweepResult(scene=scene, points=points, line="", per_call=[per_call])


def compared(mine: SweepResult, right: SweepResult | None, sweep: Sweep, function: str) -> SweepResult:
    """Return ``mine`` beside the right solution's result, with the lines of the chart and the text below it:
    which solver is enough, what a call costs, and where the time goes.
    """
    kappa = sweep.sensitivity() if sweep.sensitivity else None
    if mine.per_call:
        sentences = _of_solvers(mine, right, sweep.tolerance or ENOUGH, kappa, function)
    else:
        sentences = [mine.line, *([f"the solution: {right.line}"] if right else [])]
    return replace(
        mine,
        line="; ".join(sentences),
        reference=right.points if right else [],
        per_call=[*mine.per_call, *(right.per_call if right else [])],
        tolerance=sweep.tolerance,
        sensitivity=kappa,
        closed_form=_seconds(sweep.exact) if sweep.exact else None,
    )


def _of_solvers(
    mine: SweepResult, right: SweepResult | None, target: float, kappa: float | None, function: str
) -> list[str]:
    """Return what a call costs, where the notebook's run spends its time, and which run reaches the error
    ``target`` in the least time, or why none does.
    """
    per_call, stopped = mine.per_call[0], [p for p in mine.points if p.stopped]
    cost = f"one call of {function} takes {_us(per_call)}"
    if right:
        ratio = per_call / max(right.per_call[0], 1e-9)
        beside = f"of the solution {_us(right.per_call[0])} (×{ratio:.2g})"
        cost += ", about as long as of the solution" if ALIKE[0] < ratio < ALIKE[1] else f", {beside}"
    noise = f"{len(stopped)} of {len(mine.points)} runs were stopped at rounding noise (crosses)"
    arrived = [p for p in mine.points if p.error is not None]
    enough = [p for p in arrived if p.error is not None and p.error <= target]
    if not arrived:
        return [f"no run reaches the end: check {function} first"]
    if not enough:
        least = min(p.error for p in arrived if p.error is not None)
        why = f"check {function} first"
        if stopped and kappa and least < 10 * kappa * SINGLE:
            why = (
                "this is what single precision does, in which rounding moves the motion by up to κ·2⁻²³ ="
                f" {kappa * SINGLE:.1g}: let {function} compute and return float64"
            )
        missed = f"no run gets below an error of {least:.3g}, and {target:g} is allowed: {why}"
        return [missed, *([noise] if stopped else [])]
    own = next(p for p in mine.points if (p.method, p.rtol) == NOTEBOOKS)
    share = min(own.calls * per_call, own.seconds)
    best = min(enough, key=lambda p: p.seconds)
    enough_is = (
        f"{best.method} at rtol {best.rtol:g} is enough: it has an error of {best.error:.2g}, and {target:g}"
        f" is allowed, in {_ms(best.seconds)}"
    )
    spent = f"{own.method} at rtol {own.rtol:g} makes {own.calls} calls in {_ms(own.seconds)}"
    like = min(per_call, right.per_call[0]) if right else 0.0
    saved = share * (1 - like / per_call)
    faster = (
        "a function as fast as the solution would save" if right else "a faster function would save up to"
    )
    helps = f"{faster} {_ms(saved)} of these"
    if saved < LITTLE * own.seconds:
        helps = "fewer calls help, a faster function does not"
    return [
        enough_is,
        cost,
        f"{spent}, {_ms(share)} of it in {function}: {helps}",
        *([noise] if stopped else []),
    ]


def _seconds(run: Callable[[], object]) -> float:
    """Return the median CPU seconds of REPEATED warm runs."""
    taken = []
    for _ in range(REPEATED + 1):
        began = time.process_time()
        run()
        taken.append(time.process_time() - began)
    return statistics.median(taken[1:])


def _ms(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def _us(seconds: float) -> str:
    return f"{seconds * 1e6:.2g} µs"


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
            reached = f"{enough.error:.2g} in {_ms(enough.seconds)}"
            parts.append(f"{name} {enough.calls} calls (it reaches {reached})")
        elif own:
            parts.append(f"{name} more than {max(p.calls for p in own)} calls")
    return SweepResult(
        scene=scene, points=points, line=f"for an error of {ENOUGH_OF_STEPPERS:g}: " + ", ".join(parts)
    )


def _require_possible(calls: NDArray[np.float64], seconds: NDArray[np.float64], most_calls: int) -> None:
    """Raise ValueError for calls and seconds that no run can have."""
    if not np.all((calls >= 1) & (calls <= most_calls) & (calls == np.trunc(calls))):
        raise ValueError(f"a number of calls is not a whole number from 1 to {most_calls}")
    if not np.all((seconds >= 0) & (seconds <= MOST_S)):
        raise ValueError(f"a time is not between 0 and {MOST_S:g} s")
