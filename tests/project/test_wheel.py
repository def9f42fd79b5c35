"""polhode as a wheel: what ``pip install .`` makes of a checkout, and the one that is made of what runs."""

import io
import os
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from exercises.authoring.publishing.wheel import wheel as kit_wheel
from service.cli.grading.gradescope_export import bundle, own_wheel

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel by hatchling, unpacked, beside that of the kit."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder]
    subprocess.run(build, cwd=ROOT, capture_output=True, check=True)
    subprocess.run(build, cwd=ROOT / "exercises/kit", capture_output=True, check=True)
    for name, into in (("polhode-*.whl", "unpacked"), ("polhode_kit-*.whl", "kit")):
        [built] = folder.glob(name)
        with zipfile.ZipFile(built) as archive:
            archive.extractall(folder / into)
    return folder / "unpacked"


def polhode(wheel, *arguments, cwd):
    """Only the wheel's own modules, not the checkout's."""
    environment = os.environ | {"PYTHONPATH": f"{wheel}:{wheel.parent / 'kit'}"}
    command = [sys.executable, "-m", "service.cli", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)


def contents(folder):
    return {
        str(p.relative_to(folder)): p.read_bytes()
        for p in folder.rglob("*")
        if p.is_file() and "__pycache__" not in p.parts
    }


def read(archive):
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        return {name: opened.read(name) for name in opened.namelist()}


def test_it_holds_what_runs_and_no_sample(wheel, rigid_body):
    found = contents(wheel)
    assert {
        "exercises/rigid_body/notebook.ipynb",
        "exercises/rigid_body/course/ecp/validate.py",
        "service/cli/grading/gradescope_zip/setup.sh",
    } <= found.keys()
    kit = contents(wheel.parent / "kit")
    assert not found.keys() & kit.keys() and "polhode/__init__.py" in kit
    lock = (ROOT / "requirements/runtime.lock").read_bytes()
    assert found["service/cli/grading/gradescope_zip/requirements.lock"] == lock
    solutions = {p.read_bytes() for p in (rigid_body.folder / "samples").iterdir() if p.is_file()}
    assert len(solutions) > 100 and not solutions & {*found.values(), *kit.values()}


def test_the_one_made_of_what_runs_is_the_same(wheel):
    name, content = own_wheel()
    ours, built = read(content), contents(wheel)
    assert name.startswith("polhode-") and ours.keys() == {n for n in built if "/samples/" not in n}
    different = {n.rpartition("/")[2] for n in ours if ours[n] != built[n]}
    assert different <= {"WHEEL", "RECORD", "METADATA"}


@pytest.mark.slow
def test_installed_it_grades_and_exports_the_same_zip(wheel, rigid_body, tmp_path):
    told = polhode(
        wheel, "grade", rigid_body.folder / "samples/right_terms.py", "--exercise", "2", cwd=tmp_path
    )
    assert told.returncode == 0 and "5 of 5 points" in told.stdout, told.stderr
    told = polhode(
        wheel,
        "export",
        "gradescope",
        "--assignment",
        "rigid-body",
        "--exercise",
        "2",
        "--out",
        "autograder.zip",
        cwd=tmp_path,
    )
    assert told.returncode == 0 and "set the autograder points to 5" in told.stdout, told.stderr
    assert (tmp_path / "autograder.zip").read_bytes() == bundle(rigid_body, ["2"])


def test_the_kit_that_the_server_serves_is_the_same(wheel):
    served, built = read(kit_wheel()), contents(wheel.parent / "kit")
    assert served.keys() == built.keys()
    assert {name.rpartition("/")[2] for name in served if served[name] != built[name]} <= {"WHEEL", "RECORD"}


def test_an_assignment_from_outside_comes_along_without_its_samples(rigid_body, tmp_path):
    shutil.copytree(
        rigid_body.folder, tmp_path / "spinning_top", ignore=shutil.ignore_patterns("__pycache__")
    )
    (tmp_path / "spinning_top" / ".git").mkdir()
    for private in (".env", ".git/config", "solution.ipynb"):
        (tmp_path / "spinning_top" / private).write_text("mine")
    files = read(bundle(replace(rigid_body, slug="spinning-top", folder=tmp_path / "spinning_top"), None))
    inside = read(files["polhode-0.1.0rc1-py3-none-any.whl"])
    assert b" --assignment spinning-top 2>&1" in files["run_autograder"]
    theirs = {
        n.removeprefix("exercises/spinning_top/") for n in inside if n.startswith("exercises/spinning_top/")
    }
    assert theirs == {
        n.removeprefix("exercises/rigid_body/") for n in inside if n.startswith("exercises/rigid_body/")
    }
