"""Where tests lie: those of a package mirror its modules, so that the tests of a module are found by its
name.
"""

import ast

import pytest

from tests.support.checkout import ROOT

TESTS = ROOT / "tests"
ELSEWHERE = {
    "attacks",
    "browser",
    "image",
    "project",
    "support",
    "system",
}  # of several packages, or of the repository itself


def test_a_file_of_tests_has_the_name_of_what_it_tests():
    strays = []
    for file in TESTS.rglob("test_*.py"):
        package, *_ = parts = file.relative_to(TESTS).parts
        tested = ROOT.joinpath(*parts[:-1], file.stem.removeprefix("test_"))
        kinds = (tested, tested.with_suffix(".py"), tested.with_suffix(".ipynb"))
        if package not in ELSEWHERE and not any(kind.exists() for kind in kinds):
            strays.append(str(file.relative_to(ROOT)))
    assert strays == []


def test_what_lies_at_the_top_is_no_helper():
    assert {path.name for path in TESTS.glob("*.py")} <= {"conftest.py", "sabotage.py"}


@pytest.mark.parametrize(
    "file",
    [
        *ROOT.glob("exercises/*/assignment.py"),
        *TESTS.glob("assignments/*/assignment.py"),
        ROOT / "service/cli/authoring/template/assignment.py",
    ],
    ids=lambda file: file.parent.name,
)
def test_a_declaration_imports_no_other_assignment(file):
    """lint-imports does not see a folder without __init__.py."""
    nodes = list(ast.walk(ast.parse(file.read_text())))
    names = {
        f"{node.module}.{alias.name}"
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    names |= {f"{alias.name}." for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    allowed = {"assignment", "author", "authoring", "kinds", file.parent.name}
    found = {
        name
        for name in names
        if name.split(".")[0] in ("exercises", "service") and name.split(".")[1] not in allowed
    }
    assert found == set()
