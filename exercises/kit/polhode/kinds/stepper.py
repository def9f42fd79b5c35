"""The kind "stepper": one step of a method at points, as in "values", its order of convergence and its
stability limit.

Part "order": each row's interval of FIRST steps, done with 1, 2, 4, … times as many. Part "stability": the
largest step for which the test problem does not grow. Part "sweep": one motion by several methods in
CHARTED numbers of steps, with calls and seconds.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check, close
from polhode.judging.cpu_time import thread_time
from polhode.judging.exercise import Figure
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Judgement
from polhode.kinds.student_calls import Counted, arguments, call, flat, part_figure, restart, returned, split
from polhode.kinds.values import checks, play  # noqa: F401
from polhode.report.figure_parts import legend_above

Array = NDArray[np.float64]
FIRST, HALVINGS = 4, 6
ROUNDING, CONVERGING = (
    1e-13,
    0.1,
)  # relative errors below are those of rounding and of the truth; above, of an unstable run
SMALLEST, LARGEST, FACTOR = 0.05, 1000.0, 1.1  # the steps between which the stability limit is searched
GROWTH = 1e-6  # of one step: a smaller one is rounding
CHARTED = tuple(50 * 2**k for k in range(7))  # the numbers of steps of a chart of speed against accuracy


def _step(question: Mapping[str, Any], student: Mapping[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments after one step."""
    restart(given)
    return _after(question, given, call(question, student, given))


def _after(question: Mapping[str, Any], given: dict[str, Any], step: Any) -> dict[str, Any]:
    """Return the arguments with the state that a ``step`` of the student returned."""
    answer = returned(question, step)
    return given | {
        name: answer[value] if answer[value].ndim else float(answer[value])
        for value, name in question["state"].items()
    }


def _ends(question: Mapping[str, Any], student: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the states ``ends`` (runs, FIRST, d) at the ends of the first steps."""
    time, step, runs = question["time"], question["step"], []
    for doubled in range(HALVINGS + 1):
        given, states = arguments(question, row), []
        start, h = given.get(time, 0.0), given[step] / 2**doubled
        for k in range(FIRST * 2**doubled):
            given |= {step: h} | ({time: start + k * h} if time in given else {})
            given = _step(question, student, given)
            states.append(flat(question["state"].values(), given))
        runs.append(states[2**doubled - 1 :: 2**doubled])
    return {"ends": np.array(runs)}


def _limit(question: Mapping[str, Any], student: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the step at which the test problem, whose eigenvalues have size 1, begins to grow; LARGEST if it
    never does.
    """
    families = {
        name: {**family, "text": question["test"], "given": []}
        for name, family in question["families"].items()
    }
    given, states = arguments({**question, "families": families}, row), list(question["state"].values())
    starts = [split(states, given, unit) for unit in np.eye(flat(states, given).size)]

    def grows(h: float) -> bool:
        try:
            columns = [
                flat(states, _step(question, student, given | start | {question["step"]: h}))
                for start in starts
            ]
        except Exception:  # a method that cannot do this step, unless it can do none
            if h == SMALLEST:
                raise
            return True
        return bool(np.abs(np.linalg.eigvals(np.array(columns))).max() > 1 + GROWTH)

    stable, step = 0.0, SMALLEST
    while not grows(step):
        if step >= LARGEST:
            return {"limit": np.array(LARGEST)}
        stable, step = step, step * FACTOR
    for _ in range(30):
        middle = (stable + step) / 2
        stable, step = (stable, middle) if grows(middle) else (middle, step)
    return {"limit": np.array(stable)}


def _sweep(question: Mapping[str, Any], student: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the state at the ``end`` of each run of each of the question's ``methods``, the calls, and the
    seconds.

    ``end_0`` (runs, d) is that of the first method; ``calls`` and ``seconds`` (methods, runs) are those of
    all. A run that fails ends in NaN.
    """
    methods = question["methods"]
    runs = [[_timed_run(method, student, steps) for steps in CHARTED] for method in methods]
    ends = {f"end_{k}": np.array([end for end, _, _ in each]) for k, each in enumerate(runs)}
    return ends | {
        name: np.array([[run[k] for run in each] for each in runs])
        for k, name in ((1, "calls"), (2, "seconds"))
    }


def _timed_run(
    method: Mapping[str, Any], student: Mapping[str, Any], steps: int
) -> tuple[Array, float, float]:
    """Return the last state (d,) of a run to ``chart``, the calls of the function argument, and the CPU
    seconds in the student's function.
    """
    given, names, calls, seconds = arguments(method, {}), list(method["state"].values()), 0, 0.0
    start, h, end = (
        given.get(method["time"], 0.0),
        method["chart"] / steps,
        np.full(flat(names, given).size, np.nan),
    )
    counted = next(value for value in given.values() if isinstance(value, Counted))
    with suppress(Exception):  # a run that fails is not drawn; others may be
        for k in range(steps):
            given |= {method["step"]: h} | (
                {method["time"]: start + k * h} if method["time"] in given else {}
            )
            restart(given)
            values, began = list(given.values()), thread_time()
            answer = student[method["function"]](*values)
            seconds += thread_time() - began
            calls += counted.calls
            given = _after(method, given, answer)
        end = flat(names, given)
    return end, float(calls), seconds


def errors(ends: Array, exact: Array) -> Array:
    """Return the error of each run (runs,), relative to the size of the state: the root of the mean square
    over rows and times.
    """
    scale = np.abs(exact).max(axis=1, keepdims=True)
    scale = np.maximum(scale, 1e-6 * scale.max(axis=2, keepdims=True))[:, None]
    off: Array = np.sqrt(
        np.mean(((ends - exact[:, None]) / np.where(scale > 0, scale, 1.0)) ** 2, axis=(0, 2, 3))
    )
    return off


def observed_order(found: Array) -> float | None:
    """Return the median slope between all pairs of runs with errors from ROUNDING to CONVERGING.

    With fewer than three such runs, the three finest above ROUNDING count. Return None if there are not
    three.
    """
    above = [(k, np.log2(error)) for k, error in enumerate(found) if error > ROUNDING]
    used = [(k, error) for k, error in above if error < np.log2(CONVERGING)]
    used = used if len(used) >= 3 else above[-3:]
    slopes = [(a - b) / (m - k) for k, a in used for m, b in used if m > k]
    return float(np.median(slopes)) if len(used) >= 3 else None


PARTS = {"order": _ends, "stability": _limit, "sweep": _sweep}


def part_checks(question: Mapping[str, Any], scene: str) -> list[Check]:
    """Return the check of the order, or that of the stability limit."""
    part, function = question["part"], question["function"]
    wanted, allowed = question[part]
    tolerance, id = Tolerance(**allowed), f"{question['id']}-{part}"
    if part == "stability":
        label = f"the stability limit of {function} is {f'{wanted:g}' if wanted < LARGEST else 'infinite'}"
        given = {"rtol": 0.0, "atol": 0.0} | allowed
        return [close(id, label, scene, measured=lambda seen: seen["limit"][0], expected=wanted, **given)]

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        with np.errstate(all="ignore"):
            found = observed_order(errors(seen[0]["ends"], truth[0]["ends"]))
        if found is None:
            return comparisons.holds(True, f"the errors are below {ROUNDING:g} of the state")
        if not np.isfinite(found):
            raise ArithmeticError("the errors overflow")
        least = wanted - tolerance.atol
        judgement = comparisons.holds(found >= least, f"got {found:.6g} (at least {least:g})")
        return replace(judgement, measured=found, expected=float(wanted))

    return [Check(id, f"{function} converges with order {wanted:g}", (scene,), word, tolerance)]


def figures(question: Mapping[str, Any]) -> list[Figure]:
    """Return the figure of error against step, with the slope of the order."""

    def draw(canvas: Any, seen: list[Arrays], truth: list[Arrays]) -> None:
        found, p = errors(seen[0]["ends"], truth[0]["ends"]), question["order"][0]
        h, axes = 0.5 ** np.arange(len(found)), canvas.subplots()
        axes.loglog(h, np.maximum(found, 1e-17), "o-", label=question["function"])
        axes.loglog(h, found[0] * h**p, "k:", label=f"order {p:g}")
        axes.set(xlabel=f"{question['step']} / that of the question", ylabel="error / size of the state")
        legend_above(axes)

    function = question["function"]
    alt = f"The error of {function} against the step, both logarithmic, with the slope of its order dotted."
    return part_figure(question, "order", f"The convergence of {function}", alt, draw)
