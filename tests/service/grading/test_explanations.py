"""What numbers show: the whole answer first, then each component for itself."""

import numpy as np
import pytest

from exercises.authoring.mutants.solution import Variant
from service.grading.explanations import causes, diagnoses, wrong_components
from service.grading.quoting import StudentCode

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
    return [(d.code, d.sentence) for d in diagnoses(causes(asked, seen, truth, predicted or {}, wrong), CODE)]


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
