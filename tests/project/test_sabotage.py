"""The list of deliberate breakages fits the code and the tests that there are; what it is for is measured by
``make sabotage``.
"""

from collections import Counter

from tests import sabotage
from tests.support.breakages import BREAKAGES, Breakage


def test_every_breakage_fits_its_file_and_names_tests_that_are_there():
    assert sabotage.errors(BREAKAGES) == []


def test_there_are_many_breakages_and_of_no_module_more_than_a_few():
    by_file = Counter(one.file for one in BREAKAGES)
    assert len(BREAKAGES) >= 45 and max(by_file.values()) <= 4, by_file.most_common(3)
    assert {file.split("/")[0] for file in by_file} == {"reference", "exercises", "service"}


def test_what_is_wrong_with_a_list_is_told_all_at_once():
    here = "tests/project/test_sabotage.py"
    wrong = [
        Breakage("one", "reference/euler.py", "import numpy as np", "import numpy", (here,)),
        Breakage("one", "reference/nowhere.py", "x", "y", (f"{here}::test_nothing",)),
        Breakage("two", "reference/euler.py", "w1", "w1", ()),
    ]
    found = sabotage.errors(wrong)
    expected = (
        "there twice",
        "0 times",
        "no test tests/project",
        "times in reference/euler.py",
        "changes nothing",
    )
    assert len(found) == len(expected)
    for line, words in zip(found, expected, strict=True):
        assert words in line
