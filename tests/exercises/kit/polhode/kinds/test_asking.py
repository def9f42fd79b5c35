"""Sentences about the arguments of a call and about what it returned are short enough to read."""

import numpy as np
import pytest

from polhode.judging.return_value import WrongAnswer, article
from polhode.kinds.asking import arguments, describe, returned


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
    [("modes(m)[0]", "`modes(m)[0]`"), ("[w for w, X in [modes(m)]]" + " * 1" * 30, "modes")],
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
