"""Every slip of the catalogue at the probes gets its code, also two at once, and nothing that merely looks
similar does.
"""

import contextlib
import io
import itertools
import random

import numpy as np
import pytest

from exercises.rigid_body import plays
from exercises.rigid_body.causes import diagnose_function, diagnose_scene
from service.grading.jobs import draw_inputs

W, I = ("w[0]", "w[1]", "w[2]"), ("I[0]", "I[1]", "I[2]")
RIGHT = [f"({I[k - 2]} - {I[k - 1]}) * {W[k - 2]} * {W[k - 1]} / {I[k]}" for k in range(3)]


def slips_of(k):
    """Yield name, source and diagnosis code of wrong versions of component ``k``."""
    i, j = (k + 1) % 3, (k + 2) % 3
    yield "sign", f"-({RIGHT[k]})", "sign-flipped"
    yield "zero", "0.0 * w[0]", "missing-component"
    for factor in ("2", "0.5", "(1 + 1e-6)", "(1 + 1e-9)"):
        yield f"times {factor}", f"{factor} * ({RIGHT[k]})", "constant-factor"
    for a, b in itertools.combinations_with_replacement(range(3), 2):
        if {a, b} != {i, j}:
            yield f"ω{a + 1}ω{b + 1}", f"({I[i]} - {I[j]}) * {W[a]} * {W[b]} / {I[k]}", "cyclic-order"
    for a, b in itertools.permutations(range(3), 2):
        if {a, b} != {i, j}:
            yield f"I{a + 1} − I{b + 1}", f"({I[a]} - {I[b]}) * {W[i]} * {W[j]} / {I[k]}", "cyclic-order"
    yield "sum of moments", f"({I[i]} + {I[j]}) * {W[i]} * {W[j]} / {I[k]}", "moment-sum"
    yield "one moment", f"{I[i]} * {W[i]} * {W[j]} / {I[k]}", "missing-term"
    yield "not divided", f"({I[i]} - {I[j]}) * {W[i]} * {W[j]}", "missing-division"
    for divisor in (I[i], I[j], f"{I[k]} ** 2", "I.sum()", f"(1 / {I[k]})"):
        yield f"over {divisor}", f"({I[i]} - {I[j]}) * {W[i]} * {W[j]} / {divisor}", "wrong-divisor"
    for term in (f"0.01 * {W[k]}", "0.01", f"1e-6 * {W[k]}", f"1e-9 * {W[k]} ** 2"):
        yield f"extra {term}", f"({RIGHT[k]}) - {term}", "extra-term"
    yield "extra 0.01 * t", f"({RIGHT[k]}) - 0.01 * t", "time-dependent"


SLIPS = [(k, *slip) for k in range(3) for slip in slips_of(k)]
PAIRS = random.Random(2026).sample([(a, b) for a, b in itertools.combinations(SLIPS, 2) if a[0] != b[0]], 60)


def function(*slips):
    """Return the source of ``euler_eqs`` with these wrong components."""
    terms = RIGHT.copy()
    for k, _, term, _ in slips:
        terms[k] = term
    return f"def euler_eqs(t, w, I):\n    return np.array([{', '.join(terms)}])\n"


@pytest.fixture(scope="module")
def inputs(rigid_body):
    return draw_inputs(rigid_body.scene("probes"), seed=23)


def codes(source, inputs):
    names = {"np": np}
    exec(source, names)
    with contextlib.redirect_stdout(io.StringIO()):
        return {d.code for d in diagnose_scene("probes", inputs, plays.pointwise(names, inputs))}


@pytest.mark.parametrize(
    "slip", [pytest.param(slip, id=f"component {slip[0] + 1}: {slip[1]}") for slip in SLIPS]
)
def test_one_slip(slip, inputs):
    assert codes(function(slip), inputs) == {slip[3]}


@pytest.mark.parametrize(
    "pair", [pytest.param((a, b), id=f"{a[0] + 1}: {a[1]}; {b[0] + 1}: {b[1]}") for a, b in PAIRS]
)
def test_two_slips(pair, inputs):
    both = {slip[3] for slip in pair}
    assert codes(function(*pair), inputs) == ({"time-dependent"} if "time-dependent" in both else both)


WHOLE = {
    "np.zeros(3)": "returns-zero",
    "-right(I)": "sign-reversed",
    "1.0 * w": "returns-input",
    "2 * right(I)": "constant-factor",
    "right(I) * I": "missing-division",
    "right(I) / I": "wrong-divisor",
    "right(I).astype(np.float32)": "precision-loss",
    "np.round(right(I), 9)": "precision-loss",
    "right(np.sort(I))": "moment-order",
    "right(I)[[1, 2, 0]]": "component-order",
    "right(I[[2, 1, 0]])": "moment-order",
    "right(np.array((2.0, 3.0, 4.0)))": "hard-coded-moments",
    "right(np.array((1.0, 1.0, 1.6)))": "hard-coded-moments",
    "right(np.array((5.0, 6.0, 7.0)))": "hard-coded-moments",
    "-right(np.array((2.0, 3.0, 4.0)))": "hard-coded-moments sign-reversed",
}


@pytest.mark.parametrize("answer", WHOLE)
def test_a_slip_of_the_whole(answer, inputs):
    source = (
        f"def euler_eqs(t, w, I):\n    right = lambda I: np.array([{', '.join(RIGHT)}])\n"
        f"    return {answer}\n"
    )
    assert codes(source, inputs) == set(WHOLE[answer].split())


def test_constant_moments_of_an_unknown_body_are_named_by_their_ratio(inputs):
    w, body = inputs["w"], np.array([5.0, 6.0, 7.0])
    (found,) = diagnose_scene("probes", inputs, {"wdot": np.cross(w * body, w) / body})
    assert "in the ratio 1 : 1.2 : 1.4" in found.sentence


def test_sentences_point_at_component_and_term(inputs):
    def sentences(source):
        names = {"np": np}
        exec(source, names)
        return [d.sentence for d in diagnose_scene("probes", inputs, plays.pointwise(names, inputs))]

    def second(term):
        return function((1, "", term, ""))

    assert sentences(second(f"-({RIGHT[1]})")) == ["ω̇₂ has the opposite sign: check (I₃ − I₁)"]
    (sentence,) = sentences(second("1.25 * (I[2] - I[0]) * w[2] * w[0] / I[1]"))
    assert sentence.startswith("ω̇₂ is 1.25 times the right value")
    (sentence,) = sentences(second("(I[2] - I[0]) * w[2] * w[0] / 3.0"))
    assert "divided by the constant 3 instead of I₂" in sentence
    (sentence,) = sentences(second("(I[2] - I[0]) * w[2] * w[0] / I[1] - 0.05 * w[1]"))
    assert "-0.05 ω₂" in sentence


def test_noise_and_other_algebra_have_no_cause(inputs):
    source = (
        "def euler_eqs(t, w, I):\n"
        "    return np.array([np.sin(w[0]) * I[1], w[1] ** 3 / I[0], np.exp(-w[2] ** 2) + I[2]])"
    )
    assert codes(source, inputs) == set()


@pytest.mark.parametrize("seed", range(3))
def test_the_right_answer_has_no_cause_whatever_is_drawn(seed, rigid_body):
    inputs = draw_inputs(rigid_body.scene("probes"), seed)
    assert codes("def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I", inputs) == set()


@pytest.mark.parametrize(
    "answer",
    ["np.full(3, 1e308)", "np.nan_to_num(w * np.inf)", "np.array([1e308, w[0], w[1]])", "w * 1e-320"],
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
