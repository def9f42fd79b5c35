"""Motions that a right-hand side drives from given starts, with the attitude of a body if asked for, and
their checks.

A fixed motion is integrated and printed as a notebook prints it. A hidden one is not: the values of the
function at points along the exact motion bound its error. A check of a fixed motion against the exact one
needs both. The functions that checks measure with are those of the author's module that students get too.
"""

import functools
import inspect
import math
from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check
from polhode.judging.cpu_time import seconds_of_a_call, timed_runs
from polhode.judging.exercise import Figure, Motion
from polhode.judging.integration import Array, Evaluate, IntegrationStopped, Rates, integrate
from polhode.judging.outcome import Tolerance
from polhode.judging.return_value import WrongAnswer, real_array
from polhode.judging.verdict import Judgement, Verdict

# the notebook's settings
RTOL, ATOL, MOST_CALLS = 1e-11, 1e-13, 40_000
# ten thousand motions of right equations use less than a tenth of the resulting limit
SAFETY = 10.0
UNBOUNDED = 30.0  # times the size of the start: what only a motion that gains energy reaches
FLOAT = np.dtype(float)
INDEX = "₁₂₃₄₅₆₇₈₉"
PRODUCT = "rtol × (sensitivity + angle turned) × safety, computed for each motion"


def play(question: Mapping[str, Any], student: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the motion from the start in ``given`` at ``samples`` times up to ``until``: the state (d, n),
    and with ``attitude`` R (n, 3, 3). Part "sweep": see ``sweep``.
    """
    if question["part"] == "sweep":
        return sweep(question, student, given)
    state, name = question["state"], question["function"]
    times = np.linspace(0.0, float(given["until"]), int(given["samples"]))
    start, rates, calls = driven(question, student[name], given)
    size = np.size(given[state])
    try:
        y = integrate(rates, start, times, RTOL, ATOL)
    except (WrongAnswer, IntegrationStopped) as error:
        if math.hypot(*calls[1]) > UNBOUNDED * math.hypot(*start[:size]):
            raise WrongAnswer(
                "unbounded", f"{_letter(state)} grows without bound (energy is not conserved)"
            ) from None
        if isinstance(error, WrongAnswer):
            raise
        raise WrongAnswer(None, f"the integration stopped at t = {error.last:.3g}: {error}") from None
    return {state: y[:size]} | ({"R": y[size:].T.reshape(-1, 3, 3)} if given["attitude"] else {})


def driven(
    question: Mapping[str, Any], function: Any, given: Mapping[str, Any], most: int = MOST_CALLS
) -> tuple[Array, Rates, list[Any]]:
    """Return start and right-hand side of the motion that ``function`` drives, and a list of the number of
    its calls, ``most`` at most, and the last state.

    With ``attitude`` the state is the angular velocity along body axes, and the attitude follows from
    dR/dt = R [ω]×.
    """
    name, state = question["function"], question["state"]
    order = [p if p in (state, question["time"]) else np.asarray(given[p]) for p in question["parameters"]]
    start = np.asarray(given[state], dtype=float)
    shape = start.shape
    calls: list[Any] = [0, start.ravel()]

    def rates(y: Array, out: Array) -> Evaluate:
        size = start.size
        flat, out_flat, turn = y[:size], out[:size], np.zeros((3, 3))
        R, R_rate, turned = y[size:].reshape(-1, 3), out[size:].reshape(-1, 3), turn.ravel()

        def evaluate(t: float) -> None:
            calls[0] += 1
            calls[1] = now = flat.copy()
            if calls[0] > most:
                raise WrongAnswer(
                    None, f"the integration stalled at t = {t:.3g} after {most} calls of {name}"
                )
            whole = now.reshape(shape)
            answer = function(*[(whole if p == state else t) if type(p) is str else p.copy() for p in order])
            if not (type(answer) is np.ndarray and answer.dtype is FLOAT and answer.shape == shape):
                answer = real_array(answer, shape, name)
            found = answer.ravel().tolist()
            if not all(map(isfinite, found)):
                raise WrongAnswer("not-finite", f"{name} returned {found} at t = {t:.3g}: not finite")
            out_flat[:] = found
            if len(R):
                w1, w2, w3 = flat.tolist()
                turned[1], turned[2], turned[3], turned[5], turned[6], turned[7] = -w3, w2, w3, -w1, -w2, w1
                R.dot(turn, R_rate)

        return evaluate

    whole = np.concatenate([start.ravel(), np.eye(3).ravel()]) if given["attitude"] else start.ravel()
    return whole, rates, calls


def sweep(
    question: Mapping[str, Any], student: Mapping[str, Any], given: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the motion by several solvers and tolerances, with the calls and CPU seconds of each, and the
    seconds of one call.
    """
    name, state, most = question["function"], question["state"], int(given["most_calls"])
    arguments = [0.0 if p == question["time"] else np.array(given[p]) for p in question["parameters"]]
    per_call = seconds_of_a_call(lambda: student[name](*arguments))
    times, size = np.linspace(0.0, float(given["until"]), int(given["samples"])), np.size(given[state])
    runs = timed_runs(
        lambda: driven(question, student[name], given, most), times, question["settings"], 1.0, most
    )
    return {
        state: np.array([run.states[:size] for run in runs]),
        "calls": np.array([run.calls for run in runs], float),
        "seconds": np.array([run.seconds for run in runs]),
        "per_call": np.array(per_call),
    }


def as_closely(truth: Arrays) -> Tolerance:
    """Return the tolerance of a motion: the integrator's tolerance for every radian, magnified by the
    motion's sensitivity.
    """
    kappa, angle = float(truth["kappa"]), float(truth["angle"])
    reason = f"rtol {RTOL:g} × (sensitivity {kappa:.4g} + {angle:.4g} rad turned) × safety {SAFETY:g}"
    return Tolerance(limit=float(f"{RTOL * (kappa + angle) * SAFETY:.2e}"), reason=reason)


@functools.lru_cache(maxsize=8)
def shown(source: str) -> dict[str, Any]:
    """Return the names of the author's module that checks measure and figures draw with."""
    names: dict[str, Any] = {"__name__": "shown"}
    exec(compile(source, "shown.py", "exec"), names)
    return names


def checks(question: Mapping[str, Any], along: bool) -> list[Check]:
    """Return the checks of fixed motions; those against the exact motion also need the points ``along`` it,
    if these are asked.
    """
    return [_check(question, check, along) for check in question["checks"] if check["word"] != "bounded"]


def hidden_checks(question: Mapping[str, Any]) -> list[Check]:
    """Return the checks of motions that are not integrated."""
    return [_bounded(question, check) for check in question["checks"] if check["word"] == "bounded"]


def figures(question: Mapping[str, Any]) -> list[Figure]:
    """Return the author's figures."""
    return [
        Figure(
            f["name"],
            f["title"],
            f["alt"],
            tuple(f["scenes"]) or (question["scenes"]["public"],),
            shown(question["shown"])[f["draw"]],
        )
        for f in question.get("figures", ())
    ]


def players(question: Mapping[str, Any]) -> list[Motion]:
    """Return the motions to play."""
    return [Motion(**{**one, "half": tuple(one["half"])}) for one in question.get("players", ())]


def _check(question: Mapping[str, Any], check: Mapping[str, Any], along: bool) -> Check:
    scenes, tolerance = tuple(check["of"]), Tolerance(**check["tolerance"])
    id, label = f"{question['number']}-{check['name']}", check["label"]
    if check["word"] == "follows":
        return _follows(question, check, id, along)

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        found = _measured(question, check, seen, truth)
        match check["word"]:
            case "conserved":
                return comparisons.conserved(found, tolerance.limit or 0.0)
            case "below":
                return comparisons.below(found, tolerance.limit or 0.0)
            case "holds":
                return comparisons.holds(*found)
        exact = truth[0][f"exact {check['name']}"]
        return comparisons.close(found, exact, tolerance.rtol or 0.0, tolerance.atol or 0.0)

    def place(index: tuple[int, ...], *seen: Arrays) -> str:
        if len(scenes) > 1:
            return scenes[index[0]]
        return f"t = {seen[0]['t'][index[0]]:z.4g} s" if len(index) == 1 else ""

    is_series = check["word"] in ("conserved", "close")
    return Check(id, label, scenes, word, tolerance, place if is_series else None)


def _measured(
    question: Mapping[str, Any], check: Mapping[str, Any], seen: list[Arrays], truth: list[Arrays]
) -> Any:
    """Return what a check measures: the author's function, called with the motion's times, state, R and
    parameters by their names, and with the exact ones as ``exact_NAME``. Of several motions they are lists.
    """
    each = []
    for name, run, exact in zip(check["of"], seen, truth, strict=True):
        given = {p: np.array(value) for p, value in question["motions"][name]["start"].items()}
        arrays = [key for key in (question["state"], "R") if key in exact]
        given |= {key: run[key] for key in arrays} | {f"exact_{key}": exact[key] for key in arrays}
        each.append(given | {question["time"]: exact["t"]})
    values = each[0] if len(each) == 1 else {key: [one[key] for one in each] for key in each[0]}
    measure = shown(question["shown"])[check["measured"]]
    return measure(**{name: values[name] for name in inspect.signature(measure).parameters})


def _follows(question: Mapping[str, Any], check: Mapping[str, Any], id: str, along: bool) -> Check:
    (motion,), array = check["of"], check["array"]

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        scale = 1.0 if array == "R" else np.linalg.norm(truth[0][array][:, 0])
        found = comparisons.within(seen[0][array], truth[0][array], scale, as_closely(truth[0]).limit or 0.0)
        if not along or found.verdict is not Verdict.PASS:
            return found
        bound = _bound(question, motion, seen[1], truth[1])
        return bound if bound.verdict is not Verdict.PASS else found

    def place(index: tuple[int, ...], seen: Arrays, *points: Arrays) -> str:
        if array == "R":
            return f"R{index[1] + 1}{index[2] + 1}, t = {seen['t'][index[0]]:z.4g} s"
        return f"{_letter(array)}{INDEX[index[0]]}, t = {seen['t'][index[1]]:z.4g} s"

    return Check(
        id,
        check["label"],
        (motion, question["points_scene"]) if along else (motion,),
        word,
        Tolerance(reason=PRODUCT if array == "R" else f"of |{_letter(array)}(0)|: {PRODUCT}"),
        place,
        allow=lambda truth, *points: as_closely(truth),
        arrays=(question["state"], "R"),
    )


def _letter(state: str) -> str:
    return "ω" if state == "w" else state


def _bounded(question: Mapping[str, Any], check: Mapping[str, Any]) -> Check:
    """Check that a hidden motion follows the exact one as closely as any integrator must."""
    (motion,) = check["of"]
    return Check(
        f"{question['number']}-{check['name']}",
        check["label"],
        (question["points_scene"],),
        lambda seen, truth: _bound(question, motion, seen[0], truth[0]),
        Tolerance(reason=f"of |{_letter(question['state'])}(0)|: {PRODUCT}"),
        allow=lambda truth: as_closely(_of(truth, motion)),
        arrays=(),
    )


def _bound(question: Mapping[str, Any], motion: str, seen: Arrays, truth: Arrays) -> Judgement:
    """Judge the error of a motion by that of the values at points along the exact one.

    To first order, the motion of rates that are off by at most δ at these points is off by δ times the
    ``duration``, a time that its sensitivity has, and its attitude by that times the angle turned in
    addition.
    """
    known, (value,) = _of(truth, motion), (value["name"] for value in question["returns"])
    rows = known["rows"]
    with np.errstate(all="ignore"):  # numbers may be too large for arithmetic: their bound is infinite
        off = np.linalg.norm(seen[value][rows] - truth[value][rows], axis=1).max() / known["speed"]
        bound = float(off * known["duration"] * known["turned"])
    limit = float(as_closely(known).limit or 0.0)
    how = f"{question['function']} at {len(rows)} points along the exact motion"
    found = comparisons.within(bound, 0.0, 1.0, limit)
    return replace(found, detail=f"max|Δ|/scale ≤ {bound:.6g} (limit {limit:g}), by {how}", where=None)


def _of(truth: Arrays, motion: str) -> Arrays:
    """Return what the exact arrays of the points say of a motion."""
    begin = f"{motion}: "
    return {name.removeprefix(begin): value for name, value in truth.items() if name.startswith(begin)}
