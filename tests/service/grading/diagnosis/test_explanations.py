"""What numbers show: the whole answer first, then each component for itself."""

import numpy as np
import pytest

from exercises.authoring.mutants.solution import Variant
from service.grading.diagnosis.explanations import causes, components, diagnoses, wrong_components
from service.grading.diagnosis.quoting import StudentCode

TOLERANCE = {"rtol": 1e-9, "atol": 0.0, "reason": "rounding"}
CODE = StudentCode([], "force")
T = np.linspace(0.3, 1.7, 12)
TRUTH = {"value": np.stack([np.sin(T), 2 + T**2, np.exp(-T)], axis=1)}


def question(*names, function="force", drawn=()):
    returns = [{"name": name, "tolerance": TOLERANCE} for name in names]
    return {"function": function, "returns": returns, "drawn": drawn}


def explained(seen, predicted=None, truth=TRUTH, asked=None, inputs=None):
    asked = asked or question("value", drawn=tuple(inputs or ()))
    seen = seen | {f"at_{name}": array for name, array in (inputs or {}).items()}
    wrong = wrong_components(asked, seen, truth)
    found, right = (
        causes(asked, seen, truth, predicted or {}, wrong),
        len(components(asked, seen)) - len(wrong),
    )
    return [(d.code, d.sentence) for d in diagnoses(found, CODE, right)]


def changed(*columns):
    """The truth with other columns."""
    array = TRUTH["value"].copy()
    for k, column in columns:
        array[:, k] = column
    return {"value": array}


def test_two_slips_in_two_components_are_two_causes():
    seen = changed((0, -np.sin(T)), (2, np.zeros(12)))
    assert explained(seen) == [
        ("sign-flipped", "component 1 of force has the opposite sign"),
        ("missing-component", "component 3 of force is zero for every input"),
    ]


def test_a_change_that_predicts_all_values_comes_before_its_components():
    variant = Variant("missing-term", "the drag is missing", "", declared=True)
    seen = changed((0, -np.sin(T)))
    assert explained(seen, {variant: seen}) == [("missing-term", "the drag is missing")]


def test_components_with_one_cause_are_named_together():
    half = changed((0, np.sin(T / 2)), (1, 2 + T))
    variant = Variant("constant-factor", "`x` is halved", "")
    both = half["value"].copy()
    both[:, 2] += 1
    assert explained(half, {variant: {"value": both}}) == [
        ("constant-factor", "components 1 and 2: a constant factor is wrong")
    ]


def test_a_version_may_call_its_functions_more_often():
    asked = question("value")
    variant = Variant("missing-term", "it stops early", "", declared=True)
    seen = changed((0, T)) | {"calls": np.full(12, 2.0)}
    predicted = changed((0, T)) | {"calls": np.full(12, 3.0)}
    assert explained(seen, {variant: predicted}, asked=asked) == [("missing-term", "it stops early")]


def test_changes_of_two_kinds_with_the_same_numbers_are_not_named():
    seen = changed((0, T))
    variants = {Variant(code, "", code): seen for code in ("missing-term", "wrong-power")}
    assert explained(seen, variants) == []


@pytest.mark.parametrize(
    ("numbers", "code", "words"),
    [
        (np.zeros(12), "returns-zero", "is zero for every input"),
        (np.degrees(np.sin(T)), "units", "in degrees"),
        (np.radians(np.sin(T)), "units", "converted from degrees to radians"),
        (T, "returns-input", "is the argument t itself"),
        (np.sin(T).astype(np.float32), "precision-loss", "single precision"),
        (np.round(np.sin(T), 3), "precision-loss", "rounded to 3 decimals"),
        (-np.sin(T), "sign-reversed", "opposite sign"),
        (2.5 * np.sin(T), "constant-factor", "2.5 times"),
    ],
)
def test_numbers_are_read(numbers, code, words):
    seen, truth = {"value": np.asarray(numbers, float)}, {"value": np.sin(T)}
    ((found, sentence),) = explained(seen, truth=truth, inputs={"t": T})
    assert found == code and words in sentence


def test_a_right_answer_has_no_cause():
    assert explained(TRUTH) == []


def test_two_changes_are_two_diagnoses():
    first, second = Variant("sign-flipped", "one", ""), Variant("wrong-power", "two", "")
    seen = changed((0, T), (1, T), (2, T))
    pair = Variant("sign-flipped", "one", "x", both=(first, second))
    assert [code for code, _ in explained(seen, {pair: seen})] == ["sign-flipped", "wrong-power"]


def test_the_right_components_in_another_order():
    seen = {"value": TRUTH["value"][:, [1, 2, 0]]}
    assert explained(seen) == [("component-order", "force returns the right components in the order 2, 3, 1")]


def test_the_right_values_in_another_order():
    truth = {"x": np.sin(T), "v": np.cos(T)}
    seen = {"x": truth["v"], "v": truth["x"]}
    assert explained(seen, truth=truth, asked=question("x", "v")) == [
        ("component-order", "force returns the right values as v, x: the exercise asks for x, v")
    ]


def test_equal_values_have_no_other_order():
    truth = {"x": np.sin(T), "v": np.sin(T)}
    assert explained(truth, truth=truth, asked=question("x", "v")) == []


def test_a_change_in_general_words_gives_way_to_what_the_numbers_show():
    seen = changed((1, -2 - T**2), (2, 3 * np.exp(-T)))
    variant = Variant("wrong-power", "the exponent `k` of `x**k` is missing", "")
    assert explained(seen, {variant: seen}) == [
        ("sign-flipped", "component 2 of force has the opposite sign"),
        ("constant-factor", "component 3 of force is 3 times the right value"),
    ]


def test_a_change_in_general_words_names_the_wrong_component_if_others_are_right():
    seen = changed((1, 2 + T**3))
    variant = Variant("wrong-power", "the exponent `k` of `x**k` is missing", "")
    assert explained(seen, {variant: seen}) == [("wrong-power", "component 2: a power or a root is wrong")]


def test_two_changes_of_another_form_are_not_named():
    first, second = (Variant("sign-flipped", f"the term `{x}` has the opposite sign", "") for x in "ab")
    seen = changed((1, 2 + T**3))
    both = Variant(first.code, first.sentence, "", both=(first, second))
    assert explained(seen, {both: seen}) == []


def test_a_declared_mistake_names_its_component_if_another_one_is_wrong_too():
    mistake = Variant("wrong-power", "the force falls as 1/r", "", declared=True)
    alone = changed((0, T), (2, T**3))
    assert explained(changed((0, T), (2, T**2)), {mistake: changed((0, T))}) == [
        ("wrong-power", "component 1: the force falls as 1/r")
    ]
    assert explained(changed((0, T)), {mistake: alone}) == [("wrong-power", "the force falls as 1/r")]


def test_absolute_values_are_named():
    truth = {"value": np.sin(5 * T)}
    assert explained({"value": np.abs(truth["value"])}, truth=truth) == [
        ("absolute-value", "force is the absolute value of the right one")
    ]


def test_a_value_whose_components_are_all_wrong_is_named_as_a_whole():
    truth = {"x": TRUTH["value"], "v": TRUTH["value"] + 1}
    mistake = Variant("missing-term", "the half step is missing", "", declared=True)
    seen = {"x": truth["x"] ** 2, "v": truth["v"] ** 3}
    predicted = {mistake: {"x": truth["x"] ** 2, "v": truth["v"] ** 2}}
    assert explained(seen, predicted, truth, question("x", "v")) == [
        ("missing-term", "the value x: the half step is missing")
    ]
