"""The kind "values": the values of a function at points, to a tolerance, and the number of calls of its
function arguments.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check, Locate, below
from polhode.judging.outcome import Diagnosis, Tolerance
from polhode.judging.return_value import Kept
from polhode.judging.verdict import Judgement, RowsRight, Verdict
from polhode.kinds.equivalent_values import aligned
from polhode.kinds.student_calls import Counted, NotFinite, arguments, call, describe, each, returned


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of each row by name, and ``calls``,
    the most calls of one of its function arguments.
    """

    kept, asked = Kept(question["function"]), list[bool]()

    def answer(row: Mapping[str, Any]) -> dict[str, Any]:
        given = arguments(question, row)
        kept.replace(whole := call(question, student, given, first=not asked))
        asked.append(True)
        try:
            found = returned(question, whole, alone=True)
        except NotFinite as error:  # at one of many points: the check says so, and motions are integrated
            if "points_scene" not in question:
                raise
            found = {question["returns"][0]["name"]: error.numbers}
        calls = [value.calls for value in given.values() if isinstance(value, Counted)]
        return found | ({"calls": float(max(calls))} if calls else {})

    return each(rows, answer)


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return one check for each returned value, and one for the calls if they are limited."""
    made = [value_check(question, value, scene, suffix) for value in question["returns"]]
    if limit := question.get("calls"):
        name = next(iter(question["families"]))
        times = "once" if limit["limit"] == 1 else f"{limit['limit']} times"
        label = f"{question['function']} calls {name} at most {times}{suffix}"
        calls = below(f"{question['id']}-calls", label, scene, measured=lambda seen: seen["calls"], **limit)
        made.append(replace(calls, arrays=("calls",)))
    return made


def value_check(
    question: Mapping[str, Any],
    value: Mapping[str, Any],
    scene: str,
    suffix: str,
    *,
    scale: Callable[[Arrays], Any] | None = None,
    locate: Locate | None = None,
) -> Check:
    """Return the check that one returned ``value`` equals the exact one, up to what the value leaves open.

    A ``limit`` is relative to ``scale(truth)``, or see ``agreement``.
    """

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        got, want, unit = seen[0][name], truth[0][name], scale(truth[0]) if scale else None
        return credited(value, lambda given: agreement(value, given, want, unit), got, want)

    def describe_row(index: tuple[int, ...], seen: Arrays) -> str:
        at = value["components"][index[1]] if value.get("components") and len(index) > 1 else ""
        place = ", ".join(filter(None, (at, describe(question, seen, index[0]))))
        got = seen[name][index]
        return f"{place}: got {got:.4g}" if np.ndim(got) == 0 else place

    name, own = value["name"], value.get("check")
    if value.get("scaled"):
        scale = _own_scale(name)
    return Check(
        f"{question['number']}-{own}" if own else f"{question['id']}-{name}",
        value["label"] + suffix,
        (scene,),
        word,
        Tolerance(**value["tolerance"]),
        locate or describe_row,
        arrays=(name,),
    )


def _own_scale(name: str) -> Callable[[Arrays], Any]:
    """Return the function of the truth that is the author's scale of a value."""
    return lambda truth: truth[f"{name}_scale"]


def credited(
    value: Mapping[str, Any], compared: Callable[[Any], Judgement], got: Any, want: Any
) -> Judgement:
    """Return ``compared(got)``; for a ✗ of a value with partial credit, each row is also judged with the
    others exact.
    """
    whole = compared(got)
    if not value.get("partial") or whole.verdict is not Verdict.FAIL or whole.misshapen:
        return whole
    right = 0
    for k in range(len(want)):
        alone = want.copy()
        alone[k] = got[k]
        right += compared(alone).verdict is Verdict.PASS
    return replace(whole, partial=RowsRight(right, len(want)))


def compared(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return the causes that follow from comparing an answer with the exact one: zeros, and opposite signs of
    all or of some numbers. The server reports more.
    """
    name, (value, *others) = question["function"], question["returns"]
    got, want = np.asarray(seen[value["name"]]), np.asarray(truth[value["name"]])
    if others or not value.get("scaled") or got.ndim != 2 or got.shape != want.shape:
        return []
    scale = truth[f"{value['name']}_scale"]

    def same(one: Any, other: Any, unit: Any) -> bool:
        return agreement(value, one, other, unit).verdict is Verdict.PASS

    if not np.all(np.isfinite(got)) or same(got, want, scale):
        return []
    if not got.any():
        return [Diagnosis("returns-zero", f"{name} is zero for every input", 1.0)]
    if same(got, -want, scale):
        return [Diagnosis("sign-reversed", f"{name} has the opposite sign", 1.0)]
    labels = value.get("components") or [f"component {k + 1}" for k in range(got.shape[1])]
    return [
        Diagnosis("sign-flipped", f"{label} of {name} has the opposite sign", 1.0, component=k)
        for k, label in enumerate(labels)
        if not same(got[:, k], want[:, k], scale[:, k]) and same(got[:, k], -want[:, k], scale[:, k])
    ]


def own_scale(value: Mapping[str, Any], want: Any, truth: Arrays) -> Any:
    """Return the scale of a value that has its own, for numbers ``want`` that need not be the exact ones:
    rounding errors are those of the larger numbers. None if it has none.
    """
    scale = truth.get(f"{value['name']}_scale")
    if scale is None or np.shape(scale) != np.shape(want):
        return None
    with np.errstate(invalid="ignore"):
        sizes = np.abs(np.nan_to_num(want)).reshape(len(want), -1).max(axis=1)
    return np.maximum(scale, sizes.reshape(-1, *[1] * (np.ndim(want) - 1)))


def finite_alike(got: Any, want: Any) -> tuple[Any, Any]:
    """Return both arrays with zeros where neither is finite: there a wrong formula predicts the answer."""
    if np.shape(got) != np.shape(want) or np.all(np.isfinite(want)):
        return got, want
    neither = ~np.isfinite(got) & ~np.isfinite(want)
    return np.where(neither, 0.0, got), np.where(neither, 0.0, want)


def to_rounding(value: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a ``value`` as it is compared with the prediction of a mistake: a statistic of random numbers is
    recognised only where the same numbers were drawn, so to rounding; any other to its tolerance.
    """
    tolerance = {"rtol": 1e-9, "atol": 1e-12, "reason": "the same random numbers"}
    return {**value, "tolerance": tolerance} if value.get("statistic") else value


def agreement(value: Mapping[str, Any], got: Any, want: Any, scale: Any = None) -> Judgement:
    """Judge a returned ``value`` against the exact one, rows along the first index, up to what it leaves
    open.

    ``limit`` is relative to ``scale``, or to the largest exact number of all rows, or 1 if all are zero:
    where terms cancel in one row, rounding errors are those of the terms. ``rtol`` and ``atol`` hold for each
    number alone.
    """
    tolerance, got = Tolerance(**value["tolerance"]), aligned(got, want, value.get("up_to"))
    if tolerance.limit is None:
        return comparisons.close(got, want, tolerance.rtol or 0.0, tolerance.atol or 0.0)
    return comparisons.within(
        got, want, np.abs(want).max() or 1.0 if scale is None else scale, tolerance.limit
    )
