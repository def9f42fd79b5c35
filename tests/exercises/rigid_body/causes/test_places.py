"""Where a function is right is said, and what is wrong elsewhere; nearly right is said of what is."""

import numpy as np
import pytest

import reference
from exercises.rigid_body.causes import diagnose_scene
from service.grading.jobs import draw_inputs


@pytest.fixture(scope="module")
def probes(rigid_body):
    inputs = draw_inputs(rigid_body.scene("probes"), seed=17)
    return inputs, inputs["w"], inputs["I"], reference.euler_rhs(inputs["w"].T, inputs["I"].T).T


def sentences(probes, wdot):
    return [(cause.code, cause.sentence) for cause in diagnose_scene("probes", probes[0], {"wdot": wdot})]


PLACES = {
    "I₁ < I₂ < I₃": lambda w, I: (I[:, 0] < I[:, 1]) & (I[:, 1] < I[:, 2]),
    "I₁ < I₃": lambda w, I: I[:, 0] < I[:, 2],
    "I₂ is the largest moment": lambda w, I: I[:, 1] > np.maximum(I[:, 0], I[:, 2]),
    "ω₂ > 0": lambda w, I: w[:, 1] > 0,
    "ω₁ω₃ < 0": lambda w, I: w[:, 0] * w[:, 2] < 0,
    "|ω| ≤ ": lambda w, I: np.linalg.norm(w, axis=1) < 2,
    "|ω₃| ≥ ": lambda w, I: np.abs(w[:, 2]) > 1,
    "|I₁ − I₂| ≥ ": lambda w, I: np.abs(I[:, 0] - I[:, 1]) > 0.3,
}


@pytest.mark.parametrize("place", PLACES)
def test_right_somewhere_and_zero_elsewhere(place, probes):
    _, w, I, exact = probes
    where = PLACES[place](w, I)[:, None]
    (code, sentence), (other, elsewhere) = sentences(probes, np.where(where, exact, 0.0))
    assert code == "partly-right" and sentence.startswith(f"euler_eqs is right only where {place}")
    assert (other, elsewhere) == ("missing-component", "elsewhere euler_eqs returns zeros")


def test_what_is_wrong_elsewhere_is_named_for_each_component(probes):
    _, w, I, exact = probes
    answer = exact.copy()
    answer[I[:, 0] < I[:, 2], 2] *= -1
    assert sentences(probes, answer) == [
        ("partly-right", "ω̇₃ is right only where I₁ ≥ I₃"),
        ("sign-flipped", "elsewhere ω̇₃ has the opposite sign: check (I₁ − I₂)"),
    ]
    reversed_ = np.where(w[:, 1:2] > 0, exact, -exact)
    assert [code for code, _ in sentences(probes, reversed_)] == ["partly-right", "sign-reversed"]


def test_components_that_are_right_are_named_where_nothing_else_is_known(probes):
    _, w, _, exact = probes
    answer = exact.copy()
    answer[:, 0] = np.sin(w[:, 0])
    assert sentences(probes, answer) == [
        ("partly-right", "ω̇₂ and ω̇₃ are right at every point; look at ω̇₁ only")
    ]


def test_nearly_right(probes):
    _, w, I, exact = probes
    ((code, sentence),) = sentences(probes, exact * (1 + 2e-3 * np.sin(w)))
    assert code == "nearly-right" and "within 0.002 of" in sentence

    def rates(w):
        return reference.euler_rhs(w.T, I.T).T

    heun = (exact + rates(w + 1e-4 * exact)) / 2
    ((code, sentence),) = sentences(probes, heun)
    assert code == "nearly-right" and " of 164 points" in sentence
    assert sentences(probes, exact * (1 + 0.2 * np.sin(w))) == []


def test_a_function_that_is_wrong_at_few_points_is_not_called_nearly_right(probes):
    answer = probes[3].copy()
    answer[3:8] += 1.0 + np.arange(5)[:, None]
    assert "nearly-right" not in [code for code, _ in sentences(probes, answer)]
