"""The kit's ways to submit and an upload of the same notebook give the same exercises and points."""

import json

import pytest

from exercises.authoring.publishing import wheel
from polhode.notebook import gather
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.course_notebook import as_ipynb

WRITTEN = {
    "box_moments": "def box_moments(m, a, b, c):\n"
    "    return m / 12 * np.array([b*b + c*c, a*a + c*c, a*a + b*b])",
    "principal_moments": "principal_moments = np.linalg.eigvalsh",
    "euler_eqs": "def euler_eqs(t, w, I):\n    return np.cross(I * np.asarray(w), w) / I",
    "precession_rate": "def precession_rate(t, w):\n"
    "    return np.polyfit(t, np.unwrap(np.arctan2(w[1], w[0])), 1)[0]",
}
FUNCTIONS = (*WRITTEN, "animate_tumble", "animate_precession")


@pytest.fixture(scope="module")
def cells(rigid_body):
    """The students' notebook with exercises 1 to 5 solved, the animations as they were published."""
    published = json.loads(wheel.notebook(rigid_body, "http://localhost", "http://localhost/kit"))["cells"]
    sources = ["".join(cell["source"]) for cell in published if cell["cell_type"] == "code"]
    return [next((own for name, own in WRITTEN.items() if f"def {name}(" in s), s) for s in sources]


def report(source, name, assignment, sandbox):
    return grade(Submission.from_bytes(source, name), assignment, sandbox, seed=5).report


@pytest.mark.slow
def test_an_exercise_that_is_left_empty_earns_nothing_however_it_is_submitted(
    cells, rigid_body, sandbox, monkeypatch
):
    monkeypatch.syspath_prepend(rigid_body.folder / "course")
    namespace, ran = {}, []
    for cell in cells:
        if not any(f"polhode.{call}(" in cell for call in ("connect", "submit", "submissions", "check")):
            exec(cell.replace("plt.show()", "plt.close()"), namespace)
            ran.append(cell)
    written = [name for name in FUNCTIONS if name in WRITTEN]
    sent = gather.gather(*written, namespace=namespace, cells=ran).source.encode()
    uploaded = report(as_ipynb(cells), "mine.ipynb", rigid_body, sandbox)
    whole = report(gather.whole_notebook(cells).source.encode(), "notebook.ipynb", rigid_body, sandbox)
    gathered = report(sent, "submission.py", rigid_body, sandbox)
    for one in (whole, gathered):
        assert [o.line for o in one.outcomes()] == [o.line for o in uploaded.outcomes()]
        assert (one.score, one.total, one.not_attempted) == (uploaded.score, uploaded.total, ["6"])
    assert uploaded.passed and uploaded.score == sum(o.points for o in uploaded.outcomes())
