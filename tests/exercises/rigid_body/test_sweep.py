"""The numbers that a sweep may return."""

import numpy as np
import pytest

from exercises.rigid_body import plays, sweep

SETTINGS = len(sweep.SETTINGS)


def seen(**changed):
    truth = sweep.SWEEP.scene.truth(sweep.INPUTS)
    right = {"w": np.stack([truth["w"]] * SETTINGS), "R": np.stack([truth["R"]] * SETTINGS)}
    return right | {
        "calls": np.full(SETTINGS, 500.0),
        "seconds": np.full(SETTINGS, 0.01),
        "per_call": np.array(1e-6),
    } | changed, truth


def test_numbers_in_their_ranges():
    result = sweep.read(*seen(calls=np.full(SETTINGS, 40_001.0)))
    assert {p.calls for p in result.points} == {40_001} and sweep.MOST_CALLS == plays.MOST_CALLS + 1


@pytest.mark.parametrize("calls", [0.0, -1.0, 40_002.0, 1.5, 1e300, np.inf, np.nan])
def test_calls_that_no_run_makes(calls):
    with pytest.raises(ValueError, match="a number of calls is not a whole number from 1 to 40001"):
        sweep.read(*seen(calls=np.array([calls, *[500.0] * (SETTINGS - 1)])))


@pytest.mark.parametrize("name", ["seconds", "per_call"])
@pytest.mark.parametrize("time", [-1e-9, 81.0, np.inf, np.nan])
def test_times_that_no_run_takes(name, time):
    with pytest.raises(ValueError, match="a time is not between 0 and 80 s"):
        sweep.read(*seen(**{name: np.full((SETTINGS,) if name == "seconds" else (), time)}))
