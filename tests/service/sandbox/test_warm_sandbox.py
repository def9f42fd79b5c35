"""A worker's sandbox: small guests in turn, and the guest with SciPy and matplotlib for submissions that need
it.
"""

import os
import signal
import subprocess
import threading
import time
from dataclasses import replace

import pytest

from ecp.outcome import Ended
from exercises.assignment import ArraySpec
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.job import Cell, Job, Kept, SceneRequest
from service.sandbox.result import Cancelled, SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.select import choose
from service.sandbox.time_budget import TimeBudget, TimeLimits
from service.sandbox.zygote import Zygote
from tests.service.sandbox.test_sandbox import zygote_pid
from tests.support import machines

SETUP = "import numpy as np\nimport matplotlib.pyplot as plt\nfrom scipy.integrate import quad"
PLAYS = """
import numpy as np

def ask(student, inputs):
    return {"x": np.asarray(student["f"](), dtype=float)}

def draw(student, inputs):
    import matplotlib.pyplot
    figure = matplotlib.pyplot.figure(figsize=(1, 1), dpi=10)
    figure.canvas.draw()
    return {"frames": np.asarray(figure.canvas.buffer_rgba())}
"""


def job(source, play="ask", **returns):
    scene = SceneRequest("one", play, "f", {}, returns or {"x": ArraySpec(())}, 2.0, None)
    return Job(SETUP, PLAYS, (Cell("cell 1", source),), ("f",), (scene,))


def plays(sandbox):
    """How many plays each of the guests has seen: the small ones, and the one with the libraries."""
    return sorted(guest._plays for guest in sandbox._guests), sandbox._plays


def test_small_guests_play_in_turn(warm_sandbox):
    small, own = plays(warm_sandbox)
    for _ in range(4):
        assert warm_sandbox.play(job("def f():\n    return 1.0")).arrays["one"]["x"] == 1.0
    assert plays(warm_sandbox) == ([one + 2 for one in small], own)


def test_a_submission_that_uses_a_library_is_played_with_it_from_then_on(warm_sandbox):
    uses = job("print('begun')\ndef f():\n    return quad(np.cos, 0.0, 1.0)[0]")
    result = warm_sandbox.play(uses)
    assert result.arrays["one"]["x"] == pytest.approx(0.8414709848) and result.stdout == "begun\n"
    small, own = plays(warm_sandbox)
    assert warm_sandbox.play(uses).finished("one") and plays(warm_sandbox) == (small, own + 1)
    assert (
        warm_sandbox.play(job("def f():\n    return 1.0")).finished("one")
        and plays(warm_sandbox)[1] == own + 1
    )


def started_children(monkeypatch):
    """The children that zygotes are asked to start from now on."""
    start, found = Zygote._start, []

    def recording(zygote, *rest):
        found.append(child := start(zygote, *rest))
        return child

    monkeypatch.setattr(Zygote, "_start", recording)
    return found


def test_a_job_is_played_in_the_child_that_was_started_for_it(warm_sandbox, monkeypatch):
    right, budget, children = (
        job("def f():\n    return 1.0"),
        TimeBudget(warm_sandbox.limits),
        started_children(monkeypatch),
    )
    for count in (1, 2):
        warm_sandbox.start_child(right, budget)
        warm_sandbox.start_child(right, budget)  # there is one
        assert warm_sandbox.play(right, budget=budget).finished("one") and len(children) == count
    warm_sandbox.start_child(right, budget)
    warm_sandbox.end_unused_child()
    assert children[2].answers.closed and warm_sandbox.play(right).finished("one") and len(children) == 4
    assert warm_sandbox.play(right).finished("one") and len(children) == 5


def test_a_job_that_the_started_child_cannot_play_gets_another_child(warm_sandbox, monkeypatch, tmp_path):
    (tmp_path / "factor").write_text("3.0")
    right, limits = job("def f():\n    return 3.0"), warm_sandbox.limits
    other = replace(
        right, setup=SETUP + "\nimport builtins\nf = getattr(builtins, 'seen', 3.0)\nbuiltins.seen = 4.0"
    )
    data = replace(
        job("def f():\n    return float(open('factor').read())"), data={"factor": tmp_path / "factor"}
    )
    less = TimeLimits(1.0, limits.wall_s)
    asks = {
        "the same": (right, limits, 1),
        "other code": (other, limits, 2),
        "data": (data, limits, 2),
        "less time": (right, less, 2),
    }
    for asked in (right, other):  # guests that have kept the code of both
        assert [warm_sandbox.play(asked).finished("one") for _ in warm_sandbox._guests] == [True, True]
    children = started_children(monkeypatch)
    for what, (asked, allowed, count) in asks.items():
        warm_sandbox.start_child(right, TimeBudget(limits))
        assert (
            warm_sandbox.play(asked, budget=TimeBudget(allowed)).arrays["one"]["x"] == 3.0
            and len(children) == count
        ), what
        assert children[-1].limit == allowed.cpu_s, what
        children.clear()


KILLS = {
    "the guest": lambda guest: os.kill(zygote_pid(guest), signal.SIGKILL),
    "the child": lambda guest: [
        os.kill(child, signal.SIGKILL) for child in machines.children(zygote_pid(guest))
    ],
}


@pytest.mark.parametrize("then", ["end_unused_child", "fork_next_child", "play"])
@pytest.mark.parametrize("killed", KILLS)
def test_what_was_lost_after_a_child_had_started_is_replaced(warm_sandbox, killed, then):
    right, budget = job("def f():\n    return 1.0"), TimeBudget(warm_sandbox.limits)
    warm_sandbox.start_child(right, budget)
    time.sleep(0.2)
    KILLS[killed](warm_sandbox._guests[0])
    time.sleep(0.2)
    if then != "play":
        getattr(warm_sandbox, then)()
    assert [warm_sandbox.play(right, budget=budget).finished("one") for _ in range(3)] == [True] * 3


def test_a_guest_that_does_not_start_is_replaced(warm_sandbox, monkeypatch):
    right, budget, guest = (
        job("def f():\n    return 1.0"),
        TimeBudget(warm_sandbox.limits),
        warm_sandbox._guests[0],
    )
    guest._end_guest()
    with monkeypatch.context() as context, pytest.raises(SystemFault):
        context.setattr(guest, "isolation", replace(guest.isolation, around=("/bin/false",), inside=()))
        warm_sandbox.start_child(right, budget)
    warm_sandbox.start_child(right, budget)
    assert warm_sandbox.play(right, budget=budget).finished("one")


def test_a_grading_leaves_no_child_without_a_job(warm_sandbox, rigid_body, monkeypatch):
    children = started_children(monkeypatch)
    source = "def euler_eqs(t, w, I):\n    raise ValueError"
    grade(Submission(source), rigid_body, warm_sandbox, 1, ["2"])
    assert len(children) == 1 and all(child.answers.closed for child in children)
    assert all(guest._zygote._started_child is None for guest in warm_sandbox._guests)


@pytest.mark.parametrize("small", [True, False])
def test_a_submission_cannot_replace_the_kinds_of_questions_that_plays_import(small):
    plays = "import ecp.kinds as kinds\n" + PLAYS.replace(
        '["f"]()', '["f"]() * (kinds.agreement.__name__ == "agreement")'
    )
    replaces = "import ecp.kinds\necp.kinds.agreement = print\ndef f():\n    return 1.0"
    guest = Sandbox(choose(), small=small)
    try:
        guest.self_test()
        for _ in range(2):
            assert guest.play(replace(job(replaces), plays=plays)).arrays["one"]["x"] == 1.0
            assert guest.play(job("def f():\n    return 1.0")).finished("one")
    finally:
        guest.close()


def test_a_small_guest_imports_only_what_children_need():
    """Its start is most of the time of grading one file."""
    unneeded = {
        "ecp.course",
        "ecp.exercise",
        "ecp.kinds",
        "email",
        "html",
        "importlib.resources",
        "matplotlib.figure",
    }
    guest = Sandbox(choose(), small=True)
    try:
        guest.self_test()
        printed = guest.play(job("import sys\nprint(*sys.modules)\ndef f():\n    return 1.0")).stdout.split()
    finally:
        guest.close()
    assert "ecp.integration" in printed and not unneeded.intersection(printed)


def test_scenes_that_draw_are_played_with_matplotlib_at_once(warm_sandbox):
    small, own = plays(warm_sandbox)
    result = warm_sandbox.play(job("def f():\n    pass", "draw", frames=ArraySpec((10, 10, 4), "uint8")))
    assert result.arrays["one"]["frames"].shape == (10, 10, 4) and plays(warm_sandbox) == (small, own + 1)


def test_two_threads_play_at_the_same_time(warm_sandbox):
    both, seen = threading.Barrier(2, timeout=20), []
    right = job("import time\ndef f():\n    return 1.0")

    def play():
        seen.append(
            warm_sandbox.play(right, lambda scene: both.wait())
        )  # returns when both scenes have begun

    threads = [threading.Thread(target=play) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [result.finished("one") for result in seen] == [True, True]


def test_two_threads_that_need_the_same_guest_wait_for_each_other(warm_sandbox):
    uses, seen = job("def f():\n    return quad(np.cos, 0.0, 1.0)[0]"), []
    threads = [threading.Thread(target=lambda: seen.append(warm_sandbox.play(uses))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [result.finished("one") for result in seen] == [True] * 4


def test_parts_of_jobs_are_sent_once_and_again_to_a_guest_that_replaces_another(warm_sandbox, monkeypatch):
    values, sent, encode = Kept.of([1.5] * 1000), [], Kept.encode
    monkeypatch.setattr(Kept, "encode", lambda kept: sent.append(kept) or encode(kept))
    plays = (
        "def ask(student, inputs):\n"
        "    return {'x': student['np'].asarray(sum(inputs['values']) * student['f']())}"
    )
    asked = SceneRequest("one", "ask", "f", {"values": values}, {"x": ArraySpec(())}, 2.0, None)
    right = Job(SETUP, plays, (Cell("cell 1", "def f():\n    return 2.0"),), ("f",), (asked,))
    assert (
        values.name.encode() in right.encode(kept=True)
        and len(right.encode(kept=True)) < len(right.encode()) - 4000
    )
    for _ in range(6):
        assert warm_sandbox.play(right).arrays["one"]["x"] == 3000.0
    assert sent.count(values) == 2  # once to each small guest
    crash = replace(right, cells=(Cell("cell 1", "import ctypes\ndef f():\n    ctypes.string_at(0)"),))
    assert warm_sandbox.play(crash).scene_ends["one"].ended is Ended.KILLED
    for _ in range(2):
        assert warm_sandbox.play(right).arrays["one"]["x"] == 3000.0
    assert sent.count(values) == 3


def test_a_submission_that_changes_what_its_guest_keeps_does_not_change_it_for_the_next(warm_sandbox):
    plays = (
        "import numpy as np\ndef ask(student, inputs):\n"
        "    return {'x': np.asarray(student['f'](inputs['values']))}"
    )
    asked = SceneRequest("one", "ask", "f", {"values": Kept.of([1.5] * 30)}, {"x": ArraySpec(())}, 2.0, None)
    for source in (
        "def f(values):\n    values.append(9.0)\n    return sum(values)",
        "def f(values):\n    return sum(values)",
    ):
        right = Job(SETUP, plays, (Cell("cell 1", source),), ("f",), (asked,))
        found = [float(warm_sandbox.play(right).arrays["one"]["x"]) for _ in range(2)]
    assert found == [45.0, 45.0]


def test_a_submission_does_not_see_what_its_guest_keeps_for_others(warm_sandbox):
    other = SceneRequest(
        "one", "ask", "f", {"values": Kept.of("of another assignment")}, {"x": ArraySpec(())}, 2.0, None
    )
    right = job("def f():\n    return 1.0")
    for _ in range(2):
        assert warm_sandbox.play(replace(right, scenes=(other,))).finished("one")
    spying = "import sys\nprint(sys.modules['guest.wire']._kept)\ndef f():\n    return 1.0"
    for _ in range(2):
        result = warm_sandbox.play(job(spying))
        assert result.finished("one") and result.stdout == "{}\n"


def test_the_time_in_a_guest_without_the_library_is_not_the_submissions(warm_sandbox):
    budget = TimeBudget(TimeLimits(60.0, 120.0))
    slow = "import time\nbegun = time.process_time()\nwhile time.process_time() < begun + 0.5: pass\n"
    result = warm_sandbox.play(job(f"{slow}def f():\n    return quad(np.cos, 0.0, 1.0)[0]"), budget=budget)
    assert result.finished("one") and 0.5 < budget.cpu_s < 0.95


def test_every_play_can_be_cancelled(warm_sandbox):
    cancel = threading.Timer(0.3, warm_sandbox.cancelled.set)
    cancel.start()
    try:
        with pytest.raises(Cancelled):
            warm_sandbox.play(job("import time\ndef f():\n    time.sleep(5.0)"))
    finally:
        cancel.join()
        warm_sandbox.cancelled.clear()
    assert warm_sandbox.play(job("def f():\n    return 1.0")).finished("one")


def test_a_guest_that_a_submission_crashes_is_replaced_and_counted(warm_sandbox):
    before = warm_sandbox.replaced
    result = warm_sandbox.play(job("import ctypes\ndef f():\n    ctypes.string_at(0)"))
    assert result.scene_ends["one"].ended is Ended.KILLED and warm_sandbox.replaced == before + 1
    for _ in range(2):
        assert warm_sandbox.play(job("def f():\n    return 1.0")).finished("one")


def test_a_guest_that_cannot_be_killed_costs_no_result(warm_sandbox, monkeypatch, caplog):
    killed = []

    def never_exits(self, timeout=None):
        killed.append(self)
        raise subprocess.TimeoutExpired(self.args, timeout)

    with monkeypatch.context() as patched:
        patched.setattr(subprocess.Popen, "wait", never_exits)
        result = warm_sandbox.play(job("import os\ndef f():\n    os.abort()"))
    assert result.scene_ends["one"].ended is Ended.KILLED and "could not be killed" in caplog.text
    for process in killed:
        process.wait()
    assert warm_sandbox.play(job("def f():\n    return 1.0")).finished("one")


SLEEPS = """
import sys, time
class Stream:
    write = print
    def flush(self):
        time.sleep(1)
sys.stdout = Stream()
"""
ENDINGS = {
    "keeps its pipes open": "import os\nkept = [os.dup(k) for k in range(1, 5)]",
    "closes its output": "import os\nos.close(1)\nos.close(2)",
    "prints at last without flushing": "import sys\nsys.stdout.write('last')",
    "has a stream that never flushes": SLEEPS,
}


@pytest.mark.parametrize("source", ENDINGS.values(), ids=ENDINGS)
def test_however_a_child_ends_its_result_is_whole(warm_sandbox, source):
    result = warm_sandbox.play(job(f"{source}\ndef f():\n    return 1.0"))
    assert result.finished("one") and result.arrays["one"]["x"] == 1.0 and result.cpu_s > 0
    assert result.stdout == ("last" if "last" in source else "")


LATE = """
import os, sys
class Stream:
    write = print
    def flush(self):
        os.write(4, b"J\\x02\\x00\\x00\\x00{}")
sys.stdout = Stream()
def f():
    return 1.0
"""


def test_bytes_after_the_last_frame_are_not_accepted(warm_sandbox):
    assert warm_sandbox.play(job(LATE)).scene_ends["one"].ended is Ended.PROTOCOL


def with_setup(setup, source, **more):
    return replace(job(source), setup=f"import numpy as np\n{setup}", **more)


def play(sandbox, asked):
    """Play a job after which the guest forks a child in advance, as after a grading."""
    try:
        return sandbox.play(asked)
    finally:
        sandbox.fork_next_child()


def test_the_setup_runs_before_the_job_arrives(warm_sandbox):
    asks = with_setup(
        "import time\nbegun = time.monotonic()", "def f():\n    return time.monotonic() - begun"
    )
    for _ in warm_sandbox._guests:
        assert play(warm_sandbox, asks).arrays["one"]["x"] < 5.0
    time.sleep(0.6)
    for _ in warm_sandbox._guests:
        assert play(warm_sandbox, asks).arrays["one"]["x"] > 0.5


def test_a_child_has_its_own_setup_and_nothing_of_others(warm_sandbox):
    first = with_setup(
        "import builtins\nbuiltins.seen, several = 1.0, []",
        "several.append(1)\ndef f():\n    return len(several)",
    )
    second = with_setup("import builtins", "def f():\n    return getattr(builtins, 'seen', 0.0)")
    for asked, expected in (
        (first, 1.0),
        (first, 1.0),
        (first, 1.0),
        (second, 0.0),
        (second, 0.0),
        (first, 1.0),
        (second, 0.0),
    ):
        assert play(warm_sandbox, asked).arrays["one"]["x"] == expected


def test_a_setup_that_reads_data_files_runs_when_they_are_there(warm_sandbox, tmp_path):
    (tmp_path / "factor").write_text("3.0")
    asked = with_setup(
        "factor = float(open('factor').read())",
        "def f():\n    return factor",
        data={"factor": tmp_path / "factor"},
    )
    for _ in range(4):
        assert play(warm_sandbox, asked).arrays["one"]["x"] == 3.0


THREAD = """
import threading
try:
    threading.Thread(target=threading.Event().wait, daemon=True).start()
except RuntimeError:
    pass
"""


def test_a_setup_starts_no_thread_that_escapes_the_layers(warm_sandbox):
    asked = with_setup(THREAD, "def f():\n    return threading.active_count()")
    assert [play(warm_sandbox, asked).arrays["one"]["x"] for _ in range(4)] == [1.0] * 4


def test_a_file_that_a_setup_keeps_open_is_not_taken_for_a_pipe_of_the_play(warm_sandbox):
    asked = with_setup("import os\nopened = open(os.devnull)", "def f():\n    opened.close()\n    return 1.0")
    assert [play(warm_sandbox, asked).finished("one") for _ in range(4)] == [True] * 4


ENDS = {
    "raises": "1 / 0",
    "exits": "import os\nos._exit(3)",
    "crashes": "import ctypes\nctypes.string_at(0)",
    "draws": "import matplotlib.pyplot as plt\nplt.figure()",
    "prints": "print('of the setup')",
}


@pytest.mark.parametrize("how", ENDS)
def test_a_setup_ends_as_it_does_within_the_play(how, warm_sandbox, sandbox):
    asked = with_setup(ENDS[how], "def f():\n    return 1.0")
    assert [ending(warm_sandbox, asked) for _ in range(5)] == [ending(sandbox, asked)] * 5
    assert play(warm_sandbox, job("def f():\n    return 1.0")).finished("one")


def ending(sandbox, asked):
    try:
        result = play(sandbox, asked)
    except Exception as error:
        return type(error), str(error).partition("cpu_s")[0]
    return result.scene_ends["one"].ended, result.scene_ends["one"].sentence, result.stdout


@pytest.mark.slow
def test_a_setup_that_takes_longer_than_the_host_waits_for_a_child_runs_within_the_play(warm_sandbox):
    before = warm_sandbox.replaced
    asked = with_setup("import time\ntime.sleep(4.5)", "def f():\n    return 1.0")
    assert play(warm_sandbox, asked).finished("one") and warm_sandbox.replaced == before
