"""What counts as an answer, on the server and in ``polhode.check``: functions, variables, classes, and the
data files they read.
"""

import dataclasses
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from exercises.authoring.assignments.validation import errors
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.kit import environment, installed

LAB = Path(__file__).parents[1] / "assignments" / "lab_course"
MODEL = "def model(x):\n    return 2 * x\n"
RESIDUAL = "def residual(predicted, y):\n    return np.sum((predicted - y) ** 2)\n"
TOTAL = "def total():\n    return np.loadtxt('points.csv').sum() + float(open('runs/first.csv').read())\n"
VALUES = "slope = 2.0\ng = 9.81\n"
PENDULUM = "class Pendulum:\n    count = 0\n    def step(self):\n        self.count += 1\n"
SKELETON = """class Pendulum:
    '''A pendulum.'''
    def step(self):
        '''Make a step.'''
    @property
    def count(self): ...
"""
EMPTY = "slope = ...\ng = None\ndef total():\n    pass\n"


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    folder = shutil.copytree(
        LAB, tmp_path_factory.mktemp("course") / "lab_course", ignore=shutil.ignore_patterns("__pycache__")
    )
    with known(folder) as found:
        yield found.valid["lab-course"]


@pytest.fixture(scope="module")
def home(lab, tmp_path_factory):
    """A student's folder with the kit below kit/."""
    return installed(tmp_path_factory.mktemp("student"), "lab-course").parent


KERNEL = """
import json, sys
sys.path.insert(0, "kit")
import polhode
polhode.connect(assignment="lab-course")
reports = []
for source in json.load(sys.stdin):
    names = {"polhode": polhode}
    exec(open("kit/Setup").read() + source, names)
    report = eval("polhode.check()", names)
    reports.append([repr(report), [e.number for e in report.exercises], report.summary()])
print(json.dumps(reports))
"""


def checked(home, lab, *sources):
    (home / "kit" / "Setup").write_text(lab.setup)
    command = [sys.executable, "-P", "-W", "error", "-c", KERNEL]
    done = subprocess.run(
        command,
        input=json.dumps(sources),
        capture_output=True,
        text=True,
        timeout=60,
        cwd=home,
        env=environment(home / "kit"),
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


CASES = {
    "all": (MODEL + RESIDUAL + TOTAL + VALUES + PENDULUM, "✓✓✓✓✓✓", "1234", "6 of 6"),
    "one exercise of two functions": (MODEL + RESIDUAL, "✓✓", "1", "2 of 6"),
    "one function of the two": (RESIDUAL, "–✓", "1", "1 of 6"),
    "a variable": ("slope = np.float64(2)\n", "✓–", "3", "1 of 6"),
    "a wrong variable": ("slope = 3\ng = '9.81'\n", "✗–", "3", "0 of 6"),
    "nothing but skeletons": (MODEL + SKELETON + EMPTY, "✓–", "1", "1 of 6"),
    "a number instead of a class": (MODEL + "Pendulum = 3.0\n", "✓–", "1", "1 of 6"),
}


@pytest.fixture(scope="module")
def local(home, lab):
    return dict(zip(CASES, checked(home, lab, *[source for source, *_ in CASES.values()]), strict=True))


@pytest.mark.parametrize("case", CASES)
def test_the_server_and_the_kit_take_the_same_answers(case, lab, local, sandbox):
    source, marks, exercises, points = CASES[case]
    report = grade(Submission(source), lab, sandbox, 1).report
    lines, numbers, summary = local[case]
    assert ("".join(o.line[0] for o in report.outcomes()), "".join(e.number for e in report.exercises)) == (
        marks,
        exercises,
    )
    assert report.summary().startswith(f"{points} points")
    assert (lines, numbers) == (report.lines(), [e.number for e in report.exercises])
    assert summary.startswith(f"{points} public checks ✓")


def test_what_is_no_function_is_named(lab, home, sandbox):
    source = "Pendulum = 3.0\nmodel = None\n" + RESIDUAL
    report = grade(Submission(source), lab, sandbox, 1, ["1", "4"]).report
    lines = [
        "[not measured: model is None, not a function]",
        "[not measured: Pendulum is of type float, not a function]",
    ]
    model, _, pendulum = (o.line.partition("   ")[2] for o in report.outcomes())
    assert [model, pendulum] == lines


ESCAPES = """
import os
import numpy as np

def attempt(action):
    try:
        action()
    except (OSError, ValueError):
        return 0
    return 1

def total():
    assert sorted(os.listdir(".")) == ["points.csv", "runs"] and os.listdir("runs") == ["first.csv"]
    done = attempt(lambda: open("../assignment.py")) + attempt(lambda: os.listdir(".."))
    done += attempt(lambda: open(FOLDER + "/points.csv")) + attempt(lambda: open(FOLDER + "/assignment.py"))
    done += attempt(lambda: os.listdir(FOLDER)) + attempt(lambda: open(FOLDER + "/points.csv", "a"))
    return POINTS.sum() + 3.0 + done
"""


def test_data_files_can_be_read_and_nothing_else(lab, either_sandbox):
    source = f"FOLDER = {os.fspath(lab.folder)!r}\n{ESCAPES}"
    report = grade(Submission(source), lab, either_sandbox, 1).report
    (outcome,) = report.outcomes()
    assert outcome.line == "✓  the sum of both files   [max|Δ| = 0 (rtol=1e-12, atol=1e-12)]"


def test_a_submission_changes_its_own_copy_of_a_data_file(lab, either_sandbox):
    spoil = "with open('points.csv', 'w') as file:\n    file.write('7\\n')\n"
    for source, mark in ((spoil + TOTAL, "✗"), (TOTAL, "✓")):
        report = grade(Submission(source), lab, either_sandbox, 1).report
        assert [outcome.line[0] for outcome in report.outcomes()] == [mark], report.text()
    assert (lab.folder / "points.csv").read_text() != "7\n"


def test_no_data_file_is_left_for_the_next_submission(lab, rigid_body, either_sandbox):
    grade(Submission(TOTAL), lab, either_sandbox, 1)
    source = "import os\nprint(os.listdir('.'))\ndef euler_eqs(t, w, I):\n    return w\n"
    assert grade(Submission(source), rigid_body, either_sandbox, 1, ["3"]).report.stdout.startswith("[]")


def test_the_kit_leaves_a_data_file_of_the_students_as_it_is(home, lab, tmp_path):
    (tmp_path / "kit").symlink_to(home / "kit")
    (tmp_path / "points.csv").write_text("7\n")
    code = 'import sys; sys.path.insert(0, "kit"); import polhode; polhode.connect(assignment="lab-course")'
    done = subprocess.run(
        [sys.executable, "-P", "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=tmp_path,
        env=environment(home / "kit"),
    )
    assert done.stdout.startswith(f"points.csv in {tmp_path} differs from the course's file")
    assert ((tmp_path / "points.csv").read_text(), (tmp_path / "runs" / "first.csv").read_text()) == (
        "7\n",
        "3.0\n",
    )


def test_wrong_declarations_of_data_and_variables_are_errors(lab, tmp_path):
    (lab.folder / "large.csv").write_bytes(b"0" * 5_000_001)
    names = (
        "points.csv",
        "large.csv",
        "none.csv",
        "../lab_course/points.csv",
        "/etc/passwd",
        "plays.py",
        "samples/x.csv",
        "",
        ".",
    )
    exercises = (
        dataclasses.replace(lab.exercises[0], variables=("slope",), prerequisites=("nothing",)),
        *lab.exercises[1:],
    )
    found = errors(dataclasses.replace(lab, data=names, exercises=exercises))
    assert [error.split(":")[0] for error in found if error.startswith("data")] == [
        "data file large.csv has 5.0 MB; at most 5 MB are allowed",
        "data file none.csv is missing",
        "data file ../lab_course/points.csv",
        "data file /etc/passwd",
        "data file plays.py",
        "data file samples/x.csv",
        "data file ",
        "data file .",
    ]
    assert "exercise 1: the variable slope is not in functions" in found
    assert "exercise 1: no exercise asks for its prerequisite nothing" in found
    same = dataclasses.replace(
        lab.exercises[0], checks=tuple(dataclasses.replace(c, label="x") for c in lab.exercises[0].checks)
    )
    (found,) = errors(dataclasses.replace(lab, exercises=(same, lab.exercises[1])))
    assert (
        found == "exercise 1: several checks have the label 'x': a report shows labels, so give each its own"
    )
    assert errors(dataclasses.replace(lab, data="points.csv")) == [
        "data is 'points.csv', not a tuple of file names"
    ]
    assert errors(lab) == []
