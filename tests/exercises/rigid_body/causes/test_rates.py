"""Each slip at the probes gets its own code, and nothing that merely looks similar does."""

import numpy as np
import pytest

import reference
from exercises.rigid_body.causes import diagnose_scene
from service.grading.jobs import draw_inputs


@pytest.fixture(scope="module")
def probes(rigid_body):
    inputs = draw_inputs(rigid_body.scene("probes"), seed=11)
    w, moments = np.asarray(inputs["w"]), np.asarray(inputs["I"])
    return inputs, w, moments, reference.euler_rhs(w.T, moments.T).T


def codes(probes, wdot):
    return [d.code for d in diagnose_scene("probes", probes[0], {"wdot": wdot})]


def test_the_truth_has_no_cause(probes):
    assert codes(probes, probes[3]) == []


@pytest.mark.parametrize("k", [0, 1, 2])
def test_one_component(probes, k):
    _, w, moments, truth = probes
    i, j = (k + 1) % 3, (k + 2) % 3
    for code, column in (
        ("sign-flipped", -truth[:, k]),
        ("missing-component", 0 * truth[:, k]),
        ("missing-division", truth[:, k] * moments[:, k]),
        ("wrong-divisor", truth[:, k] * moments[:, k] / moments[:, i]),
        ("wrong-divisor", truth[:, k] * moments[:, k] / moments[:, j]),
        ("moment-sum", (moments[:, i] + moments[:, j]) * w[:, i] * w[:, j] / moments[:, k]),
        ("cyclic-order", (moments[:, i] - moments[:, j]) * w[:, k] * w[:, j] / moments[:, k]),
        ("cyclic-order", (moments[:, i] - moments[:, j]) * w[:, i] * w[:, k] / moments[:, k]),
    ):
        answer = truth.copy()
        answer[:, k] = column
        assert codes(probes, answer) == [code], code


def test_all_components(probes):
    _, w, moments, truth = probes
    assert codes(probes, -truth) == ["sign-reversed"]
    assert codes(probes, 0 * truth) == ["returns-zero"]
    assert codes(probes, w) == ["returns-input"]
    assert codes(probes, truth * moments) == ["missing-division"]
    assert codes(probes, np.roll(truth, 1, axis=1)) == ["component-order"]
    with np.errstate(divide="ignore", invalid="ignore"):
        swapped = reference.euler_rhs(moments.T, w.T).T
    assert codes(probes, swapped) == ["swapped-arguments"], "also where it divides by ω = 0"
    assert codes(probes, np.where(truth > 0, np.nan, truth)) == ["not-finite"]


def test_a_factor_is_told_with_its_value(probes):
    (diagnosis,) = diagnose_scene("probes", probes[0], {"wdot": 0.5 * probes[3]})
    assert diagnosis.code == "constant-factor" and " 0.5 times" in diagnosis.sentence


@pytest.mark.parametrize("size", [1e-9, 1e-6, 0.1])
def test_silent_when_nothing_reproduces_the_numbers(probes, size):
    _, w, I, exact = probes
    scatter = np.sin(1e5 * (w + I[:, ::-1]))  # equal at equal points
    assert codes(probes, -exact + size * scatter) == []


def test_answers_that_differ_at_equal_points_are_not_deterministic(probes):
    noise = np.random.default_rng(3).normal(size=probes[3].shape)
    assert codes(probes, probes[3] * (1 + 1e-16 * noise)) == ["not-deterministic"]
    assert codes(probes, probes[3] * (1 + 1e-12 * noise)) == ["not-deterministic"]


def test_the_sentence_points_at_component_and_term(probes):
    answer = probes[3] * [1, -1, 1]
    (diagnosis,) = diagnose_scene("probes", probes[0], {"wdot": answer})
    assert diagnosis.sentence == "ω̇₂ has the opposite sign: check (I₃ − I₁)"
