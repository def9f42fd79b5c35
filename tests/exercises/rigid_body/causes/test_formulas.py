"""Misspellings that are no form of weights and products get their code and sentence, in one component and in
all.
"""

import numpy as np
import pytest

import reference
from exercises.rigid_body import plays
from exercises.rigid_body.causes import diagnose_scene
from service.grading.jobs import draw_inputs

TERMS = (
    "(I[1] - I[2]) * w[1] * w[2] / I[0]",
    "(I[2] - I[0]) * w[2] * w[0] / I[1]",
    "(I[0] - I[1]) * w[0] * w[1] / I[2]",
)
SECOND = {
    "I[2] - I[0] * w[2] * w[0] / I[1]": ("missing-brackets", "ω̇₂ is computed as I₃ − I₁·ω₃ω₁/I₂"),
    "I[2] * w[2] * w[0] - I[0] * w[2] * w[0] / I[1]": ("missing-brackets", "I₃·ω₃ω₁ − I₁·ω₃ω₁/I₂"),
    "(I[2] - I[0] * w[2] * w[0]) / I[1]": ("missing-brackets", "(I₃ − I₁·ω₃ω₁)/I₂"),
    "abs(I[2] - I[0]) * w[2] * w[0] / I[1]": ("absolute-value", "of the difference (I₃ − I₁)"),
    "(I[2] - I[0]) * abs(w[2]) * w[0] / I[1]": ("absolute-value", "of ω₃"),
    "abs((I[2] - I[0]) * w[2] * w[0] / I[1])": ("absolute-value", "of the whole result"),
    "(I[2] - I[0]) * w[2] * w[0] // I[1]": ("floor-division", "divide by I₂ with /"),
    "(I[2] - I[0]) // I[1] * w[2] * w[0]": ("floor-division", "divide by I₂ with /"),
    "max((I[2] - I[0]) * w[2] * w[0] / I[1], 0.0)": ("clipped", "ω̇₂ is never negative"),
    "min(max((I[2] - I[0]) * w[2] * w[0] / I[1], -0.7), 0.7)": ("clipped", "limited to ±0.7"),
    "(1 / I[2] - 1 / I[0]) * w[2] * w[0] * I[1]": ("inverted-moments", "I and 1/I swapped"),
    "(I[2] - I[0]) * w[2] ** 2 * w[0] ** 2 / I[1]": ("wrong-power", "squares ω₃² and ω₁²"),
    "(I[2] ** 2 - I[0] ** 2) * w[2] * w[0] / I[1]": ("wrong-power", "ω̇₂ has I₃² − I₁² instead of (I₃ − I₁)"),
    "(I[2] ** 2 - I[0] ** 2) * w[2] * w[0] / I[1] ** 2": ("wrong-power", "and I₂² instead of I₂"),
    "(I[2] - I[0]) * w[2] * w[0] * w[1] / I[1]": ("wrong-power", "ω̇₂ has ω₃ω₁ω₂ instead of ω₃ω₁"),
    "(I[2] - I[0]) * w[2] * w[0] ** 2 / I[1]": ("wrong-power", "ω̇₂ has ω₃ω₁² instead of ω₃ω₁"),
    "(I[2] - I[0]) * w[2] * TERM1 / I[1]": (
        "wrong-quantity",
        "ω̇₂ is computed from rates that already replaced ω",
    ),
    "TERM2 if abs(w[1]) < max(abs(w)) else 0.0": (
        "missing-component",
        "ω̇₂ is zero where |ω₂| is the largest of the three",
    ),
    "(I[2] - I[0]) * np.prod(np.where(abs(w[::2]) < 1e-3, 0.0, w[::2])) / I[1]": (
        "clipped",
        "small values are cut off",
    ),
    "TERM2 * (abs(TERM2) > 1e-6)": ("clipped", "small values are cut off"),
    "57.2958 * (I[2] - I[0]) * w[2] * w[0] / I[1]": ("units", "180/π"),
    "-0.10472 * (I[2] - I[0]) * w[2] * w[0] / I[1]": ("units", "2π/60"),
}
WHOLE = {
    "abs": (np.abs, "absolute-value"),
    "clip": (lambda x: np.clip(x, -2.5, 2.5), "clipped"),
    "floor": (np.floor, "floor-division"),
    "degrees": (np.degrees, "units"),
}


@pytest.fixture(scope="module")
def inputs(rigid_body):
    return draw_inputs(rigid_body.scene("probes"), seed=31)


def causes(source, inputs):
    names = {"np": np}
    exec(source, names)
    return diagnose_scene("probes", inputs, plays.pointwise(names, inputs))


@pytest.mark.parametrize("term", SECOND)
def test_one_component(term, inputs):
    code, said = SECOND[term]
    term = term.replace("TERM1", f"({TERMS[0]})").replace("TERM2", f"({TERMS[1]})")
    (cause,) = causes(
        f"def euler_eqs(t, w, I):\n    return np.array([{TERMS[0]}, {term}, {TERMS[2]}])", inputs
    )
    assert cause.code == code and said in cause.sentence


def test_three_misspellings_are_all_named(inputs):
    terms = "I[1] - I[2] * w[1] * w[2] / I[0]", f"abs({TERMS[1]})", f"-(({TERMS[2]}) // 1)"
    found = [
        cause.code
        for cause in causes(f"def euler_eqs(t, w, I):\n    return np.array([{', '.join(terms)}])", inputs)
    ]
    assert found == ["missing-brackets", "absolute-value", "floor-division", "sign-flipped"]


@pytest.mark.parametrize("name", WHOLE)
def test_all_components_at_once(name, inputs):
    change, code = WHOLE[name]
    (cause,) = diagnose_scene("probes", inputs, {"wdot": change(exact(inputs))})
    assert cause.code == code and cause.sentence.endswith("; likewise in the other two components")


def test_a_normalised_spin_is_named_and_so_is_where_it_has_no_value(inputs):
    source = "def euler_eqs(t, w, I):\n    n = w / np.linalg.norm(w)\n    return np.cross(I * n, n) / I"
    with np.errstate(invalid="ignore"):
        normalised, missing = causes(source, inputs)
    assert (
        normalised.code == "normalised" and missing.code == "not-finite" and "where ω = 0" in missing.sentence
    )


@pytest.mark.parametrize(
    ("factor", "place"),
    [
        ("w[0] / w[0]", "ω₁ = 0"),
        ("(I[0] - I[1]) / (I[0] - I[1])", "I₁ = I₂"),
        ("w[1] * w[2] / w[1] / w[2]", "ω₂ω₃ = 0"),
    ],
)
def test_where_values_are_not_finite(factor, place, inputs):
    with np.errstate(invalid="ignore"):
        (cause,) = causes(f"def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I * ({factor})", inputs)
    assert cause.code == "not-finite" and f"where {place}:" in cause.sentence


@pytest.mark.parametrize(
    "change", [np.sin, np.tanh, lambda x: x + 0.1 * np.sin(7 * x), lambda x: np.abs(x) * 1.1 + 0.01]
)
def test_other_functions_of_the_right_rates_are_not_taken_for_any_of_these(change, inputs):
    assert diagnose_scene("probes", inputs, {"wdot": change(exact(inputs))}) == []


def exact(inputs):
    return reference.euler_rhs(inputs["w"].T, inputs["I"].T).T
