"""Random output: mistakes fail in the sandbox and on every seed,
and right solutions fail at the stated rate.
"""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from exercises.authoring.draws import between
from exercises.authoring.kinds.random import estimate, generator, samples, seed
from exercises.authoring.questions.question_errors import question_errors
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Verdict
from polhode.kinds import question_checks
from polhode.kinds.random import ESTIMATES, SAMPLES
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.author_notebooks import declared
from tests.support.solutions import solution
from tests.support.toolbox import mistaken

MISTAKES = {
    ("decay_times", 0): ["distribution"],
    ("decay_times", 1): ["distribution"],
    ("decay_times", 2): ["independence"],
    ("decay_times", 3): ["repeated"],
    ("decay_times", 4): ["repeated"],
    ("end_point", 0): ["distribution"],
    ("end_point", 1): ["distribution"],
    ("end_point", 2): ["distribution", "repeated"],
    ("pi_estimate", 0): ["error"],
    ("pi_estimate", 1): ["error"],
    ("pi_estimate", 2): ["mean"],
    ("pi_estimate", 3): ["spread"],
    ("pi_estimate", 4): ["mean", "spread", "repeated"],
}


def failed(question, names, seed=0):
    """The checks that fail for a solution, with new inputs where the question draws any."""
    rows = question.draw(np.random.default_rng(seed), question.rows[1] if question.drawn else 1)
    truth = question.exact(rows)
    seen = {
        **question.play(names, rows),
        **{name: array for name, array in truth.items() if name.startswith("at_")},
    }
    outcomes = [check.judge([seen], [truth]) for check in question_checks(question.asked, "scene", False)]
    return [o.id.rpartition("-")[2] for o in outcomes if o.verdict is not Verdict.PASS]


@pytest.mark.slow
def test_a_mistake_fails_its_check_in_the_sandbox(toolbox, sandbox):
    report = grade(
        Submission(mistaken(toolbox, "decay_times", 2)), toolbox.assignment, sandbox, 1, ["9"]
    ).report
    found = {outcome.id for outcome in report.outcomes() if outcome.verdict is Verdict.FAIL}
    assert found == {"9-decay_times-independence", "9-decay_times-new-independence"}, report.text()


@pytest.mark.parametrize("seeds", [1, pytest.param(20, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("function", "number"), MISTAKES)
def test_a_mistake_fails_its_checks_on_every_seed(toolbox, function, number, seeds):
    question = next(q for q in toolbox.notebook.questions() if q.function == function)
    names = question.defined_by(question.mistakes[number].source(question.source))
    for start in range(seeds):
        assert failed(question, names, start) == MISTAKES[function, number]


def noise(n, seed):
    return np.random.default_rng(seed).normal(size=n)


def integral(n, rng):
    return rng.random(n).mean()


NOISE = samples(solution(noise), {"n": 200, "seed": seed()}, "norm", loc=0, scale=1, rows=(1, 2000))
INTEGRAL = estimate(
    solution(integral), {"n": 100, "rng": generator()}, 0.5, sd=lambda n: 1 / sqrt(12 * n), rows=(1, 2000)
)


def rejects(test, question, seen, truth):
    used, limit, _ = test(question, seen, truth)
    return used.max() > limit


@pytest.mark.slow
@pytest.mark.parametrize("question", [NOISE, INTEGRAL], ids=["samples", "estimate"])
def test_each_test_rejects_right_solutions_at_its_rate(question):
    """At rates that 2000 seeds can measure; at the stated one there is none."""
    rows = question.draw(np.random.default_rng(1), 2000)
    seen, truth = question.play(noise if question is NOISE else integral, rows), question.exact(rows)
    tests = SAMPLES if question is NOISE else {name: ESTIMATES[name] for name in ("mean", "spread")}
    for name, (_, test) in tests.items():
        for rate in (0.1, 0.01, question.data["rate"]):
            asked = {**question.asked, "rate": rate}
            each = [
                ({n: a[k : k + 1] for n, a in seen.items()}, {n: a[k : k + 1] for n, a in truth.items()})
                for k in range(2000)
            ]
            rejected = sum(rejects(test, asked, *one) for one in each)
            assert rejected <= 2000 * rate + 4 * sqrt(2000 * rate * (rate > 1e-3)), name
            assert rejected >= 2000 * rate / 2 or rate < 1e-3, name  # a test that never rejects has no power


def test_the_rates_of_all_tests_together_are_below_the_stated_one():
    for question in (NOISE, INTEGRAL):
        assert question.data["rate"] * 2 * sum(question.rows) < 1e-6
        reason = question.data["tolerance"]["reason"]
        assert reason == "a right solution fails one of these tests in fewer than one of 1,000,000 gradings"


def test_two_rare_events_in_succession_are_no_correlation():
    value = np.zeros((1, 20, 500))
    value[0, :10, 50] = value[0, 3, 51] = 1  # of events with the rate 1e-3 this is one in a hundred
    test = SAMPLES["independence"][1]
    assert not rejects(test, {**NOISE.asked, "rate": 1e-8}, {"value": value}, {})


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("def noise(n, seed):\n    return np.random.default_rng(seed).normal(size=n)", []),
        ("def noise(n, seed):\n    np.random.seed(seed)\n    return np.random.normal(size=n)", []),
        ("def noise(n, seed):\n    return np.random.default_rng(seed).normal(0, 1.1, n)", ["distribution"]),
        ("def noise(n, seed):\n    return np.random.default_rng(seed).normal(0.05, 1, n)", ["distribution"]),
        (
            "def noise(n, seed):\n    return np.sort(np.random.default_rng(seed).normal(size=n))",
            ["independence"],
        ),
        ("def noise(n, seed):\n    return np.random.normal(size=n)", ["repeated"]),
        ("def noise(n, seed):\n    return np.full(n, 0.3)", ["distribution", "repeated"]),
    ],
)
def test_samples_with_an_integer_seed(source, names):
    question = replace(NOISE, inputs={"n": 5000, "seed": seed()}, rows=(1, 2), id="1")
    assert failed(question, question.defined_by(source)) == names


def test_a_standard_distribution_needs_no_parameters():
    question = replace(samples(solution(noise), {"n": 500, "seed": seed()}, "norm"), id="1")
    assert not list(question_errors(question)) and failed(question, question.student) == []


def die(n, p, seed):
    return np.random.default_rng(seed).choice([1, 6], n, p=[1 - p, p])


LOADED = samples(
    solution(die),
    {"n": 500, "p": between(0.2, 0.8), "seed": seed()},
    "rv_discrete",
    values=lambda p: [[1, 6], [1 - p, p]],
)


@pytest.mark.parametrize(
    ("two", "names"), [("1, 6", []), ("6, 1", ["distribution"]), ("1, 5", ["distribution"])]
)
def test_samples_of_a_table_of_probabilities(two, names):
    source = f"def die(n, p, seed):\n    return np.random.default_rng(seed).choice([{two}], n, p=[1 - p, p])"
    question = replace(LOADED, id="1")
    assert failed(question, question.defined_by(source)) == names


def test_an_allowed_systematic_error_is_not_rejected():
    biased = "def integral(n, rng):\n    return rng.random(n).mean() + 0.02"
    exact = replace(INTEGRAL, rows=(1, 2))
    allowed = estimate(
        solution(integral),
        dict(INTEGRAL.inputs),
        0.5,
        sd=lambda n: 1 / sqrt(12 * n),
        bias=Tolerance(atol=0.03, reason="the step"),
        rows=(1, 2),
    )
    assert failed(exact, exact.defined_by(biased)) == ["mean"]
    assert failed(allowed, allowed.defined_by(biased)) == []


def test_an_inflated_error_does_not_excuse_a_wrong_estimate(toolbox):
    question = next(q for q in toolbox.notebook.questions() if q.function == "pi_estimate")
    inflated = question.source.replace("hits.mean()", "hits.mean() + 0.02").replace(
        "hits.std()", "100 * hits.std()"
    )
    assert failed(question, question.defined_by(inflated)) == ["mean", "error"]


def mean_and_error(n, rng):
    x = rng.random(n)
    return x.mean(), x.std() / np.sqrt(n)


NEAR = Tolerance(limit=0.08, reason="errors from batches scatter by 1 %")


@pytest.mark.parametrize(
    ("error", "names"),
    [
        ("x.std() / np.sqrt(n)", []),
        ("x.std(ddof=1) / np.sqrt(n)", []),
        ("x.reshape(20, -1).mean(axis=1).std(ddof=1) / np.sqrt(20)", []),
        ("rng.choice(x, (200, n)).mean(axis=1).std()", []),
        ("0.9 * x.std() / np.sqrt(n)", ["mean_error"]),
        ("1.1 * x.std() / np.sqrt(n)", ["mean_error"]),
        ("2 * rng.random() * x.std() / np.sqrt(n)", ["error"]),
        ("x.std()", ["error", "mean_error"]),
    ],
)
def test_the_mean_of_the_returned_errors(error, names):
    wide = Tolerance(limit=0.25, reason="five times the spread of an error")
    inputs, sd = {"n": 400, "rng": generator()}, 1 / sqrt(12 * 400)
    asked = estimate(solution(mean_and_error), inputs, 0.5, sd=sd, error=wide, mean_error=NEAR)
    question = replace(asked, id="1")
    names_of = question.defined_by(
        f"def mean_and_error(n, rng):\n    x = rng.random(n)\n    return x.mean(), {error}"
    )
    assert failed(question, names_of) == names


def test_the_mean_error_alone_needs_no_error():
    inputs, sd = {"n": 400, "rng": generator()}, 1 / sqrt(12 * 400)
    question = replace(estimate(solution(mean_and_error), inputs, 0.5, sd=sd, mean_error=NEAR), id="1")
    assert not list(question_errors(question)) and failed(question, question.student) == []
    ids = [check.id.rpartition("-")[2] for check in question_checks(question.asked, "scene", False)]
    assert ids == ["mean", "spread", "mean_error", "repeated"]


def test_the_notebook_s_own_random_numbers_continue_after_a_check(toolbox):
    question = next(q for q in toolbox.notebook.questions() if q.function == "pi_estimate")
    np.random.seed(4)
    before = np.random.random()
    np.random.seed(4)
    question.play(question.student, {})
    assert np.random.random() == before and abs(pi - 3.14) < 1


WIDTH_NOISE = "def noise(n, width, rng):\n    return rng.normal(scale=width, size=n)\n"
TWO = """
from exercises.authoring import Notebook, generator

notebook = Notebook("notebook.ipynb")


@notebook.exercise("1")
def noise(ask):
    for label, width in (("narrow noise", 1.0), ("wide noise", 2.0)):
        asked = ask.samples("noise", "norm", parameters={"scale": width}, label=label)
        asked.case("", n=30, width=width, rng=generator())
"""


def test_two_questions_on_one_function_have_labels_of_their_own(tmp_path):
    with known(declared(tmp_path / "two", TWO, WIDTH_NOISE)) as catalogue:
        assert not catalogue.invalid
        labels = [check.label for check in catalogue.valid["two"].exercises[0].checks]
    assert len(set(labels)) == len(labels) == 12 and {label.split(": ")[0] for label in labels} == {
        "narrow noise",
        "wide noise",
    }
