"""Sentences about the arguments of a call and about what it returned are short enough to read."""

import numpy as np
import pytest

from polhode.judging.return_value import WrongAnswer, article
from polhode.kinds.student_calls import (
    MOST_CALLS,
    Counted,
    arguments,
    describe,
    evaluate,
    evaluations,
    expression,
    returned,
)


def test_a_large_argument_is_shown_by_its_corners():
    question = {"drawn": ["r", "t", "n"]}
    seen = {"at_r": np.ones((1, 9, 6, 2)), "at_t": np.arange(40.0)[None], "at_n": np.array([3])}
    text = describe(question, seen, 0)
    assert (
        text.startswith("r = [[[1., 1.], ...")
        and text.endswith("t = [ 0., 1., 2., ..., 37., 38., 39.], n = 3")
        and len(text) < 130
    )


@pytest.mark.parametrize(
    ("call", "named"),
    [
        ("modes(m)[0]", "`modes(m)[0]`"),
        ("[w for w, X in [modes(m)]]" + " * 1" * 30, "what the check makes of modes's answers"),
    ],
)
def test_a_long_expression_of_the_author_is_not_quoted(call, named):
    question = {"function": "modes", "call": call, "returns": [{"name": "omega", "shape": []}]}
    with pytest.raises(WrongAnswer, match="it is a complex128") as raised:
        returned(question, np.complex128(1j))
    assert str(raised.value).startswith(f"{named} must be a real number")


def test_an_article_before_a_vowel_is_an():
    nouns = ("Equality", "int", "OrderedDict", "Undefined", "str", "dict", "uint8", "ufunc", "Union")
    assert [article(noun).split()[0] for noun in nouns] == ["an"] * 4 + ["a"] * 5
    question = {"function": "modes", "returns": [{"name": "omega", "shape": []}, {"name": "X", "shape": []}]}
    with pytest.raises(WrongAnswer, match=r"it returned an int$"):
        returned(question, 3)
    with pytest.raises(WrongAnswer, match=r"it returned an Exception$"):
        returned({**question, "returns": question["returns"][:1]}, Exception())


def test_a_function_argument_has_its_name_and_counts_its_calls():
    question = {
        "constants": {},
        "families": {"step": {"text": "-x", "over": ["x"], "given": []}},
        "parameters": ["step"],
    }
    step = arguments(question, {})["step"]
    assert step.__name__ == "step" and (step(2), step(x=3)) == (-2, -3) and step.calls == 2


@pytest.mark.parametrize(
    ("values", "unit", "calls"),
    [
        ([0.5], 1, 1),
        ([], 1, 1),
        ([np.float64(0.5), np.zeros(1)], 1, 1),
        ([np.zeros(2000)], 1, 2000),
        ([[[0.5, 0.5], [0.5]]], 1, 3),
        ([np.zeros(2), np.zeros(2)], 2, 1),
        ([np.zeros(3)], 2, 2),
        ([np.zeros(0)], 2, 1),
    ],
)
def test_a_call_with_many_places_at_once_counts_for_many(values, unit, calls):
    assert evaluations(values, unit) == calls
    counted = Counted(lambda *values, **named: 0, "f", 5000, unit)
    counted(*values)
    counted(**{f"x{k}": value for k, value in enumerate(values)})
    assert counted.calls == 2 * calls


def test_the_places_of_one_call_have_as_many_numbers_as_the_arguments_of_the_question():
    families = {"f": {"text": "c * x", "over": ["x"], "given": ["c"]}}
    question = {
        "constants": {"a": [1.0, 2.0], "h": 0.1},
        "families": families,
        "parameters": ["f", "a", "h"],
        "calls": {"limit": 30},
    }
    f = arguments(question, {"c": 3.0})["f"]
    f(np.zeros(2))
    assert f.calls == 1
    f(np.zeros(20))
    assert f.calls == 11


def test_a_call_with_many_places_is_one_call_where_the_question_limits_none():
    families = {"f": {"text": "c * x", "over": ["x"], "given": ["c"]}}
    f = arguments({"constants": {}, "families": families, "parameters": ["f"]}, {"c": 3.0})["f"]
    for _ in range(MOST_CALLS):
        f(np.zeros(20))
    with pytest.raises(WrongAnswer, match="more than 20000 times"):
        f(1.0)


SOURCE = """
def twice(x):
    return 2 * x

def observed(double, x):
    return double(twice(x)) + sin(0)
"""


def test_a_source_is_evaluated_by_its_last_function_with_the_names_that_it_takes():
    assert evaluate(SOURCE, {"double": lambda x: 2 * x, "x": 3, "unused": 0}) == 12
    assert evaluate("double(x) + 1", {"double": lambda x: 2 * x, "x": 3}) == 7


def test_a_function_argument_may_be_the_last_function_of_a_source():
    function = expression("def pull(x, k):\n    return -k * x", ("x",), {"k": 2.0})
    assert function(3.0) == function(x=3.0) == -6.0 and function([1, 2]).tolist() == [-2.0, -4.0]
    with pytest.raises(TypeError, match=r"takes \(x\)"):
        function(1, 2)
