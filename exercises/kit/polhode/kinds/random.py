"""The kind "random": samples of a distribution and Monte Carlo estimates, by statistical tests of repeated
calls.

The tests of a question together reject a right solution at the rate that the question states, ``rate`` for
each test. They compare with exact values only, never with an error that the student's function returns.
"""

import random
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check, holds
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Judgement
from polhode.kinds.student_calls import arguments, call, describe, each, returned, stacked

Array = NDArray[np.float64]
Test = tuple[Array, float, str]
"""What each row's numbers are, their limit, and the text that shows the largest."""
AFRESH = "afresh"
NORMAL = 1000


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answers of repeated calls for each row, repetitions along the second index.

    A seed is another for each repetition. ``again`` is 1 where the first seed, passed again, gives the same
    answer. A question with AFRESH is that for the last repetition alone.
    """

    def once(row: Mapping[str, Any], repetition: int) -> dict[str, Any]:
        seeds = {name: [row[name], repetition] for name in question["generators"]}
        seeds |= {name: row[name] + repetition for name in question["seeds"]}
        answer = call(question, student, arguments(question, {**row, **seeds}))
        return returned(question, answer, alone=True)

    def answer(row: Mapping[str, Any]) -> dict[str, Any]:
        runs = [once(row, repetition) for repetition in range(question["repetitions"])]
        again = once(row, 0) if question["generators"] or question["seeds"] else runs[0]
        return stacked(runs) | {
            "again": float(all(np.array_equal(runs[0][name], again[name], equal_nan=True) for name in again))
        }

    def last(row: Mapping[str, Any]) -> dict[str, Any]:
        return once(row, question["repetitions"] - 1)

    with _global_generators():
        return each(rows, last if question.get(AFRESH) else answer)


@contextmanager
def _global_generators() -> Iterator[None]:
    """Seed the generators of numpy and Python for a while, so that grading again gives the same report."""
    before, states = random.getstate(), np.random.get_state()
    random.seed(0)
    np.random.seed(0)
    try:
        yield
    finally:
        random.setstate(before)
        np.random.set_state(states)


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return the checks of the samples or of the estimates, and the one that repeated calls differ."""
    id, label = question["id"], question["label"]
    seeds = [*question["generators"], *question["seeds"]]
    without_seeds = {**question, "drawn": [name for name in question["drawn"] if name not in seeds]}

    def locate(index: tuple[int, ...], seen: Arrays) -> str:
        return describe(without_seeds, seen, index[0])

    def check(name: str, about: str, test: Callable[..., Test]) -> Check:
        def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
            used, limit, text = test(question, seen[0], truth[0])
            judgement, worst = comparisons.below(used, limit), float(used.max())
            return replace(judgement, detail=text.format(worst), measured=worst, expected=0.0)

        tolerance = Tolerance(**question[name if name in ERRORS else "tolerance"])
        read = ("error" if name in ERRORS else "value",)
        full = f"{label}: {about}{suffix}"
        return Check(f"{id}-{name}", full, (scene,), word, tolerance, locate, arrays=read)

    tests = SAMPLES if question.get("distribution") else ESTIMATES
    found = [check(name, *test) for name, test in tests.items() if name not in ERRORS or question.get(name)]
    about = (
        "equal seeds give equal results, different seeds different ones"
        if seeds
        else "repeated calls give different results"
    )
    reason = "results are compared bit for bit"
    repeated = holds(f"{id}-repeated", f"{label}: {about}{suffix}", scene, claim=_repeats, reason=reason)
    return [*found, replace(repeated, arrays=("value", "again"))]


def _repeats(seen: Arrays) -> tuple[bool, str]:
    values = seen["value"]
    if not np.all(seen["again"] == 1):
        return False, "the same seed gave different results: draw all numbers from the argument"
    if any(np.all(row == row[0]) for row in values):
        return False, f"{values.shape[1]} calls gave the same result"
    return True, f"{values.shape[1]} calls"


def _distribution(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the largest difference of the cumulative distributions (Kolmogorov–Smirnov).

    By Massart's inequality it exceeds √(ln(2/rate)/2N) for N independent samples of any distribution at most
    at that rate.
    """
    import scipy.stats

    made = getattr(scipy.stats, question["distribution"])
    samples = seen["value"].reshape(len(seen["value"]), -1)
    most = []
    for k, row in enumerate(samples):
        exact = made(**{name: truth[name][k] for name in question["shape_parameters"]})
        at, counts = np.unique(row, return_counts=True)
        upper, want = np.cumsum(counts) / len(row), exact.cdf(at)
        below = want - exact.pmf(at) if hasattr(made, "pmf") else want
        most.append(max(np.abs(upper - want).max(), np.abs(upper - counts / len(row) - below).max()))
    limit = float(np.sqrt(np.log(2 / question["rate"]) / (2 * samples.shape[1])))
    return np.array(most), limit, f"max|ΔF| = {{:.3g}} with {samples.shape[1]} samples (limit {limit:.3g})"


def _independence(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the rank correlation of successive samples of a call, or of single samples of successive calls.

    It has the standard deviation 1/√N for N independent pairs, and is nearly normal if ``NORMAL`` pairs
    differ from the most frequent one; otherwise it is not judged.
    """
    import scipy.stats

    samples = seen["value"].reshape(*seen["value"].shape[:2], -1)
    samples = np.swapaxes(samples, 1, 2) if samples.shape[2] == 1 else samples
    ranks = scipy.stats.rankdata(samples.reshape(len(samples), -1), axis=1).reshape(samples.shape)
    first, second = (
        ranks[:, :, part].reshape(len(samples), -1) for part in (slice(None, -1), slice(1, None))
    )
    other = [1 - np.unique(row, return_counts=True)[1].max() / row.size for row in ranks]
    judged = [share**2 * first.shape[1] >= NORMAL for share in other]
    found = np.array(
        [np.corrcoef(a, b)[0, 1] if ok else 0.0 for a, b, ok in zip(first, second, judged, strict=True)]
    )
    limit = _deviations(question) / first.shape[1] ** 0.5
    return np.abs(found), limit, f"correlation {{:.3g}} of successive samples (limit {limit:.3g})"


def _mean(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the deviation of the mean in its exact standard deviation, beyond the systematic error that the
    author allows.
    """
    want, tolerance = truth["value"], question["tolerance"]
    allowed = tolerance.get("atol", 0.0) + tolerance.get("rtol", 0.0) * np.abs(want)
    away = np.maximum(np.abs(seen["value"].mean(axis=1) - want) - allowed, 0.0)
    unit, limit = truth["sd"] / seen["value"].shape[1] ** 0.5, _deviations(question)
    worst = int(np.argmax(away / unit))
    text = (
        f"mean {seen['value'][worst].mean():.6g} vs expected {want[worst]:.6g}, {{:.3g}} standard errors"
        f" (limit {limit:.3g})"
    )
    return away / unit, limit, text


def _spread(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the deviation of the estimates' standard deviation as a fraction of what the χ² distribution of
    its square allows.
    """
    import scipy.stats

    free = seen["value"].shape[1] - 1
    ratio = seen["value"].std(axis=1, ddof=1) / truth["sd"]
    quantiles = scipy.stats.chi2.ppf([question["rate"] / 2, 1 - question["rate"] / 2], free)
    low, high = np.sqrt(quantiles / free)
    used = np.where(ratio > 1, (ratio - 1) / (high - 1), (1 - ratio) / (1 - low))
    text = (
        f"{ratio[int(np.argmax(used))]:.4g} times the expected standard deviation ({low:.3g} to {high:.3g}"
        " accepted)"
    )
    return used, 1.0, text


def _error(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the relative deviation of the returned errors from the exact standard deviation of an
    estimate.
    """
    off = np.sqrt(np.mean((seen["error"] / truth["sd"][:, None] - 1) ** 2, axis=1))
    limit = question["error"]["limit"]
    return off, limit, f"off by {{:.3g}} of the exact standard deviation (limit {limit:g})"


def _mean_error(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Test:
    """Return the relative deviation of the mean of the returned errors from the exact standard deviation of
    an estimate.
    """
    ratio = seen["error"].mean(axis=1) / truth["sd"]
    limit = question["mean_error"]["limit"]
    text = (
        f"{ratio[int(np.argmax(np.abs(ratio - 1)))]:.4g} times the exact standard deviation (off by at most"
        f" {limit:g} accepted)"
    )
    return np.abs(ratio - 1), limit, text


SAMPLES: Mapping[str, Any] = {
    "distribution": ("samples follow the exact distribution", _distribution),
    "independence": ("successive samples are independent", _independence),
}
ESTIMATES: Mapping[str, Any] = {
    "mean": ("the estimates are right on average", _mean),
    "spread": ("the estimates spread as expected", _spread),
    "error": ("the returned error is right", _error),
    "mean_error": ("the returned error is right on average", _mean_error),
}
ERRORS = ("error", "mean_error")
"""The tests with a tolerance of their own, which the author may leave out."""


def _deviations(question: Mapping[str, Any]) -> float:
    """Return the standard deviations that a normal number exceeds at the rate of one test."""
    import scipy.stats

    return float(scipy.stats.norm.isf(question["rate"] / 2))
