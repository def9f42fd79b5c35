"""Assignments that lie elsewhere, and broken ones: each tells all that is wrong with it and costs no
other.
"""

import subprocess
import sys

import pytest

from exercises.authoring.assignments.assignment import InvalidAssignment, NoAssignment
from exercises.authoring.assignments.catalogue import (
    assignments,
    default_folder,
    find,
    folders,
    is_taken,
    register_folder,
)
from tests.support.assignments import change, copied, known
from tests.support.checkout import ROOT


@pytest.mark.parametrize("named", ["the folder itself", "the folder it is in"])
def test_an_assignment_outside_is_found(tmp_path, named):
    folder = copied(tmp_path / "my course")
    with known(folder if named == "the folder itself" else folder.parent) as found:
        assert list(found.valid) == ["rigid-body", "damped-oscillator"] and not found.invalid
        assert find("damped_oscillator").folder == folder
    assert "damped-oscillator" not in assignments()


def test_a_new_assignment_belongs_beside_those_of_the_checkout():
    with known():
        assert default_folder() == ROOT / "exercises"


def test_an_assignment_named_alone_brings_no_neighbour(tmp_path):
    one, two = copied(tmp_path), copied(tmp_path, "neighbour")
    with known(one) as found:
        assert list(found.valid) == ["rigid-body", "damped-oscillator"] and not is_taken("neighbour")
        register_folder(two)
        assert two in folders() and "neighbour" in assignments()


def test_a_course_names_its_assignments_in_order(tmp_path, monkeypatch):
    monkeypatch.setenv("POLHODE_COURSE", "neighbour  absent damped-oscillator")
    with known(copied(tmp_path), copied(tmp_path, "neighbour")) as found:
        assert list(found.valid) == ["neighbour", "damped-oscillator"]
        assert str(found.invalid["absent"]).endswith("POLHODE_COURSE names it, but it does not exist")


def test_one_assignment_is_found_without_loading_the_others():
    code = (
        "import sys; from exercises.authoring.assignments.catalogue import find; find('rigid-body');"
        " print(*(name for name in"
        " sys.modules))"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "exercises.rigid_body.assignment" in loaded and "sympy" not in loaded


def spoiled(folder):
    change(folder / "assignment.py", "relative(1e-12", "relative(-1e-12")
    change(folder / "assignment.py", "until=20.0", "until=-20.0")
    change(folder / "assignment.py", '@notebook.exercise("1"', '@notebook.exercise("one"')


def incomplete(folder):
    (folder / "notebook.ipynb").unlink()


def unreadable(folder):
    (folder / "causes.py").write_text("x = 1\ndef f(:\n")
    (folder / "truth.py").write_bytes(b"x = 1\0")


def raising(folder):
    change(folder / "assignment.py", "notebook = ", "TIMES = 32 / 0\nnotebook = ")


BROKEN = [
    (spoiled, ["one", "-20", "a tolerance must be a finite number"]),
    (incomplete, ["notebook.ipynb"]),
    (unreadable, ["causes.py line 2: invalid syntax", "truth.py"]),
    (raising, ["assignment.py line 7: ZeroDivisionError: division by zero"]),
    (
        lambda folder: change(folder / "assignment.py", "import numpy as np", "import nunpy as np"),
        ["assignment.py line 3", "nunpy"],
    ),
    (
        lambda folder: (folder / "assignment.py").write_text("notebook = 'x'"),
        ["assignment.py makes 0 notebooks; it must make one"],
    ),
    (
        lambda folder: (folder / "assignment.py").write_text("raise SystemExit(0)"),
        ["assignment.py line 1: SystemExit"],
    ),
]


@pytest.mark.parametrize(("spoil", "told"), BROKEN)
def test_a_broken_one_tells_everything_and_costs_no_other(tmp_path, spoil, told):
    spoil(copied(tmp_path))
    copied(tmp_path, "sound")
    with known(tmp_path) as found:
        assert list(found.valid) == ["rigid-body", "sound"] and list(found.invalid) == ["damped-oscillator"]
        with pytest.raises(InvalidAssignment) as caught:
            find("damped-oscillator")
    for part in told:
        assert part in str(caught.value)


def test_a_name_that_is_taken(tmp_path):
    for name in ("rigid_body", "authoring"):
        copied(tmp_path, name)
    with known(tmp_path) as found:
        assert list(found.valid) == ["rigid-body"] and find("rigid-body").folder != tmp_path / "rigid_body"
        assert "the name rigid_body is already used" in str(found.invalid["rigid-body"])
        assert "the name authoring is already used" in str(found.invalid["authoring"])


def test_a_folder_that_is_not_there_or_no_package(tmp_path):
    copied(tmp_path, "Two-Words")
    with known(tmp_path / "nowhere", tmp_path) as found:
        assert "there is no folder" in str(found.invalid["nowhere"])
        assert "Two-Words is not a package name" in str(found.invalid["Two-Words"])
    (tmp_path / "Two-Words" / "assignment.py").rename(tmp_path / "Two-Words" / "declaration.py")
    with known(tmp_path / "Two-Words") as found:
        assert "assignment.py is missing" in str(found.invalid["Two-Words"])
    with (
        known(),
        pytest.raises(
            NoAssignment, match=r"no assignment knitting; known: rigid-body; .* in POLHODE_ASSIGNMENTS"
        ),
    ):
        find("knitting")


def test_everything_that_a_host_asks_of_the_bundled_assignments_works_in_a_new_process():
    """Where no test has imported what an assignment needs."""
    script = """
from exercises.authoring.assignments.catalogue import assignments
for one in assignments().values():
    for scene in one.scenes:
        dict(scene.returns), dict(scene.question or {})
        scene.inputs if callable(scene.inputs) else dict(scene.inputs)
    print(one.slug, len(one.scenes) > 0)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert set(done.stdout.splitlines()) >= {f"{slug} True" for slug in assignments()}
