"""What run_autograder does with a submission, in a folder of ours; test_bundle.py has it in a container."""

import json
import subprocess
import sys

import pytest

from service.cli.grading import run_in_gradescope

ASKED = ["--assignment", "rigid-body", "--exercise", "2"]


@pytest.fixture
def home(tmp_path, monkeypatch):
    """Gradescope's folder, with the results of an earlier run."""
    monkeypatch.setattr(run_in_gradescope, "HOME", tmp_path)
    for name in ("submission", "results"):
        (tmp_path / name).mkdir()
    (tmp_path / "results" / "results.json").write_text('{"score": 5}')
    return tmp_path


def grade(home, files):
    """Exit code, and (points, most points, output) of the results if there are any."""
    for name, content in files.items():
        file = home / "submission" / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content)
    code, written = run_in_gradescope.main(ASKED), home / "results" / "results.json"
    if not written.exists():
        return code, None
    results = json.loads(written.read_text())
    return code, (
        results["score"],
        sum(test.get("max_score", 0) for test in results["tests"]),
        results["output"],
    )


@pytest.mark.slow
def test_a_submission_gets_its_points(home, rigid_body):
    wrong = (rigid_body.folder / "samples" / "wrong_zeros.py").read_bytes()
    code, results = grade(
        home, {"wrong_zeros.py": wrong, ".ipynb_checkpoints/old.py": b"x = 1", "notes.txt": b"mine"}
    )
    assert code == 0 and results[:2] == (2, 5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"mine.txt": b"x"}, "no .py or .ipynb file"),
        ({"a.py": b"x = 1", "sub/b.ipynb": b"{}"}, "2 .py or .ipynb files: a.py, sub/b.ipynb"),
        ({"mine.py": b"\xff\xfe"}, "not a text file"),
    ],
)
def test_what_is_no_submission_gets_a_sentence_for_the_student(home, files, said):
    code, results = grade(home, files)
    assert code == 0 and results[:2] == (0, 5) and said in results[2]


def test_where_we_cannot_grade_there_are_no_results_and_the_reason_is_printed(home, monkeypatch, capfd):
    monkeypatch.setenv("POLHODE_MIN_ISOLATION", "C")
    assert grade(home, {"mine.py": b"x = 1"}) == (2, None)
    printed = capfd.readouterr()
    assert "polhode: POLHODE_MIN_ISOLATION: " in printed.err
    assert "system fault (exit code 2)" in printed.out.splitlines()[-1]


def test_a_submission_that_gradescope_did_not_give_us_is_no_zero(home):
    (home / "submission").rmdir()
    assert run_in_gradescope.main(ASKED) == 2 and not (home / "results" / "results.json").exists()


def test_the_program_that_reports_a_failed_grading_imports_none_of_its_libraries():
    program = "import sys; from service.cli.grading import run_in_gradescope; print(*sys.modules)"
    imported = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "service.cli.grading.find_files" in imported and not {
        "numpy",
        "scipy",
        "pydantic",
        "exercises",
        "polhode",
    } & set(imported)
