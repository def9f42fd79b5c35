"""What a child has given up before it reads a submission: resources, open files, capabilities."""

import json
import resource
import subprocess
import sys

from service.sandbox.job import Cell, Job, SceneRequest

MIB = 1 << 20
SCENE = SceneRequest("one", "ask", "f", {}, {}, 1.0, None)
LIMITS = {
    "RLIMIT_AS": 768 * MIB,
    "RLIMIT_DATA": 512 * MIB,
    "RLIMIT_STACK": 8 * MIB,
    "RLIMIT_CPU": 60,
    "RLIMIT_NOFILE": 32,
    "RLIMIT_NPROC": 1,
    "RLIMIT_FSIZE": 16 * MIB,
    "RLIMIT_CORE": 0,
    "RLIMIT_MEMLOCK": 0,
    "RLIMIT_MSGQUEUE": 0,
}


def printed(sandbox, source):
    """Return the JSON that ``source`` prints as a submission that defines nothing."""
    seen = sandbox.play(Job("", "", (Cell("submission.py", source),), ("f",), (SCENE,)))
    return json.loads(seen.stdout)


def test_every_resource_is_limited(either_sandbox):
    numbers = {name: getattr(resource, name) for name in LIMITS}
    source = (
        "import json, resource\nprint(json.dumps({k: resource.getrlimit(n) for k, n in"
        f" {numbers!r}.items()}}))"
    )
    found = printed(either_sandbox, source)
    assert {name: soft for name, (soft, _) in found.items()} == LIMITS
    assert all(hard == soft + (name == "RLIMIT_CPU") for name, (soft, hard) in found.items()), (
        "a child cannot raise them again"
    )


def test_no_file_is_open_but_those_of_the_play(either_sandbox):
    source = """
import json, os
def is_open(number):
    try:
        os.fstat(number)
    except OSError:
        return False
    return True
print(json.dumps([number for number in range(4096) if is_open(number)]))
"""
    folders = json.loads(either_sandbox.isolation.command[-1])[
        "folders"
    ]  # root opens those below folders closed to the guest
    others = [number for number in printed(either_sandbox, source) if number > 4]
    assert printed(either_sandbox, source)[:5] == [0, 1, 2, 3, 4] and len(others) == len(folders)


def test_a_child_may_ask_about_itself(either_sandbox):
    """What Python, NumPy and a submission that times itself call works, with process id 0 and with the
    child's own.
    """
    source = """
import json, os, resource, threading, time
import numpy as np
clocks = [name for name in dir(time) if name.startswith("CLOCK_")]
actions = {name: lambda name=name: time.clock_gettime(getattr(time, name)) for name in clocks}
actions |= {name + " resolution": lambda name=name: time.clock_getres(getattr(time, name)) for name in clocks}
for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time"):
    actions[name] = getattr(time, name)
actions |= {
    "sleep": lambda: time.sleep(1e-3),
    "processors": os.cpu_count,
    "group": os.getpgrp,
    "limit": lambda: resource.getrlimit(resource.RLIMIT_CPU),
    "usage": lambda: resource.getrusage(resource.RUSAGE_SELF),
    "event": lambda: threading.Event().wait(1e-3),
    "name of the thread": lambda: setattr(threading.current_thread(), "name", "other"),
    "linear algebra": lambda: np.linalg.eigh(np.ones((200, 200))),
}
for pid in (0, os.getpid()):
    actions[f"affinity {pid}"] = lambda pid=pid: os.sched_getaffinity(pid)
    actions[f"group {pid}"] = lambda pid=pid: os.getpgid(pid)
    actions[f"limit {pid}"] = lambda pid=pid: resource.prlimit(pid, resource.RLIMIT_CPU)
def fails(action):
    try:
        action()
    except Exception as error:
        return repr(error)
failed = {name: error for name, action in actions.items() if (error := fails(action))}
print(json.dumps([len(clocks), failed]))
"""
    clocks, failed = printed(either_sandbox, source)
    assert clocks >= 5 and failed == {}


def test_stepping_down_keeps_no_capability():
    """Also where there is no other user to become."""
    source = (
        "from service.sandbox.guest.confinement.lockdown import drop_privileges\ndrop_privileges(None)\n"
        "print(open('/proc/self/status').read())"
    )
    told = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True).stdout
    held = dict(line.split(":\t") for line in told.splitlines() if line.startswith("Cap"))
    assert {int(held[name], 16) for name in ("CapInh", "CapPrm", "CapEff", "CapAmb")} == {0}
