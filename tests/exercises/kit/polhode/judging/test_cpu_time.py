"""CPU seconds of a right-hand side and its motions, without a submission."""

from time import thread_time

import numpy as np
import pytest

from polhode.judging.cpu_time import LONG_S, REPEATED, seconds_of_a_call, timed_runs
from polhode.judging.return_value import WrongAnswer

T = np.linspace(0.0, 6.0, 7)
SETTINGS = [("DOP853", 1e-3), ("DOP853", 1e-9), ("DOP853", 1e-11), ("LSODA", 1e-3)]


def spin(seconds):
    until = thread_time() + seconds
    while thread_time() < until:
        pass


class Oscillator:
    """x'' = −x; ``begun`` counts runs, ``wait`` is what each call costs, after ``most`` calls it stops."""

    def __init__(self, most=10**6, wait=0.0):
        self.begun, self.most, self.wait = 0, most, wait

    def begin(self):
        self.begun += 1
        calls = [0]

        def rates(y, out):
            def evaluate(t):
                calls[0] += 1
                if calls[0] > self.most:
                    raise WrongAnswer(None, "stalled")
                spin(self.wait)
                out[:] = y[1], -y[0]

            return evaluate

        return np.array([1.0, 0.0]), rates, calls


def test_a_call_takes_what_it_takes():
    assert seconds_of_a_call(lambda: spin(2e-4)) == pytest.approx(2e-4, rel=0.2)


def test_short_runs_are_repeated_and_follow_their_tolerance():
    system = Oscillator()
    runs = timed_runs(system.begin, T, SETTINGS, 1.0, system.most)
    errors = [np.abs(run.states[0] - np.cos(T)).max() for run in runs]
    assert errors[1] < 1e-7 < errors[0] and errors[2] < 1e-9
    assert system.begun == REPEATED * len(SETTINGS) and all(run.seconds > 0 for run in runs)
    assert runs[0].calls < runs[1].calls < runs[2].calls


def test_a_long_run_is_timed_once():
    system = Oscillator(wait=LONG_S / 30)
    (run,) = timed_runs(system.begin, T, SETTINGS[:1], 1.0, system.most)
    assert system.begun == 1 and run.seconds > LONG_S


def test_a_solver_that_stalls_is_not_run_at_finer_tolerances():
    system = Oscillator(most=130)
    coarse, stalled, finer, other = timed_runs(system.begin, T, SETTINGS, 1.0, system.most)
    assert not np.isnan(coarse.states).any() and np.isnan(stalled.states).all()
    assert finer is stalled and stalled.calls == system.most + 1
    assert other.calls <= system.most and system.begun == 3 * REPEATED
