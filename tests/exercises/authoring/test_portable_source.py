"""Mistakes written as functions: their source needs nothing of the author's file."""

import numpy
import numpy as np
import pytest
from numpy import sqrt

from exercises.authoring.portable_source import NotPortable, WrittenMistake

RIGHT = "def root(x):\n    return x ** 0.5\n"
FACTOR, TABLE, HANDLE = 3.0, np.array([1.0, 2.0]), object()


class AskedRoot:
    solution_name = "root"


root = AskedRoot()


def twice(x):
    return 2 * x


def played(function, x=4.0, known=frozenset(), **given):
    names = {}
    exec(WrittenMistake(function, "root", "x", "", 1, given, lambda: set(known)).source(RIGHT), names)
    return names["root"](x)


def test_it_may_call_the_right_solution():
    def doubled(x):
        return 2 * root(x)

    assert played(doubled) == 4.0


def test_it_takes_along_functions_constants_arrays_and_imports():
    def other(x):
        return twice(FACTOR) * numpy.sum(TABLE) * sqrt(x)

    assert played(other) == 2 * 3.0 * 3.0 * 2.0


def test_it_takes_along_what_encloses_it():
    shift = 10

    def shifted(x):
        return x + shift

    assert played(shifted) == 14.0


def test_a_member_of_a_family_has_its_parameter():
    def early(x, steps):
        return x * steps

    assert played(early, steps=5) == 20.0


def test_a_name_of_the_notebook_is_left_to_it():
    def from_setup(x):
        return gravity * x  # noqa: F821

    assert "gravity" in WrittenMistake(from_setup, "root", "x", "", 1, {}, lambda: {"gravity"}).source(RIGHT)


def test_what_has_no_source_is_named():
    def with_object(x):
        return HANDLE

    def with_nothing(x):
        return nowhere  # noqa: F821

    for function, name in ((with_object, "HANDLE"), (with_nothing, "nowhere")):
        with pytest.raises(NotPortable, match=name):
            WrittenMistake(function, "root", "x", "", 1).source(RIGHT)
