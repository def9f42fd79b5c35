"""The course's own packages are imported in the sandbox, and each that fails there is named."""

import shutil
from pathlib import Path

import markupsafe._speedups
import pytest

from exercises.authoring.assignments import catalogue
from service.cli.__main__ import main
from service.cli.authoring.verify.course_packages import import_errors
from service.sandbox.isolation import select
from tests.support.assignments import copied, known
from tests.support.course_shape import written

SAID = "the course's module {} cannot be imported in the sandbox: "
PACKAGES = {
    "raises.py": ("x = 1\ny = 1 / 0\n", "course/raises.py, line 2: ZeroDivisionError: division by zero"),
    "exits.py": ("import sys\nsys.exit(1)\n", "course/exits.py, line 2: SystemExit: 1"),
    "ends.py": ("import os\nos._exit(3)\n", "its process exited with code 3"),
    "threads.py": (
        "import threading\nthreading.Thread(target=print).start()\n",
        "course/threads.py, line 2: Runt",
    ),
    "needs.py": ("import no_such_library\n", "course/needs.py, line 1: ModuleNotFoundError: No module named"),
    "writes.py": ("open('log.txt', 'w').write('x')\n", None),
    "writes_elsewhere.py": ("open('/tmp/x/log.txt', 'w')\n", "course/writes_elsewhere.py, line 1: "),
    "works.py": ("import numpy, sympy\n", None),
}


@pytest.fixture
def course(tmp_path):
    copied(tmp_path)
    tmp_path.chmod(0o755)
    return tmp_path


def failures(course):
    with known(course):
        isolation = select.choose("process", True)
        packages = catalogue.find("damped-oscillator").packages
        return list(import_errors(select.with_packages(isolation, packages)))


def test_each_module_that_fails_is_named_with_file_and_line(course):
    for name, (text, _) in PACKAGES.items():
        written(course / "course", name, text)
    found = failures(course)
    expected = {Path(name).stem: words for name, (_, words) in PACKAGES.items() if words}
    assert len(found) == len(expected)
    for sentence, (name, words) in zip(found, sorted(expected.items()), strict=True):
        assert sentence.startswith(SAID.format(name)) and words in sentence


@pytest.mark.slow
def test_a_module_that_does_not_end_is_named(course):
    written(course / "course", "endless.py", "while True:\n    pass\n")
    (sentence,) = failures(course)
    assert "importing it takes more than 10 s" in sentence and "course/endless.py, line" in sentence


def test_a_compiled_extension_works(course):
    compiled = Path(markupsafe._speedups.__file__)
    written(course / "course" / "lab", "__init__.py", "from lab._speedups import _escape_inner\n")
    shutil.copy(compiled, course / "course" / "lab" / compiled.name)
    (course / "course" / "lab" / compiled.name).chmod(0o644)
    assert failures(course) == []


def test_verify_and_assignments_say_it_and_verify_still_compares_the_samples(course, capsys, warm_guest):
    written(course / "course", "raises.py", PACKAGES["raises.py"][0])
    written(course / "course", "random.py", "")
    with known(course):
        assert main(["assignments"]) == 2
        listed = capsys.readouterr()
        code = main(["verify", "--jobs", "1", "damped-oscillator", "--only", "right_terms.py"])
    verified = capsys.readouterr()
    shadows = f"polhode: {course / 'course' / 'random.py'} has the name of a module of the standard library"
    assert shadows in listed.err and "damped-oscillator" in listed.out
    assert code == 2 and shadows in verified.err and PACKAGES["raises.py"][1] in verified.err
    assert "✓  right_terms.py" in verified.out
