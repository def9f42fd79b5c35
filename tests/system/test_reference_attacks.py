"""What a submission does to get at the reference functions of another process, and to that process: it learns
only their values.
"""

import re
import textwrap

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox import session
from service.sandbox.isolation.bubblewrap import find_bubblewrap, namespace_isolation
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.job import Cell, Job, ReferenceFunctions, SceneRequest
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeBudget, TimeLimits

CANARY = "reference_canary_5e1f"
REFERENCE = f'''
def step(f, x):
    """{CANARY}"""
    {CANARY} = "{CANARY}"
    return f(x) + 1
'''
PLAYS = "def ask(student, inputs):\n    return {'x': student['np'].array(student['later'](inputs['x']))}"
PRELUDE = f"""
import ctypes, gc, json, os, struct, sys, types
YRANAC = "{CANARY[::-1]}"  # backwards: the searches shall not find their own text
libc = ctypes.CDLL(None, use_errno=True)
libc.syscall.restype = ctypes.c_long
def search(label, *found):
    found = [x.decode("latin-1") if isinstance(x, bytes) else x for x in found]
    texts = [x if isinstance(x, str) else repr(x) for x in found]
    if any(YRANAC in text[::-1] for text in texts):
        print("ESCAPED", label)
def search_code(label, code):
    search(label, code.co_consts, code.co_names, code.co_varnames)
def attempt(label, action):
    try:
        return action()
    except Exception as error:
        print(label, "blocked:", type(error).__name__, str(error)[:80])
"""
LATER = "\ndef later(x):\n    return step(lambda x: 2 * x, x)\n"
ATTACKS = {
    "closure": (
        """
        def parts(value, depth=0):
            yield value
            if depth < 6:
                for part in gc.get_referents(value):
                    if not isinstance(part, (types.ModuleType, dict)) or depth < 2:
                        yield from parts(part, depth + 1)
        for value in parts(step):
            if isinstance(value, (str, bytes)):
                search("closure", value)
            elif isinstance(value, types.CodeType):
                search_code("closure", value)
        """
    ),
    "objects": (
        """
        for value in gc.get_objects():
            for part in [value, *gc.get_referents(value)]:
                if isinstance(part, types.CodeType):
                    search_code("objects", part)
                elif isinstance(part, (str, bytes)):
                    search("objects", part)
        """
    ),
    "frames": (
        """
        def look(x):
            frame = sys._getframe()
            while frame:
                search_code("frames", frame.f_code)
                search("frames", *map(repr, frame.f_locals.values()))
                frame = frame.f_back
            return x
        step(look, 1.0)
        """
    ),
    "exception": (
        """
        def raises(x):
            raise ValueError
        try:
            step(raises, 1.0)
        except ValueError as error:
            trace = error.__traceback__
            while trace:
                search_code("exception", trace.tb_frame.f_code)
                search("exception", *map(repr, trace.tb_frame.f_locals.values()))
                trace = trace.tb_next
        for arguments in ((), (1,), ("x" * 10, None), (None, 1)):
            try:
                step(*arguments)
            except Exception as error:
                search("exception", repr(error), repr(error.__dict__))
        """
    ),
    "proc": (
        """
        pids = {os.getpid() + k for k in range(-6, 7)} | {os.getppid(), 1}
        pids |= {int(name) for name in attempt("list", lambda: os.listdir("/proc")) or () if name.isdigit()}
        for pid in pids - {os.getpid()}:
            for name in ("mem", "environ", "maps", "stack", "fd/3"):
                if attempt(f"{pid}/{name}", lambda: open(f"/proc/{pid}/{name}", "rb").read(100)) is not None:
                    print("ESCAPED proc", pid, name)
        """
    ),
    "kernel": (
        """
        def raw(number, *arguments):
            given = (ctypes.c_long(a) if isinstance(a, int) else a for a in (number, *arguments))
            found = libc.syscall(*given)
            if found < 0:
                raise OSError(ctypes.get_errno(), "")
            return found
        buffer = ctypes.create_string_buffer(64)
        here, there = ((ctypes.c_size_t * 2)(at, 64) for at in (ctypes.addressof(buffer), id(YRANAC)))
        CALLS = [
            ("ptrace", 101, (16, "pid", 0, 0)),
            ("process_vm_readv", 310, ("pid", here, 1, there, 1, 0)),
        ]
        CALLS += [
            ("kill", 62, ("pid", 9)),
            ("tgkill", 234, ("pid", "pid", 9)),
            ("pidfd_open", 434, ("pid", 0)),
        ]
        for pid in range(os.getpid() - 6, os.getpid() + 7):
            for label, number, arguments in CALLS if pid != os.getpid() else ():
                given = [pid if x == "pid" else x for x in arguments]
                if attempt(label, lambda: raw(number, *given)) is not None:
                    print("ESCAPED", label, pid)
        """
    ),
    "descriptors": (
        """
        for fd in [*range(6, 100)]:
            if attempt(str(fd), lambda: os.fstat(fd)) is not None:
                print("ESCAPED descriptor", fd)
        """
    ),
    "calls": (
        """
        def ask(*message):
            text = json.dumps(message).encode()
            os.write(5, struct.pack("<II", len(text), len(text)) + text)
            length, header = struct.unpack("<II", os.read(5, 8))
            return os.read(5, length)
        names = ("eval", "exec", "__import__", "open", "globals", "later", "step.__code__", "?")
        for target in (*names, 0, 1, 2, -1):
            for value in ("1", f"step.__code__.co_consts", 0):
                search("call", ask("call", target, ["tuple", value], ["dict"]))
        nodes = ["function", 0, "f"], ["function", -1, "__import__"], ["dict", ["__class__", "x"]]
        for node in (*nodes, ["complex", 1, 2]):
            safe = node[0] != "function"
            search("value", ask("call", "step", ["tuple", node, 1], ["dict"]) if safe else b"")
        search("raise", ask("call", "step", ["tuple", "text", "x"], ["dict"]))
        """
    ),
}
ENDS = {
    "garbage": ("os.write(5, b'\\x80\\x04garbage!')", Ended.PROTOCOL, ""),
    "huge length": ("os.write(5, b'\\xff' * 8)", Ended.PROTOCOL, ""),
    "answer without a call": (
        "os.write(5, struct.pack('<II', 13, 13) + b'[\"return\", 1]')",
        Ended.PROTOCOL,
        "",
    ),
    "closed": ("os.close(5)", Ended.RAISED, "the process of the reference functions stopped"),
    "raising": ("step(lambda x: 1 / 0, 1.0)", Ended.RAISED, "ZeroDivisionError"),
    "recursion": ("g = lambda x: step(g, x); g(1.0)", Ended.RAISED, "RecursionError: more than 20 calls"),
    "exit": ("step(lambda x: sys.exit(3), 1.0)", Ended.RAISED, "SystemExit"),
    "kill": ("step(lambda x: os.kill(os.getpid(), 9), 1.0)", Ended.KILLED, ""),
    "never": ("step(lambda x: [0 for _ in iter(int, 1)], 1.0)", Ended.TIMED_OUT, "0.3 s"),
    "object": ("step(lambda x: object(), 1.0)", Ended.RAISED, "cannot exchange a value of type object"),
    "large": ("step(lambda x: np.zeros(1 << 22), 1.0)", Ended.RAISED, "larger than 16 MiB"),
    "many lists": ("step(lambda x: [[]] * 1_500_000, 1.0)", Ended.RAISED, "more memory than the process of"),
    "many lists passed": ("step([[]] * 1_500_000, 1.0)", Ended.RAISED, "more memory than the process of"),
    "flood": ("os.write(5, b'[' * (1 << 24))", Ended.PROTOCOL, ""),
}


LONG = {"many lists": 30.0, "many lists passed": 30.0}  # CPU seconds that they may need


@pytest.fixture(scope="module")
def sandboxes():
    started = {
        "process": Sandbox(process_isolation()),
        "namespaces": Sandbox(namespace_isolation(find_bubblewrap())),
    }
    yield started
    for sandbox in started.values():
        sandbox.close()


@pytest.fixture(autouse=True)
def short_waits(monkeypatch):
    monkeypatch.setattr(session, "GRACE_S", 0.3)


def played(sandbox, source, scenes=1, budget_s=5.0, reference=REFERENCE):
    requests = [
        SceneRequest(f"s{k}", "ask", "later", {"x": k + 1.0}, {"x": ArraySpec(())}, budget_s, None)
        for k in range(scenes)
    ]
    cells = (Cell("submission.py", PRELUDE + source),)
    functions = ReferenceFunctions(("step",), reference)
    return sandbox.play(
        Job("import numpy as np", PLAYS, cells, ("later",), tuple(requests), reference=functions)
    )


def unharmed(sandbox):
    result = played(sandbox, LATER, 2)
    return [result.arrays[f"s{k}"]["x"].tolist() for k in range(2)] == [3.0, 5.0]


@pytest.mark.parametrize("level", ["process", "namespaces"])
def test_the_reference_cannot_be_read(sandboxes, level):
    sandbox = sandboxes[level]
    source = "\n".join(
        f"{textwrap.dedent(attack)}\nprint('tried', {name!r})" for name, attack in ATTACKS.items()
    )
    result = played(sandbox, source + LATER, 2)
    assert not result.cells, result.cells
    assert all(f"tried {name}\n" in result.stdout for name in ATTACKS), result.stdout
    assert "ESCAPED" not in result.stdout and CANARY not in result.stdout, result.stdout
    assert [result.arrays[f"s{k}"]["x"].tolist() for k in range(2)] == [3.0, 5.0] and unharmed(sandbox)


def test_each_search_finds_the_reference_where_the_submission_itself_has_it(sandboxes):
    """A search that finds nothing anywhere proves nothing."""
    for name in ("closure", "objects"):
        result = played(
            sandboxes["process"],
            REFERENCE.replace("def step", "def own") + textwrap.dedent(ATTACKS[name]).replace("step", "own"),
        )
        assert "ESCAPED" in result.stdout, name


@pytest.mark.slow
def test_processes_of_the_same_user_cannot_read_it_without_the_other_layers_either():
    """Only the refusal to be traced (PR_SET_DUMPABLE) is left."""
    sandbox = Sandbox(process_isolation(["limits"]))
    try:
        proc = textwrap.dedent(ATTACKS["proc"]).replace(
            ', "maps", "stack", "fd/3"', ""
        )  # "maps" opens, and cannot be read
        kernel = re.sub(r"(?s)\nCALLS \+= \[.*?\n\]", "", textwrap.dedent(ATTACKS["kernel"]))
        result = played(sandbox, f"{proc}{kernel}print('tried')\n{LATER}")
        assert "tried" in result.stdout and "ESCAPED" not in result.stdout, result.stdout
        assert (
            "environ blocked: PermissionError" in result.stdout
            and "process_vm_readv blocked: PermissionError" in result.stdout
        )
    finally:
        sandbox.close()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else []) for name in ENDS]
)
@pytest.mark.parametrize("level", ["process", pytest.param("namespaces", marks=pytest.mark.slow)])
def test_a_scene_that_misuses_the_calls_ends_with_a_sentence(sandboxes, level, name):
    action, ended, sentence = ENDS[name]
    source = f"def later(x):\n    if x == 1:\n        {action}\n    return step(lambda x: 2 * x, x)\n"
    budget_s = 0.3 if name == "never" else LONG.get(name, 5.0)
    result = played(sandboxes[level], source, 2, budget_s=budget_s)
    assert result.scene_ends["s0"].ended is ended and sentence in result.scene_ends["s0"].sentence, (
        result.scene_ends
    )
    if ended is not Ended.PROTOCOL:
        assert result.arrays["s1"]["x"] == 5.0, result.scene_ends  # the other scene is unharmed
    assert unharmed(sandboxes[level])


def test_a_scene_does_not_wait_for_a_reference_that_sleeps(sandboxes):
    reference = "import time\ndef step(f, x):\n    time.sleep(1000 if x == 1 else 0)\n    return f(x) + 1\n"
    result = played(sandboxes["process"], LATER, 2, 0.1, reference)
    assert result.scene_ends["s0"].ended is Ended.TIMED_OUT and result.arrays["s1"]["x"] == 5.0, (
        result.scene_ends
    )
    assert unharmed(sandboxes["process"])


@pytest.mark.slow
def test_right_solutions_that_cannot_be_loaded_are_a_system_fault(sandboxes):
    with pytest.raises(SystemFault, match="the right solutions: NameError: name 'missing' is not defined"):
        played(sandboxes["process"], LATER, reference="missing")


@pytest.mark.slow
def test_both_processes_are_charged_and_each_has_the_limit(sandboxes):
    """The submission computes for 0.4 s, then the reference until the kernel ends it after about a second."""
    reference = ReferenceFunctions(("step",), "def step(f, x):\n    for _ in iter(int, 1): pass\n")
    source = (
        "import time\ndef later(x):\n    while time.process_time() < before + 0.4: pass\n"
        "    return step(abs, x)\n"
    )
    cells = (Cell("submission.py", f"{source}before = time.process_time()\n"),)
    requests = (SceneRequest("s0", "ask", "later", {"x": 1.0}, {"x": ArraySpec(())}, 5.0, None),)
    budget = TimeBudget(TimeLimits(cpu_s=1.0))
    job = Job("import numpy as np", PLAYS, cells, ("later",), requests, reference=reference)
    result = sandboxes["process"].play(job, budget=budget)
    assert (
        budget.cpu_s > 1.1
        and "the process of the reference functions stopped" in result.scene_ends["s0"].sentence
    )
