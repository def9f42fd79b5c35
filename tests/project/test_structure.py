"""Where tests lie: those of a package mirror its modules, so that the tests of a module are found by its name."""

from tests.support.checkout import ROOT

TESTS = ROOT / "tests"
ELSEWHERE = {"attacks", "browser", "image", "project", "support", "system"}  # of several packages, or of the repository itself


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
