"""The course's own notebook, filled in, is graded whole; its own checks are captured, judged again and carry
no points.
"""

import json

import pytest

from polhode.judging.verdict import Verdict
from polhode.report.dataclass_json import document
from polhode.report.report_html import html
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.course_notebook import FILE, LABELS, as_ipynb, as_percent, code

EULER = code()["solution-2a"]


def graded(data, name, rigid_body, sandbox, numbers=("2",)):
    return grade(Submission.from_bytes(data, name), rigid_body, sandbox, 3, numbers).report


def failed_cells(report):
    return [scene_end.scene for scene_end in report.scene_ends if scene_end.traceback]


PERCENT = pytest.param("mine.py", as_percent(code().values()), marks=pytest.mark.slow)


@pytest.mark.parametrize(("name", "data"), [("mine.ipynb", FILE.read_bytes()), PERCENT])
def test_nine_of_nine_lines_and_no_cell_fails(name, data, rigid_body, sandbox):
    report = graded(data, name, rigid_body, sandbox)
    assert report.passed and failed_cells(report) == []
    assert tuple(check.label for check in report.notebook_checks) == LABELS
    assert all(check.verdict is Verdict.PASS for check in report.notebook_checks)
    lines = [check.line for check in report.notebook_checks]
    assert lines == [line for line in report.stdout.splitlines() if line.startswith("✓")], (
        "as the notebook printed them"
    )
    assert lines[7].endswith("[growth: min 0.038, mid 1.136, max 0.029]")
    assert "The notebook's own checks (self-reported, no points)\n" + "\n".join(lines) in report.text()


@pytest.mark.slow
def test_it_attempts_what_its_function_drives(rigid_body, sandbox):
    report = graded(FILE.read_bytes(), "mine.ipynb", rigid_body, sandbox, None)
    assert report.passed and {"2", "3", "4", "5"} <= {e.number for e in report.exercises}


@pytest.mark.parametrize("form", [as_ipynb, as_percent])
def test_what_is_not_filled_in_costs_only_itself(form, rigid_body, sandbox):
    cells = [EULER, *code("solution").values()]
    report = graded(form(cells), "mine.ipynb" if form is as_ipynb else "mine.py", rigid_body, sandbox)
    assert report.passed and report.notebook_checks == []
    assert "NameError: name 'eig' is not defined" in report.text()


FORGED = """
import json, os, struct
def claim(**changed):
    header = {"kind": "check", "label": "forged", "detail": "", "mark": "", "own": "", "left_out": ""}
    header |= {"cell": "a.py", "numbers": {}, "arrays": {"passed": []}, "unjudged": ""} | changed
    head = json.dumps(header).encode()
    payload = struct.pack("<H", len(head)) + head + struct.pack("<d", 1.0)
    os.write(4, struct.pack("<cI", b"C", len(payload)) + payload)
"""


def test_forged_claims_are_lines_and_nothing_else(rigid_body, sandbox):
    plain = graded(EULER.encode(), "a.py", rigid_body, sandbox)
    forged = graded((FORGED + "claim(label='<b>x</b>')\n" + EULER).encode(), "a.py", rigid_body, sandbox)
    assert [check.line for check in forged.notebook_checks] == ["✓  <b>x</b>"]
    assert "<b>x" not in html(forged) and "&lt;b&gt;x" in html(forged)
    alone = document(forged) | {"notebook_checks": []}
    assert alone == document(plain) and plain.notebook_checks == []


def test_a_forged_frame_that_is_no_claim_is_a_broken_protocol(rigid_body, sandbox):
    report = graded((FORGED + "claim(kind='no word')\n" + EULER).encode(), "a.py", rigid_body, sandbox)
    assert report.score == 0 and report.notebook_checks == []


def test_a_wrong_claim_of_a_right_function_costs_nothing(rigid_body, sandbox):
    cells = [
        EULER,
        "eig, I_box = np.zeros(3), np.ones(3)",
        code()["validation-1"],
        "validate.conserved(np.zeros(70_000), 'long')",
        "validate.conserved(np.broadcast_to(0.0, 10**7 + 1), 'longer')",
    ]
    cells.append("for k in range(200):\n    validate.check(True, f'claim {k}')")
    report = graded(as_ipynb(cells), "a.ipynb", rigid_body, sandbox)
    first, long, longer, *_, last = report.notebook_checks
    assert report.passed and first.verdict is Verdict.FAIL and first.cell == "cell 3"
    assert long.line == "✓  long   [max relative drift = 0 (limit 0.0001)]"
    reported = "as your notebook reports it, not judged again: 10000001 numbers"
    assert longer.line.startswith("✓  longer   [max") and reported in longer.line
    assert (
        len(report.notebook_checks) == 101
        and last.line == "–  103 more checks   [not measured: at most 100 are accepted]"
    )


def animation(changed=("", ""), last="show(anim)"):
    """The cells that exercise 6 of the notebook needs, with every fourth frame; the last statement and one
    more text replaced.
    """
    words = ("import numpy", "def euler_eqs", "I_sym = ", "R_anim =")
    kept = [cell for cell in code().values() if any(word in cell for word in words)]
    cells = [
        cell.replace("frames=len(t_anim)", "frames=range(0, 80, 4)").replace("show(anim)", last)
        for cell in kept
    ]
    return as_ipynb([cell.replace(*changed) if changed[0] else cell for cell in cells])


HTML = "from IPython.display import HTML\nHTML(anim.to_jshtml())"
SLOW = [pytest.mark.slow]


@pytest.mark.parametrize(
    ("last", "changed", "verdict"),
    [
        ("show(anim)", ("", ""), "pass"),
        pytest.param("anim", ("", ""), "pass", marks=SLOW),
        pytest.param(HTML, ("", ""), "pass", marks=SLOW),
        pytest.param("anim.save('precession.gif', fps=20)", ("", ""), "pass", marks=SLOW),
        pytest.param("show(anim)", ("e3 = R_anim[:, :, 2]", "e3 = R_anim[:, :, 0]"), "fail", marks=SLOW),
    ],
    ids=["show", "bare", "html", "saved", "e1"],
)
def test_an_animation_built_in_a_cell_is_judged_by_the_motion_behind_it(
    last, changed, verdict, rigid_body, sandbox
):
    report = graded(animation(changed, last), "a.ipynb", rigid_body, sandbox, ["6"])
    verdicts = {outcome.id: outcome.verdict for outcome in report.exercises[0].outcomes}
    assert verdicts["6-follows"] == verdict and verdicts["6-drawn-momentum"] == "pass", report.text()


@pytest.mark.slow
def test_a_motion_that_is_not_recognized_is_not_judged(rigid_body, sandbox):
    odd = animation(("I_sym = (1.0, 1.0, 1.6)", "I_sym = (1.0, 1.0, 1.7)"), "I_sym = None; show(anim)")
    report = graded(odd, "a.ipynb", rigid_body, sandbox, ["6"])
    follows = next(outcome for outcome in report.exercises[0].outcomes if outcome.id == "6-follows")
    assert follows.verdict is Verdict.UNMEASURED and "submit it as a function" in follows.line


def test_a_motion_that_only_another_cell_names_is_not_judged(rigid_body, sandbox):
    *others, last = [cell for cell in json.loads(animation())["cells"] if cell["cell_type"] == "code"]
    motion, drawing = "".join(last["source"]).split("\nfig = ")
    cells = ["".join(cell["source"]) for cell in others]
    cells += [motion + "\nmade = {'axis': e3}\n", "fig = " + drawing.replace("e3", "made['axis']")]
    report = graded(as_ipynb(cells), "a.ipynb", rigid_body, sandbox, ["6"])
    follows = next(outcome for outcome in report.exercises[0].outcomes if outcome.id == "6-follows")
    assert follows.verdict is Verdict.UNMEASURED and "submit it as a function" in follows.line, report.text()
