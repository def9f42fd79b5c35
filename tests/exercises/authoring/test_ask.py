"""Each kind of question in the declared form: sound, with the rows of its kind, and right by its solution."""

import json

import numpy as np
import pytest

from polhode.kinds import reproduces
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.assignments import known

SOLUTIONS = {
    "Decay times": "def decay_times(n, tau, rng):\n    return -tau * np.log(1 - rng.random(n))",
    "The mean life": "def mean_life(n, tau, rng):\n    return decay_times(n, tau, rng).mean()",
    "A fit": (
        "def fit_decay(t, counts, sigma):\n"
        "    return curve_fit(lambda t, N, k: N * np.exp(-k * t), t, counts, (1, 1), sigma, True, xtol=1e-12)"
    ),
}
DECLARED = """
import numpy as np
from exercises.authoring import Notebook, Value, absolute, between, generator, integer, relative

notebook = Notebook("decay.ipynb", title="Radioactive decay")
NEAR = relative(1e-3, because="of a standard deviation")


@notebook.exercise("1")
def times(ask):
    times = ask.samples("decay_times", "expon", parameters={"scale": lambda tau: tau})
    times.case("any mean life", n=500, tau=between(0.5, 3), rng=generator())
    times.mistake("missing-term", "the mean life is missing", change="-tau * -> -")

    number = ask.function("decay_times", returns="number mean", mistakes_of=times)

    @number.observe
    def shape_and_mean(decays, n, tau, seed):
        drawn = decays(n, tau, np.random.default_rng(seed))
        return len(drawn), np.mean(drawn) / tau

    number.case("", n=500, tau=between(2, 3), seed=integer(0, 9))

    @number.truth(agree=Value(absolute(0.5, because="ten times the spread"), statistic=True))
    def of_n_decays(n):
        return n, 1


@notebook.exercise("2")
def mean(ask):
    mean = ask.estimate("mean_life", sd=lambda n, tau: tau / np.sqrt(n))
    mean.case("any mean life", n=500, tau=between(0.5, 3), rng=generator(), public=2)

    @mean.truth
    def expected(tau):
        return tau


@notebook.exercise("3")
def fitted(ask):
    ask.fit(
        "fit_decay",
        lambda t, N, k: N * np.exp(-k * t),
        x=np.linspace(0, 3, 25),
        sigma=0.05,
        drawn={"N": between(1, 4), "k": between(0.5, 2)},
        parameters=NEAR,
        covariance=NEAR,
    )
"""


@pytest.fixture
def decay(tmp_path):
    cells = [("markdown", "# Decay\n\n## Setup", [])]
    cells.append(("code", "import numpy as np\nfrom scipy.optimize import curve_fit", []))
    for number, (title, solution) in enumerate(SOLUTIONS.items(), 1):
        cells.append(("markdown", f"## Exercise {number}: {title}", []))
        cells.append(("code", solution, ["solution"]))
    document = {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {},
        "cells": [{"cell_type": k, "source": s, "metadata": {"tags": tags}} for k, s, tags in cells],
    }
    folder = tmp_path / "decay"
    folder.mkdir()
    (folder / "decay.ipynb").write_text(json.dumps(document))
    (folder / "assignment.py").write_text(DECLARED)
    with known(folder) as catalogue:
        assert not catalogue.invalid
        yield catalogue.valid["decay"]


def test_a_question_has_the_rows_of_its_kind_unless_a_case_says_others(decay):
    rows = {
        scene.name: len(next(iter(inputs.values())))
        for scene in decay.scenes
        if (inputs := scene.inputs) and not callable(inputs)
    }
    assert rows == {"1-1-public": 1, "1-2-public": 3, "2-public": 2, "3-public": 2}


def test_the_solutions_of_the_notebook_pass(decay, sandbox):
    right = next(sample.source for sample in decay.made_samples() if sample.right)
    report = grade(Submission(right), decay, sandbox, 1).report
    assert report.passed and len(report.exercises) == 3, report.text()


def test_a_function_of_the_solution_is_asked_in_its_place(decay, sandbox):
    short = f"{SOLUTIONS['Decay times']}[1:]"
    report = grade(Submission(short), decay, sandbox, 1, ["1"]).report
    verdicts = {outcome.id: outcome.verdict.name for outcome in report.outcomes()}
    assert verdicts["1-2-number"] == "FAIL" and verdicts["1-2-mean"] == "PASS"


def test_a_later_question_about_a_solution_has_the_mistakes_of_the_earlier_one(decay):
    assert [variant.sentence for variant in decay.variants("1-2")[1:] if variant.declared] == [
        "the mean life is missing"
    ]


def test_a_mistake_is_recognised_by_a_statistic_only_to_rounding(decay):
    """Two means that differ by less than the tolerance are not the same random numbers."""
    question = decay.scene("1-2-public").question
    other, predicted = ({"number": np.full(3, 500.0), "mean": np.full(3, at)} for at in (0.39, 0.4))
    assert reproduces(question, predicted, predicted) and not reproduces(question, other, predicted)
