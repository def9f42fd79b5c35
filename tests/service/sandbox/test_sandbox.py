"""The sandbox by its effect: what a submission can do is what it could do when it tried."""

import ctypes
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox import session, zygote
from service.sandbox.isolation.levels import Isolation
from service.sandbox.isolation.select import choose
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from tests.support.isolation import BY_THE_HOST
from tests.support.machines import children

PLAYS = """
import numpy as np

def ask(student, inputs):
    return {"x": np.asarray(student["f"](*inputs["args"]), dtype=float)}
"""


@pytest.fixture(autouse=True)
def short_waits(monkeypatch):
    """Let the host wait less long for a guest that does not come back."""
    monkeypatch.setattr(session, "GRACE_S", 0.5)
    monkeypatch.setattr(zygote, "ANSWER_S", 1.5)


def job(source, *scenes, function="f"):
    played = scenes or (scene("one"),)
    return Job("import numpy as np", PLAYS, (Cell("submission.py", source),), (function,), tuple(played))


def scene(name, args=(1.0,), budget_s=1.0, after=None):
    return SceneRequest(name, "ask", "f", {"args": list(args)}, {"x": ArraySpec((2,))}, budget_s, after)


GOOD = "def f(x):\n    return [x, 2 * x]"


def attempt(sandbox, body):
    """Run ``body`` as a submission and return what it printed as JSON lines."""
    seen = sandbox.play(job(f"import json\n{body}"))
    return [json.loads(line) for line in seen.stdout.splitlines() if line.startswith(("[", "{", '"'))]


def test_arrays_come_back(either_sandbox):
    seen = either_sandbox.play(job(GOOD, scene("one", [1.0]), scene("two", [2.5])))
    assert seen.arrays["one"]["x"].tolist() == [1.0, 2.0] and seen.arrays["two"]["x"].tolist() == [2.5, 5.0]
    assert seen.defined == {"f"}


@BY_THE_HOST
@pytest.mark.parametrize(
    ("body", "scene_end", "code"),
    [
        ("def f(x):\n    while True: pass", Ended.TIMED_OUT, "timeout"),
        ("import time\ndef f(x):\n    time.sleep(60)", Ended.TIMED_OUT, "timeout"),
        (
            (
                "def f(x):\n    while True:\n        try:\n            while True: pass\n"
                "        except BaseException: pass"
            ),
            Ended.TIMED_OUT,
            "timeout",
        ),
        (
            (
                "import signal\nsignal.pthread_sigmask(signal.SIG_BLOCK, range(1, 60))\ndef f(x):\n"
                "    while True: pass"
            ),
            Ended.TIMED_OUT,
            "timeout",
        ),
        ("def f(x):\n    raise KeyError(x)", Ended.RAISED, "raises"),
        ("def f(x):\n    raise SystemExit(0)", Ended.RAISED, "raises"),
        ("def f(x):\n    return f(x)", Ended.RAISED, "raises"),
        ("def f(x):\n    return eval('1 +')", Ended.SYNTAX, "syntax-error"),
        ("import os\ndef f(x):\n    os._exit(0)", Ended.EXITED, None),
        ("import ctypes\ndef f(x):\n    ctypes.string_at(0)", Ended.KILLED, None),
        ("def f(x):\n    return bytearray(1 << 33)", Ended.MEMORY, "memory"),
        ("def f(x):\n    return [0] * (1 << 33)", Ended.MEMORY, "memory"),
        ("import sys\ndef f(x):\n    while True: print('x' * 100000)", Ended.OUTPUT, None),
        ("def g(x):\n    return x", Ended.MISSING, "missing-function"),
    ],
)
def test_endings_and_the_next_submission_is_unharmed(either_sandbox, body, scene_end, code):
    budget_s = 0.3 if scene_end is Ended.TIMED_OUT else 5.0
    seen = either_sandbox.play(job(body, scene("one", budget_s=budget_s)))
    assert (seen.scene_ends["one"].ended, seen.scene_ends["one"].code) == (scene_end, code)
    assert "one" not in seen.arrays
    assert either_sandbox.play(job(GOOD)).finished("one")


@pytest.mark.slow
def test_a_budget_is_CPU_time_with_a_longer_limit_by_the_clock(sandbox):
    def play(statement):
        return sandbox.play(
            job(f"import time\ndef f(x):\n    {statement}\n    return [x, x]", scene("one", budget_s=0.2))
        )

    assert play("time.sleep(0.4)").finished("one"), "a wait, as on a loaded machine, costs no CPU time"
    assert play("while True: pass").scene_ends["one"].sentence == "your code used more than 0.2 s of CPU time"
    assert (
        play("time.sleep(9)").scene_ends["one"].sentence.startswith("your code did not finish within 0.8 s")
    )


@BY_THE_HOST
@pytest.mark.parametrize(
    ("body", "scene_end"),
    [
        ("import os\ndef f(x):\n    os.write(4, b'J' + bytes(100))", Ended.PROTOCOL),
        ("def f(x):\n    return [1.0, 2.0, 3.0]", Ended.RAISED),
    ],
)
def test_what_is_no_result_is_not_believed_and_the_next_submission_is_unharmed(
    either_sandbox, body, scene_end
):
    seen = either_sandbox.play(job(body))
    assert seen.scene_ends["one"].ended is scene_end and "one" not in seen.arrays
    assert either_sandbox.play(job(GOOD)).finished("one")


@BY_THE_HOST
def test_one_stall_costs_one_scene(either_sandbox):
    body = (
        "import signal\ndef f(x):\n    signal.pthread_sigmask(signal.SIG_BLOCK, [14])\n"
        "    while x == 2.0: pass\n    return [x, x]"
    )
    seen = either_sandbox.play(
        job(
            body, scene("a", [1.0]), scene("b", [2.0], budget_s=0.2), scene("c", [3.0]), scene("d", after="b")
        )
    )
    assert seen.finished("a") and seen.finished("c")
    assert seen.scene_ends["b"].ended is Ended.TIMED_OUT and seen.scene_ends["d"].ended is Ended.NOT_PLAYED


def test_a_failing_cell_is_told_and_the_others_run(sandbox):
    cells = (
        Cell("cell 1", "%matplotlib inline\n!ls\nx = 1"),
        Cell("cell 2", "1 / 0"),
        Cell("cell 3", "%%time\n" + GOOD),
    )
    seen = sandbox.play(Job("", PLAYS, cells, ("f",), (scene("one"),)))
    assert seen.finished("one")
    trace = seen.cells["cell 2"].traceback
    assert "ZeroDivisionError" in trace and "cell 2" in trace and "play.py" not in trace


def test_traceback_shows_only_the_students_lines(sandbox):
    seen = sandbox.play(
        job("def helper(x):\n    return np.linalg.inv([[0.0]])\n\ndef f(x):\n    return helper(x)")
    )
    trace = seen.scene_ends["one"].traceback
    assert "line 5, in f" in trace and "line 2, in helper" in trace and "Singular matrix" in trace
    assert "plays.py" not in trace and "linalg.py" not in trace


def test_no_file_of_the_host_is_there(sandbox, tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("swordfish")
    tried = [
        str(secret),
        "/etc/passwd",
        "/etc/shadow",
        "/proc/self/environ",
        "/root/.bashrc",
        str(Path(__file__).resolve()),
    ]
    body = f"""
import os
told = []
for path in {tried!r}:
    try:
        told.append(open(path).read()[:20])
    except OSError as error:
        told.append(type(error).__name__)
print(json.dumps(told))
print(json.dumps([os.path.exists(p) for p in {tried!r}]))
"""
    opened, existing = attempt(sandbox, body)
    assert set(opened) <= {"FileNotFoundError", "PermissionError"} and not any(existing)


def test_neither_reference_nor_truth_can_be_imported(sandbox):
    names = [
        "reference",
        "exercises",
        "exercises.rigid_body.draws",
        "service",
        "fastapi",
        "sqlalchemy",
        "psycopg",
        "pydantic",
    ]
    body = f"""
import importlib, sys
told = {{}}
for name in {names!r}:
    try:
        importlib.import_module(name); told[name] = "there"
    except ImportError:
        told[name] = "not there"
print(json.dumps(told))
"""
    assert set(attempt(sandbox, body)[0].values()) == {"not there"}


def test_secret_environment_does_not_cross(monkeypatch):
    monkeypatch.setenv("POLHODE_CANARY", "swordfish")
    guarded = Sandbox(choose())
    try:
        assert "swordfish" not in json.dumps(
            attempt(guarded, "import os\nprint(json.dumps(dict(os.environ)))")
        )
    finally:
        guarded.close()


def test_nothing_can_be_written_outside_of_the_working_folder(sandbox):
    body = """
import os, sys, numpy
told = []
own = ["/polhode", "/polhode/code", "/polhode/code/polhode", "/polhode/data", "/polhode/scratch", ".."]
own += ["/polhode/matplotlib"]
for folder in [*own, "/", "/tmp", "/dev", os.path.dirname(numpy.__file__), "/polhode/scratch/1"]:
    try:
        open(os.path.join(folder, "left"), "w").write("x"); told.append(folder)
    except OSError:
        pass
    try:
        os.mkdir(os.path.join(folder, "left.d")); told.append(folder)
    except OSError:
        pass
print(json.dumps(told))
"""
    assert attempt(sandbox, body) == [[]]


def test_the_folders_around_its_own_can_be_neither_listed_nor_read(sandbox):
    body = """
import os
told = []
for folder in ["/polhode", "/polhode/scratch", "..", "../..", "/polhode/matplotlib"]:
    try:
        told += [folder, *os.listdir(folder)]
    except PermissionError:
        pass
print(json.dumps(told))
"""
    assert attempt(sandbox, body) == [[]]


def test_no_network(sandbox):
    with socket.create_server(("127.0.0.1", 0)) as listener, socket.socket(socket.AF_UNIX) as abstract:
        listener.settimeout(0.2)
        abstract.bind(f"\0polhode-canary-{os.getpid()}")
        abstract.listen()
        body = _CONNECT.replace("PORT", str(listener.getsockname()[1])).replace(
            "NAME", repr(abstract.getsockname().decode())
        )
        assert attempt(sandbox, body) == [[]]
        with pytest.raises(TimeoutError):
            listener.accept()


_CONNECT = """
import socket
told = []
addresses = [(socket.AF_INET, ("127.0.0.1", PORT)), (socket.AF_INET, ("8.8.8.8", 53)), (socket.AF_UNIX, NAME)]
for family, address in addresses:
    try:
        with socket.socket(family) as s:
            s.settimeout(1); s.connect(address); told.append(str(address))
    except OSError:
        pass
print(json.dumps(told))
"""


def test_no_process_outlives_its_submission_and_none_can_be_signalled(either_sandbox):
    body = """
import os, time
children = 0
try:
    for _ in range(200):
        if os.fork() == 0:
            os.setsid(); time.sleep(60); os._exit(0)
        children += 1
except OSError:
    pass
reached = []
for pid in [*range(1, 400), os.getppid()]:
    if pid != os.getpid():
        try:
            os.kill(pid, 0); reached.append(pid)
        except OSError:
            pass
print(json.dumps({"children": children, "reached": len(reached)}))
"""
    _adopt_orphans(True)
    try:
        before = _guests()
        (told,) = attempt(either_sandbox, body)
        assert told == {"children": 0, "reached": 0}
        time.sleep(0.3)
        assert _guests() == before
    finally:
        _adopt_orphans(False)
    assert either_sandbox.play(job(GOOD)).finished("one")


def _adopt_orphans(yes):
    """Whether a descendant of ours whose parent ends becomes our child (PR_SET_CHILD_SUBREAPER) and not the
    machine's.
    """
    assert ctypes.CDLL(None, use_errno=True).prctl(36, int(yes), 0, 0, 0) == 0


def _guests():
    """How many guests descend from us; others' come and go."""
    told = subprocess.run(
        ["ps", "-eo", "pid=,ppid=,args="], capture_output=True, text=True, check=True
    ).stdout
    found = {
        int(pid): (int(parent), args)
        for pid, parent, args in (line.split(None, 2) for line in told.splitlines())
    }

    def ours(pid):
        return pid == os.getpid() or (pid in found and ours(found[pid][0]))

    return sum("guest.zygote" in args and ours(pid) for pid, (_, args) in found.items())


def test_no_privilege_is_left(either_sandbox):
    body = """
import ctypes, os
libc = ctypes.CDLL(None, use_errno=True)
told = {"uid": os.getuid(), "unshare": libc.unshare(0x00020000)}
told["mount"] = libc.mount(b"none", b"/polhode/scratch", b"tmpfs", 0, None)
try:
    os.setuid(0); told["root"] = True
except OSError:
    told["root"] = False
print(json.dumps(told))
"""
    (told,) = attempt(either_sandbox, body)
    assert told["uid"] != 0
    assert told["unshare"] == -1 and told["mount"] == -1 and told["root"] is False


def test_submissions_do_not_see_each_other(either_sandbox):
    either_sandbox.play(
        job(
            "import numpy, builtins, sys\nnumpy.pi = 3\nbuiltins.left = 1\nsys.modules['left'] = sys\n"
            "np.random.seed(1)\n" + GOOD
        )
    )
    body = (
        "import sys, builtins\nprint(json.dumps([np.pi, hasattr(builtins, 'left'), 'left' in sys.modules]))"
    )
    assert attempt(either_sandbox, body) == [[np.pi, False, False]]


@BY_THE_HOST
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_a_dead_or_frozen_zygote_is_noticed_replaced_and_its_job_played(either_sandbox, how):
    killed = zygote_pid(either_sandbox)
    os.kill(killed, how)
    assert either_sandbox.play(job(GOOD)).finished("one")
    assert zygote_pid(either_sandbox) != killed


@pytest.mark.slow
@BY_THE_HOST
def test_a_zygote_lost_in_the_middle_costs_nothing(either_sandbox):
    """What the first child had sent is forgotten, and all of it is played again."""
    either_sandbox.wait_ready()
    end = threading.Timer(0.4, os.kill, (zygote_pid(either_sandbox), signal.SIGKILL))
    end.start()
    slow = "import time\ndef f(x):\n    time.sleep(0.1)\n    return [x, x]"
    seen = either_sandbox.play(job(slow, *(scene(f"s{k}") for k in range(8))))
    end.join()
    assert all(seen.finished(f"s{k}") and f"s{k}" in seen.arrays for k in range(8)), seen.scene_ends


def test_devnull_takes_what_is_printed_to_it(either_sandbox):
    body = (
        "import contextlib, os\nwith contextlib.redirect_stdout(open(os.devnull, 'w')):\n    print('x')\n"
        + GOOD
    )
    assert either_sandbox.play(job(body)).finished("one")


@BY_THE_HOST
def test_our_own_code_failing_is_a_fault_and_never_the_students(either_sandbox):
    broken = Job("1 / 0", PLAYS, (Cell("submission.py", GOOD),), ("f",), (scene("one"),))
    with pytest.raises(
        SystemFault, match=r"before the submission ran: Setup line 1: ZeroDivisionError: division by zero"
    ):
        either_sandbox.play(broken)
    assert either_sandbox.play(job(GOOD)).finished("one")


@pytest.mark.slow
@BY_THE_HOST
def test_a_zygote_that_is_lost_twice_is_a_fault(monkeypatch, either_sandbox):
    start = either_sandbox.start

    def start_and_kill():
        started = start()
        either_sandbox.wait_ready = None
        os.kill(zygote_pid(either_sandbox), signal.SIGKILL)
        return started

    either_sandbox.wait_ready()
    monkeypatch.setattr(either_sandbox, "start", start_and_kill)
    with pytest.raises(SystemFault):
        either_sandbox.play(job(GOOD))
    monkeypatch.undo()
    del either_sandbox.wait_ready
    assert either_sandbox.play(job(GOOD)).finished("one")


def zygote_pid(sandbox):
    """The zygote's own process, behind bubblewrap's if there is one,
    or the last of these that has started.
    """
    pid = sandbox._zygote._started.process.pid
    while not os.path.basename(os.readlink(f"/proc/{pid}/exe")).startswith("python") and (
        below := children(pid)
    ):
        pid = below[0]
    return pid


@pytest.mark.slow
def test_a_zygote_is_recycled_after_many_plays_and_after_an_odd_one(monkeypatch, sandbox):
    monkeypatch.setattr("service.sandbox.sandbox.MOST_PLAYS", 2)
    sandbox.close()
    sandbox.play(job(GOOD))
    first = sandbox._zygote
    sandbox.play(job(GOOD))
    assert sandbox._zygote is not first
    second = sandbox._zygote
    sandbox.play(job("import ctypes\ndef f(x):\n    ctypes.string_at(0)"))
    assert sandbox._zygote is not second


HOST = """
import time
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox
from service.sandbox.isolation.levels import process_isolation
sandbox = Sandbox(ISOLATION)
sandbox.self_test()
print(sandbox._zygote._started.process.pid, flush=True)
time.sleep(60)
"""


@pytest.mark.slow
@pytest.mark.parametrize("isolation", ["choose('namespaces')", "process_isolation()"])
def test_nothing_survives_a_killed_server(isolation):
    process = subprocess.Popen(
        [sys.executable, "-c", HOST.replace("ISOLATION", isolation)], stdout=subprocess.PIPE, text=True
    )
    pid = int(process.stdout.readline())
    process.kill()
    process.wait()
    process.stdout.close()
    deadline = time.monotonic() + 1
    while _alive(pid):
        assert time.monotonic() < deadline, "the guest outlived its server"
        time.sleep(0.05)


def _alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_a_sandbox_that_does_not_start_is_a_fault():
    fake = Isolation(
        "namespaces", ("bubblewrap",), (sys.executable, "-c"), ("print('no sandbox here')",), dict(os.environ)
    )
    with pytest.raises(SystemFault, match="no sandbox here"):
        Sandbox(fake).self_test()
