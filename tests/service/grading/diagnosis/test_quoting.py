"""Sentences about changes of the author's solution quote only what the student's function contains."""

import pytest

from service.grading.diagnosis.quoting import StudentCode

STUDENT = StudentCode(["import numpy as np\n", "def speed(t, k):\n    return np.tanh(t) + k * t\n"], "speed")


@pytest.mark.parametrize("fragment", ["k * t", "np.tanh(t)", "k", "2", "+=", "*"])
def test_what_the_function_contains_may_be_quoted(fragment):
    assert STUDENT.has(fragment)


@pytest.mark.parametrize("fragment", ["turns", "k * turns", "t * k", "np.sinh(t)", "M - turns", ".T"])
def test_terms_and_names_of_the_solution_may_not(fragment):
    assert not STUDENT.has(fragment)


def test_a_sentence_that_quotes_the_solution_becomes_a_general_one():
    revealing = "the term `M` is missing in `M - turns`"
    assert STUDENT.sentence("missing-term", {revealing}) == "a term or a factor is missing"


def test_a_sentence_about_the_students_own_term_stays():
    own = "the term `k * t` has the opposite sign"
    assert STUDENT.sentence("sign-flipped", {own}) == own


def test_several_changes_of_one_kind_have_its_general_sentence():
    two = {"the term `k * t` has the opposite sign", "the term `np.tanh(t)` has the opposite sign"}
    assert STUDENT.sentence("sign-flipped", two) == "one term has the opposite sign"


def test_a_code_without_a_general_meaning_has_no_sentence():
    assert STUDENT.sentence("my-code", {"`x` is wrong"}) is None


def test_only_the_last_definition_counts():
    code = StudentCode(["def f(x):\n    return a\n", "def f(x):\n    return b\n"], "f")
    assert code.has("b") and not code.has("a")
