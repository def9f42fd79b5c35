"""Store submissions for tests with results as a worker writes them. But for ``grade_really`` the reports are
built.

``hand_in``, ``grade`` and ``grade_really`` take an open database, the others its address.
"""

import time
import uuid

from exercises.authoring.assignments.catalogue import assignments
from service.grading import grade as core
from service.grading.figures import rendering
from service.grading.submission import Submission
from service.store.queue import runs
from service.store.submissions.accepting import accept
from service.store.submissions.records import NewSubmission
from tests.support.database import new, run, sql
from tests.support.reports import report_of_marks, report_of_verdicts


async def hand_in(
    database,
    person,
    marks,
    *,
    days_ago=0.0,
    source="def euler_eqs(t, w, I):\n    return w\n",
    filename="a.py",
    **about,
):
    """Store a submission of exercise 2, graded if ``marks`` is not None; return its id."""
    arrived = time.monotonic() - 86400.0 * days_ago
    new = NewSubmission(uuid.uuid4(), "rigid-body", person, Submission(source, filename, ["2"]), 7, arrived)
    await accept(database, new)
    if marks is not None:
        await grade(database, new.id, marks, **about)
    return new.id


async def grade(database, submission, marks, **about):
    """Give the last grading of a submission a report of those marks."""
    query = "SELECT id FROM grading WHERE submission_id = %(id)s ORDER BY number DESC LIMIT 1"
    grading = (await database.rows(query, {"id": submission}))[0].id
    claimed = await runs.claim(database, grading, uuid.uuid4(), "test worker")
    assert await runs.finish(database, claimed, report_of_marks(marks, **about), {"arrays.npz": b"none"})


async def grade_really(database, submission, sandbox, phases_ms):
    """Grade the last grading of a submission in the sandbox and keep its arrays."""
    query = "SELECT id FROM grading WHERE submission_id = %(id)s ORDER BY number DESC LIMIT 1"
    id = (await database.rows(query, {"id": submission}))[0].id
    claimed = await runs.claim(database, id, uuid.uuid4(), "test worker")
    graded = core.grade(claimed.submission, assignments()[claimed.assignment], sandbox, claimed.seed)
    graded.report.provenance.phases_ms = phases_ms
    assert await runs.finish(database, claimed, graded.report, rendering.pack(graded))


def submitted(url, person="ann", **more):
    """Store a submission that waits; return its id and its grading's."""
    one = new(person, **more)
    run(url, lambda d: accept(d, one))
    return one.id, sql(url, "SELECT id FROM grading WHERE submission_id = %s", one.id)[0][0]


def claim(url, grading, worker="w1"):
    """Begin a run of the grading."""
    return run(url, lambda d: runs.claim(d, grading, uuid.uuid4(), worker))


def finish(url, grading, verdicts="", version="1", **more):
    """Give the grading a report of those verdicts, such as "+-?";
    ``more`` sets other fields of the report.
    """
    sql(url, "DELETE FROM procrastinate_jobs WHERE args->>'attempt' = %s", str(grading))
    claimed = claim(url, grading)
    return run(
        url, lambda d: runs.finish(d, claimed, report_of_verdicts(verdicts, version=version, **more), {})
    )


def graded(url, person, verdicts="", version="1", **more):
    """Store a submission with a report of those verdicts; ``more`` sets other fields of the report. Return
    its id.
    """
    id, grading = submitted(url, person)
    assert finish(url, grading, verdicts, version, **more)
    return id


def open_gradings(url):
    """Return submission and grading of each grading without result, oldest first."""
    query = (
        "SELECT submission_id, id FROM grading a WHERE NOT EXISTS (SELECT 1 FROM result WHERE grading_id ="
        " a.id) ORDER BY number"
    )
    return sql(url, query)


def grade_open(url, verdicts_by_submission, version="2"):
    """Grade every open grading of the submissions named."""
    for submission, grading in open_gradings(url):
        if submission in verdicts_by_submission:
            finish(url, grading, verdicts_by_submission[submission], version)
