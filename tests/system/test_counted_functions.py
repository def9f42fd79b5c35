"""What a submission does to make more calls of a function argument than it says, or to read what the function
knows: the calls are counted where the function is, in another process.
"""

import numpy as np
import pytest

from exercises.authoring.assignments.catalogue import find
from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.sandbox_job import draw_inputs, job_of
from service.grading.submission import Submission
from tests.support.isolation import BY_THE_HOST

SEED = 5
BISECTION = """
def bisect(f, a, b):
    fa = f(a)
    while b - a > 1e-12 * max(abs(a), abs(b)):
        middle = (a + b) / 2
        value = f(middle)
        a, b, fa = (middle, b, value) if (value > 0) == (fa > 0) else (a, middle, fa)
    return (a + b) / 2
"""
FEW = """
from scipy.optimize import brentq
def find_root(f, a, b, tol):
    return brentq(f, a, b, xtol=1e-15, rtol=1e-14)
"""
FORGED = {
    "counter": "def find_root(f, a, b, tol):\n    x = bisect(f, a, b)\n    f.calls = 2\n    return x\n",
    "frames": """
import sys
def find_root(f, a, b, tol):
    x, frame = bisect(f, a, b), sys._getframe()
    while frame:
        for value in list(frame.f_locals.values()):
            for one in value.values() if isinstance(value, dict) else [value]:
                if hasattr(one, "calls"):
                    one.calls = 2
        frame = frame.f_back
    return x
""",
    "class": """
import polhode.kinds.student_calls as asking
asking.Counted.__call__ = lambda self, *values: self.function(*values)
find_root = lambda f, a, b, tol: bisect(f, a, b)
""",
    "the function below": "find_root = lambda f, a, b, tol: bisect(f.function, a, b)\n",
    "the channel": """
def find_root(f, a, b, tol):
    parts = dict(zip(f.function.__code__.co_freevars, f.function.__closure__))
    channel, target = parts["self"].cell_contents, parts["target"].cell_contents
    return bisect(lambda x: channel.call(target, x), a, b)
""",
    "bytes on the socket": """
import json, os, struct
def find_root(f, a, b, tol):
    parts = dict(zip(f.function.__code__.co_freevars, f.function.__closure__))
    target = parts["target"].cell_contents
    def ask(x):
        text = json.dumps(["call", target, ["tuple", x], ["dict"]]).encode()
        os.write(5, struct.pack("<II", len(text), len(text)) + text)
        length, header = struct.unpack("<II", os.read(5, 8))
        kind, answer = json.loads(os.read(5, length)[:header])
        return answer if isinstance(answer, float) else f(x)
    return bisect(ask, a, b)
""",
}

FORGED["many places at once"] = """
def find_root(f, a, b, tol):
    for _ in range(12):
        x = np.linspace(a, b, 17)
        try:
            y = f(x)
        except ValueError:  # not for arrays
            return bisect(f, a, b)
        above = int(np.argmax(y > 0))
        a, b = x[above - 1], x[above]
    return (a + b) / 2
"""


@pytest.fixture(scope="module")
def waves():
    return find("waves")


def calls(assignment, sandbox, source):
    """The outcomes of the number of calls, and of the values, of both scenes with inputs for find_root."""
    report = grade(Submission(source), assignment, sandbox, SEED, ["1"]).report
    found = {o.id: o for o in report.outcomes() if o.id.startswith("1-1")}
    counted = [o for id, o in found.items() if "calls" in id]
    return counted, [o for id, o in found.items() if "calls" not in id]


def test_few_calls_are_few(waves, sandbox):
    counted, values = calls(waves, sandbox, FEW)
    assert len(counted) == 2 and {o.verdict for o in [*counted, *values]} == {Verdict.PASS}, counted


@pytest.mark.parametrize("name", FORGED)
@BY_THE_HOST
def test_many_calls_are_many_whatever_the_submission_says_of_them(waves, either_sandbox, name):
    counted, values = calls(waves, either_sandbox, BISECTION + FORGED[name])
    assert {o.verdict for o in values} == {Verdict.PASS}, [o.line for o in values]
    assert {o.verdict for o in counted} == {Verdict.FAIL}, [o.line for o in counted]


FINDS = """
import gc, sys, types
from scipy.optimize import brentq
SEEN = set()
def numbers(value, depth):
    if isinstance(value, (float, np.floating)):
        SEEN.add(float(value))
    elif isinstance(value, np.ndarray) and value.dtype.kind == "f":
        SEEN.update(value.ravel().tolist())
    elif depth < 5 and not isinstance(value, (types.ModuleType, str, bytes, type)):
        for part in gc.get_referents(value):
            if depth < 2 or not isinstance(part, types.FrameType):
                numbers(part, depth + 1)
def find_root(f, a, b, tol):
    frame = sys._getframe()
    while frame:
        for value in list(frame.f_locals.values()):
            numbers(value, 0)
        frame = frame.f_back
    numbers(f, 0)
    for one in gc.get_objects():
        if type(one) in (dict, list, tuple):
            numbers(one, 3)
    for name, halves in HALVES.items():  # doubled here: the search shall not find its own text
        if any(2 * half in SEEN for half in halves):
            print("FOUND", name)
    return brentq(f, a, b, xtol=1e-15, rtol=1e-14)
"""


@BY_THE_HOST
def test_the_numbers_of_a_function_are_not_in_the_process_that_it_is_passed_to(waves, either_sandbox):
    inputs = {**draw_inputs(waves.scene("1-1-hidden"), SEED), **draw_inputs(waves.scene("1-2-hidden"), SEED)}
    ends = {0.1, 10.0, 1e-6, 1e3}  # which are drawn more often, and are numbers of other code too
    halves = {name: [x / 2 for x in np.ravel(column) if x not in ends] for name, column in inputs.items()}
    halves = {name: list(map(float, column)) for name, column in halves.items()}
    assert halves.keys() == {"w", "d", "size", "steepness", "part", "a", "b"}
    report = grade(Submission(f"HALVES = {halves}\n{FINDS}"), waves, either_sandbox, SEED, ["1"]).report
    assert set(report.stdout.splitlines()) == {"FOUND a", "FOUND b"}, report.stdout  # they are arguments


@pytest.mark.parametrize("slug", ["waves", "integrators", "random-walks"])
def test_no_job_of_a_submission_has_numbers_from_which_a_function_is_made_apart(slug):
    assignment = find(slug)
    scenes = [s for s in assignment.scenes if s.question is not None and not s.question.get("part")]
    inputs = {s.name: draw_inputs(s, SEED) for s in scenes}
    job = job_of(Submission(""), assignment, scenes, inputs)
    apart = [request for request in job.scenes if request.apart is not None]
    assert apart
    for request in apart:
        assert not request.inputs.keys() & request.apart.inputs.keys()
        assert (
            request.together.inputs.keys() == dict(inputs[request.name]).keys() | request.apart.inputs.keys()
        )
