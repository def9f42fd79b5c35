"""Every file of tests/attacks: what it must end as, and that it reached, left and disturbed nothing.

Each runs at one isolation level, in `make test-all` at both. Those of a family that try to get out run
together in one submission at each level, in `make test-all` also one by one; the rest take turns.

A file's first comment says how it ends: ``pass`` (the attack fails and the right answer that we append is
accepted), ``fail`` or ``any``; ``film`` where Exercise 6 is asked, ``slow`` where it runs out of time.
"""

import fcntl
import json
import os
import re
import socket
import subprocess
import tempfile
import threading
import time
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.verdict import Verdict
from polhode.report.dataclass_json import document
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox import job, session
from service.sandbox.isolation.bubblewrap import find_bubblewrap, namespace_isolation
from service.sandbox.isolation.levels import LAYERS, process_isolation
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox
from service.sandbox.zygote import _with_children

HERE = Path(__file__).parents[1] / "attacks"
ATTACKS = sorted(HERE.glob("*.py"))
# seconds each, at every level; process_scheduling and text_forged_place are short, but much like others
LONG = {
    "answers_builtins",
    "answers_by_clock",
    "answers_by_process",
    "answers_doubled",
    "answers_late_calls",
    "answers_numpy_agrees",
    "answers_rounded",
    "compile_huge_constant",
    "cpu_at_import",
    "cpu_ignores_signals",
    "cpu_power",
    "cpu_sleep",
    "cpu_slow_calls",
    "cpu_stops_itself",
    "exit_abort",
    "exit_at_end",
    "film_endless",
    "film_latex",
    "film_of_noise",
    "film_out_of_sight",
    "frames_npy",
    "game_clock",
    "memory_recursion",
    "output_result_flood",
    "output_stalls",
    "process_scheduling",
    "text_forged_place",
    "text_loops",
}
ISOLATION = ("fd", "kernel", "net", "process", "read", "signal", "write")  # families that try to get out
VERDICTS = (
    "answers",
    "compile",
    "cpu",
    "film",
    "frames",
    "game",
    "return",
    "text",
)  # tried without the sandbox by tests of their own
LEVELS = ("namespaces", "process")
CANARY = "CANARY-7f3a-swordfish"
RIGHT = (
    "\nimport numpy as np\n\n\ndef euler_eqs(t, w, I):\n"
    "    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)\n"
)
PRELUDE = """
import ctypes as _ctypes, os as _os
JOB, RESULT, TCP_PORT, UDP_PORT, ABSTRACT = 3, 4, {tcp}, {udp}, {abstract!r}
SECRETS, HOST_CODE, YRANAC = {secrets!r}, {code!r}, {backwards!r}
_libc = _ctypes.CDLL(None, use_errno=True)
_libc.syscall.restype = _ctypes.c_long
def attempt(label, action):
    try:
        answer = action()
    except BaseException as error:
        print(label, "blocked:", type(error).__name__, str(error)[:80])
    else:
        print("ESCAPED", label, repr(answer)[:200])
def raw(number, *arguments):
    given = (_ctypes.c_long(a) if isinstance(a, int) else a for a in arguments)
    answer = _libc.syscall(_ctypes.c_long(number), *given)
    if answer < 0:
        raise OSError(_ctypes.get_errno(), _os.strerror(_ctypes.get_errno()))
    return answer
"""


def family(file):
    return file.stem.split("_")[0]


@pytest.fixture(scope="module")
def traps(tmp_path_factory):
    """Files with a secret, closed to others as a data folder is, and listeners that nobody may touch."""
    folder = tmp_path_factory.mktemp("traps") / "secrets"
    folder.mkdir(mode=0o700)
    for name in ("expected.json", "app.db"):
        (folder / name).write_text(CANARY)
    (folder / "link").symlink_to("app.db")
    with ExitStack() as stack:
        tcp = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        udp = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        udp.bind(("127.0.0.1", 0))
        by_path, abstract = (stack.enter_context(socket.socket(socket.AF_UNIX)) for _ in range(2))
        with suppress(OSError):  # where the path is too long for a socket, the listener is left out
            by_path.bind(str(folder / "canary.sock"))
            by_path.listen()
        abstract.bind(f"\0polhode-canary-{os.getpid()}")
        abstract.listen()
        listeners = (tcp, udp, by_path, abstract)
        for listener in listeners:
            listener.setblocking(False)
        prelude = PRELUDE.format(
            tcp=tcp.getsockname()[1],
            udp=udp.getsockname()[1],
            abstract=abstract.getsockname().decode(),
            secrets=str(folder),
            code=str(HERE.parents[1]),
            backwards=CANARY[::-1],
        )
        os.environ["POLHODE_CANARY"] = CANARY
        yield prelude, listeners
        del os.environ["POLHODE_CANARY"]


@pytest.fixture(scope="module")
def sandboxes(traps):
    """Sandboxes by isolation level, started at first use, while the secret is in the environment."""
    started = {}

    def at(level):
        if level not in started:
            started[level] = Sandbox(choose("namespaces") if level == "namespaces" else process_isolation())
            started[level].self_test()
        return started[level]

    neighbour = Sandbox(process_isolation())  # nothing but the attacker's own sandbox protects it
    neighbour.self_test()
    before = _resident_mib()
    yield at, neighbour
    assert _resident_mib() - before < 96, "the host's memory grew"  # judging films takes 70 once
    for sandbox in (neighbour, *started.values()):
        sandbox.close()


@pytest.fixture
def traces_shared():
    """What attacks leave behind is looked for in places that all processes share: no other one leaves any
    meanwhile.
    """
    with _lock_of_traces(fcntl.LOCK_SH):
        yield


@pytest.fixture
def traces_alone():
    """This test leaves traces on purpose: no other process looks for any meanwhile."""
    with _lock_of_traces(fcntl.LOCK_EX):
        yield


@pytest.fixture(scope="module")
def impatient(rigid_body):
    """The assignment with little time for the first scene, where attacks that never end are stopped."""
    scenes = [replace(s, budget_s=0.4) if s.name == "probes" else s for s in rigid_body.scenes]
    return replace(rigid_body, scenes=type(rigid_body.scenes)(scenes))


@pytest.fixture
def hurry(monkeypatch):
    """Little time to load, and little more than that before the host stops a guest."""
    monkeypatch.setattr("service.grading.sandbox_job.Job", partial(job.Job, load_budget_s=0.4))
    monkeypatch.setattr(session, "GRACE_S", 0.3)


def declared(file):
    """How an attack ends, whether Exercise 6 is asked, and whether it runs out of time."""
    ends = re.match(r'""".*"""\n+# ends: (pass|fail|any)( film)?( slow)?\n', file.read_text())
    assert ends, f"the first comment of {file} says how it ends"
    return ends[1], bool(ends[2]), bool(ends[3])


def attacks():
    """Every attack at both levels; ``make test`` has each short one at one of them, of those against verdicts
    every third one.

    Those that try to get out in vain are tried there in one submission for each family instead.
    """
    for _, files in groupby(ATTACKS, family):
        for k, file in enumerate(files):
            first = "process" if family(file) in ISOLATION else LEVELS[k % 2]
            for level in LEVELS:
                together = family(file) in ISOLATION and declared(file)[0] == "pass"
                spared = (k % 3 and family(file) in VERDICTS) or file.stem in LONG or together
                marks = [] if level == first and not spared else [pytest.mark.slow]
                yield pytest.param(level, file, id=f"{level}-{file.stem}", marks=marks)


@pytest.mark.parametrize(("level", "file"), [*attacks()])
def test_attack(level, file, sandboxes, traps, rigid_body, impatient, request, traces_shared):
    at, neighbour = sandboxes
    sandbox, (prelude, listeners) = at(level), traps
    verdict, film, slow = declared(file)
    if slow:
        request.getfixturevalue("hurry")
    source = file.read_text()
    needs_answer = verdict != "fail" and "def euler_eqs" not in source
    code = prelude + source + (RIGHT if needs_answer else "")
    before = _traces()
    with _beside(neighbour) as unharmed:
        graded = grade(
            Submission(code), impatient if slow else rigid_body, sandbox, 3, ["6" if film else "2"]
        )
        report = graded.report
        assert unharmed() and _plays(sandbox) and _plays(sandbox)
    if _is_in_vain(file, sandbox, level):
        assert "ESCAPED" not in report.stdout, report.stdout
    assert CANARY not in json.dumps(document(report)) and CANARY not in report.text()
    if verdict == "pass":
        assert report.passed, report.text() + report.stdout[:2000]
    elif verdict == "fail":
        assert not report.passed, report.text()
    assert all(o.verdict in Verdict and o.line for o in report.outcomes())
    _untouched(listeners)
    assert not _traces() - before and _scratch_is_empty(sandbox)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("of", ISOLATION)
def test_all_attacks_of_a_family_in_one_submission_are_in_vain(
    of, level, sandboxes, traps, rigid_body, traces_shared
):
    """All attacks of the family that fail without an end to the submission, one after the other in a single
    one.
    """
    sandbox, (prelude, listeners) = sandboxes[0](level), traps
    files = [file for file in ATTACKS if family(file) == of and declared(file)[0] == "pass"]
    files = [file for file in files if _is_in_vain(file, sandbox, level)]
    tried = [file.read_text() + f'\nprint("tried {file.stem}")\n' for file in files]
    before = _traces()
    report = grade(Submission("\n".join([prelude, *tried, RIGHT])), rigid_body, sandbox, 3, ["2"]).report
    assert files and all(f"tried {file.stem}\n" in report.stdout for file in files), report.stdout
    assert "ESCAPED" not in report.stdout, report.stdout
    assert CANARY not in json.dumps(document(report))
    assert report.passed and _plays(sandbox), report.text()
    _untouched(listeners)
    assert not _traces() - before


SLOW = pytest.mark.slow  # the family's test at that level is red without the layer


@pytest.mark.parametrize(
    ("level", "missing", "attack"),
    [
        ("namespaces", "namespaces", "read_metadata"),
        pytest.param("namespaces", "landlock", "read_system", marks=SLOW),
        pytest.param("namespaces", "seccomp", "net_unix", marks=SLOW),
        pytest.param("namespaces", "limits", "memory_shared_map", marks=SLOW),
        ("process", "landlock", "read_system"),
        ("process", "seccomp", "net_tcp"),
        ("process", "limits", "memory_shared_map"),
    ],
)
def test_no_layer_is_decoration(level, missing, attack, traps, rigid_body, traces_alone):
    """Without it, an attack that the others let through succeeds."""
    layers = [x for x in LAYERS if x != missing]
    isolation = (
        namespace_isolation(find_bubblewrap(), layers)
        if level == "namespaces" and missing != "namespaces"
        else process_isolation(layers)
    )
    if missing == "namespaces":  # the guest as the server's own user, as an ordinary user's server has it
        isolation = replace(
            isolation,
            inside=(*isolation.inside[:-1], isolation.inside[-1].replace('"user": 64001', '"user": null')),
        )
    holed = Sandbox(isolation)
    try:
        source = traps[0] + (HERE / f"{attack}.py").read_text()
        assert "ESCAPED" in grade(Submission(source), rigid_body, holed, 3, ["2"]).report.stdout
    finally:
        holed.close()
        _drain(traps[1])
        subprocess.run(
            ["ipcrm", "-M", "0x1234", "-S", "0x1234", "-Q", "0x1234"], capture_output=True, check=False
        )


def test_there_are_enough_attacks_and_each_says_what_it_tries():
    assert len(ATTACKS) >= 174 and {family(file) for file in ATTACKS} >= set(ISOLATION)
    assert all(re.match(r'"""[A-Z].*\."""\n+# ends: ', f.read_text()) for f in ATTACKS)


GOOD = job.Job(
    "import numpy as np",
    "def ask(student, inputs):\n    return {'x': student['np'].array(student['f'](3.0))}",
    (
        job.Cell(
            "submission.py",
            "import builtins\ndef f(x):\n    return [x, np.pi, hasattr(builtins, 'poisoned')]",
        ),
    ),
    ("f",),
    (job.SceneRequest("one", "ask", "f", {}, {"x": ArraySpec((3,))}, 2.0, None),),
)


def _plays(sandbox):
    """Whether a good submission gets its due, with nothing of another's in its memory."""
    return sandbox.play(GOOD).arrays.get("one", {}).get("x", np.zeros(3)).tolist() == [3.0, np.pi, 0.0]


@contextmanager
def _beside(sandbox):
    """Good submissions played in another sandbox all the while; gives a function that tells whether all got
    their due.
    """
    sandbox.start()  # from this thread: a guest dies with the thread that started it
    over, results = threading.Event(), []

    def play():
        while not over.is_set():
            results.append(_plays(sandbox))
            over.wait(0.5)

    def unharmed():
        over.set()
        thread.join(60)
        return bool(results) and all(results)

    thread = threading.Thread(target=play)
    thread.start()
    try:
        yield unharmed
    finally:
        unharmed()


def _is_in_vain(file, sandbox, level):
    """Whether an attack at this level fails: what files there are is hidden from other users only."""
    return file.stem != "read_metadata" or level != "process" or _other_user(sandbox)


def _other_user(sandbox):
    return '"user": 64001' in sandbox.isolation.command[-1]


def _drain(listeners):
    """Forget what a test without a layer sent on purpose."""
    for listener in listeners:
        with suppress(OSError):
            listener.recv(1) if listener.type == socket.SOCK_DGRAM else listener.accept()[0].close()


def _untouched(listeners):
    for listener in listeners:
        with pytest.raises(OSError):
            listener.recv(1) if listener.type == socket.SOCK_DGRAM else listener.accept()


def _scratch_is_empty(sandbox):
    """Whether the guest has no folder any more when it has removed the last child's."""
    rooms, until = sandbox.start().wait_ready() and _rooms(sandbox), time.monotonic() + 5
    while time.monotonic() < until:
        if not any(any(room.iterdir()) for room in rooms):
            return True
        time.sleep(0.01)
    return False


def _rooms(sandbox):
    """The folders of a guest's scratch folders, which root sees in namespaces too."""
    started = sandbox.start()._started
    if sandbox.isolation.level == "process":
        return [started.data.parent / "scratch"]
    if os.geteuid() != 0:
        return []
    inside = next(pid for pid in _with_children(started.process.pid) if _is_python(pid))
    return [Path(f"/proc/{inside}/root/polhode/scratch")]


def _is_python(pid):
    return os.path.basename(os.readlink(f"/proc/{pid}/exe")).startswith("python")


def _resident_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4 / 1024


@contextmanager
def _lock_of_traces(how):
    with (Path(tempfile.gettempdir()) / f"polhode-tests-{os.getuid()}.lock").open("w") as lock:
        fcntl.flock(lock, how)
        yield


def _traces():
    """Shared memory, queues, files in common folders: what a submission could have left behind."""
    found = set()
    for kind in ("shm", "sem", "msg"):
        fields = [line.split() for line in Path(f"/proc/sysvipc/{kind}").read_text().splitlines()[1:]]
        found |= {
            (kind, key, id) for key, id, _, size, *_ in fields if (kind, size) != ("shm", "56")
        }  # a PostgreSQL's has 56
    for folder in ("/dev/shm", "/tmp", "/"):
        found |= {(folder, name) for name in os.listdir(folder) if re.search("left|evil|fill|daemon", name)}
    return found
