"""What the course's packages import is in the sandbox, and in the command that installs the kit."""

import pytest

from exercises.authoring.assignments.course_imports import distributions, libraries
from exercises.authoring.publishing import wheel
from tests.support.assignments import copied, known
from tests.support.course_shape import written


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import sympy as sp\nfrom numpy import linalg\nimport polhode, json, cycler\n", ("sympy",)),
        ("def f():\n    from yaml.nodes import Node\n", ("pyyaml",)),
        ("import lab.other\nfrom . import order\n", ()),
        ("try:\n    import google.colab\nexcept ImportError:\n    pass\n", ()),
        ("def f(:\n", ()),
    ],
)
def test_only_what_is_installed_and_no_sandbox_has_anyway(source, found, tmp_path):
    written(tmp_path / "lab", "__init__.py", source)
    assert tuple(name.lower() for name in distributions((tmp_path,))) == found


def test_every_assignment_has_what_the_courses_packages_import(tmp_path):
    copied(tmp_path)
    with known(tmp_path) as without:
        assert without.valid["rigid-body"].packages == ()
    written(tmp_path / "course" / "lab", "__init__.py", "import sympy\n")
    with known(tmp_path) as found:
        for slug in ("rigid-body", "damped-oscillator"):
            assert found.valid[slug].packages == ("sympy",)
        assert "KIT sympy\\n" in wheel.notebook(found.valid["rigid-body"], "http://s", "KIT").decode()


def test_what_is_imported_with_the_package_is_loaded_beforehand(tmp_path):
    written(tmp_path / "lab", "__init__.py", "import numpy\nimport sympy.abc\ndef f():\n    import yaml\n")
    written(tmp_path / "lab", "no_such.py", "import no_such_library\n")
    assert libraries((tmp_path,)) == ("sympy",)
