"""Whose error an exception is, by its traceback."""

import pytest

import polhode.report.figure_parts
from polhode.judging.author_errors import author_error
from polhode.kinds.student_calls import call

QUESTION = {"function": "f", "parameters": ["x"], "call": None, "variables": []}


def raised(student, text=None):
    names = {"draw": polhode.report.figure_parts}
    exec(compile(student, "answer.py", "exec"), names)
    with pytest.raises(Exception) as caught:
        call(QUESTION | {"call": text}, names, {"x": 1.0})
    return author_error(caught.value, lambda filename: filename == "answer.py")


def test_a_student_who_calls_the_kit_wrongly_raised_the_error():
    assert raised("def f(x): return draw.box_polys(x, x)") is None


def test_an_error_in_the_authors_text_is_the_authors():
    assert raised("def f(x): return x", "f(x) + undefined").startswith("question line 1: NameError")
