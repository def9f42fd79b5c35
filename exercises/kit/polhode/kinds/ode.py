"""The kind "ode": a right-hand side at points, as in "values", and the motion that it drives.

Part "motion": the motion from each row's state at t = 0, the quantities that it conserves, and a figure. Part
"sweep": one motion by several solvers and tolerances, with calls and seconds.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check
from polhode.judging.cpu_time import seconds_of_a_call, timed_runs
from polhode.judging.exercise import Figure
from polhode.judging.integration import Array, Evaluate, IntegrationStopped, Rates, integrate
from polhode.judging.outcome import Tolerance
from polhode.judging.return_value import WrongAnswer
from polhode.judging.verdict import Judgement
from polhode.kinds.student_calls import (
    arguments,
    describe,
    each_row,
    expression,
    flat,
    part_figure,
    restart,
    returned,
    split,
    stacked,
)
from polhode.kinds.values import checks, play  # noqa: F401
from polhode.report.figure_parts import legend_above

RTOL, TIMES = 1e-11, 201


def times(question: Mapping[str, Any]) -> NDArray[np.float64]:
    """Return the times of the motion (TIMES,)."""
    return np.linspace(0.0, question["t_end"], TIMES)


def _motion(
    question: Mapping[str, Any], student: Mapping[str, Any], row: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the ``motion`` (d, TIMES) of a row."""
    start, rates, atol = _driven(question, student, row, RTOL, [0])
    try:
        return {"motion": integrate(rates, start, times(question), RTOL, atol)}
    except IntegrationStopped as stopped:
        raise WrongAnswer(None, f"the integration stopped at t = {stopped.last:.3g}: {stopped}") from None


def _sweep(question: Mapping[str, Any], student: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row's motion with each of the settings, the calls and CPU seconds it took, and the seconds of
    one call.
    """
    given = arguments(question, row)
    per_call = seconds_of_a_call(lambda: student[question["function"]](*given.values()))

    def begin() -> tuple[Array, Rates, list[int]]:
        calls = [0]
        return *_driven(question, student, row, RTOL, calls)[:2], calls

    settings, most = question["settings"], question["most_calls"]
    runs = timed_runs(begin, times(question), settings, question["scale"], most)
    found = [{"motion": run.states, "calls": float(run.calls), "seconds": run.seconds} for run in runs]
    return stacked(found) | {"per_call": np.array(per_call)}


def _driven(
    question: Mapping[str, Any],
    student: Mapping[str, Any],
    row: Mapping[str, Any],
    rtol: float,
    calls: list[int],
) -> tuple[Array, Rates, Array]:
    """Return start, right-hand side and atol of a row's motion; ``calls`` counts the calls of the student's
    function.
    """
    given, name, most = arguments(question, row), question["function"], question["most_calls"]
    state, (value,) = [question["state"]], (value["name"] for value in question["returns"])

    def rates(y: Array, out: Array) -> Evaluate:
        def evaluate(t: float) -> None:
            calls[0] += 1
            if calls[0] > most:
                raise WrongAnswer(
                    None, f"the integration stalled at t = {t:.3g} after {most} calls of {name}"
                )
            restart(given)
            asked = {**given, question["time"]: float(t), **split(state, given, y)}
            try:
                answer = student[name](*(asked[parameter] for parameter in question["parameters"]))
                out[:] = returned(question, answer)[value].ravel()
            except WrongAnswer as error:
                raise WrongAnswer(error.code, f"{error} (at t = {t:.3g} of the integration)") from None

        return evaluate

    return flat(state, given), rates, 1e-2 * rtol * np.asarray(question["scale"])


def deviation(question: Mapping[str, Any], got: Any, want: Any) -> tuple[Any, Any, Any]:
    """Return the components (…, k, n) of a motion that the exact one has, the exact ones, and the scale of
    each.

    The scale is the largest exact value of the component, at least a thousandth of the state's typical size.
    """
    least = 1e-3 * np.broadcast_to(question["scale"], got.shape[-2])[: want.shape[-2], None]
    scale = np.maximum(np.abs(want).max(axis=-1, keepdims=True), least)
    return got[..., : want.shape[-2], :], want, np.broadcast_to(scale, want.shape)


PARTS = {"motion": _motion, "sweep": _sweep}


def part_checks(question: Mapping[str, Any], scene: str) -> list[Check]:
    """Return the checks of the motion: the exact one, and each conserved quantity."""
    tolerance, name, id = Tolerance(**question["follow"]), question["function"], question["id"]

    def follows(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        return comparisons.within(
            *deviation(question, seen[0]["motion"], truth[0]["motion"]), tolerance.limit or 0.0
        )

    def place(index: tuple[int, ...], seen: Arrays) -> str:
        return f"t = {times(question)[index[-1]]:z.4g}, {_at_start(question, seen, index[0])}"

    made = [Check(f"{id}-motion", f"{name} drives the right motion", (scene,), follows, tolerance, place)]
    for quantity, (text, allowed) in question["conserved"].items():
        label, word = (
            f"{quantity} conserved along the motion of {name}",
            partial(_drift, question, text, allowed["limit"]),
        )
        made.append(Check(f"{id}-{quantity}", label, (scene,), word, Tolerance(**allowed), place))
    return made


def _drift(
    question: Mapping[str, Any], text: str, limit: float, seen: list[Arrays], truth: list[Arrays]
) -> Judgement:
    """Judge an expression over state, time and parameters along the motions; the worst row counts."""
    every, state = [], question["state"]
    for row, motion in zip(
        each_row({name: seen[0][f"at_{name}"] for name in question["drawn"]}), seen[0]["motion"], strict=True
    ):
        given = {**question["constants"], **row}
        value = expression(text, (question["time"], state), given)
        with np.errstate(all="ignore"):
            series = [
                float(value(t, split([state], given, y)[state]))
                for t, y in zip(times(question), motion.T, strict=True)
            ]
        every.append(comparisons.conserved(series, limit))
    worst = max(range(len(every)), key=lambda k: every[k].measured or 0.0)
    return replace(every[worst], where=(worst, *(every[worst].where or (0,))))


def _at_start(question: Mapping[str, Any], seen: Arrays, row: int) -> str:
    return describe(
        {**question, "drawn": [name for name in question["drawn"] if name != question["time"]]}, seen, row
    )


def figures(question: Mapping[str, Any]) -> list[Figure]:
    """Return the figure of the first motion beside the exact one."""

    def draw(canvas: Any, seen: list[Arrays], truth: list[Arrays]) -> None:
        axes, t = canvas.subplots(), times(question)
        for k, curve in enumerate(seen[0]["motion"][0]):
            axes.plot(t, curve, color=f"C{k}", label=f"{question['state']}[{k}]")
        axes.plot(
            t,
            truth[0]["motion"][0].T,
            "k:",
            lw=1.2,
            label=["exact", *[None] * (truth[0]["motion"].shape[1] - 1)],
        )
        axes.set(xlabel=question["time"], ylabel=question["state"], title=_at_start(question, seen[0], 0))
        legend_above(axes)

    function = question["function"]
    alt = f"The components of the motion that {function} drives against time, with the exact ones dotted."
    return part_figure(question, "motion", f"The motion of {function}", alt, draw)
