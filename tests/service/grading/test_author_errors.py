"""Errors in an assignment's own code are system faults with file and line; what a student causes stays a
verdict.
"""

import json

import pytest

from polhode.judging.outcome import Ended
from polhode.judging.verdict import Verdict
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.result import SystemFault, ignore
from tests.support.assignments import change, known
from tests.support.author_notebooks import declared

ASSIGNMENT = """import numpy as np

from exercises.authoring import Notebook, close
from exercises.doubling import shown

notebook = Notebook("notebook.ipynb", title="Doubling")


@notebook.draw
def points(draw):
    return {"x": draw.rng.uniform(1.0, 2.0, 4)}


@notebook.exercise("1", "Doubling")
def doubling(ask):
    double = ask.function("double", points)

    @double.observe
    def values(double, x):
        answer = double(x)
        numbers = answer["y"]
        return np.array(numbers)

    @double.truth(agree=close(rtol=1e-9, atol=0.0, because="rounding"))
    def exact(x):
        return 2.0 * x

    double.figure("values", "Values", "points", shown.plot, shown)
"""
SHOWN = """def plot(canvas, seen, truth):
    canvas.subplots().plot(seen[0]["value"][0])
"""
RIGHT = "def double(x):\n    return {'y': 2 * x}\n"
CELLS = [
    ("markdown", "# Doubling"),
    ("markdown", "## Setup"),
    ("code", "import numpy as np"),
    ("code", RIGHT),
]
NOTEBOOK = {
    "cells": [
        {"cell_type": kind, "id": f"c{k}", "source": text, "metadata": {}}
        for k, (kind, text) in enumerate(CELLS)
    ],
    "metadata": {},
    "nbformat": 4,
    "nbformat_minor": 5,
}
NOTEBOOK["cells"][-1]["metadata"]["tags"] = ["solution"]
for cell in NOTEBOOK["cells"]:
    cell |= {"outputs": [], "execution_count": None} if cell["cell_type"] == "code" else {}
FILES = {"assignment.py": ASSIGNMENT, "shown.py": SHOWN, "notebook.ipynb": json.dumps(NOTEBOOK)}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "doubling").mkdir()
    for name, text in FILES.items():
        (tmp_path / "doubling" / name).write_text(text)
    return tmp_path / "doubling"


def graded(folder, sandbox, source=RIGHT):
    with known(folder) as catalogue:
        assert not catalogue.invalid, catalogue.invalid
        return grade(Submission(source), catalogue.valid["doubling"], sandbox, 1)


def test_without_an_error_it_is_graded(folder, sandbox):
    assert graded(folder, sandbox).report.passed


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("return 2.0 * x", "return 2.0 * x['y']", "assignment.py line 26: IndexError"),
        ("return 2.0 * x", "return 2.0 * x[:3]", "the truth does not answer as the right solution does"),
        ("return 2.0 * x", "return str(x)", "the truth does not answer as the right solution does"),
        ('answer["y"]', 'answer["z"]', "assignment.py line 16: question 1: KeyError: 'z'"),
    ],
)
def test_an_error_of_the_author_is_a_fault_with_file_and_line(folder, sandbox, old, new, message):
    change(folder / "assignment.py", old, new)
    with pytest.raises(SystemFault) as fault:
        graded(folder, sandbox)
    assert message in str(fault.value), fault.value
    assert str(folder) not in str(fault.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rng.uniform(", "rng.uniforms(", "assignment.py line 11: AttributeError"),
        ("np.array(numbers)", "np.array(nummbers)", "assignment.py line 14: NotPortable: it uses nummbers"),
    ],
)
def test_an_error_that_the_declaration_shows_costs_no_grading(folder, old, new, message):
    change(folder / "assignment.py", old, new)
    with known(folder) as catalogue:
        (error,) = catalogue.invalid["doubling"].errors
    assert error.startswith(message)


def test_a_package_that_the_setup_lacks_is_to_be_declared(folder, sandbox):
    change(folder / "notebook.ipynb", "import numpy as np", "import numpy as np\\nimport iniconfig")
    with pytest.raises(SystemFault, match="'iniconfig': name the distribution that has it in packages="):
        graded(folder, sandbox)


def test_an_error_in_a_figure_is_a_fault_with_file_and_line(folder, sandbox):
    change(folder / "shown.py", '["value"][0])', '["value"][40])')
    with known(folder) as catalogue:
        assignment = catalogue.valid["doubling"]
        arrays = grade(Submission(RIGHT), assignment, sandbox, 1).arrays
        with pytest.raises(SystemFault, match=r"figure values: shown.py line 2: IndexError"):
            rendering.draw(assignment, rendering.find(assignment, "values"), arrays, 1, "png")


@pytest.mark.parametrize(
    ("source", "error"),
    [
        ("def double(x): return {}", "KeyError: 'y'"),
        ("def double(x): return None", "TypeError: 'NoneType' object is not subscriptable"),
        ("def double(x): return object()", "TypeError: 'object' object is not subscriptable"),
        ("double = len", "TypeError: 'int' object is not subscriptable"),
    ],
)
def test_what_the_student_returned_is_no_error_of_the_author(folder, sandbox, source, error):
    report = graded(folder, sandbox, source).report
    outcomes, ends = report.outcomes(), report.scene_ends
    assert {o.verdict for o in outcomes} == {Verdict.UNMEASURED}
    assert {end.ended for end in ends} == {Ended.WRONG_ANSWER}
    assert "the checks could not call double or use what it returned (" in outcomes[0].line
    assert error in outcomes[0].line


def test_a_submission_cannot_forge_an_error_of_the_author(folder, sandbox):
    event = {"event": "scene", "scene": "1-public", "ended": "raised", "sentence": "KeyError: 'y'"}
    forged = json.dumps(event | {"author": "question line 3: KeyError: 'x'"})
    source = f"import os, struct\ndef double(x):\n    data = {forged.encode()!r}\n"
    source += "    os.write(4, struct.pack('<cI', b'J', len(data)) + data)\n    os._exit(0)\n"
    first, *_ = graded(folder, sandbox, source).report.outcomes()
    assert first.verdict is Verdict.UNMEASURED and "KeyError: 'y'" in first.line


def test_the_exception_of_a_student_stays_one(folder, sandbox):
    report = graded(folder, sandbox, "def double(x):\n    return x['y']\n").report
    assert (
        report.scene_ends[0].ended is Ended.RAISED and "line 2, in double" in report.scene_ends[0].traceback
    )
    report = graded(folder, sandbox, "double = eval('lambda x: 1 // 0')\n").report
    assert report.scene_ends[0].ended is Ended.RAISED and "ZeroDivisionError" in report.scene_ends[0].sentence


def test_the_right_submission_is_never_in_the_process_of_a_students(folder, sandbox):
    solution = "def double(x):\\n    return {'y': 2 * x}\\n"
    secret = "SECRET = 'the right' + ' solution'\\n"
    change(folder / "notebook.ipynb", solution, secret + solution)
    searches = """
import gc
def double(x):
    found = [o for o in gc.get_objects() if isinstance(o, dict) and 'SECRET' in o]
    return {} if not found else {'y': 2 * x}
"""
    outcomes = graded(folder, sandbox, searches).report.outcomes()
    assert {o.verdict for o in outcomes} == {Verdict.UNMEASURED}


def test_polhode_grade_reports_no_verdict(folder, polhode):
    change(folder / "assignment.py", 'answer["y"]', 'answer["z"]')
    (folder / "mine.py").write_text(RIGHT)
    with known(folder):
        told = polhode("grade", folder / "mine.py", "--assignment", "doubling", "--json")
    (entry,) = json.loads(told.stdout)["reports"]
    assert (
        told.returncode == 2
        and entry["report"] is None
        and "assignment.py line 16: question 1: KeyError: 'z'" in entry["system_fault"]
    )


HALVING = """from exercises.authoring import Notebook, between, close, integer

notebook = Notebook("notebook.ipynb")


@notebook.exercise("1")
def halving(ask):
    half = ask.function("half")
    half.case("a number", x=between(1, 2))

    @half.truth(agree=close(rtol=1e-9, atol=0.0, because="rounding"))
    def exact(x):
        return 0.5 * x
"""
HALF = "def half(x):\n    return x / 2\n"


@pytest.mark.parametrize(
    ("old", "new", "source", "message"),
    [
        (
            "return 0.5 * x",
            "return [0.5 * x, x]",
            None,
            (
                "assignment.py line 9: question 1: ValueError: the truth does not answer as the right"
                " solution does for the first input: half must return a number; it returned shape (2,)"
            ),
        ),
        (
            "return 0.5 * x",
            "return 0.5 * y",
            None,
            "assignment.py line 13: NameError: name 'y' is not defined",
        ),
        (
            "between(1, 2)",
            "integer(2, 1)",
            None,
            "assignment.py line 9: question 1: ValueError: low > high",
        ),
        (
            "return x / 2",
            "return x / 0",
            "def half(x): return x / 2",
            (
                "assignment.py line 9: question 1: ZeroDivisionError: float division by zero"
                " (line 2 of the solution half)"
            ),
        ),
    ],
)
def test_an_error_in_a_truth_a_draw_or_a_solution_is_a_fault_with_its_line(
    tmp_path, sandbox, old, new, source, message
):
    assert (old in HALVING) != (old in HALF)
    home = declared(tmp_path / "halving", HALVING.replace(old, new), HALF.replace(old, new))
    with known(home) as catalogue, pytest.raises(SystemFault) as fault:
        grade(Submission(source or HALF), catalogue.valid["halving"], sandbox, 1)
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
    J(event="start", scene="1-public")
    J(event="scene", scene="1-public", ended="raised", sentence="x", author="question line 3: KeyError: 'y'")
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
