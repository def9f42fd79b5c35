"""A fit and its covariance, in units of the exact standard deviations."""

import numpy as np
import pytest
from scipy.optimize import curve_fit

from exercises.authoring.draws import between
from exercises.authoring.kinds.fit import fit
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Verdict
from polhode.kinds import question_checks
from tests.support.solutions import solution

PARAMETERS, COVARIANCE = "parameters", "covariance"


def failed(question, names, seed=0):
    rows = question.draw(np.random.default_rng(seed), 4)
    seen, truth = question.play(names, rows), question.exact(rows)
    outcomes = [check.judge([seen], [truth]) for check in question_checks(question.asked, "scene", False)]
    return [o.id.rpartition("-")[2] for o in outcomes if o.verdict is not Verdict.PASS]


@pytest.mark.parametrize(
    ("number", "names"),
    [
        (0, [PARAMETERS, COVARIANCE]),
        (1, [PARAMETERS, COVARIANCE]),
        (2, [COVARIANCE]),
        (3, [COVARIANCE]),
        (4, [COVARIANCE]),
    ],
)
def test_a_mistake_fails_its_checks(toolbox, number, names):
    question = next(q for q in toolbox.notebook.questions() if q.kind == "fit")
    assert failed(question, question.student) == []
    assert failed(question, question.defined_by(question.mistakes[number].source(question.source))) == names


def line(x, y, s):
    A = np.stack([np.ones_like(x), x], axis=1) / s[:, None]
    C = np.linalg.inv(A.T @ A)
    p = C @ A.T @ (y / s)
    return p, C


def scaled(x, y, s):
    p, C = line(x, y, s)
    return p, C * np.sum(((y - p[0] - p[1] * x) / s) ** 2) / (len(x) - 2)


@pytest.mark.parametrize("absolute", [True, False])
def test_a_straight_line_by_the_normal_equations(absolute):
    limit = Tolerance(limit=1e-6, reason="of a standard deviation")
    question = fit(
        solution(line if absolute else scaled),
        lambda x, a, b: a + b * x,
        x=np.linspace(0, 5, 12),
        sigma=0.3,
        drawn={"a": between(-3, 3), "b": between(-1, 1)},
        parameters=limit,
        covariance=limit,
        absolute_sigma=absolute,
    )
    assert failed(question, {question.function: line if absolute else scaled}) == []
    assert failed(question, {question.function: scaled if absolute else line}) == [COVARIANCE]


def test_a_covariance_that_is_not_finite_fails_alone(toolbox):
    question = next(q for q in toolbox.notebook.questions() if q.kind == "fit")
    assert failed(
        question, question.defined_by(question.source.replace("return p, C", "return p, C * np.nan"))
    ) == [COVARIANCE]


def resonance(x, y, s):
    start = (1.0, 1.5, 0.5)
    p, C = curve_fit(lorentz, x, y, start, sigma=s, absolute_sigma=True, xtol=1e-12, ftol=1e-12)
    return p, C


def lorentz(x, A, x0, g):
    return A / (1 + ((x - x0) / g) ** 2)


@pytest.mark.parametrize("seed", range(4))
def test_a_model_with_two_equal_minima_has_the_one_that_was_drawn(seed):
    drawn = {"A": between(0.8, 2), "x0": between(1, 2), "g": between(0.3, 0.8)}
    near = Tolerance(limit=1e-3, reason="of a standard deviation")
    question = fit(
        solution(resonance),
        lorentz,
        x=np.linspace(0, 3, 40),
        sigma=0.05,
        drawn=drawn,
        parameters=near,
        covariance=near,
    )
    assert not list(question.errors() if question.errors else ())
    assert np.all(question.exact(question.draw(np.random.default_rng(seed), 4))["parameters"][:, 2] > 0)
