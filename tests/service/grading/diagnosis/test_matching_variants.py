"""Diagnosis by reproduction: the variant that returns the student's numbers, found in limited time."""

import pytest

from exercises.authoring.assignments.catalogue import find
from service.grading.diagnosis import matching_variants
from service.grading.grade import grade
from service.grading.submission import Submission

WRONG = "def mean_square(r):\n    square = np.sum(r**2, axis=2)\n"
WRONG += "    return square.mean(axis=0), square.std(axis=0, ddof=1) / np.sqrt(len(r))\n"


@pytest.fixture
def walks(monkeypatch):
    monkeypatch.setattr(matching_variants, "_public", type(matching_variants._public)())
    return find("random-walks")


def codes(assignment, sandbox):
    report = grade(Submission(WRONG), assignment, sandbox, 1, ["2"]).report
    assert not report.passed
    return {found.code for outcome in report.outcomes() for found in outcome.diagnosis}


def test_variants_that_need_too_long_diagnose_nothing_and_nothing_of_them_is_kept(
    walks, sandbox, monkeypatch
):
    diagnose_question = matching_variants.diagnose_question

    def nearly_spent(*args):
        *_, budget = args
        budget.charge(cpu_s=budget.cpu_left() - 0.01, waited_s=0.0, running_s=1.0)
        return diagnose_question(*args)

    with monkeypatch.context() as short:
        short.setattr(matching_variants, "diagnose_question", nearly_spent)
        assert codes(walks, sandbox) == set()
    assert codes(walks, sandbox) == {"missing-term"}


def test_declared_mistakes_are_played_first_and_if_they_predict_all_nothing_else_is(
    walks, sandbox, monkeypatch
):
    played, variants = [], matching_variants.play_variants

    def play_variants(job, scene, chosen, *others, **limits):
        played.append([variant.declared for variant in chosen])
        return variants(job, scene, chosen, *others, **limits)

    monkeypatch.setattr(matching_variants, "play_variants", play_variants)
    assert codes(walks, sandbox) == {"missing-term"}
    assert played and all(all(declared) for _, *declared in played)
    played.clear()
    grade(
        Submission(WRONG.replace("square.mean(axis=0)", "square.mean(axis=0) + 0.1")),
        walks,
        sandbox,
        1,
        ["2"],
    )
    assert not all(all(declared) for _, *declared in played)


def test_all_questions_of_a_grading_share_one_budget(walks, sandbox, monkeypatch):
    budgets, variants = [], matching_variants.play_variants

    def play_variants(job, scene, chosen, sandbox, budget, **limits):
        budgets.append(budget)
        return variants(job, scene, chosen, sandbox, budget, **limits)

    monkeypatch.setattr(matching_variants, "play_variants", play_variants)
    wrong = f"{WRONG}def boltzmann(r, dt, T, eta, a):\n    return r[0], 1.0, 1.0, 1.0\n"
    grade(Submission(wrong), walks, sandbox, 1, ["2", "7"])
    assert len(budgets) > 1 and len(set(map(id, budgets))) == 1
