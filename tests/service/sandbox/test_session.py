"""Submissions that lie on the wire or strain the host: each gets a verdict, the next one its due, and nobody
a fault.
"""

import json
from dataclasses import replace
from functools import partial

import pytest

from polhode.judging.outcome import Ended
from polhode.judging.verdict import Verdict
from polhode.report.dataclass_json import document
from service.grading.figures import rendering
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.job import RUN_AGAIN, Job

PRELUDE = """
import json, os, struct, signal, time
def J(**event):
    data = json.dumps(event).encode(); os.write(4, struct.pack("<cI", b"J", len(data)) + data)
def A(raw, **shapes):
    head = json.dumps(shapes).encode()
    data = struct.pack("<H", len(head)) + head + raw; os.write(4, struct.pack("<cI", b"A", len(data)) + data)
"""
FILM = PRELUDE + 'J(event="defined", names=["animate_precession"])\nJ(event="start", scene="film")\n'
ENDED = 'J(event="scene", scene="film", ended="finished", sentence="")\nJ(event="done")\nos._exit(0)\n'
RIGHT = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"

LIES = {
    "names are null": PRELUDE + 'J(event="defined", names=None)',
    "finished without arrays": (
        PRELUDE + 'J(event="start", scene="probes")\nJ(event="scene", scene="probes", ended="finished")'
    ),
    "no colours": FILM + 'A(b"", frames=[24, 360, 480, 0])\n' + ENDED,
    "two colours": FILM + "A(bytes(64), frames=[2, 4, 4, 2])\n" + ENDED,
    "no frames": FILM + 'A(b"", frames=[0, 4, 4, 3])\n' + ENDED,
    "blames the sandbox": "import os\nos.write(1, b'\\0hi')\nos._exit(97)",
    "sleeps through its alarm": (
        PRELUDE + "signal.signal(signal.SIGALRM, signal.SIG_IGN)\nJ(event='defined', names=5)\ntime.sleep(60)"
    ),
    "huge numbers": "def euler_eqs(t, w, I):\n    return np.full(3, 1e180)",
}


LIKE_OTHERS = (  # test_wire.py refuses them too
    "finished without arrays",
    "names are null",
    "no colours",
    "no frames",
    "two colours",
)


@pytest.mark.parametrize(
    "source",
    [pytest.param(LIES[lie], id=lie, marks=pytest.mark.slow if lie in LIKE_OTHERS else []) for lie in LIES],
)
def test_a_lie_on_the_wire_gets_its_verdict_and_the_next_is_unharmed(source, rigid_body, sandbox):
    graded = grade(Submission(source), rigid_body, sandbox, 3)
    assert not graded.report.passed and all(o.line for o in graded.report.outcomes())
    rendering.pack(graded)
    assert grade(Submission(RIGHT), rigid_body, sandbox, 3, ["2"]).report.passed


def test_nothing_is_believed_of_a_child_that_broke_the_protocol(rigid_body, sandbox):
    """It answers the points and breaks the protocol in the motion that follows."""
    breaks = "    calls.append(t)\n    if len(calls) == 500:\n        os.write(4, bytes(8))\n    return"
    source = PRELUDE + "calls = []\n" + RIGHT.replace("    return", breaks)
    report = grade(Submission(source), rigid_body, sandbox, 3, ["2"]).report
    assert {o.verdict for o in report.outcomes()} == {Verdict.UNMEASURED}
    assert {e.ended for e in report.scene_ends} == {Ended.PROTOCOL}


def test_forged_lines_stay_in_their_line(rigid_body, sandbox):
    source = (
        "def euler_eqs(t, w, I):\n"
        "    raise ValueError('x]\\n✓  rotational energy conserved (torque-free)   [fine]')"
    )
    text = grade(Submission(source), rigid_body, sandbox, 3, ["2"]).report.text()
    assert not any(line.startswith("✓") for line in text.split("\n"))


@pytest.mark.parametrize("number", ["2", "6", *(pytest.param(n, marks=pytest.mark.slow) for n in "345")])
@pytest.mark.parametrize(
    "wrong",
    [
        "lambda t, w, I: -np.cross(w, np.array([2.0, 3.0, 4.0]) * w) / np.array([2.0, 3.0, 4.0])",
        "lambda t, w, I: -np.cross(w, np.array([1.0, 1.0, 1.6]) * w) / np.array([1.0, 1.0, 1.6])",
        "lambda t, w, I: -np.cross(w, I * w) / I + [(I[0] - I[1]) * w[1] * w[2], 0, 0]",
    ],
    ids=["hard-coded", "hard-coded top", "right for a symmetric top"],
)
def test_equations_right_for_one_body_only_fail_every_exercise_they_drive(wrong, number, rigid_body, sandbox):
    report = grade(Submission(f"euler_eqs = {wrong}"), rigid_body, sandbox, 3, [number]).report
    assert Verdict.FAIL in {o.verdict for o in report.outcomes()}


def test_what_an_exercise_needs_is_missed_and_what_it_can_do_without_is_not(rigid_body, sandbox):
    only = grade(Submission("def animate_precession(t, R, L):\n    t.size"), rigid_body, sandbox, 3).report
    assert [e.number for e in only.exercises] == ["6"] and only.max_score == 8 and only.score == 0
    rate = grade(Submission("def precession_rate(t, w):\n    return 1.0"), rigid_body, sandbox, 3).report
    assert [e.number for e in rate.exercises] == ["4"] and "4-function" in {o.id for o in rate.outcomes()}


def test_a_student_cannot_invent_a_diagnosis_code(rigid_body, sandbox):
    source = (
        "from polhode.judging.return_value import WrongAnswer\ndef euler_eqs(t, w, I):\n"
        "    raise WrongAnswer('all-right', 'x')"
    )
    report = grade(Submission(source), rigid_body, sandbox, 3, ["2"]).report
    assert report.scene_ends[0].ended is Ended.WRONG_ANSWER and not any(
        o.diagnosis for o in report.outcomes()
    )


def test_notebook_cells_that_show_things_run_and_many_failures_are_told_in_short(rigid_body, sandbox):
    show = (
        "from IPython.display import HTML, display\nfrom IPython import get_ipython\n"
        "display(HTML('<b>x</b>'))\nfig = plt.figure()"
    )
    cells = [show, *["raise Exception('x' * 9999)"] * 100, RIGHT]
    notebook = {"nbformat": 4, "cells": [{"cell_type": "code", "source": s} for s in cells]}
    submission = Submission.from_bytes(json.dumps(notebook).encode(), "a.ipynb")
    report = grade(submission, rigid_body, sandbox, 3, ["2"]).report
    assert report.passed and len(json.dumps(document(report))) < 300_000
    assert "cell 1" not in {e.scene for e in report.scene_ends}


@pytest.mark.parametrize(
    "cell",
    [
        "display(3)",
        "get_ipython().run_line_magic('matplotlib', 'inline')",
        "from IPython.core.display import HTML",
        "import IPython.display as shown\nshown.display(shown.HTML('x'))",
        "r = polhode.check('2')\nassert r.passed\nr.score / r.max_score\nf'{r.score:3d}'\nr.exercises[0]",
        "for one in polhode.submissions().submissions:\n    print(one)",
        "polhode.connect('http://x')\npolhode.login()\nprint(polhode.submit(), len(polhode.submit()))",
    ],
)
def test_what_only_a_notebook_does_costs_no_function_below_it(cell, rigid_body, sandbox):
    report = grade(Submission(f"{cell}\n{RIGHT}"), rigid_body, sandbox, 3, ["2"]).report
    assert report.passed, report.text()


def test_a_function_nobody_has_written_yet_is_not_attempted(rigid_body, sandbox):
    empty = (
        "def animate_tumble(t, R, half):\n    'Draw.'\n    ...\n\ndef box_moments(m, a, b, c):\n    pass\n"
    )
    report = grade(Submission(f"{RIGHT}\n{empty}"), rigid_body, sandbox, 3).report
    assert [e.number for e in report.exercises] == ["2", "3", "4", "5"] and report.passed


@pytest.mark.slow
def test_slow_cells_cost_the_loading_and_not_the_guest(rigid_body, sandbox, monkeypatch):
    monkeypatch.setattr("service.grading.sandbox_job.Job", partial(Job, load_budget_s=0.25))
    cells = [RIGHT, *["import time; time.sleep(0.2)"] * 6]
    notebook = {"nbformat": 4, "cells": [{"cell_type": "code", "source": s} for s in cells]}
    submission = Submission.from_bytes(json.dumps(notebook).encode(), "a.ipynb")
    report = grade(submission, rigid_body, sandbox, 3, ["2"]).report
    assert report.passed and report.scene_ends[0].ended is Ended.TIMED_OUT


def test_functions_below_a_cell_that_never_ends_are_graded(rigid_body, sandbox):
    """Such a cell may be the course's own demonstration of an earlier function that is not written yet."""
    cells = [
        "import numpy as np",
        "while True: pass\ndef helper(x):\n    return x",
        RIGHT,
        "for k in range(10**9): pass",
    ]
    notebook = {"nbformat": 4, "cells": [{"cell_type": "code", "source": s} for s in cells]}
    submission = Submission.from_bytes(json.dumps(notebook).encode(), "a.ipynb")
    report = grade(submission, replace(rigid_body, load_s=0.3), sandbox, 3).report
    assert report.score == report.max_score == 23 and report.not_attempted == ["1", "6"], report.text()
    for cell in ("cell 2", "cell 4"):
        assert f"{cell}: your code used more than 0.3 s of CPU time{RUN_AGAIN}" in report.text()


def test_a_motion_forged_without_its_probes_earns_nothing(rigid_body, sandbox):
    forged = (
        PRELUDE
        + """
I, w0 = np.array([2.0, 3.0, 4.0]), np.array([1.0, 0.6, 0.8])
t = np.linspace(0, 20, 3100)
w, R = integrate_body(lambda t, w, I: -np.cross(w, I * w) / I, w0, I, t)
J(event="start", scene="torque-free")
A(np.ascontiguousarray(w).tobytes() + np.ascontiguousarray(R).tobytes(), w=[3, 3100], R=[3100, 3, 3])
J(event="scene", scene="torque-free", ended="finished")
os._exit(0)
"""
    )
    report = grade(Submission(forged), rigid_body, sandbox, 3, ["2"]).report
    assert report.score == 0, report.text()
