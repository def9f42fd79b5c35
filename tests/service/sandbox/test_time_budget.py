"""The time budget of a grading: all its processes share it, and a machine without a free processor is no
reason for a verdict.
"""

import contextlib
import os
import signal
import subprocess
import threading
import time
from dataclasses import replace

import pytest

from polhode.judging.outcome import Ended
from service.grading import grade as grading
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox import session, zygote
from service.sandbox.guest_process import GuestProcess
from service.sandbox.isolation.select import choose
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import WALL_PER_CPU, TimeBudget, TimeLimits
from tests.service.sandbox.test_sandbox import GOOD, job, scene, zygote_pid
from tests.support.isolation import BY_THE_HOST
from tests.support.machines import children

IGNORE_SIGNALS = """
import os, signal, time
signal.pthread_sigmask(signal.SIG_BLOCK, range(1, 64))
"""
LONGEST_S = 8.0  # far above the limits below, far below the scenes' own limits together


@pytest.fixture(autouse=True)
def short_waits(monkeypatch):
    monkeypatch.setattr(session, "GRACE_S", 0.3)


def play(sandbox, source, scenes=8, budget_s=3.0, **limits):
    """Play scenes whose own limits are far above those of all together. Return the result, which must not
    take as long.
    """
    sandbox.wait_ready()
    began = time.monotonic()
    budget = TimeBudget(TimeLimits(**limits))
    seen = sandbox.play(
        job(source, *(scene(f"s{k}", budget_s=budget_s) for k in range(scenes))), budget=budget
    )
    assert time.monotonic() - began < LONGEST_S
    return seen


@BY_THE_HOST
@pytest.mark.parametrize(
    "stall",
    [
        "time.sleep(1000)",
        "while True: os.write(1, b'.'), time.sleep(0.01)",
        pytest.param("while True: os.write(1, b'.'), time.sleep(0.3)", marks=pytest.mark.slow),
    ],
    ids=["silent", "printing", "printing slowly"],
)
def test_processes_that_sleep_share_one_deadline(either_sandbox, stall):
    seen = play(either_sandbox, f"{IGNORE_SIGNALS}\ndef f(x):\n    {stall}", wall_s=1.5)
    assert {e.ended for e in seen.scene_ends.values()} == {Ended.TIMED_OUT} and len(seen.scene_ends) == 8
    assert seen.scene_ends["s7"].sentence == "your submission did not finish within 1.5 s in all"
    assert seen.scene_ends["s7"].code == "timeout"
    following = either_sandbox.play(job(GOOD))
    assert following.finished("one"), (
        f"the next submission has a budget of its own: {following.scene_ends} {following.cells}"
    )


@BY_THE_HOST
def test_processes_that_compute_share_one_limit_of_CPU_time(either_sandbox):
    seen = play(either_sandbox, f"{IGNORE_SIGNALS}\ndef f(x):\n    while True: pass", cpu_s=0.5)
    assert {e.ended for e in seen.scene_ends.values()} == {Ended.TIMED_OUT}
    assert seen.scene_ends["s7"].sentence == "your submission used more than 0.5 s of CPU time in all"


def test_a_process_that_starts_when_no_time_is_left_is_no_fault(sandbox, monkeypatch):
    budget = TimeBudget(TimeLimits(wall_s=1000.0))
    budget.charge(cpu_s=0.0, waited_s=0.0, running_s=1.0)
    left = iter([1.0, 0.0])  # at the look before the process starts, and afterwards
    monkeypatch.setattr(budget, "wall_left", lambda: next(left, 0.0))
    slow = f"import time\ntime.sleep(1.0)\n{GOOD}"  # else it may have finished at that look
    assert sandbox.play(job(slow), budget=budget).scene_ends["one"].ended is Ended.TIMED_OUT


@BY_THE_HOST
def test_a_process_that_starts_with_little_CPU_time_left_is_no_fault(either_sandbox):
    budget = TimeBudget(TimeLimits(cpu_s=10.0))
    budget.charge(cpu_s=9.9, waited_s=0.0, running_s=10.0)
    slow_setup = replace(job(GOOD), setup="while True: pass")
    seen = either_sandbox.play(slow_setup, budget=budget)
    assert seen.scene_ends["one"].ended is Ended.TIMED_OUT
    assert seen.scene_ends["one"].sentence == "your submission used more than 10 s of CPU time in all"


def test_what_finished_before_the_limit_is_kept(sandbox):
    source = (
        f"{IGNORE_SIGNALS}\nn = []\ndef f(x):\n    n.append(x)\n    return [x, x] if len(n) < 3 else"
        " time.sleep(1000)"
    )
    seen = play(sandbox, source, wall_s=1.0)
    assert [name for name in seen.scene_ends if seen.finished(name)] == ["s0", "s1"]


@BY_THE_HOST
def test_a_child_whose_zygote_is_lost_is_charged(either_sandbox):
    """Its exit is not reported, so the kernel's account while it ran counts."""
    either_sandbox.wait_ready()
    budget, end = (
        TimeBudget(TimeLimits()),
        threading.Timer(1.2, os.kill, (zygote_pid(either_sandbox), signal.SIGKILL)),
    )
    end.start()
    source = "import time\ndef f(x):\n    while time.process_time() < 2.5: pass\n    return [x, x]"
    seen = either_sandbox.play(job(source, scene("one", budget_s=4.0)), budget=budget)
    end.join()
    assert seen.finished("one") and budget.cpu_s > 2.5 + 0.5


@pytest.mark.slow
def test_a_submission_that_sleeps_through_its_grading_gets_a_report(rigid_body, sandbox, monkeypatch):
    monkeypatch.setattr(sandbox, "limits", TimeLimits(cpu_s=5.0, wall_s=1.5))
    began = time.monotonic()
    report = grade(
        Submission(f"{IGNORE_SIGNALS}\ndef euler_eqs(t, w, I):\n    time.sleep(1000)"), rigid_body, sandbox, 3
    ).report
    assert time.monotonic() - began < LONGEST_S and report.score == 0
    assert {e.ended for e in report.scene_ends} == {Ended.TIMED_OUT, Ended.NOT_PLAYED}


@contextlib.contextmanager
def on_a_busy_processor(hogs):
    """Start processes on a processor that they share with so many programs that never sleep."""
    before, others = os.sched_getaffinity(0), []
    try:
        os.sched_setaffinity(0, {min(before)})
        others = [
            subprocess.Popen(["sh", "-c", "while :; do :; done"], start_new_session=True) for _ in range(hogs)
        ]
        yield
    finally:
        os.sched_setaffinity(0, before)
        for other in others:
            other.kill()
            other.wait()


@contextlib.contextmanager
def shared_with(hogs, sandbox):
    """Let the guest share a processor with so many programs that never sleep."""
    sandbox.wait_ready()
    zygote, before = zygote_pid(sandbox), os.sched_getaffinity(0)
    with on_a_busy_processor(hogs):
        for pid in (zygote, *children(zygote)):
            os.sched_setaffinity(pid, os.sched_getaffinity(0))
        os.sched_setaffinity(0, before)
        yield
    for pid in (zygote, *children(zygote)):
        with contextlib.suppress(ProcessLookupError):
            os.sched_setaffinity(pid, before)


@pytest.fixture
def one_busy_processor(sandbox):
    with shared_with(12, sandbox):
        yield


@pytest.mark.slow
def test_a_guest_that_waits_for_a_processor_is_waited_for(monkeypatch):
    monkeypatch.setattr(zygote, "START_S", 1.0)  # it computes for more than that
    waiting = Sandbox(choose())
    with on_a_busy_processor(4):
        waiting.start()
        waiting.wait_ready()
    waiting.close()


def test_a_guest_that_sleeps_when_it_starts_is_a_fault(monkeypatch):
    monkeypatch.setattr(zygote, "START_S", 0.3)
    began, sleeping = (
        time.monotonic(),
        zygote.Zygote(GuestProcess(["sh", "-c", "sleep 60"], {}), threading.Event()),
    )
    with pytest.raises(SystemFault, match="the sandbox did not start: no output"):
        sleeping.wait_ready()
    assert time.monotonic() - began < LONGEST_S


COMPUTE = """
import time
def f(x):
    end = time.process_time() + 0.25
    while time.process_time() < end: pass
    return [x, x]
"""


@pytest.mark.slow
def test_a_submission_without_a_processor_is_not_judged(sandbox, one_busy_processor):
    with pytest.raises(SystemFault, match="this machine was too busy"):
        sandbox.play(job(COMPUTE, scene("one", budget_s=0.3)))


@pytest.mark.parametrize("computes", [True, False], ids=["computes", "sleeps"])
def test_the_sandbox_says_how_long_a_play_has_waited_for_a_processor_while_it_runs(sandbox, computes):
    source = COMPUTE if computes else "import time\ndef f(x):\n    time.sleep(0.5)\n    return [x, x]"
    during = []
    with shared_with(3, sandbox):
        before, began = sandbox.waited_s, time.monotonic()
        playing = threading.Thread(
            target=sandbox.play, args=(job(source, *(scene(f"s{k}", budget_s=3.0) for k in range(2))),)
        )
        playing.start()
        while playing.is_alive():
            during.append(sandbox.waited_s - before)
            time.sleep(0.02)
        after, took = sandbox.waited_s - before, time.monotonic() - began
    if computes:  # half a second, with a quarter of a processor
        assert 0.5 < after < took and 0.5 * after < max(during) < 1.1 * after
    else:
        assert after < 0.5 < took


@pytest.mark.slow
def test_a_submission_that_waits_through_the_limit_of_all_scenes_is_not_judged(sandbox):
    limits = TimeLimits(cpu_s=10.0, wall_s=2.5)  # eight scenes need 2 s of a processor
    scenes = [scene(f"s{k}", budget_s=0.6) for k in range(8)]
    with shared_with(2, sandbox), pytest.raises(SystemFault, match="this machine was too busy"):
        sandbox.play(job(COMPUTE, *scenes), budget=TimeBudget(limits))


@pytest.mark.slow
def test_a_submission_that_sleeps_through_the_limit_on_a_busy_machine_has_timed_out(sandbox):
    scenes = [scene(f"s{k}", budget_s=1.0) for k in range(8)]
    with shared_with(2, sandbox):
        budget = TimeBudget(TimeLimits(cpu_s=10.0, wall_s=2.5))
        seen = sandbox.play(
            job("import time\ndef f(x):\n    time.sleep(0.5)\n    return [x, x]", *scenes), budget=budget
        )
    assert seen.scene_ends["s7"].ended is Ended.TIMED_OUT


@pytest.mark.slow
def test_a_submission_that_sleeps_on_a_busy_machine_has_timed_out(sandbox, one_busy_processor):
    seen = sandbox.play(job("import time\ndef f(x):\n    time.sleep(1000)", scene("one", budget_s=1.5)))
    assert seen.scene_ends["one"].ended is Ended.TIMED_OUT


def test_an_assignment_raises_both_limits_and_lowers_none():
    limits = TimeLimits(cpu_s=60.0, wall_s=120.0)
    assert limits.at_least(None) == limits == limits.at_least(10.0)
    assert limits.at_least(100.0) == TimeLimits(cpu_s=100.0, wall_s=100.0 * WALL_PER_CPU)


def test_inputs_that_take_long_to_draw_do_not_use_up_the_submissions_time(rigid_body, sandbox, monkeypatch):
    drawn, limits = grading.draw_inputs, TimeLimits(cpu_s=60.0, wall_s=2.0)
    slow = iter([2.5])
    monkeypatch.setattr(grading, "draw_inputs", lambda *asked: time.sleep(next(slow, 0.0)) or drawn(*asked))
    monkeypatch.setattr(sandbox, "limits", limits)
    report = grade(
        Submission("def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I"),
        rigid_body,
        sandbox,
        1,
        ["2"],
    ).report
    assert report.passed, report.text()


def test_what_the_host_computes_for_a_submission_can_be_charged():
    budget = TimeBudget(TimeLimits())
    with budget.charged():
        until = time.thread_time() + 0.05
        while time.thread_time() < until:
            pass
    assert 0.05 <= budget.cpu_s < 0.5
