"""What accuracy costs: CPU time and error of every method at every setting on a scene, of the closed form,
and of the same DOP853 in SciPy.

An error is the maximum over the time grid against the exact solution, because the error at one final time may
be small by chance. All runs of a scene are timed in turn, several rounds; a time is the median of its rounds,
so that the load of a shared machine falls on all alike.
"""

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from reference.charts.deviations import errors, exact_run
from reference.charts.failures import EPSILON, Claim
from reference.methods import HEAVY, METHODS
from reference.methods.method import Scene
from reference.methods.runge_kutta import in_scipy
from reference.stability import sensitivity

SAMPLES = (41, 2000)
CLOSED, SCIPY = "closed form", "DOP853 in SciPy"
RTOL = 1e-9  # of the comparison with SciPy
ENOUGH = 1e-8
ROUNDS = 9
SHORTEST_S = 1e-3  # a run shorter than this is timed several at a time


class Point(NamedTuple):
    """One method at one setting: the larger error of ω and R (infinite: it diverges), calls, and CPU seconds.

    A setting is steps per interval, rtol, or for the closed form the number of samples.
    """

    method: str
    setting: float
    error: float
    calls: int
    seconds: float


def measure(scene: Scene, rounds: int = ROUNDS) -> list[Point]:
    """Return the points of a scene: every method's, CLOSED at SAMPLES, and SCIPY at RTOL."""
    methods = HEAVY if scene.mgl else METHODS
    runs = {(m.name, s): partial(m.run, scene, s) for m in methods for s in m.settings}
    runs[SCIPY, RTOL] = partial(in_scipy, scene, RTOL)
    closed = {(CLOSED, n): partial(exact_run, replace(scene, intervals=n - 1)) for n in SAMPLES}
    exact, found = exact_run(scene), [Point(*job, 0.0, 1, 0.0) for job in closed]
    with np.errstate(all="ignore"):
        for job, run in runs.items():  # the first run compiles what is not compiled yet
            made = run()
            off = errors(scene, made, exact)
            found.append(Point(*job, max(off.w, off.R), made.calls, 0.0))
        seconds = interleaved({**runs, **closed}, rounds)
    return [point._replace(seconds=seconds[point.method, point.setting]) for point in found]


def interleaved(runs: Mapping[Any, Callable[[], object]], rounds: int) -> dict[Any, float]:
    """Return the median CPU seconds of each run, over ``rounds`` rounds of all runs in turn."""
    many = {
        job: max(1, min(100, round(SHORTEST_S / max(_seconds(run, 1), 1e-6)))) for job, run in runs.items()
    }
    taken: dict[Any, list[float]] = {job: [] for job in runs}
    for _ in range(rounds):
        for job, run in runs.items():
            taken[job].append(_seconds(run, many[job]))
    return {job: statistics.median(times) for job, times in taken.items()}


def _seconds(run: Callable[[], object], many: int) -> float:
    began = time.process_time()
    for _ in range(many):
        run()
    return (time.process_time() - began) / many


def floor(scene: Scene) -> float | None:
    """Return (κ + angle)·2⁻⁵², about the least error that a stepper reaches: κ for ω, and the angle turned in
    rad for R. None for a heavy top.
    """
    angle = float(np.linalg.norm(scene.w0)) * scene.t_end
    return None if scene.mgl else EPSILON * (sensitivity(scene.w0, scene.I, scene.t_end) + angle)


def claims(points: Sequence[Point], least: float | None) -> list[Claim]:
    """Return what a scene's points say about the cost of accuracy; ``least`` is ``floor``'s."""
    steppers = [p for p in points if p.method not in (CLOSED, SCIPY)]
    few, many = (next(p.seconds for p in points if (p.method, p.setting) == (CLOSED, n)) for n in SAMPLES)
    theirs = next(p for p in points if p.method == SCIPY)
    ours = next(p for p in points if (p.method, p.setting) == ("DOP853", RTOL))
    best = min((p for p in steppers if p.error <= ENOUGH), key=lambda p: p.seconds, default=None)
    accurate = min(steppers, key=lambda p: p.error)
    ratio = theirs.seconds / ours.seconds
    found = [
        Claim(
            f"DOP853 at rtol {RTOL:g} takes {ours.seconds * 1e6:.0f} µs compiled and"
            f" {theirs.seconds * 1e3:.0f} ms in SciPy with a function in Python: ×{ratio:.0f}. That is the"
            " price of the interpreter, not of the method.",
            ratio > 10,
        ),
        Claim(
            f"The closed form costs {few * 1e6:.0f} µs for {SAMPLES[0]} samples and {many * 1e6:.0f} µs for"
            f" {SAMPLES[1]}, whatever the accuracy; the most accurate run of a stepper has"
            f" {accurate.error:.1g}"
            f" ({accurate.method}, {accurate.seconds * 1e6:.0f} µs)"
            + (f", where (κ + angle)·2⁻⁵² is {least:.1g}." if least else "."),
            many < theirs.seconds,
        ),
    ]
    if best is None:
        told = f"No stepper reaches {ENOUGH:g} with these settings."
    else:
        beside = "less" if best.seconds < few else "more"
        told = (
            f"The cheapest stepper to {ENOUGH:g} is {best.method}, {best.seconds * 1e6:.0f} µs: {beside}"
            f" than the closed form for {SAMPLES[0]} samples."
        )
    return [*found, Claim(told, True)]
