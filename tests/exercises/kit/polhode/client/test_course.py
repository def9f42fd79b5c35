"""Kits in a student's environment: one needs no slug, a second one does not break the first."""

import io
import json
import subprocess
import sys
import zipfile

import pytest

from exercises.wheel import filename, wheel
from tests.support.assignments import copied, known

SERVER = "http://course.example"
RIGHT = "def oscillator(t, y, omega, gamma):\n    x, v = y\n    return [v, -(omega**2) * x - 2 * gamma * v]\n"
ZEROS = "def euler_eqs(t, w, I):\n    return 0 * w\n"


@pytest.fixture(scope="module")
def wheels(tmp_path_factory):
    """The kits of two assignments."""
    folder = tmp_path_factory.mktemp("course")
    copied(folder)
    with known(folder):
        return {slug: wheel(slug, SERVER) for slug in ("rigid-body", "damped-oscillator")}


@pytest.fixture
def installed(wheels, tmp_path):
    def install(*slugs):
        for slug in slugs:
            with zipfile.ZipFile(io.BytesIO(wheels[slug])) as archive:
                archive.extractall(tmp_path)
        return tmp_path

    return install


def kernel(folder, *lines):
    """Return what each of ``lines``, run in one kernel with the kits in ``folder``, evaluates to as text."""
    code = f"""
import json, sys
sys.path.insert(0, {str(folder)!r})
import polhode.client.course
names, values = {{"polhode": polhode}}, []
exec({RIGHT + ZEROS!r}, names)
for line in {lines!r}:
    try:
        values.append(str(eval(line, names)))
    except polhode.client.course.UnknownCourse as error:
        values.append(str(error))
print(json.dumps(values))
"""
    done = subprocess.run(
        [sys.executable, "-P", "-c", code], capture_output=True, text=True, timeout=60, cwd=folder, env={}
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_with_one_kit_neither_server_nor_assignment_has_to_be_named(installed):
    report, server, slug = kernel(
        installed("damped-oscillator"),
        "polhode.check()",
        "polhode.client.course.server()",
        "polhode.client.course.assignment()",
    )
    assert report.endswith("2 of 2 public checks ✓\n") and (server, slug) == (SERVER, "damped-oscillator")


@pytest.mark.slow
def test_a_second_kit_leaves_the_first_as_it_was(installed):
    checks = (
        'polhode.check("1", assignment="damped-oscillator")',
        'polhode.check("2", assignment="rigid-body")',
    )
    alone = kernel(installed("damped-oscillator"), checks[0])
    both = kernel(installed("rigid-body"), *checks, "polhode.check()", "polhode.client.course.server()")
    assert both[0] == alone[0] and "✗" in both[1] and "Exercise 2." in both[1]
    assert (
        both[2].startswith("No assignment is set (kits of damped-oscillator, rigid-body are installed)")
        and both[3] == SERVER
    )


def test_the_message_without_an_assignments_kit_has_its_address(installed):
    (sentence,) = kernel(installed("damped-oscillator"), 'polhode.check(assignment="rigid-body")')
    assert "the kit of rigid-body is not installed, only that of damped-oscillator" in sentence
    assert (
        f"%pip install --force-reinstall --no-deps {SERVER}/kit/{filename('rigid-body')} and restart the"
        " kernel" in sentence
    )


def test_a_kit_that_does_not_fit_the_one_installed_last_says_so(installed):
    folder = installed("damped-oscillator", "rigid-body")
    (folder / "polhode" / "assignments" / "damped_oscillator" / "__init__.py").write_text(
        "from polhode.judging.checks import earlier\n"
    )
    broken, other = kernel(
        folder, 'polhode.check(assignment="damped-oscillator")', 'polhode.check("2", assignment="rigid-body")'
    )
    assert (
        "the kit of damped-oscillator does not fit the installed version of polhode (ImportError: cannot"
        " import name" in broken
    )
    assert f"{SERVER}/kit/{filename('damped-oscillator')}" in broken and "✗" in other


@pytest.mark.slow
def test_pip_installs_both_kits_in_one_environment(wheels, tmp_path):
    subprocess.run(
        [sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", tmp_path / "venv"],
        check=True,
    )
    for slug in ("damped-oscillator", "rigid-body"):
        (tmp_path / filename(slug)).write_bytes(wheels[slug])
        pip = [
            sys.executable,
            "-m",
            "pip",
            "--python",
            tmp_path / "venv",
            "install",
            "--force-reinstall",
            "--no-deps",
            "--no-index",
        ]
        done = subprocess.run([*pip, tmp_path / filename(slug)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    (packages,) = (tmp_path / "venv").glob("lib/*/site-packages")
    reports = kernel(
        packages,
        'polhode.check("1", assignment="damped-oscillator")',
        'polhode.check("2", assignment="rigid-body")',
    )
    assert "2 of 2 public checks ✓" in reports[0] and "Exercise 2." in reports[1]
