"""The course's own packages in a notebook's kernel: after all that is installed, and named where they are
missing.
"""

import subprocess
import sys

import pytest

from polhode.client import cache
from tests.support.kit import environment, installed

IN_EDITABLE_MODE = """
from importlib.machinery import PathFinder
class Finder:  # as setuptools installs it, behind the folders of sys.path
    def find_spec(name, path=None, target=None):
        return PathFinder.find_spec(name, [{folder!r}]) if path is None else None
sys.meta_path.append(Finder)
"""


@pytest.fixture
def kernel(tmp_path):
    """A function that runs code as a notebook's kernel with the kit and these assignments, each with the
    module ``lab`` of the course and one of its own, and returns what it prints, or its last error.
    """
    kit = installed(tmp_path)
    for slug in ("first", "second"):
        folder = kit.parent / "cache" / "polhode" / "assignments" / slug
        (folder / "course" / "lab").mkdir(parents=True)
        (folder / "course" / "lab" / "__init__.py").write_text(f"FROM = 'the course, {slug}'\n")
        (folder / "course" / f"of_{slug}.py").write_text("")
        (folder / cache.MADE).write_text('{"build": "0", "server": ""}')

    def run(code):
        start = f"import sys\nsys.path.insert(0, {str(kit)!r})\nimport IPython\n"
        done = subprocess.run(
            [sys.executable, "-P", "-c", start + code],
            capture_output=True,
            text=True,
            timeout=60,
            cwd=kit.parent,
            env=environment(kit),
        )
        return done.stdout.strip() if done.returncode == 0 else done.stderr.strip().splitlines()[-1]

    return run


CONNECT = 'import polhode\npolhode.connect(assignment="first")\n'
WHICH = "import lab\nprint(lab.FROM)\n"


def test_what_is_installed_comes_first_in_editable_mode_too(kernel, tmp_path):
    (tmp_path / "clone" / "lab").mkdir(parents=True)
    (tmp_path / "clone" / "lab" / "__init__.py").write_text("FROM = 'installed'\n")
    clone = str(tmp_path / "clone")
    assert kernel(CONNECT + WHICH) == "the course, first"
    assert kernel(f"sys.path.append({clone!r})\n{CONNECT}{WHICH}") == "installed"
    assert kernel(IN_EDITABLE_MODE.format(folder=clone) + CONNECT + WHICH) == "installed"
    # installed while the kernel runs, after the kit was imported
    assert kernel("import polhode\n" + IN_EDITABLE_MODE.format(folder=clone) + CONNECT + WHICH) == "installed"


def test_a_second_assignment_brings_its_packages_in_place_of_those_of_the_first(kernel):
    both = CONNECT + 'import of_first\npolhode.connect(assignment="second")\nimport of_second\n'
    assert kernel(both + WHICH) == "the course, second"
    again = kernel(both + "del sys.modules['of_first']\nimport of_first")
    assert again == "ModuleNotFoundError: No module named 'of_first'"


BROUGHT = (
    "ModuleNotFoundError: No module named 'lab': if it is the course's own package, first run the cell that"
    " calls polhode.connect(…), which brings it"
)


def test_a_cell_that_runs_before_connect_is_told_what_to_run(kernel):
    for line in ("import lab", "import lab.part", "from lab import part"):
        assert kernel(f"import polhode\n{line}") == BROUGHT
    unknown = 'import polhode\npolhode.connect(assignment="third")\nimport lab'
    assert kernel(unknown).endswith(BROUGHT)  # it was not brought
    assert kernel(CONNECT + "import labs") == "ModuleNotFoundError: No module named 'labs'"


def test_only_a_cell_is_told(kernel, tmp_path):
    assert kernel("import polhode, importlib.util\nprint(importlib.util.find_spec('lab'))") == "None"
    probing = "try:\n    import lab\nexcept ImportError as error:\n    print({})\n"
    (tmp_path / "library.py").write_text(probing.format("error"))
    library = f"import polhode\nsys.path.append({str(tmp_path)!r})\nimport library\n"
    assert kernel(library) == "No module named 'lab'"
    assert kernel("import polhode\n" + probing.format("'without'")) == "without"
