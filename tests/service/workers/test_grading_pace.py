"""What a worker takes for slow depends on what is usual for the assignment."""

import time
from uuid import uuid4

import pytest

from service.workers.grading_pace import ENOUGH, KEPT, SLOW_S, Pace, Stopwatch


@pytest.mark.parametrize(("usual", "slow_after"), [(0.07, 3.0), (0.3, 3.0), (2.0, 20.0), (40.0, 400.0)])
def test_slow_is_many_times_the_usual_time(usual, slow_after):
    pace = Pace()
    for _ in range(ENOUGH - 1):
        pace.note("waves", uuid4(), usual)
    assert pace.slow_after("waves") == SLOW_S, "too few are known"
    pace.note("waves", uuid4(), usual)
    assert pace.slow_after("waves") == pytest.approx(slow_after)
    assert pace.slow_after("lagrangian") == SLOW_S


def test_a_few_slow_ones_do_not_change_what_is_usual():
    pace = Pace()
    for seconds in [0.1] * 6 + [120.0] * 5:
        pace.note("waves", uuid4(), seconds)
    assert pace.slow_after("waves") == 3.0


def test_one_person_alone_does_not_make_long_times_usual():
    pace, attacker = Pace(), uuid4()
    for _ in range(KEPT):
        pace.note("waves", attacker, 9.0)
    assert pace.slow_after("waves") == SLOW_S, "one person is known"
    for _ in range(ENOUGH):
        pace.note("waves", uuid4(), 0.1)
    for _ in range(2 * KEPT):
        pace.note("waves", attacker, 9.0)
    assert pace.slow_after("waves") == SLOW_S


def test_the_last_persons_say_what_is_usual():
    pace = Pace()
    for seconds in [40.0] * KEPT + [0.5] * KEPT:
        pace.note("waves", uuid4(), seconds)
    assert pace.slow_after("waves") == 5.0


def test_waiting_for_a_processor_is_not_slow():
    waited = [7.0]
    watch = Stopwatch(lambda: waited[0])
    time.sleep(0.2)
    assert 0.2 <= watch.seconds() < 2
    waited[0] += 0.15
    assert watch.seconds() >= 0.05
    waited[0] += 60
    assert watch.seconds() == 0.0
