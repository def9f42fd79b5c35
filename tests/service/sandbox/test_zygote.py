"""One play after the other in a warm sandbox: each ends as if it were the only one."""

import os
import subprocess
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.result import Cancelled, SystemFault
from tests.service.sandbox.test_sandbox import zygote_pid

CGROUPS = Path("/sys/fs/cgroup")
SETUP = "import numpy as np\nfrom scipy.integrate import quad"
PLAYS = """
import numpy as np

def ask(student, inputs):
    return {"x": np.asarray(student["f"](), dtype=float)}
"""


def job(source):
    scene = SceneRequest("one", "ask", "f", {}, {"x": ArraySpec(())}, 2.0, None)
    return Job(SETUP, PLAYS, (Cell("cell 1", source),), ("f",), (scene,))


def test_several_threads_play_one_after_the_other(sandbox):
    uses, seen = job("def f():\n    return quad(np.cos, 0.0, 1.0)[0]"), []
    threads = [threading.Thread(target=lambda: seen.append(sandbox.play(uses))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [result.finished("one") for result in seen] == [True] * 4


def test_every_play_can_be_cancelled(sandbox):
    cancel = threading.Timer(0.3, sandbox.cancelled.set)
    cancel.start()
    try:
        with pytest.raises(Cancelled):
            sandbox.play(job("import time\ndef f():\n    time.sleep(5.0)"))
    finally:
        cancel.join()
        sandbox.cancelled.clear()
    assert sandbox.play(job("def f():\n    return 1.0")).finished("one")


def test_a_guest_that_a_submission_crashes_is_replaced_and_counted(sandbox):
    before = sandbox.replaced
    result = sandbox.play(job("import ctypes\ndef f():\n    ctypes.string_at(0)"))
    assert result.scene_ends["one"].ended is Ended.KILLED and sandbox.replaced == before + 1
    for _ in range(2):
        assert sandbox.play(job("def f():\n    return 1.0")).finished("one")


@pytest.fixture
def little_memory(sandbox):
    """A control group with 60 MB of memory, by version 1 or 2 of the kernel's interface."""
    v1, v2 = CGROUPS / "memory/memory.limit_in_bytes", CGROUPS / "memory.max"
    group = (v1 if v1.exists() else v2).parent / f"polhode-test-{os.getpid()}"
    try:
        group.mkdir()
        (group / (v1 if v1.exists() else v2).name).write_text("60000000")
    except OSError as error:
        pytest.skip(f"this user may not limit memory: {error}")
    yield group
    sandbox.close()
    while (group / "cgroup.procs").read_text():
        time.sleep(0.01)
    group.rmdir()


def test_a_process_that_the_kernel_kills_for_memory_is_no_fault_of_the_student(sandbox, little_memory):
    sandbox.wait_ready()
    (little_memory / "cgroup.procs").write_text(str(zygote_pid(sandbox)))
    with pytest.raises(SystemFault, match="no memory left"):
        sandbox.play(job("def f():\n    return len(b'x' * 200_000_000)"))


def test_a_submission_that_kills_itself_is_not_taken_for_one_without_memory(sandbox):
    result = sandbox.play(job("import os\ndef f():\n    os.kill(os.getpid(), 9)"))
    assert result.scene_ends["one"].ended is Ended.KILLED


def test_a_guest_that_cannot_be_killed_costs_no_result(sandbox, monkeypatch, caplog):
    killed = []

    def never_exits(self, timeout=None):
        killed.append(self)
        raise subprocess.TimeoutExpired(self.args, timeout)

    with monkeypatch.context() as patched:
        patched.setattr(subprocess.Popen, "wait", never_exits)
        result = sandbox.play(job("import os\ndef f():\n    os.abort()"))
    assert result.scene_ends["one"].ended is Ended.KILLED and "could not be killed" in caplog.text
    for process in killed:
        process.wait()
    assert sandbox.play(job("def f():\n    return 1.0")).finished("one")


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
def test_however_a_child_ends_its_result_is_whole(sandbox, source):
    result = sandbox.play(job(f"{source}\ndef f():\n    return 1.0"))
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


def test_bytes_after_the_last_frame_are_not_accepted(sandbox):
    assert sandbox.play(job(LATE)).scene_ends["one"].ended is Ended.PROTOCOL


def with_setup(setup, source, **more):
    return replace(job(source), setup=f"import numpy as np\n{setup}", **more)


def test_a_child_has_its_own_setup_and_nothing_of_others(sandbox):
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
        assert sandbox.play(asked).arrays["one"]["x"] == expected


def test_a_setup_that_reads_data_files_runs_when_they_are_there(sandbox, tmp_path):
    (tmp_path / "factor").write_text("3.0")
    asked = with_setup(
        "factor = float(open('factor').read())",
        "def f():\n    return factor",
        data={"factor": tmp_path / "factor"},
    )
    for _ in range(4):
        assert sandbox.play(asked).arrays["one"]["x"] == 3.0


THREAD = """
import threading
try:
    threading.Thread(target=threading.Event().wait, daemon=True).start()
except RuntimeError:
    pass
"""


def test_a_setup_starts_no_thread_that_escapes_the_layers(sandbox):
    asked = with_setup(THREAD, "def f():\n    return threading.active_count()")
    assert [sandbox.play(asked).arrays["one"]["x"] for _ in range(4)] == [1.0] * 4


def test_a_file_that_a_setup_keeps_open_is_not_taken_for_a_pipe_of_the_play(sandbox):
    asked = with_setup("import os\nopened = open(os.devnull)", "def f():\n    opened.close()\n    return 1.0")
    assert [sandbox.play(asked).finished("one") for _ in range(4)] == [True] * 4
