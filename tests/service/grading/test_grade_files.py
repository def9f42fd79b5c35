"""Grading files: what polhode itself fails at is a fault of that file, and never what its author gets points
for.
"""

import json
from dataclasses import replace

import pytest

from service.formats.source_lines import SourceLines
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.sandbox.guest_process import PREFIX
from service.sandbox.isolation.select import choose
from tests.support.big_notebook import with_outputs


@pytest.mark.slow
def test_a_sandbox_that_fails_is_a_fault_and_no_refused_submission(rigid_body, tmp_path):
    files = [tmp_path / "mine.py", tmp_path / "none.py"]
    for file, content in zip(files, (b"def euler_eqs(t, w, I): return w", b"\xff\xfe"), strict=True):
        file.write_bytes(content)
    wanted = GradeOptions(
        replace(rigid_body, setup="1 / 0"), seed=1
    )  # fails in the child before it reads the submission
    failed, refused = grade_files([GradeRequest(file, ("2",)) for file in files], wanted, choose(), jobs=1)
    assert "before the submission ran" in failed.fault and failed.refused is None and failed.points is None
    assert "not a text file" in refused.refused and refused.fault is None and refused.points == 0


@pytest.mark.slow
def test_a_notebook_with_outputs_is_graded_as_without_and_its_lines_are_those_of_the_file(
    rigid_body, tmp_path
):
    content = (rigid_body.folder / "samples" / "right_notebook.ipynb").read_bytes()
    files = [tmp_path / "plain" / "mine.ipynb", tmp_path / "full" / "mine.ipynb"]
    for file, text in zip(files, (content, with_outputs(content)), strict=True):
        file.parent.mkdir()
        file.write_bytes(text)
    requests = [GradeRequest(file, ("2",)) for file in files]
    plain, full = grade_files(requests, GradeOptions(rigid_body, seed=1), choose(), jobs=1)
    assert plain.passed and full.passed and full.report.text() == plain.report.text()
    assert len(full.source) < 30_000 < len(files[1].read_bytes())
    lines = files[1].read_text().split("\n")
    for outcome in full.report.outcomes():
        number = SourceLines(full, rigid_body).line_of(outcome)
        assert "def euler_eqs" in lines[number - 1] and number != SourceLines(plain, rigid_body).line_of(
            outcome
        )


@pytest.mark.slow
def test_a_json_document_is_graded_as_the_api_grades_it(rigid_body, tmp_path):
    right = (rigid_body.folder / "samples" / "right_terms.py").read_text()
    wrong = {"source": right, "exercises": ["9"]}, {"source": right, "filename": "a.md"}, ["x"]
    files = []
    for number, document in enumerate(({"source": right, "exercises": ["2"]}, *wrong)):
        files.append(tmp_path / f"{number}.json")
        files[-1].write_text(json.dumps(document))
    graded, *refused = grade_files(
        [GradeRequest(f) for f in files], GradeOptions(rigid_body, seed=1), choose(), jobs=1
    )
    assert graded.passed and [e.number for e in graded.report.exercises] == ["2"]
    for one, why in zip(
        refused, ("no exercise 9", "submit a .py or .ipynb file", 'a string "source"'), strict=True
    ):
        assert why in one.refused and one.fault is None


def test_two_processes_grade_as_one_does_and_leave_no_folder(rigid_body, tmp_path, monkeypatch):
    monkeypatch.setattr("service.sandbox.guest_process._temporary_folder", lambda: tmp_path)
    samples = [
        rigid_body.folder / "samples" / name
        for name in ("right_terms.py", "wrong_zeros.py", "right_terms.py")
    ]
    requests = [GradeRequest(file, ("2",)) for file in samples]
    wanted = GradeOptions(replace(rigid_body, data=("notebook.ipynb",)), seed=1)
    alone, together = (list(grade_files(requests, wanted, choose(), jobs)) for jobs in (1, 2))
    assert [file.report.text() for file in together] == [file.report.text() for file in alone]
    assert [file.passed for file in together] == [True, False, True]
    assert not list(tmp_path.glob(f"{PREFIX}*"))
