"""Grading files: what polhode itself fails at is a fault of that file, and never what its author gets points for."""

from dataclasses import replace

from service.grading.batch import GradeOptions, GradeRequest, grade_files
from service.sandbox.select import choose


def test_a_sandbox_that_fails_is_a_fault_and_no_refused_submission(rigid_body, tmp_path):
    (tmp_path / "setup.py").write_text("1 / 0")  # fails in the child before it reads the submission
    (tmp_path / "plays.py").write_bytes((rigid_body.folder / "plays.py").read_bytes())
    files = [tmp_path / "mine.py", tmp_path / "none.py"]
    for file, content in zip(files, (b"def euler_eqs(t, w, I): return w", b"\xff\xfe"), strict=True):
        file.write_bytes(content)
    wanted = GradeOptions(replace(rigid_body, folder=tmp_path), seed=1)
    failed, refused = grade_files([GradeRequest(file, ("2",)) for file in files], wanted, choose(), jobs=1)
    assert "before the submission ran" in failed.fault and failed.refused is None and failed.points is None
    assert "not a text file" in refused.refused and refused.fault is None and refused.points == 0
