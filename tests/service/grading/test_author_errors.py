"""Errors in an assignment's own code are system faults with file and line; what a student causes stays a
verdict.
"""

import json

import pytest

from polhode.judging.judge import Verdict
from polhode.judging.outcome import Ended
from service.grading import rendering
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.result import SystemFault, ignore
from tests.support.assignments import change, known

FILES = {
    "assignment.py": (
        """import numpy as np

from polhode.judging.checks import close
from polhode.judging.exercise import Exercise, Figure
from exercises.authoring.assignments.assignment import ArraySpec, Scene
from exercises.authoring.questions.author import Notebook


def draw(rng):
    return {"x": rng.uniform(1.0, 2.0, 4)}


def exact(inputs):
    return {"y": 2.0 * np.asarray(inputs["x"])}


def returned(seen):
    return seen["y"]


def wanted(truth):
    return truth["y"]


def plot(canvas, seen, truth):
    canvas.subplots().plot(seen[0]["y"])


SCENE = Scene("points", "points", "double", draw, {"y": ArraySpec((4,))}, exact, 2.0)
NEAR = {"rtol": 1e-9, "atol": 0.0, "reason": "rounding"}
CHECK = close("1-points", "double is right", "points", measured=returned, expected=wanted, **NEAR)
FIGURE = Figure("values", "Values", "points", ("points",), plot)
EXERCISE = Exercise("1", "Doubling", ("double",), (CHECK,), (FIGURE,))
notebook = Notebook("Doubling", setup="import numpy as np\\n", scenes=(SCENE,))
notebook.own_exercise(EXERCISE)
"""
    ),
    "plays.py": (
        """import numpy as np


def points(student, inputs):
    answer = student["double"](np.array(inputs["x"]))
    values = answer["y"]
    return {"y": np.array(values)}
"""
    ),
    "samples/right_dict.py": "def double(x):\n    return {'y': 2 * x}\n",
}
RIGHT = FILES["samples/right_dict.py"]


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / "doubling" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "doubling" / name).write_text(text)
    return tmp_path / "doubling"


def graded(folder, sandbox, source=RIGHT):
    with known(folder) as catalogue:
        assert not catalogue.invalid, catalogue.invalid
        return grade(Submission(source), catalogue.valid["doubling"], sandbox, 1)


def test_without_an_error_it_is_graded(folder, sandbox):
    assert graded(folder, sandbox).report.passed


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("plays.py", 'inputs["x"]', 'inputs["length"]', "scene points: plays.py line 5: KeyError: 'length'"),
        (
            "plays.py",
            "np.array(values)",
            "np.array(vallues)",
            "scene points: plays.py line 7: NameError: name 'vallues'",
        ),
        ("plays.py", 'answer["y"]', 'answer["z"]', "scene points: plays.py line 6: KeyError: 'z'"),
        (
            "plays.py",
            '{"y":',
            '{"z":',
            "plays.py line 4: points returned the arrays z; the scene declares the arrays y",
        ),
        (
            "plays.py",
            "np.array(values)",
            "values[:, None]",
            r"points returned y with shape (4, 1); the scene declares (4,)",
        ),
        ("plays.py", "np.array(values)", "[str(v) for v in values]", "points returned y with dtype <U"),
        ("plays.py", "np.array(values)}", "values}.popitem()", "points returned tuple, not a dict of arrays"),
        pytest.param(
            "plays.py",
            "import numpy as np\n",
            "import numpy as np\nimport nowhere\n",
            "plays.py line 2: ModuleNotFoundError",
            marks=pytest.mark.slow,
        ),  # starts a new guest
        pytest.param(
            "assignment.py",
            'setup="import numpy as np',
            'setup="1 / 0',
            "Setup line 1: ZeroDivisionError",
            marks=pytest.mark.slow,
        ),  # starts a new guest
        ("assignment.py", "rng.uniform(", "rng.uniforms(", "assignment.py line 10: AttributeError"),
        ("assignment.py", 'inputs["x"]', 'inputs["z"]', "assignment.py line 14: KeyError: 'z'"),
        (
            "assignment.py",
            'return seen["y"]',
            'return seen["z"]',
            "check 1-points: assignment.py line 18: KeyError: 'z'",
        ),
        (
            "assignment.py",
            'return truth["y"]',
            'return truth["y"] @ 1',
            "check 1-points: assignment.py line 22: ValueError",
        ),
        (
            "assignment.py",
            'return truth["y"]',
            'return truth["y"][:3]',
            "check 1-points: assignment.py line 21: ValueError: shape (4,)",
        ),
        (
            "assignment.py",
            'return truth["y"]',
            'return str(truth["y"])',
            "check 1-points: assignment.py line 21: TypeError",
        ),
    ],
)
def test_an_error_of_the_author_is_a_fault_with_file_and_line(folder, sandbox, file, old, new, message):
    change(folder / file, old, new)
    with pytest.raises(SystemFault) as fault:
        graded(folder, sandbox)
    assert message in str(fault.value), fault.value
    assert str(folder) not in str(fault.value)


def test_an_error_in_a_figure_is_a_fault_with_file_and_line(folder, sandbox):
    change(folder / "assignment.py", 'seen[0]["y"])', 'truth[0]["y"][4])')
    with known(folder) as catalogue:
        assignment = catalogue.valid["doubling"]
        arrays = grade(Submission(RIGHT), assignment, sandbox, 1).arrays
        with pytest.raises(SystemFault, match=r"figure values: assignment.py line 26: IndexError"):
            rendering.draw(assignment, rendering.find(assignment, "values"), arrays, 1, "png")


@pytest.mark.parametrize("sample", [True, False], ids=["with a right sample", "without one"])
@pytest.mark.parametrize(
    ("source", "error"),
    [
        ("def double(x): return {}", "KeyError: 'y'"),
        ("def double(x): return None", "TypeError: 'NoneType' object is not subscriptable"),
        ("def double(x): return object()", "TypeError: 'object' object is not subscriptable"),
        ("def double(x): return {'y': x[:3]}", "points returned y with shape (3,)"),
        ("double = len", "TypeError: 'int' object is not subscriptable"),
    ],
)
def test_what_the_student_returned_is_no_error_of_the_author(folder, sandbox, sample, source, error):
    if not sample:
        (folder / "samples" / "right_dict.py").unlink()
    report = graded(folder, sandbox, source).report
    (outcome,), (end,) = report.outcomes(), report.scene_ends
    assert outcome.verdict is Verdict.UNMEASURED and end.ended is Ended.WRONG_ANSWER
    assert (
        "the checks could not call double or use what it returned (" in outcome.line and error in outcome.line
    )


def test_without_a_right_sample_an_error_of_the_author_is_recognized_too(folder, sandbox):
    (folder / "samples" / "right_dict.py").unlink()
    change(folder / "plays.py", 'answer["y"]', 'answr["y"]')
    with pytest.raises(SystemFault, match=r"plays.py line 6: NameError: name 'answr'"):
        graded(folder, sandbox)


@pytest.mark.parametrize("sample", [True, False], ids=["with a right sample", "without one"])
def test_a_submission_cannot_forge_an_error_of_the_author(folder, sandbox, sample):
    if not sample:
        (folder / "samples" / "right_dict.py").unlink()
    event = {"event": "scene", "scene": "points", "ended": "raised", "sentence": "KeyError: 'y'"}
    forged = json.dumps(event | {"author": "plays.py line 5: KeyError: 'x'"})
    source = f"import os, struct\ndef double(x):\n    data = {forged.encode()!r}\n"
    source += "    os.write(4, struct.pack('<cI', b'J', len(data)) + data)\n    os._exit(0)\n"
    (outcome,) = graded(folder, sandbox, source).report.outcomes()
    assert outcome.verdict is Verdict.UNMEASURED and "KeyError: 'y'" in outcome.line


def test_the_exception_of_a_student_stays_one(folder, sandbox):
    report = graded(folder, sandbox, "def double(x):\n    return x['y']\n").report
    assert (
        report.scene_ends[0].ended is Ended.RAISED and "line 2, in double" in report.scene_ends[0].traceback
    )
    report = graded(folder, sandbox, "double = eval('lambda x: 1 // 0')\n").report
    assert report.scene_ends[0].ended is Ended.RAISED and "ZeroDivisionError" in report.scene_ends[0].sentence


def test_the_right_submission_is_never_in_the_process_of_a_students(folder, sandbox):
    (folder / "samples" / "right_dict.py").write_text(RIGHT + "SECRET = 'the right' + ' solution'\n")
    searches = """
import gc
def double(x):
    found = [o for o in gc.get_objects() if isinstance(o, dict) and 'SECRET' in o]
    return {} if not found else {'y': 2 * x}
"""
    (outcome,) = graded(folder, sandbox, searches).report.outcomes()
    assert outcome.verdict is Verdict.UNMEASURED


def test_polhode_grade_reports_no_verdict(folder, polhode):
    change(folder / "plays.py", 'inputs["x"]', 'inputs["length"]')
    with known(folder):
        told = polhode("grade", folder / "samples" / "right_dict.py", "--assignment", "doubling", "--json")
    (entry,) = json.loads(told.stdout)["reports"]
    assert (
        told.returncode == 2
        and entry["report"] is None
        and "plays.py line 5: KeyError: 'length'" in entry["system_fault"]
    )


@pytest.mark.parametrize(
    "text",
    [
        "from .public.setting import LENGTH",
        "from .import public",
        "from \\\n    . import public",
        "from exercises.doubling import draw",
        "import service.settings",
    ],
)
def test_plays_that_import_what_the_guest_does_not_have_are_an_error_of_the_declaration(folder, text):
    change(folder / "plays.py", "import numpy as np\n", f"import numpy as np\n{text}\n")
    with known(folder) as catalogue:
        (error,) = catalogue.invalid["doubling"].errors
    assert error.startswith("plays.py line 2: the sandbox and the kit have no ")


ONE_FILE = """from exercises.authoring.questions.author import Notebook, Tolerance, integers, uniform
from exercises.authoring.kinds.values import values

notebook = Notebook("Halving", setup="")


def half(x):
    return x / 2


def exact(x):
    return 0.5 * x


notebook.exercise(
    "1",
    "Halving",
    values(
        half,
        ask={"x": uniform(1, 2)},
        truth=exact,
        agree=Tolerance(rtol=1e-9, reason="rounding"),
    ),
)
"""


@pytest.mark.parametrize(
    ("old", "new", "source", "message"),
    [
        (
            "return 0.5 * x",
            "return [0.5 * x, x]",
            None,
            (
                "assignment.py line 18: question 1: ValueError: the truth does not answer as the right"
                " solution does for the first input: half must return a number; it returned shape (2,)"
            ),
        ),
        (
            "return 0.5 * x",
            "return 0.5 * y",
            None,
            "assignment.py line 12: NameError: name 'y' is not defined",
        ),
        (
            "uniform(1, 2)",
            "integers(2, 1)",
            None,
            "assignment.py line 18: question 1: ValueError: low > high",
        ),
        (
            "return x / 2",
            "return x / 0",
            "def half(x): return x / 2",
            "assignment.py line 8: ZeroDivisionError",
        ),
    ],
)
def test_an_error_in_a_declaration_of_one_file_is_a_fault_with_its_line(
    tmp_path, sandbox, old, new, source, message
):
    (tmp_path / "halving").mkdir()
    text = ONE_FILE.replace(old, new)
    (tmp_path / "halving" / "assignment.py").write_text(text)
    assert text != ONE_FILE
    with known(tmp_path / "halving") as catalogue, pytest.raises(SystemFault) as fault:
        grade(Submission(source or "def half(x): return x / 2"), catalogue.valid["halving"], sandbox, 1)
    assert str(fault.value).startswith(f"assignment halving has an error: {message}"), fault.value


def test_what_a_submission_says_of_the_authors_code_is_checked_within_its_own_time(
    folder, sandbox, monkeypatch
):
    """The right submission is played for each scene whose error the child attributes to the author."""
    forged = """
import json, os, struct
def J(**event):
    data = json.dumps(event).encode(); os.write(4, struct.pack("<cI", b"J", len(data)) + data)
def forge():
    J(event="defined", names=["double"], missing=[])
    J(event="start", scene="points")
    J(event="scene", scene="points", ended="raised", sentence="x", author="plays.py line 6: KeyError: 'y'")
    J(event="done")
    os._exit(0)
forge()
"""
    budgets, play = [], sandbox.play
    monkeypatch.setattr(
        sandbox,
        "play",
        lambda job, on_scene=ignore, budget=None: budgets.append(budget) or play(job, on_scene, budget),
    )
    report = graded(folder, sandbox, forged).report
    assert not report.passed and len(budgets) == 2 and budgets[0] is budgets[1]
