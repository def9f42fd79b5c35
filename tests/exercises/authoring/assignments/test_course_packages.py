"""The course's own packages: which one is used, and what makes one unusable."""

import pytest

from exercises.authoring.assignments import course_packages
from tests.support.assignments import copied, known
from tests.support.course_shape import written


@pytest.fixture
def course(tmp_path):
    """The folder of a course with one assignment, and its folder of packages."""
    copied(tmp_path)
    written(tmp_path / "course" / "lab", "__init__.py", "from lab import order\n")
    written(tmp_path / "course" / "lab", "order.py", "x = 1\n")
    return tmp_path


def said(*folders):
    with known(*folders):
        return course_packages.errors(), course_packages.remarks()


def test_a_usable_package_is_not_mentioned(course):
    written(course / "course", "helpers.py", "y = 2\n")
    written(course / "course" / "data", "a b.csv", "1,2\n")  # no package
    assert said(course) == ((), [])


@pytest.mark.parametrize(
    ("file", "text", "sentence"),
    [
        (
            "random.py",
            "",
            "{} has the name of a module of the standard library, which comes before it: rename it",
        ),
        ("polhode/__init__.py", "", "has the name of the students' kit, which comes before it: rename it"),
        (
            "numpy.py",
            "",
            "has the name of a package that every notebook can use, which comes before it: rename",
        ),
        ("my-lab.py", "", "{} cannot be imported: rename it to a name of letters, digits and _"),
        ("lab/order.py", "def f(:\n", "{}, line 1: invalid syntax"),
        ("lab/order.py", "x = 1\0", "{}: source code string cannot contain null bytes"),
        ("lab.py", "x = 1\n", "the course's package lab exists in"),
    ],
)
def test_an_unusable_package_is_named_with_its_file_and_what_to_do(file, text, sentence, course):
    path = course / "course" / file
    written(path.parent, path.name, text)
    ((error,), _) = said(course)
    assert sentence.format(path) in error and str(course) in error


def test_of_two_folders_of_assignments_with_one_package_one_is_used(course, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    copied(other, "second")
    written(other / "course" / "lab", "__init__.py", "from lab import order\n")
    written(other / "course" / "lab", "order.py", "x = 1\n")
    assert said(course, other) == ((), []), "the same package"
    written(other / "course" / "lab", "order.py", "x = 2\n")
    ((error,), _) = said(course, other)
    used, unused = (folder / "course" / "lab" for folder in (course, other))
    assert error == f"the course's package lab exists in {used}, which is used, and in {unused}: remove one"


def test_the_package_of_one_assignment_gives_way_without_a_word(course):
    written(course / "course" / "ecp", "__init__.py", "")  # rigid-body has its own
    assert said(course) == ((), [])


def test_a_compiled_file_is_no_error(course):
    written(course / "course" / "lab", "fast.cpython-311-x86_64-linux-gnu.so", "")
    errors, (remark,) = said(course)
    assert (
        errors == () and "fast.cpython-311-x86_64-linux-gnu.so is compiled: students with another" in remark
    )


def test_modules_are_those_that_can_be_imported_and_those_with_words(course):
    for name, text in {"order.py": "x = 1\n", "validate.py": "def check(): ...\n"}.items():
        written(course / "course" / "lab", name, text)
    written(course / "course", "words.txt", "lab.order: converges\n")
    for name in ("random.py", "my-lab.py", "helpers.py"):
        written(course / "course", name, "")
    written(course / "course", "wrong.py", "def f(:\n")
    with known(course):
        found = course_packages.modules() - {"ecp", "ecp.validate"}
    assert found == {"lab", "lab.order", "lab.validate", "helpers"}
