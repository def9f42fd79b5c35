"""Sentences about the arguments of a call and about what it returned are short enough to read."""

import numpy as np
import pytest

from ecp.kinds.asking import describe, returned
from ecp.return_value import WrongAnswer


def test_a_large_argument_is_shown_by_its_corners():
    question = {"drawn": ["r", "t", "n"]}
    seen = {"at_r": np.ones((1, 9, 6, 2)), "at_t": np.arange(40.0)[None], "at_n": np.array([3])}
    text = describe(question, seen, 0)
    assert (
        text.startswith("r = [[[1., 1.], ...") and text.endswith("t = [ 0., 1., 2., ..., 37., 38., 39.], n = 3") and len(text) < 130
    )


@pytest.mark.parametrize(
    ("call", "named"), [("modes(m)[0]", "`modes(m)[0]`"), ("[w for w, X in [modes(m)]]" + " * 1" * 30, "modes")]
)
def test_a_long_expression_of_the_author_is_not_quoted(call, named):
    question = {"function": "modes", "call": call, "returns": [{"name": "omega", "shape": []}]}
    with pytest.raises(WrongAnswer, match="it is a complex128") as raised:
        returned(question, np.complex128(1j))
    assert str(raised.value).startswith(f"{named} must be a real number")
