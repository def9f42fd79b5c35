"""Packages beyond numpy, scipy and matplotlib: importable where the assignment declares them, and nowhere
else.
"""

from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib import font_manager, get_cachedir

from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.submission import Submission
from service.sandbox.isolation.guest_files import font_list, packages
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.isolation.select import choose, with_packages
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox

EXTRA = ("iniconfig",)  # small, pure Python, and installed for pytest
CODE = """
import iniconfig, pathlib
def box_moments(m, a, b, c):
    try:
        (pathlib.Path(iniconfig.__file__).parent / "x.py").write_text("x")
    except OSError:
        return m / 12 * np.array([b * b + c * c, c * c + a * a, a * a + b * b])
"""


@pytest.mark.parametrize(
    "isolation",
    [lambda: choose("namespaces"), pytest.param(process_isolation, marks=pytest.mark.slow)],
    ids=["namespaces", "process"],
)
def test_a_declared_package_can_be_imported_and_not_written_to(rigid_body, isolation):
    sandbox = Sandbox(with_packages(isolation(), EXTRA))
    try:
        report = grade(Submission(CODE), replace(rigid_body, packages=EXTRA), sandbox, 1, ["1"]).report
    finally:
        sandbox.close()
    verdicts = {outcome.id: outcome.verdict for outcome in report.outcomes()}
    assert verdicts["1-boxes"] is Verdict.PASS, report.text()


def test_without_it_the_error_lists_what_there_is(rigid_body, sandbox):
    report = grade(Submission(CODE), rigid_body, sandbox, 1, ["1"]).report
    lacks = "ModuleNotFoundError: No module named 'iniconfig' (the sandbox has numpy "
    assert report.scene_ends[0].sentence.startswith(lacks)
    assert lacks in report.text()


@pytest.mark.slow
def test_a_package_that_the_server_lacks_is_a_fault(rigid_body, sandbox, tmp_path):
    lacking = replace(rigid_body, packages=("no-such-package",))
    with pytest.raises(
        SystemFault, match="rigid-body needs packages that are not installed on this server: no-such-package"
    ):
        grade(Submission(CODE), lacking, sandbox, 1)
    (tmp_path / "mine.py").write_text(CODE)
    with pytest.raises(SystemFault, match="no-such-package"):
        list(grade_files([GradeRequest(tmp_path / "mine.py")], GradeOptions(lacking, 1), choose()))


def test_the_packages_of_a_guest_are_those_that_its_distributions_require():
    found = packages(EXTRA)
    needed = {
        "numpy",
        "numpy.libs",
        "scipy",
        "matplotlib",
        "mpl_toolkits",
        "PIL",
        "dateutil",
        "kiwisolver",
        "iniconfig",
    }
    assert needed.issubset(found) and not {"pytest", "psycopg", "fastapi", "..", "__pycache__"} & set(found)
    assert "iniconfig" not in packages()


def test_the_font_list_is_that_of_this_matplotlib():
    assert font_list() == [Path(get_cachedir()) / f"fontlist-v{font_manager.FontManager.__version__}.json"]
