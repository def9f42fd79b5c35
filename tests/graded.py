"""For tests of what was graded: submissions with reports of chosen verdicts, written as a worker writes them."""

import uuid

from ecp.judge import Verdict
from ecp.outcome import Outcome, Tolerance
from ecp.report import ExerciseReport, Provenance, Report
from service.store import runs
from service.store.accept import accept
from tests.stored import new, run, sql

VERDICTS = {"+": Verdict.PASS, "-": Verdict.FAIL, "?": Verdict.UNMEASURED}


def report(told, version="1"):
    """A report whose checks c1, c2, … have the verdicts ``told``, such as "+-?"; "." is a check that does not count."""
    outcomes = [
        Outcome(
            id=f"c{k}", label=f"check {k}", verdict=VERDICTS.get(mark, Verdict.UNMEASURED), detail="", counted=mark != ".",
            tolerance=Tolerance(reason="r"),
        )
        for k, mark in enumerate(told, start=1)
    ]  # fmt: skip
    made = Provenance(seed=7, versions={}, walls="tier B", phases_ms={"grade": 1.0})
    return Report("rigid-body", version, [ExerciseReport("2", "Euler", outcomes)], made)


def submitted(url, person="ann", **more):
    """A submission that waits; its id and its attempt's."""
    one = new(person, **more)
    run(url, lambda d: accept(d, one))
    return one.id, sql(url, "SELECT id FROM attempt WHERE submission_id = %s", one.id)[0][0]


def claim(url, attempt, worker="w1"):
    return run(url, lambda d: runs.claim(d, attempt, uuid.uuid4(), worker))


def finish(url, attempt, told, version="1"):
    """Grade that attempt."""
    sql(url, "DELETE FROM procrastinate_jobs WHERE args->>'attempt' = %s", str(attempt))
    claimed = claim(url, attempt)
    return run(url, lambda d: runs.finish(d, claimed, report(told, version), {}))


def graded(url, person, told, version="1"):
    """A submission with its report; its id."""
    id, attempt = submitted(url, person)
    assert finish(url, attempt, told, version)
    return id


def open_attempts(url):
    """Submission and attempt of what has no result, oldest first."""
    query = (
        "SELECT submission_id, id FROM attempt a WHERE NOT EXISTS (SELECT 1 FROM result WHERE attempt_id = a.id) ORDER BY number"
    )
    return sql(url, query)


def grade_open(url, told_by_submission, version="2"):
    """Grade what is open, by submission."""
    for submission, attempt in open_attempts(url):
        if submission in told_by_submission:
            finish(url, attempt, told_by_submission[submission], version)
