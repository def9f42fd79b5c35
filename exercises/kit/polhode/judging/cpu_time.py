"""CPU seconds of a student's right-hand side: of one call, and of a motion by one of SciPy's solvers.

The clock is bound before the submission runs, so that replacing it changes nothing here. It is the thread's:
that of a process with a limit of CPU time advances in steps of milliseconds. A web page's Python has none.
"""

import statistics
import time
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from polhode.judging.integration import Array, Rates, returning, solve_ivp
from polhode.judging.return_value import WrongAnswer

thread_time: Callable[[], float] = getattr(time, "thread_time", time.perf_counter)

BATCHES, BATCH = 10, 50  # of calls
REPEATED = 3
LONG_S = 0.2  # a run longer than this is timed once


def seconds_of_a_call(call: Callable[[], object]) -> float:
    """Return the median CPU seconds of one call, which is warm afterwards."""
    taken = []
    for _ in range(BATCHES):
        began = thread_time()
        for _ in range(BATCH):
            call()
        taken.append((thread_time() - began) / BATCH)
    return statistics.median(taken)


class TimedRun(NamedTuple):
    """One solver at one tolerance: ``states`` (d, n), NaN from where it stopped, the calls, and the median
    CPU seconds of REPEATED runs, or of one if that is long.
    """

    states: Array
    calls: int
    seconds: float


def timed_runs(
    begin: Callable[[], tuple[Array, Rates, list[int]]],
    times: Array,
    settings: Iterable[tuple[str, float]],
    scale: Array | float,
    most_calls: int,
) -> list[TimedRun]:
    """Integrate from ``times``' first to its last (n,) by solvers of SciPy, each at its tolerances from
    coarse to fine. ``scale`` (d,) is the size of the state.

    ``begin`` returns the start (d,), the right-hand side and a list whose first element counts its calls,
    anew for each run. The right-hand side raises WrongAnswer to end a run, in particular after
    ``most_calls``; the finer tolerances of a solver that did not arrive with these are taken as the same.
    """
    solve_ivp()  # imports SciPy, which is not the motion's time
    runs: list[TimedRun] = []
    stalled: dict[str, TimedRun] = {}
    for solver, rtol in settings:
        run = stalled.get(solver) or _timed_run(begin, times, solver, rtol, 1e-2 * rtol * np.asarray(scale))
        if run.calls > most_calls:
            stalled[solver] = run
        runs.append(run)
    return runs


def _timed_run(
    begin: Callable[[], tuple[Array, Rates, list[int]]], times: Array, solver: str, rtol: float, atol: Array
) -> TimedRun:
    taken: list[float] = []
    while len(taken) < REPEATED and max(taken, default=0.0) < LONG_S:
        start, rates, calls = begin()
        states, began = np.full((len(start), len(times)), np.nan), thread_time()
        rhs, span = returning(rates), (times[0], times[-1])
        try:
            run = solve_ivp()(rhs, span, start, method=solver, t_eval=times, rtol=rtol, atol=atol)
            states[:, : run.y.shape[1]] = run.y
        except WrongAnswer:
            pass  # this setting stalls; others may not
        taken.append(thread_time() - began)
    return TimedRun(states, calls[0], statistics.median(taken))
