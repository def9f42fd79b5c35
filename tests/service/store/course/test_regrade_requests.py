"""Regrade requests: one open at a time, answered once, each step in the audit log."""

import asyncio
import uuid

import pytest

from service.store.course.regrade_requests import (
    RequestRejected,
    answer,
    of_assignment,
    of_submission,
    request,
)
from tests.support.database import run, sql
from tests.support.submissions import graded, submitted


def requested(url, submission, reason="my answer is the same number"):
    return run(url, lambda d: request(d, submission, "ann", reason))


def answered(url, id, status="declined", text="it is not", by="prof"):
    return run(url, lambda d: answer(d, id, by, status, text))


def test_a_request_and_its_answer(database_url):
    sent = graded(database_url, "ann", "+-")
    open_ = requested(database_url, sent)
    assert (open_.submission, open_.status, open_.answer, open_.answered_at) == (sent, "open", None, None)
    done = answered(database_url, open_.id, "accepted", "you are right")
    assert (done.status, done.answer, done.answered_by) == (
        "accepted",
        "you are right",
        "prof",
    ) and done.answered_at
    assert run(database_url, lambda d: of_submission(d, sent)) == [done]
    assert sql(database_url, "SELECT actor, action, subject, detail FROM audit ORDER BY id") == [
        ("ann", "regrade request", str(sent), {"reason": "my answer is the same number"}),
        ("prof", "regrade request accepted", str(sent), {"answer": "you are right"}),
    ]


def test_a_request_may_be_about_a_check(database_url):
    sent = graded(database_url, "ann", "+-")
    made = run(database_url, lambda d: request(d, sent, "ann", "it is right", "2-energy"))
    assert made.check == "2-energy" and run(database_url, lambda d: of_submission(d, sent)) == [made]
    (listed,) = run(database_url, lambda d: of_assignment(d, "rigid-body"))
    assert listed.check == "2-energy"
    assert sql(database_url, "SELECT detail FROM audit") == [
        ({"reason": "it is right", "check": "2-energy"},)
    ]


def test_a_second_request_waits_for_the_answer_to_the_first(database_url):
    sent, other = graded(database_url, "ann", "+-"), graded(database_url, "ann", "--")
    first = requested(database_url, sent)
    with pytest.raises(RequestRejected, match="is open: wait for its answer"):
        requested(database_url, sent)
    requested(database_url, other)
    answered(database_url, first.id)
    second = requested(database_url, sent, "once more")
    assert [one.id for one in run(database_url, lambda d: of_submission(d, sent))] == [first.id, second.id]


def test_two_that_arrive_together_make_one_request(database_url):
    sent = graded(database_url, "ann", "+-")

    async def both(database):
        return await asyncio.gather(
            *(request(database, sent, "ann", "r") for _ in range(2)), return_exceptions=True
        )

    results = run(database_url, both)
    assert sorted(type(one).__name__ for one in results) == ["RegradeRequest", "RequestRejected"]
    assert len(run(database_url, lambda d: of_submission(d, sent))) == 1


def test_a_request_is_answered_once(database_url):
    one = requested(database_url, graded(database_url, "ann", "+-"))
    answered(database_url, one.id)
    with pytest.raises(RequestRejected, match="prof has already answered this request"):
        answered(database_url, one.id, "accepted", "yes", by="tutor")
    assert answered(database_url, uuid.uuid4()) is None


def test_a_submission_without_a_report_cannot_be_disputed(database_url):
    sent, _ = submitted(database_url, "ann")
    with pytest.raises(RequestRejected, match="once it is graded"):
        requested(database_url, sent)


def test_the_list_of_an_assignment_begins_with_the_open_requests(database_url):
    sent = [graded(database_url, name, "+-") for name in ("ann", "ben", "cid")]
    made = [requested(database_url, one) for one in sent]
    answered(database_url, made[0].id)
    rows = run(database_url, lambda d: of_assignment(d, "rigid-body"))
    assert [(row.person, row.status, row.points, row.total) for row in rows] == [
        ("ben", "open", 1, 2),
        ("cid", "open", 1, 2),
        ("ann", "declined", 1, 2),
    ]
    assert not run(database_url, lambda d: of_assignment(d, "waves"))
