"""A time limit in the kernel: it ends loops, and leaves the notebook's own signals and trace functions as
they were.
"""

import signal
import sys
import threading
import time

import numpy as np
import pytest

from polhode.client import local
from polhode.client.public_assignment import PublicAssignment, PublicScene
from polhode.judging.time_limit import OutOfTime, limited


def endless():
    while True: pass  # fmt: skip  # noqa: E701 -- in one line, which has no event of a line


def stubborn():
    for _ in range(3):
        try:
            endless()
        except BaseException:
            continue
    endless()


def in_thread(action):
    caught = []

    def run():
        try:
            action()
        except BaseException as error:
            caught.append(type(error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(10)
    assert not thread.is_alive()
    return caught


def within(seconds, action):
    with limited(seconds):
        action()


@pytest.mark.parametrize("loop", [endless, stubborn])
def test_a_loop_is_ended_in_the_main_thread(loop):
    with pytest.raises(OutOfTime):
        within(0.05, loop)


def test_a_loop_is_ended_in_another_thread():
    assert in_thread(lambda: within(0.05, endless)) == [OutOfTime]


def test_a_loop_that_calls_libraries_is_ended_in_another_thread():
    def solving():
        from scipy.integrate import solve_ivp

        solve_ivp(lambda t, y: y if t < 0.01 else endless(), (0, 1), [1.0])

    assert in_thread(lambda: within(0.05, solving)) == [OutOfTime]


def test_what_is_fast_enough_is_left_alone_also_afterwards():
    within(0.05, lambda: None)
    assert in_thread(lambda: within(0.05, lambda: None)) == []
    time.sleep(0.1)


def test_a_handler_and_a_timer_of_the_notebooks_own_go_on():
    rung = []
    before = signal.signal(signal.SIGALRM, lambda signum, frame: rung.append(signum))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(OutOfTime):
            within(0.05, endless)
        assert not rung
        time.sleep(0.4)
        assert rung == [signal.SIGALRM]
    finally:
        signal.signal(signal.SIGALRM, before)


def test_an_interrupt_is_the_users():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        within(1.0, interrupted)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_a_debuggers_trace_function_stays():
    seen = []

    def debugger():
        def trace(frame, event, argument):
            return None

        sys.settrace(trace)
        within(0.05, lambda: seen.append(sys.gettrace() is trace))
        seen.append(sys.gettrace() is trace)
        sys.settrace(None)

    assert in_thread(debugger) == [] and seen == [True, True]


def test_check_gives_a_loop_the_servers_time_and_sentence():
    scene = PublicScene("motion", "play", "f", {}, [], 0.05, None, {})
    known = PublicAssignment(
        "a", "1", {}, (), {"motion": scene}, {"play": lambda student, inputs: student["f"]()}
    )
    played = local._play([scene], known, {"f": endless})
    scene_end = played.scene_ends["motion"]
    assert (scene_end.ended, scene_end.code, scene_end.sentence) == (
        "timed-out",
        "timeout",
        "your code did not finish within 0.05 s",
    )
    assert "motion" not in played.arrays and not played.slow
    np.testing.assert_array_equal(
        local._play([scene], known, {"f": lambda: {"x": [1.0]}}).arrays["motion"]["x"], [1.0]
    )
