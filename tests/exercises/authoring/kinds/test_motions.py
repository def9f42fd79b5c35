"""The numbers that the chart of a motion may return."""

import numpy as np
import pytest

from exercises.authoring.assignments.catalogue import find
from exercises.authoring.assignments.sweep import SETTINGS as EVERY
from exercises.authoring.kinds.motions import MOST_SWEPT

SETTINGS = len(EVERY)
SWEEP = find("rigid-body").sweep


def seen(**changed):
    truth = SWEEP.scene.truth(SWEEP.scene.inputs)
    return {
        "w": np.stack([truth["w"]] * SETTINGS),
        "calls": np.full(SETTINGS, 500.0),
        "seconds": np.full(SETTINGS, 0.01),
        "per_call": np.array(1e-6),
    } | changed, truth


def test_numbers_in_their_ranges_and_a_run_of_the_most_calls_was_stopped():
    assert not any(p.stopped for p in SWEEP.read(*seen()).points)
    result = SWEEP.read(*seen(calls=np.full(SETTINGS, 20_001.0)))
    assert all(p.stopped and p.calls == MOST_SWEPT + 1 for p in result.points)


@pytest.mark.parametrize("calls", [0.0, -1.0, 20_002.0, 1.5, 1e300, np.inf, np.nan])
def test_calls_that_no_run_makes(calls):
    with pytest.raises(ValueError, match="a number of calls is not a whole number from 1 to 20001"):
        SWEEP.read(*seen(calls=np.array([calls, *[500.0] * (SETTINGS - 1)])))


@pytest.mark.parametrize("name", ["seconds", "per_call"])
@pytest.mark.parametrize("time", [-1e-9, 81.0, np.inf, np.nan])
def test_times_that_no_run_takes(name, time):
    with pytest.raises(ValueError, match="a time is not between 0 and 80 s"):
        SWEEP.read(*seen(**{name: np.full((SETTINGS,) if name == "seconds" else (), time)}))
