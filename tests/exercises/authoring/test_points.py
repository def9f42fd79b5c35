"""The points of an exercise among its checks."""

import pytest

from exercises.authoring.points import allotted


@pytest.mark.parametrize("points", [1, 3, 4, 6, 7, 36, 100])
def test_all_points_are_given(points):
    assert sum(allotted(points, [["a", "b"], ["c", "d", "e"]], [1, 1]).values()) == points


def test_checks_of_a_question_are_worth_the_same_and_the_last_one_gets_the_rest():
    assert allotted(7, [["public", "hidden"]], [1]) == {"public": 3, "hidden": 4}


def test_shares_are_those_of_questions():
    found = allotted(9, [["a", "b"], ["c"]], [1, 2])
    assert found["c"] == 6 and found["a"] + found["b"] == 3


def test_a_question_with_few_checks_takes_nothing_from_one_with_many():
    many, few = ["x", "y", "z", "new x", "new y", "new z"], ["only", "other"]
    found = allotted(6, [many, few], [1, 1])
    assert [found[id] for id in many] == [0, 0, 0, 1, 1, 1]
    assert found["only"] + found["other"] == 3
