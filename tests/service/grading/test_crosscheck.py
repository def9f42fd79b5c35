"""Answers that change, motions that are not the function's own,
and functions asked call by call by the host.
"""

import struct
from dataclasses import replace

import numpy as np
import pytest

from ecp.document import document
from ecp.judge import Verdict
from ecp.outcome import Ended
from exercises.assignment import ArraySpec
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.guest.wire import pack
from service.sandbox.job import Cell, Job, SceneRequest
from tests.support.course_notebook import as_ipynb
from tests.support.isolation import BY_THE_HOST

RIGHT = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
WRONG = "def euler_eqs(t, w, I):\n    return np.cross(w, I * w) / I\n"
TIMES = "-np.cross(w, I * w) / I\n"
UNSTEADY = {
    "noise": "def euler_eqs(t, w, I):\n    return (1 + 1e-15 * np.random.default_rng().random()) * " + TIMES,
    "a count": (
        "n = []\ndef euler_eqs(t, w, I):\n    n.append(1)\n    return (1 + 3e-16 * (len(n) % 2)) * " + TIMES
    ),
    "one call": (
        "n = []\ndef euler_eqs(t, w, I):\n    n.append(1)\n    return (1 + 3e-16 * (len(n) == 40)) * " + TIMES
    ),
    "the process": (
        "import os\ns = 1 + 1e-20 * int.from_bytes(os.urandom(4))\ndef euler_eqs(t, w, I):\n    return s * "
        + TIMES
    ),
    "the order": (
        "m = [0.0]\ndef euler_eqs(t, w, I):\n    m[0], e = t, m[0] * 1e-16\n    return (1 + e) * " + TIMES
    ),
}

FORGED = """
import sys
wrong = euler_eqs
def euler_eqs(t, w, I):
    of_integrator = sys._getframe(1).f_code.co_name == "evaluate"
    return -np.cross(w, I * w) / I if of_integrator else wrong(t, w, I)
"""


@pytest.mark.parametrize("source", UNSTEADY.values(), ids=UNSTEADY.keys())
def test_answers_that_differ_in_the_last_bits_are_found(source, rigid_body, sandbox):
    report = grade(Submission(source), rigid_body, sandbox, 5, ["2"]).report
    points = next(o for o in report.outcomes() if o.id == "2-pointwise")
    assert points.verdict is Verdict.FAIL and [d.code for d in points.diagnosis] == ["not-deterministic"]


CHANGED = {
    "a list that another cell changes": [
        "signs = [1]",
        "signs[0] = -1",
        f"{RIGHT[: RIGHT.index('-np')]}signs[0] * np.cross(w, I * w) / I",
    ],
    "a name that a function assigns": [
        "def choose():\n    global sign\n    sign = -1",
        "choose()",
        RIGHT.replace("-np", "sign * np"),
    ],
    "an attribute": [RIGHT.replace("-np", "euler_eqs.sign * np"), "euler_eqs.sign = -1"],
    "exec": ["exec('sign = -1')", RIGHT.replace("-np", "sign * np")],
}


@pytest.mark.parametrize("cells", CHANGED.values(), ids=CHANGED)
def test_a_right_function_may_depend_on_cells_that_do_not_name_what_they_change(cells, rigid_body, sandbox):
    submission = Submission.from_bytes(as_ipynb(cells), "notebook.ipynb")
    assert grade(submission, rigid_body, sandbox, 5, ["2"]).report.passed


def test_cells_that_no_question_needs_run_once(rigid_body, sandbox, monkeypatch):
    jobs, play = [], sandbox.play
    monkeypatch.setattr(sandbox, "play", lambda job, *options: jobs.append(play(job, *options)) or jobs[-1])
    submission = Submission.from_bytes(as_ipynb([RIGHT, "print('a long computation')"]), "notebook.ipynb")
    assert grade(submission, rigid_body, sandbox, 5, ["2"]).report.passed
    assert [result.stdout for result in jobs] == ["a long computation\n", ""]


def test_right_equations_are_certified_and_their_motion_is_the_childs(rigid_body, sandbox):
    report = grade(Submission(RIGHT), rigid_body, sandbox, 5, ["2"]).report
    assert report.passed and "verified by probes" in report.provenance.motions["torque-free"]


def test_a_right_function_is_not_integrated_along_hidden_motions_and_the_line_says_so(rigid_body, sandbox):
    graded = grade(Submission(RIGHT), rigid_body, sandbox, 5, ["2", "6"])
    lines = {o.id: o for o in graded.report.outcomes()}
    assert all(
        "not integrated: euler_eqs at 128 points" in lines[id].detail for id in ("2-secret", "6-secret")
    )
    assert "≤" not in lines["2-motion"].detail and lines["2-secret"].margin > 100
    how = graded.report.provenance.motions
    assert {name for name in how if "not integrated" in how[name]} == {"drawn-long", "drawn-attitude"}
    assert all(end.ended is Ended.FINISHED for end in graded.report.scene_ends if end.scene in how)


def test_a_hidden_motion_without_a_bound_is_integrated(rigid_body, sandbox):
    def without_bound(scene):
        drive = scene.drive and replace(scene.drive, bounded=lambda inputs, truth, points, answers: None)
        return replace(scene, drive=drive)

    integrating = replace(rigid_body, scenes=tuple(map(without_bound, rigid_body.scenes)))
    report = grade(Submission(RIGHT + "print('cells')\n"), integrating, sandbox, 5, ["2"]).report
    secret = next(o for o in report.outcomes() if o.id == "2-secret")
    assert report.passed and "≤" not in secret.detail and report.stdout == "cells\n"
    assert "computed in the sandbox" in report.provenance.motions["drawn-long"]
    assert [end.scene for end in report.scene_ends] == ["probes", "torque-free", "drawn-long"]


def test_a_function_whose_proof_does_not_finish_has_no_hidden_motions(rigid_body, sandbox):
    report = grade(
        Submission("def euler_eqs(t, w, I):\n    return 1 / 0\n"), rigid_body, sandbox, 5, ["2"]
    ).report
    secret = next(o for o in report.outcomes() if o.id == "2-secret")
    assert "ZeroDivisionError" in secret.detail and secret.diagnosis[0].code == "raises"
    assert [end.ended for end in report.scene_ends] == [Ended.RAISED, Ended.NOT_PLAYED, Ended.NOT_PLAYED]


def test_a_statement_that_ends_each_child_is_left_out_of_the_hidden_motions_too(rigid_body, sandbox):
    report = grade(Submission("import os\n" + RIGHT + "os._exit(0)\n"), rigid_body, sandbox, 5, ["2"]).report
    assert [end.ended for end in report.scene_ends] == [Ended.EXITED, *[Ended.FINISHED] * 3] and report.passed


def test_a_wrong_functions_own_motion_is_recognised(rigid_body, sandbox):
    report = grade(Submission(WRONG), rigid_body, sandbox, 5).report
    told = report.provenance.motions
    assert len(told) == 15 and all("follows euler_eqs" in how for how in told.values())


def test_a_forged_motion_is_replaced_by_the_functions_own(rigid_body, sandbox):
    """The function is right only where the child's integrator calls it."""
    report = grade(Submission(WRONG + FORGED), rigid_body, sandbox, 5, ["2"]).report
    assert "integrated by the host" in report.provenance.motions["torque-free"]
    motion = next(o for o in report.outcomes() if o.id == "2-motion")
    assert motion.verdict is Verdict.FAIL


def test_a_forged_motion_of_a_function_that_cannot_be_played_is_not_measured_and_says_why(
    rigid_body, sandbox
):
    stops = WRONG.replace("    return", "    calls.append(t)\n    return 1 / 0 if len(calls) > 200 else")
    report = grade(Submission("calls = []\n" + stops + FORGED), rigid_body, sandbox, 5, ["2"]).report
    motion = next(o for o in report.outcomes() if o.id == "2-motion")
    assert motion.verdict is Verdict.UNMEASURED and "called by the server: ZeroDivisionError" in motion.detail


def test_a_motion_is_not_believed_if_its_function_was_not_asked_again(rigid_body, sandbox):
    """The second child, which has one scene only, ends before it answers."""
    alone = "isinstance(x, dict) and len(x.get('scenes', '..')) == 1"
    leaves = f"import gc, os\nis_alone = any({alone} for x in gc.get_objects())\n{RIGHT}right = euler_eqs\n"
    leaves += "def euler_eqs(t, w, I):\n    return os._exit(0) if is_alone else right(t, w, I)\n"
    report = grade(Submission(leaves), rigid_body, sandbox, 5, ["2"]).report
    found = {o.id: o for o in report.outcomes()}
    assert found["2-pointwise"].verdict is found["2-motion"].verdict is Verdict.UNMEASURED
    assert "when repeated" in found["2-pointwise"].detail


@pytest.mark.slow
def test_the_same_seed_gives_the_same_report(rigid_body, sandbox):
    one, two = (grade(Submission(WRONG), rigid_body, sandbox, 11, ["2", "3"]).report for _ in range(2))
    assert document(one) == document(two)


PLAYS = """
import numpy as np
from ecp.return_value import real_array
def call(student, inputs):
    return {"x": real_array(student["f"](inputs["t"], inputs["w"], inputs["I"]), (3,), "f")}
def ask(student, inputs):
    return call(student, {"t": 0.0, "w": np.ones(3), "I": None})
"""


def driven(source, drive, budget_s=2.0):
    after = SceneRequest("after", "ask", "f", {}, {"x": ArraySpec((3,))}, 1.0, None)
    scene = SceneRequest("asked", "call", "f", {}, {"x": ArraySpec((3,))}, budget_s, None, drive)
    return Job("import numpy as np", PLAYS, (Cell("submission.py", source),), ("f",), (scene, after))


FORGED_ANSWER = struct.pack("<cI", b"A", len(pack({"x": np.ones(3)}))) + pack({"x": np.ones(3)})


def ten(ask):
    return [ask({"t": k, "w": np.full(3, k), "I": np.ones(3)})["x"].tolist() for k in range(10)]


@BY_THE_HOST
def test_the_host_asks_call_by_call(either_sandbox):
    seen = either_sandbox.play(driven("def f(t, w, I):\n    return 2 * w + t", ten))
    assert seen.driven["asked"] == [[3.0 * k] * 3 for k in range(10)]
    assert seen.finished("asked") and seen.finished("after")


@BY_THE_HOST
@pytest.mark.parametrize(
    ("source", "scene_end"),
    [
        ("def f(t, w, I):\n    return w if t < 5 else 1 / 0", Ended.RAISED),
        ("def f(t, w, I):\n    return w[:2] if t else w", Ended.WRONG_ANSWER),
        ("import os\ndef f(t, w, I):\n    os._exit(0)", Ended.EXITED),
        ("def f(t, w, I):\n    while True: pass", Ended.TIMED_OUT),
        ("import os\ndef f(t, w, I):\n    os.write(4, bytes(500))", Ended.PROTOCOL),
        (f"import os\nfor _ in range(3): os.write(4, {FORGED_ANSWER})\nf = print", Ended.PROTOCOL),
        ("g = 1", Ended.MISSING),
    ],
)
def test_a_child_that_does_not_answer_ends_its_scene(either_sandbox, source, scene_end):
    seen = either_sandbox.play(driven(source, ten, 0.5))
    assert seen.scene_ends["asked"].ended is scene_end and "asked" not in seen.driven
    good = either_sandbox.play(driven("def f(t, w, I):\n    return w", ten))
    assert len(good.driven["asked"]) == 10


@BY_THE_HOST
def test_a_question_may_be_larger_than_the_pipe_and_answers_have_names(either_sandbox):
    plays = "def both(student, inputs):\n    return {'sums': inputs['x'].sum(0), 'most': inputs['x'].max()}"
    returns = {"sums": ArraySpec((2,)), "most": ArraySpec(())}

    def drive(ask):
        return [ask({"x": np.full((n, 2), k)}) for k, n in enumerate((3, 100_000, 1))]

    scene = SceneRequest("asked", "both", "f", {}, returns, 5.0, None, drive)
    seen = either_sandbox.play(Job("", plays, (Cell("submission.py", "f = print"),), ("f",), (scene,)))
    assert [(a["sums"].tolist(), float(a["most"])) for a in seen.driven["asked"]] == [
        ([0.0, 0.0], 0.0),
        ([1e5, 1e5], 1.0),
        ([2.0, 2.0], 2.0),
    ]
    assert seen.finished("asked")


@BY_THE_HOST
def test_answers_without_reading_the_questions_break_the_protocol(either_sandbox):
    flood = """
import os, time
def f(t, w, I):
    for _ in range(9):
        os.write(4, ANSWER)
    time.sleep(9)
"""
    seen = either_sandbox.play(driven(f"ANSWER = {FORGED_ANSWER}\n{flood}", ten, budget_s=0.4))
    assert seen.scene_ends["asked"].ended is Ended.PROTOCOL and "asked" not in seen.driven
