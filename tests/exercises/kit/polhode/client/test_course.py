"""The server and the assignment of a notebook: what ``connect`` brings, and what is used without a server."""

import json
import subprocess
import sys

import pytest

import polhode
from exercises.authoring.publishing import public_assignment
from polhode.client import cache, course
from tests.support.assignments import copied, known
from tests.support.fake_server import Scripted, says
from tests.support.kit import environment, installed

SERVER = "http://course.example"
RIGHT = "def oscillator(t, y, omega, gamma):\n    x, v = y\n    return [v, -(omega**2) * x - 2 * gamma * v]\n"
ZEROS = "def euler_eqs(t, w, I):\n    return 0 * w\n"
SLUGS = ("rigid-body", "damped-oscillator")


@pytest.fixture
def student(tmp_path):
    """A function that puts assignments into the cache of a student with the kit, and returns the kit's
    folder.
    """

    def install(*slugs, server=SERVER):
        with known(tmp_path / "course"):
            return installed(tmp_path, *slugs, server=server)

    (tmp_path / "course").mkdir()
    copied(tmp_path / "course")
    return install


def kernel(kit, *lines):
    """Return what each of ``lines``, run in one kernel with the kit, evaluates to as text."""
    code = f"""
import json, sys
sys.path.insert(0, {str(kit)!r})
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
        [sys.executable, "-P", "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=kit.parent,
        env=environment(kit),
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_with_one_assignment_neither_server_nor_assignment_has_to_be_named(student):
    report, server, slug = kernel(
        student("damped-oscillator"),
        "polhode.check()",
        "polhode.client.course.server()",
        "polhode.client.course.assignment()",
    )
    assert report.endswith("2 of 2 public checks ✓\n") and (server, slug) == (SERVER, "damped-oscillator")


def test_a_second_assignment_leaves_the_first_as_it_was(student):
    checks = (
        'polhode.check("1", assignment="damped-oscillator")',
        'polhode.check("2", assignment="rigid-body")',
    )
    both = kernel(student(*SLUGS), *checks, "polhode.check()", "polhode.client.course.server()")
    assert "2 of 2 public checks ✓" in both[0] and "✗" in both[1] and "Exercise 2." in both[1]
    assert both[2].startswith("No assignment is set (damped-oscillator, rigid-body are on this computer)")
    assert both[3] == SERVER


def test_the_message_without_an_assignment_says_what_to_call(student):
    (sentence,) = kernel(student("damped-oscillator"), 'polhode.check(assignment="rigid-body")')
    assert sentence.startswith("the checks of rigid-body are not on this computer (only damped-oscillator)")
    assert 'polhode.connect("https://…", assignment="rigid-body")' in sentence


def test_checks_that_do_not_fit_the_kit_say_so(student):
    kit = student(*SLUGS)
    home = kit.parent / "cache" / "polhode" / "assignments" / "damped_oscillator"
    (home / "plays.py").write_text("from polhode.judging.checks import earlier\n")
    broken, other = kernel(
        kit, 'polhode.check(assignment="damped-oscillator")', 'polhode.check("2", assignment="rigid-body")'
    )
    assert "do not fit the installed version of polhode-kit (ImportError: cannot import name" in broken
    assert f"{SERVER}/kit/polhode_kit-1-py3-none-any.whl" in broken and "✗" in other


KERNEL = """
import sys
sys.path.insert(0, {kit!r})
{before}
import polhode
import ecp
print(ecp.__file__)
"""


def test_in_a_new_kernel_the_kit_finds_the_packages_of_the_assignment_connected_last(student):
    kit = student("rigid-body", server="")
    kernel(kit, 'polhode.connect(assignment="rigid-body")')
    ends = []
    for before in ("import IPython", ""):
        code = KERNEL.format(kit=str(kit), before=before)
        done = subprocess.run(
            [sys.executable, "-P", "-c", code], capture_output=True, text=True, env=environment(kit)
        )
        ends.append(done.stdout.strip().rpartition("/assignments/")[2] or done.stderr.splitlines()[-1])
    assert ends == ["rigid_body/course/ecp/__init__.py", "ModuleNotFoundError: No module named 'ecp'"]


def test_an_installed_package_that_lacks_what_the_course_has_is_named(server, tmp_path, capsys, monkeypatch):
    cache.store(cache.home("rigid-body"), public_assignment.archive("rigid-body"), "http://polhode.invalid")
    installed_one = tmp_path / "site" / "ecp"
    installed_one.mkdir(parents=True)
    for name in ("__init__.py", "animate.py", "draw.py", "style.py"):
        (installed_one / name).write_text("")
    sys.path.insert(0, str(installed_one.parent))
    for text, named in (
        (None, "ecp.validate"),
        ("def check(): ...\n", "ecp.validate"),
        ("def check(): ...\ndef close(): ...\n", ""),
    ):
        if text is not None:
            (installed_one / "validate.py").write_text(text)
        polhode.connect("http://polhode.invalid", assignment="rigid-body")
        said = capsys.readouterr().out
        assert (
            f"The package ecp that is installed in {installed_one} is not the course's: it lacks" in said
        ) is (named != "")
        assert f"it lacks {named}. Run %pip uninstall ecp" in said or not named


@pytest.fixture
def server(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(course, "_connected", [course.Course()])
    monkeypatch.setattr(cache, "PATIENCE_S", 0.1)
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "meta_path", list(sys.meta_path))
    started = Scripted()
    yield started
    started.stop()


def packages_from():
    return sys.meta_path[-1].folder


def test_connect_brings_an_assignment_and_asks_for_it_only_if_it_has_changed(server, capsys):
    sent = says(200, public_assignment.archive("rigid-body"), "application/zip")
    server.script += [sent, says(304, b"", "application/zip")]
    for _ in range(2):
        polhode.connect(server.url, assignment="rigid-body")
    first, again = server.seen
    assert first.path == "/v1/assignments/rigid-body/kit" and "if-none-match" not in first.headers
    assert again.headers["if-none-match"] == f'"{public_assignment.build("rigid-body")}"'
    assert cache.made("rigid-body") == {"build": public_assignment.build("rigid-body"), "server": server.url}
    assert packages_from() == cache.home("rigid-body") / "course" and capsys.readouterr().out == ""


def test_without_the_server_what_came_earlier_is_used(server, capsys):
    cache.store(cache.home("rigid-body"), public_assignment.archive("rigid-body"), "http://polhode.invalid")
    polhode.connect("http://polhode.invalid", assignment="rigid-body")
    assert "the checks and files that came earlier are used" in capsys.readouterr().out
    assert packages_from() == cache.home("rigid-body") / "course"
