"""Every slip of the catalogue at the probes gets its code, also two at once, and nothing that merely looks similar does."""

import contextlib
import io

import numpy as np
import pytest

from exercises.rigid_body import plays
from exercises.rigid_body.causes import diagnose_function, diagnose_scene
from exercises.rigid_body.mutants import _component_slips, differs, mutants
from service.grading.grade import draw_inputs

CODES = {
    "sign": "sign-flipped",
    "zero": "missing-component",
    "doubled": "constant-factor",
    "halved": "constant-factor",
    "off": "constant-factor",
    "sum": "moment-sum",
    "one": "missing-term",
    "over": "wrong-divisor",
    "extra": "extra-term",
}


def code(name: str) -> str:
    slip = name.split(": ")[1]
    if slip.startswith("over 1.0"):
        return "missing-division"
    if slip.endswith("* t"):
        return "time-dependent"
    return "cyclic-order" if slip[0] in "ωI" else CODES[slip.split()[0]]


@pytest.fixture(scope="module")
def inputs(rigid_body):
    return draw_inputs(rigid_body.scene("probes"), seed=23)


def codes(source, inputs):
    names = {"np": np}
    exec(source, names)
    with contextlib.redirect_stdout(io.StringIO()):
        return {d.code for d in diagnose_scene("probes", inputs, plays.pointwise(names, inputs))}


def of_kind(kind):
    return [pytest.param(m, id=m.sentence) for m in mutants() if m.code == kind]


@pytest.mark.parametrize("mutant", of_kind("one mistake in one component"))
def test_one_slip(mutant, inputs):
    assert codes(mutant.source, inputs) == {code(mutant.sentence)}


@pytest.mark.parametrize("mutant", of_kind("two mistakes"))
def test_two_slips(mutant, inputs):
    both = {code(name) for name in mutant.sentence.split("; ")}
    if "time-dependent" in both:
        both = {"time-dependent"}
    assert codes(mutant.source, inputs) == both


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("zeros", {"returns-zero"}),
        ("reversed in time", {"sign-reversed"}),
        ("w itself", {"returns-input"}),
        ("all doubled", {"constant-factor"}),
        ("not divided", {"missing-division"}),
        ("divided twice", {"wrong-divisor"}),
        ("single precision", {"precision-loss"}),
        ("rounded to 9 places", {"precision-loss"}),
        ("moments sorted", {"moment-order"}),
        ("components in the order (1, 2, 0)", {"component-order"}),
        ("moments in the order (2, 1, 0)", {"moment-order"}),
        ("always I = (2.0, 3.0, 4.0)", {"hard-coded-moments"}),
        ("always I = (1.0, 1.0, 1.6)", {"hard-coded-moments"}),
    ],
)
def test_a_slip_of_the_whole(name, expected, inputs):
    (mutant,) = [m for m in mutants() if m.sentence == name]
    assert codes(mutant.source, inputs) == expected


def test_sentences_point_at_component_and_term(inputs):
    def told(source):
        names = {"np": np}
        exec(source, names)
        return [d.sentence for d in diagnose_scene("probes", inputs, plays.pointwise(names, inputs))]

    slips = {name: term for name, _, term in _component_slips(1)}
    right = ["(I[1] - I[2]) * w[1] * w[2] / I[0]", "", "(I[0] - I[1]) * w[0] * w[1] / I[2]"]

    def function(term):
        return f"def euler_eqs(t, w, I):\n    return np.array([{right[0]}, {term}, {right[2]}])"

    assert told(function(slips["component 2: sign"])) == ["ω̇₂ has the opposite sign: check (I₃ − I₁)"]
    (sentence,) = told(function("1.25 * (I[2] - I[0]) * w[2] * w[0] / I[1]"))
    assert sentence.startswith("ω̇₂ is 1.25 times the right value")
    (sentence,) = told(function("(I[2] - I[0]) * w[2] * w[0] / 3.0"))
    assert "divided by the constant 3 instead of I₂" in sentence
    (sentence,) = told(function("(I[2] - I[0]) * w[2] * w[0] / I[1] - 0.05 * w[1]"))
    assert "-0.05 ω₂" in sentence


def test_noise_and_other_algebra_have_no_cause(inputs):
    source = "def euler_eqs(t, w, I):\n    return np.array([np.sin(w[0]) * I[1], w[1] ** 3 / I[0], np.exp(-w[2] ** 2) + I[2]])"
    assert codes(source, inputs) == set()


@pytest.mark.parametrize("seed", range(3))
def test_the_right_answer_has_no_cause_whatever_is_drawn(seed, rigid_body):
    inputs = draw_inputs(rigid_body.scene("probes"), seed)
    assert codes("def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I", inputs) == set()


def test_wrong_is_found_out_without_the_checks():
    right = "def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I"
    assert not differs(right)
    assert differs(right + " * (1 + 1e-9)") and differs(right + " + 1e-9 * t") and differs("x = 1") and differs("def euler_eqs(:")
    assert differs("def euler_eqs(t, w, I):\n    return 0.0")


@pytest.mark.parametrize(
    "answer", ["np.full(3, 1e308)", "np.nan_to_num(w * np.inf)", "np.array([1e308, w[0], w[1]])", "w * 1e-320"]
)
def test_numbers_beyond_arithmetic_are_no_fault(answer, inputs):
    with np.errstate(all="ignore"):
        codes(f"def euler_eqs(t, w, I):\n    return {answer}", inputs)


def test_moments_without_a_value_or_of_nothing(rigid_body):
    for scene in ("boxes", "tensors"):
        asked = draw_inputs(rigid_body.scene(scene), 1)
        shape = (len(next(iter(asked.values()))), 3)
        for moments, code in ((np.full(shape, np.nan), "not-finite"), (np.zeros(shape), "returns-zero")):
            if scene == "boxes":
                found = diagnose_scene(scene, asked, {"moments": moments})
            else:
                found = diagnose_function("principal_moments", {scene: (asked, {"moments": moments})})
            assert found is not None and [d.code for d in found] == [code]
