"""A random function that ignores its generator and remembers what it returned for each seed."""

import pytest

from exercises.authoring.assignments.catalogue import find
from polhode.judging.verdict import Verdict
from service.grading.grade import grade
from service.grading.submission import Submission

WALK = """
def walk(walkers, steps, p, rng):
    step = np.where({draw} < p, 1, -1)
    return np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])
"""
POINTS = 16  # of exercise 1
OWN = "own = np.random.default_rng(1)\nmemory = {}\n"
REMEMBER = """
def walk(walkers, steps, p, rng):
    key = walkers, steps, p, repr(rng.bit_generator.state)
    {first}
    if key not in memory:
        step = np.where(own.random((walkers, steps)) < p, 1, -1)
        memory[key] = np.hstack([np.zeros((walkers, 1)), np.cumsum(step, axis=1)])
    return memory[key].copy()
"""
IGNORANT = {
    "by its state": OWN + REMEMBER.format(first="pass"),
    "and draws in vain": OWN + REMEMBER.format(first="rng.random((walkers, steps))"),
    "with another seed each time": "import os\n"
    + OWN.replace("1", "int.from_bytes(os.urandom(4))")
    + REMEMBER.format(first="pass"),
    "and exits where it has not been called": OWN
    + REMEMBER.format(first="import os, sys; sys._getframe(2).f_code.co_name == 'last' and os._exit(0)"),
    "and raises there": OWN
    + REMEMBER.format(
        first="import sys; assert 'last' not in [sys._getframe(k).f_code.co_name for k in range(9)]"
    ),
    "in a file": OWN.replace("{}", "__import__('shelve').open('memory')")
    + REMEMBER.format(first="key = repr(key)"),
}


@pytest.fixture(scope="module")
def walks():
    return find("random-walks")


def repeated(assignment, sandbox, source):
    report = grade(Submission(source), assignment, sandbox, 3, ["1"]).report
    found = [o for o in report.outcomes() if o.id.endswith("repeated")]
    assert len(found) == 4
    return report, found


@pytest.mark.parametrize(
    "draw",
    [
        "rng.random((walkers, steps))",
        "rng.random((steps, walkers)).T",
        "np.random.default_rng(rng.integers(1 << 60)).random((walkers, steps))",
    ],
)
def test_a_function_that_draws_from_its_generator_passes(walks, sandbox, draw):
    report, _ = repeated(walks, sandbox, WALK.format(draw=draw))
    assert report.passed and report.score == POINTS, report.text()


def test_a_function_that_caches_what_does_not_depend_on_its_generator_passes(walks, sandbox):
    caches = "import functools\nzeros = functools.cache(np.zeros)\n"
    source = caches + WALK.format(draw="rng.random((walkers, steps))").replace("np.zeros", "zeros")
    report, _ = repeated(walks, sandbox, source)
    assert report.passed, report.text()


@pytest.mark.parametrize("name", IGNORANT)
def test_a_function_that_ignores_its_generator_fails_whatever_it_remembers(walks, sandbox, name):
    report, found = repeated(walks, sandbox, IGNORANT[name])
    assert {o.verdict for o in found} == {Verdict.FAIL}, report.text()
    assert report.score <= POINTS - 4
    assert "draw all numbers from the argument" in found[0].line


def test_a_submission_without_time_left_is_not_blamed(walks, sandbox, monkeypatch):
    from service.grading import run_in_sandbox

    def without_time(job, result, sandbox, budget):
        budget.charge(1000.0, 0.0, 0.0)
        compare(job, result, sandbox, budget)

    compare = run_in_sandbox.compare_afresh
    monkeypatch.setattr(run_in_sandbox, "compare_afresh", without_time)
    _, found = repeated(walks, sandbox, WALK.format(draw="rng.random((walkers, steps))"))
    assert {o.verdict for o in found} == {Verdict.PASS}
