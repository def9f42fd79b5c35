"""Notes of a scene: remarks that are said once, and why an array is absent."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from polhode.judging.remarks import MOST_REMARKS, Absent, Notes, absent, noting, remark, unsaid
from polhode.judging.return_value import Kept, WrongAnswer, real_array
from polhode.kinds.student_calls import returned


@pytest.mark.parametrize(
    "value", [np.array([2.5]), np.array([[2.5]]), [2.5], (2.5,), np.array([2], dtype=np.int8) + 0.5]
)
def test_an_array_of_one_number_is_a_number_with_a_remark(value):
    with noting() as notes:
        found = real_array(value, (), "f")
    assert found.shape == () and found == 2.5
    assert notes.remarks == [
        f"f returned an array of shape {np.shape(value)}, which is accepted for a number: use x.item()"
    ]


def test_a_number_needs_no_remark_and_an_array_is_no_number():
    with noting() as notes:
        assert real_array(np.array(2.5), (), "f") == real_array(np.float32(2.5), (), "f") == 2.5
        for value, shape in (([1, 2], ()), ([], ()), (1, (1,)), ([[1]], (1,)), ([1], (1, 1)), ([None], ())):
            with pytest.raises(WrongAnswer):
                real_array(value, shape, "f")
    assert notes == Notes()


@pytest.mark.parametrize(
    ("value", "had"),
    [
        ([Fraction(1, 2), Fraction(1, 3)], "it returned Fractions: convert each with float(x)"),
        ((Decimal("0.5"), 1.0), "it returned Decimals: convert each with float(x)"),
        ([Fraction(1, 2), Decimal("0.5")], "it returned Decimals and Fractions: convert each with float(x)"),
        (np.array([Fraction(1, 2), 1]), "it returned Fractions: convert each with float(x)"),
        ([None, 1.0], "it returned a list"),
        ([{}, {}], "it returned a list"),
    ],
)
def test_numbers_of_other_types_are_named(value, had):
    with pytest.raises(WrongAnswer) as refused:
        real_array(value, (2,), "f")
    assert str(refused.value) == f"f must return real numbers; {had}"


def test_a_single_fraction_is_named():
    with pytest.raises(WrongAnswer, match=r"it returned a Fraction: convert it with float\(x\)$"):
        real_array(Fraction(1, 3), (), "f")


def test_a_symbol_is_no_number_of_another_type():
    sympy = pytest.importorskip("sympy")
    with pytest.raises(WrongAnswer, match=r"it returned a list$"):
        real_array([sympy.Symbol("x")] * 2, (2,), "f")
    with pytest.raises(WrongAnswer, match=r"it returned Halfs: convert each with float\(x\)$"):
        real_array([sympy.S.Half] * 2, (2,), "f")


def test_the_array_of_the_last_call_may_be_overwritten_but_that_is_said():
    buffer, others = np.zeros(2), [np.arange(2.0) + k for k in range(3)]
    with noting() as notes:
        kept = Kept("f")
        for answer in (*others, others[0], None, 3.0, np.array([np.nan]), np.array([{}])):
            kept.replace(answer)
    assert notes.remarks == []
    with noting() as notes:
        kept = Kept("f")
        for k in range(3):
            buffer[:] = k
            kept.replace(buffer)
    assert notes.remarks[0].startswith("f returns the same array at each call and overwrites it")


def test_remarks_are_said_once_and_a_few():
    remark("nobody keeps this")
    with noting() as notes:
        for k in (1, 1, *range(20)):
            remark(f"remark {k}")
    assert len(notes.remarks) == MOST_REMARKS and notes.remarks[:2] == ["remark 1", "remark 0"]
    said = {"remark 0"}
    assert unsaid([Notes(["remark 0", "a"]), Notes(["a", "b"])], said) == ["a", "b"]
    assert unsaid([Notes(["a"])], said) == []


QUESTION = {
    "function": "f",
    "returns": [
        {"name": "a", "shape": []},
        {"name": "b", "shape": [2]},
        {"name": "c", "shape": [], "complex": True},
    ],
}


def test_each_part_of_an_answer_stands_alone():
    with noting() as notes:
        found = returned(QUESTION, (1.0, [1, 2, 3], "c"), alone=True)
    assert found["a"] == 1 and np.isnan(found["b"]).all() and found["b"].shape == found["c"].shape == (2,)
    assert notes.absent == {
        "b": Absent("f (b) must return shape (2,); it returned shape (3,)", "wrong-shape"),
        "c": Absent("f (c) must return a real number; it returned a str", "wrong-shape"),
    }
    with noting() as notes:
        found = returned(QUESTION, (np.inf, [1, 2], 1j), alone=True)
    assert found["a"] == np.inf and notes.absent == {}, "a value that is not finite is compared"


def test_an_answer_without_a_right_part_is_wrong_as_a_whole():
    with noting() as notes, pytest.raises(WrongAnswer, match=r"f \(a\) must return a real number"):
        returned(QUESTION, ("a", "b", "c"), alone=True)
    assert notes.absent == {}
    with pytest.raises(WrongAnswer, match=r"f \(b\)"):
        returned(QUESTION, (1.0, [1, 2, 3], 2.0))
    with pytest.raises(WrongAnswer, match=r"f \(b\)"):
        returned(QUESTION, (1.0, [1, 2, 3], 2.0), alone=True)  # nobody keeps notes


def test_a_key_that_is_missing_is_absent():
    with noting() as notes:
        found = returned({**QUESTION, "keys": True}, {"a": 1.0, "c": 2.0}, alone=True)
    assert found["c"].tolist() == [2, 0] and list(notes.absent) == ["b"]
    assert notes.absent["b"].sentence.endswith("it returned the keys a, c")
    with pytest.raises(WrongAnswer, match="a dict with the keys a, b, c"), noting():
        returned({**QUESTION, "keys": True}, {"x": 1.0}, alone=True)


def test_the_first_reason_stays():
    with noting() as notes:
        assert absent("a", Absent("one", None)) and absent("a", Absent("two", None))
    assert notes.absent["a"].sentence == "one" and not absent("a", Absent("three", None))
