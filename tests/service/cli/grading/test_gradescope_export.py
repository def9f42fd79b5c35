"""The wheel that goes into the zip for Gradescope holds no solution."""

import io
import json
import shutil
import subprocess
import sys
import zipfile

import pytest

from exercises.authoring.assignments.catalogue import find
from polhode.client.kit_hash import WHEEL
from service.cli.grading.gradescope_export import bundle, own_wheel
from tests.support.containers import Container


def test_the_samples_stay_out(rigid_body, tmp_path):
    outside = tmp_path / "pendulum"
    (outside / "samples").mkdir(parents=True)
    (outside / "samples/right_one.py").write_text("def solved(): pass")
    for file in ("1.1.ipynb", "2.1.ipynb"):
        (outside / file).touch()
    (outside / "assignment.py").write_text('notebook = Notebook("Pendulum", notebook="1.1.ipynb")\n')
    name, content = own_wheel(outside)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        held = {path: archive.read(path) for path in archive.namelist()}
    assert (
        name.endswith(".whl")
        and {
            "exercises/pendulum/1.1.ipynb",
            "service/cli/__main__.py",
            "exercises/rigid_body/draws.py",
            "exercises/pendulum/assignment.py",
        }
        <= held.keys()
    )
    solutions = {
        path.read_bytes() for path in (rigid_body.folder / "samples").iterdir() if path.is_file()
    } | {b"def solved(): pass"}
    assert "exercises/pendulum/2.1.ipynb" not in held
    assert not [path for path in held if "/samples/" in path] and not solutions & set(held.values())


class Gradescope:
    """What its harness does: unpacks the zip, builds the image once; for each submission runs run_autograder,
    takes the results.
    """

    def __init__(self, home):
        self.home = home
        for name in ("source", "submission", "results"):
            (home / name).mkdir(parents=True)
        (home / "autograder.zip").write_bytes(bundle(find("rigid-body"), ["2"]))
        with zipfile.ZipFile(home / "autograder.zip") as archive:
            for about in archive.infolist():
                archive.extract(about, home / "source")
                (home / "source" / about.filename).chmod(about.external_attr >> 16)
        shutil.copy(home / "source/run_autograder", home)
        self.container = Container(home, "/autograder/polhode")
        self.built = self.container.run("bash", "/autograder/source/setup.sh")

    def grade(self, files, before="", **environment):
        """(exit code, all that was printed, results or None) of a submission of ``files``, name and bytes."""
        for name in ("submission", "results"):
            shutil.rmtree(self.home / name)
            (self.home / name).mkdir()
        for name, content in files.items():
            file = self.home / "submission" / name
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(content)
        told = self.container.run("sh", "-c", f"{before} exec /autograder/run_autograder", **environment)
        assert told.stderr == ""
        results = self.home / "results/results.json"
        return told.returncode, told.stdout, json.loads(results.read_text()) if results.exists() else None


@pytest.fixture(scope="module")
def gradescope(tmp_path_factory):
    made = Gradescope(tmp_path_factory.mktemp("gradescope") / "autograder")
    assert made.built.returncode == 0 and "self-test     passed" in made.built.stdout, (
        made.built.stdout + made.built.stderr
    )
    return made


@pytest.fixture
def sample(rigid_body):
    return lambda name: (rigid_body.folder / "samples" / name).read_bytes()


@pytest.mark.slow
def test_the_zip_holds_programs_that_install_by_hashes_and_run_the_harness_on_the_exercises_asked_for(
    rigid_body, tmp_path
):
    """In a container run test_a_submission_gets_its_points and those below; here there is no /autograder."""
    with zipfile.ZipFile(io.BytesIO(bundle(rigid_body, ["2", "6"]))) as archive:
        archive.extractall(tmp_path)
        modes = {about.filename: about.external_attr >> 16 for about in archive.infolist()}
    assert {name for name, mode in modes.items() if mode & 0o111} == {"setup.sh", "run_autograder"}
    assert modes.keys() == {"setup.sh", "run_autograder", "requirements.lock", WHEEL, own_wheel()[0]}
    assert subprocess.run(["bash", "-n", tmp_path / "setup.sh"], check=False).returncode == 0
    assert (
        "install --quiet --require-hashes --requirement requirements.lock"
        in (tmp_path / "setup.sh").read_text()
    )
    script = (tmp_path / "run_autograder").read_text()
    assert " --assignment rigid-body --exercise 2 --exercise 6 2>&1\n" in script
    script = script.replace("/autograder/polhode/bin/python", sys.executable)
    told = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=False)
    assert told.returncode == 2 and "Gradescope provided no folder /autograder/submission" in told.stdout


def points(results):
    return results["score"], sum(test.get("max_score", 0) for test in results["tests"])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "expected"), [("right_notebook.ipynb", (5, 5)), ("wrong_zeros.py", (2, 5))])
def test_a_submission_gets_its_points(gradescope, sample, name, expected):
    code, printed, results = gradescope.grade(
        {name: sample(name), ".ipynb_checkpoints/old.py": b"x = 1", "notes.txt": b"mine"}
    )
    assert (code, points(results)) == (0, expected), printed
    assert f"== /autograder/submission/{name}" in printed


@pytest.mark.slow
def test_a_submission_that_looks_for_our_files_finds_none(gradescope):
    walk = b"import os\nos.listdir('/autograder/source')\n"
    code, printed, results = gradescope.grade({"mine.py": walk})
    assert (code, points(results)) == (0, (0, 5)) and "PermissionError" in printed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"mine.txt": b"x"}, "no .py or .ipynb file"),
        ({"a.py": b"x = 1", "sub/b.ipynb": b"{}"}, "2 .py or .ipynb files: a.py, sub/b.ipynb"),
        ({"mine.py": b"\xff\xfe"}, "not a text file"),
    ],
)
def test_what_is_no_submission_gets_a_sentence_for_the_student(gradescope, files, said):
    code, printed, results = gradescope.grade(files)
    assert (code, points(results)) == (0, (0, 5)) and said in results["output"], printed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("before", "environment", "reason"),
    [
        ("", {"POLHODE_MIN_ISOLATION": "namespaces"}, "namespaces are not available"),
        ("ulimit -f 0;", {}, "File too large"),
        ("ulimit -v 60000;", {}, "failed to map segment"),  # with a little more, OpenBLAS loads and hangs
    ],
    ids=["no sandbox", "no room on the disk", "no memory"],
)
def test_where_we_cannot_grade_there_are_no_results_and_the_reason_is_printed(
    gradescope, sample, before, environment, reason
):
    code, printed, results = gradescope.grade({"mine.py": sample("right_terms.py")}, before, **environment)
    assert (code, results) == (2, None)
    assert reason in printed and "system fault (exit code " in printed.splitlines()[-1]
