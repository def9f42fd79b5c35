"""``polhode.check`` in a notebook's kernel: the kit from its wheel, alone, prints the server's lines."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import polhode
from polhode.client import local
from polhode.client.local import check
from polhode.client.public_assignment import PublicAssignment, PublicScene
from polhode.judging.author_errors import AuthorError
from polhode.judging.checks import close
from polhode.judging.exercise import Exercise
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.kit import environment

# What they do to a student's functions, each in its own way; those of chance and of syntax cannot be alike.
SAME = [
    "right_ex1_integrals",
    "right_terms",
    "wrong_zeros",
    "wrong_not_finite",
    "wrong_raises",
    "wrong_two_arguments",
    "wrong_mutates_I",
    "wrong_shape_six",
]
LONG = [
    "wrong_time_reversed",
    "wrong_four_arguments",
    "wrong_arguments_exchanged",
    "wrong_mutates_w",
    "wrong_nothing_returned",
    "wrong_shape_ragged_list",
    "wrong_strings",
    "wrong_complex",
    "wrong_function_missing",
    "wrong_raises_name_error",
    "wrong_animation_raises",
    "wrong_moments_cyclic",
    "right_all",
    "right_animation_scatter_tip",
    "wrong_animation_static",
    "wrong_slip_1e-9",
    "wrong_sign_first",
]
KERNEL = """
import contextlib, io, json, sys
import polhode
polhode.connect(assignment="rigid-body")
setup, told = compile({setup!r}, "Setup", "exec"), {{}}
for file, numbers in {files!r}:
    names = {{"__name__": "__main__", "polhode": polhode}}
    exec(setup, names)
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(open(file).read(), file, "exec"), names)
    try:
        report = eval(f"polhode.check(*{{numbers!r}}, assignment='rigid-body')", names)
    except polhode.client.course.UnknownCourse as error:
        told[file] = {{"error": str(error)}}
        continue
    told[file] = {{"lines": repr(report), "text": str(report), "remark": report.remark}}
    if {drawn}:
        told[file]["html"] = report._repr_html_()
for name in ("reference", "exercises", "service", "pydantic", "fastapi", "numba", "IPython"):
    assert name not in sys.modules, name
print(json.dumps(told))
"""


def checked(kit, rigid_body, *files, drawn=False):
    """What a fresh kernel without any of our packages makes of (file, numbers of exercises), with figures if
    ``drawn``.
    """
    listed = [(str(file), numbers) for file, numbers in files]
    code = KERNEL.format(setup=rigid_body.setup, files=listed, drawn=drawn)
    command = [
        sys.executable,
        "-P",
        "-W",
        "error",
        "-c",
        f"import sys; sys.path.insert(0, {str(kit)!r})\n{code}",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, cwd=kit, env=environment(kit))
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    return [told[str(file)] for file, _ in files]


@pytest.mark.parametrize("names", [SAME, pytest.param(LONG, marks=pytest.mark.slow)], ids=["short", "long"])
def test_local_and_remote_lines_are_identical(kit, rigid_body, sandbox, names):
    files = [rigid_body.folder / "samples" / f"{name}.py" for name in names]
    reports = [grade(Submission(file.read_text()), rigid_body, sandbox, 11).report for file in files]
    told = checked(
        kit, rigid_body, *[(f, [e.number for e in r.exercises]) for f, r in zip(files, reports, strict=True)]
    )
    for file, report, here in zip(files, reports, told, strict=True):
        assert here["lines"].split("\n") == [o.line for o in report.outcomes() if not o.hidden], file.name


AUTHORS = """
def twice(student, inputs):
    answer = student["double"](inputs["x"])
    return {"y": np.array(answer["y"] * FACTOR)}
"""


@pytest.fixture
def doubling(monkeypatch):
    """An assignment of the kit with one check, whose plays.py is the text given."""

    def assignment(plays, measured=lambda seen: seen["y"]):
        names = {"__name__": "plays", "np": np}
        exec(compile(plays, "plays.py", "exec"), names)
        returns = {"y": {"shape": [2], "dtype": "float64", "up_to": False}}
        inputs, truth = {"x": np.array([1.0, 2.0])}, {"y": np.array([2.0, 4.0])}
        scene = PublicScene("one", "twice", "double", inputs, [], 2.0, None, truth, returns=returns)
        check = close(
            "1",
            "double is right",
            "one",
            measured=measured,
            expected=lambda t: t["y"],
            rtol=0,
            atol=1e-9,
            reason="exact",
        )
        exercise = Exercise("1", "Doubling", ("double",), (check,))
        known = PublicAssignment("doubling", "1", {}, (exercise,), {"one": scene}, names)
        monkeypatch.setattr(local, "public", lambda slug: known)

    return assignment


def right(x):
    return {"y": 2 * x}


@pytest.mark.parametrize(
    ("plays", "measured", "message"),
    [
        (AUTHORS, None, "scene one: plays.py line 4: NameError: name 'FACTOR' is not defined"),
        (AUTHORS.replace('inputs["x"]', 'inputs["z"]'), None, "scene one: plays.py line 3: KeyError: 'z'"),
        (
            "def twice(student, inputs):\n    return {'z': np.ones(2)}",
            None,
            "scene one: plays.py line 1: twice returned the arrays z;",
        ),
        (
            "def twice(student, inputs):\n    return {'y': np.ones(3)}",
            None,
            "scene one: plays.py line 1: twice returned y with shape",
        ),
        (AUTHORS.replace("FACTOR", "1"), lambda seen: seen["z"], "check 1: test_local.py line"),
    ],
)
def test_an_error_of_the_course_is_none_of_the_student(doubling, monkeypatch, plays, measured, message):
    doubling(plays, *([measured] if measured else []))
    monkeypatch.setitem(globals(), "double", right)
    with pytest.raises(AuthorError) as error:
        check(assignment="doubling")
    assert str(error.value).startswith(f"The assignment doubling has an error, not your code: {message}"), (
        error.value
    )


def test_what_the_student_returned_is_none_of_the_course(doubling, monkeypatch):
    doubling(AUTHORS.replace("FACTOR", "1"))
    monkeypatch.setitem(globals(), "double", lambda x: {})
    (outcome,) = check(assignment="doubling").outcomes()
    assert (
        outcome.detail
        == "not measured: the checks could not call double or use what it returned (KeyError: 'y')"
    )
    monkeypatch.setitem(globals(), "double", right)
    assert check(assignment="doubling").passed


@pytest.fixture(scope="module")
def shown(kit, rigid_body, tmp_path_factory):
    """What one kernel shows of some functions, by name."""
    folder = tmp_path_factory.mktemp("mine")
    sources = {
        "zeros": ((rigid_body.folder / "samples" / "wrong_zeros.py").read_text(), ["2"]),
        "right": ((rigid_body.folder / "samples" / "right_terms.py").read_text(), ["5"]),
        "reversed": ("def euler_eqs(t, w, I):\n    return np.cross(w, I * w) / I\n", ["2", "3"]),
        "sign": (
            "def euler_eqs(t, w, I):\n    a, b, c = np.cross(I * w, w) / I\n    return [a, b, -c]\n",
            ["2"],
        ),
        "stopped": ("def euler_eqs(t, w, I):\n    return 1 / 0\n", ["2"]),
        "markup": ("def principal_moments(tensor):\n    raise ValueError('<script>alert(1)</script>')\n", []),
        "no exercise": ("", ["9"]),
    }
    for name, (source, _) in sources.items():
        (folder / f"{name}.py").write_text(source)
    files = [(folder / f"{name}.py", numbers) for name, (_, numbers) in sources.items()]
    return dict(zip(sources, checked(kit, rigid_body, *files, drawn=True), strict=True))


@pytest.mark.slow
def test_a_right_function_passes_in_a_kernel_too(shown):
    lines = shown["right"]["lines"].split("\n")
    assert len(lines) == 3 and all(line.startswith("✓") for line in lines), lines


def test_the_text_tells_where_and_how_far_off_and_the_html_shows_figures(shown):
    told = shown["zeros"]
    assert "worst at ω₁, t = 8.093 s" in told["text"] and "worst at" not in told["lines"]
    assert told["html"].count("data:image/png;base64,") == 2 and "<script" not in told["html"]
    assert (
        told["remark"]
        == "Checked locally. The server makes 2 more checks, with new random inputs for each submission."
    )


def test_what_stops_the_code_is_told_with_its_own_line(shown):
    told = shown["stopped"]
    assert "[not measured: ZeroDivisionError: division by zero]" in told["lines"]
    assert told["text"].startswith(
        "Fix this first:\n1. ZeroDivisionError: division by zero\n     line 2: return 1 / 0\n"
    )
    assert told["text"].count("division by zero") == 1 and "plays.py" not in told["text"]


def test_a_cause_that_follows_from_the_numbers_is_named_here_too(shown):
    sentence = "1. euler_eqs has the opposite sign\n"
    assert sentence in shown["reversed"]["text"] and sentence not in shown["zeros"]["text"]
    assert "1. ω̇₃ of euler_eqs has the opposite sign\n" in shown["sign"]["text"]
    assert "returns-zero" in shown["zeros"]["text"] and "likely" not in shown["right"]["text"]


def test_only_what_is_defined_is_checked_and_markup_stays_text(shown):
    told = shown["markup"]
    assert (
        told["lines"].count("\n") == 0 and "<script" not in told["html"] and "&lt;script&gt;" in told["html"]
    )


def test_an_unknown_exercise_is_a_clear_error(shown):
    assert "rigid-body has no exercise 9; it has 1, 2, 3, 4, 5, 6" in shown["no exercise"]["error"]


def test_no_module_of_the_kit_hides_a_function_of_it():
    home = Path(polhode.__path__[0])
    assert not [name for name in polhode.__all__ if (home / name).exists() or (home / f"{name}.py").exists()]
