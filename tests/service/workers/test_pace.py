"""What a worker takes for slow depends on what is usual for the assignment."""

import pytest

from service.workers.pace import ENOUGH, SLOW_S, Pace


@pytest.mark.parametrize(("usual", "slow_after"), [(0.07, 3.0), (0.3, 3.0), (2.0, 20.0), (40.0, 400.0)])
def test_slow_is_many_times_the_usual_time(usual, slow_after):
    pace = Pace()
    for _ in range(ENOUGH - 1):
        pace.note("waves", usual)
    assert pace.slow_after("waves") == SLOW_S, "too few are known"
    pace.note("waves", usual)
    assert pace.slow_after("waves") == pytest.approx(slow_after)
    assert pace.slow_after("lagrangian") == SLOW_S


def test_a_few_slow_ones_do_not_change_what_is_usual():
    pace = Pace()
    for seconds in [0.1] * 6 + [120.0] * 5:
        pace.note("waves", seconds)
    assert pace.slow_after("waves") == 3.0
