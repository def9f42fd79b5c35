"""Accepting: one transaction, one submission per key, limits that hold for many at once."""

import asyncio
import dataclasses
import time
from datetime import UTC, datetime, timedelta

import psycopg
import pytest

from service.store.course.deadlines import extend
from service.store.queue.workers import sweep
from service.store.submissions import records
from service.store.submissions.accepting import Accepted, KeyReused, SubmissionRejected, TooManyOpen, accept
from tests.support.database import new, run, sql
from tests.support.submissions import grade


def test_a_submission_its_grading_and_its_job_are_there_together(database_url):
    one = new(source="print('ω')", exercises=["2"])
    assert run(database_url, lambda d: accept(d, one)).id == one.id
    stored = run(database_url, lambda d: records.read(d, one.id))
    assert (stored.submission, stored.person, stored.seed) == (one.submission, "ann", 7)
    assert stored.submission.exercises == ["2"]
    assert stored.status == "queued" and not stored.finished and not stored.late
    ((args, priority),) = sql(database_url, "SELECT args, priority FROM procrastinate_jobs")
    assert args == {"attempt": str(stored.grading)} and priority == 2000


def test_a_key_means_one_submission_for_one_person(database_url):
    one, again, other = new(), new(), new(source="x = 1")
    assert run(database_url, lambda d: accept(d, one, "k")).fresh
    known = run(database_url, lambda d: accept(d, again, "k"))
    assert known.id == one.id and not known.fresh
    with pytest.raises(KeyReused):
        run(database_url, lambda d: accept(d, other, "k"))
    elsewhere = new("ben")
    assert run(database_url, lambda d: accept(d, elsewhere, "k")).id == elsewhere.id
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs") == [(2,)]


def test_what_repeats_the_last_submission_is_stored_only_if_wanted(database_url):
    def sent(one, key=None, repeat=False):
        return run(database_url, lambda d: accept(d, one, key, repeat=repeat))

    one = new(exercises=["2"])
    assert sent(one).fresh
    repeated = sent(new(exercises=["2"]), "k1")
    assert (repeated.id, repeated.fresh, repeated.repeated) == (one.id, False, True)
    assert (
        sent(new(exercises=["2"]), repeat=True).fresh
        and sent(new()).fresh
        and sent(new("ben", exercises=["2"])).fresh
    )
    earlier = new(exercises=["2"])
    assert sent(earlier).fresh, "only the last submission counts"
    kept = new(source="x = 1")
    assert sent(kept, "k2").fresh
    retried = sent(new(source="x = 1"), "k2")
    assert retried.id == kept.id and not retried.repeated, "a retry of one request is no repetition"
    assert sql(database_url, "SELECT count(*) FROM submission") == [(6,)]


@pytest.mark.parametrize("result", ["another version", "a system fault"])
def test_a_repetition_is_graded_if_its_report_would_be_another(database_url, result):
    one = new()
    run(database_url, lambda d: accept(d, one))
    if result == "another version":
        run(database_url, lambda d: grade(d, one.id, {"2-energy": "✓"}, version="0"))
    else:
        sql(database_url, "INSERT INTO result (grading_id, fault) SELECT id, 'ours' FROM grading")
    assert run(database_url, lambda d: accept(d, new(), repeat=False)).fresh


def test_the_last_submission_is_returned_after_the_deadline_and_at_the_limit(database_url):
    one = new()
    run(database_url, lambda d: accept(d, one))
    sql(database_url, "UPDATE assignment SET due_at = now() - interval '1 h', submission_limit = 1")
    assert run(database_url, lambda d: accept(d, new(), repeat=False)).id == one.id
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda d: accept(d, new(source="x = 1"), repeat=False))


def test_twenty_at_once_with_one_key_are_one(database_url):
    ids = run(database_url, lambda d: asyncio.gather(*(accept(d, new(), "k") for _ in range(20))))
    assert (
        len({a.id for a in ids}) == 1
        and sum(a.fresh for a in ids) == 1
        and sql(database_url, "SELECT count(*) FROM grading") == [(1,)]
    )


async def _count_refused(database, news):
    answers = await asyncio.gather(*(accept(database, n) for n in news), return_exceptions=True)
    assert all(isinstance(a, Accepted | SubmissionRejected) for a in answers), answers
    return [a.kind for a in answers if isinstance(a, SubmissionRejected)]


def test_the_limit_holds_for_many_at_once_and_faults_do_not_count(database_url):
    run(database_url, lambda d: d.ping())
    sql(database_url, "UPDATE assignment SET submission_limit = 3")
    refused = run(database_url, lambda d: _count_refused(d, [new(seed=k) for k in range(10)]))
    assert refused == ["none-left"] * 7
    assert (
        sql(database_url, "SELECT count(*) FROM submission")
        == sql(database_url, "SELECT count(*) FROM procrastinate_jobs")
        == [(3,)]
    )
    sql(database_url, "INSERT INTO result (grading_id, fault) SELECT id, 'ours' FROM grading LIMIT 1")
    assert run(database_url, lambda d: _count_refused(d, [new(), new()])) == ["none-left"]


def test_a_repeated_request_is_answered_although_none_is_left(database_url):
    one = new()
    run(database_url, lambda d: accept(d, one, "k"))
    sql(database_url, "UPDATE assignment SET submission_limit = 1, due_at = now() - interval '1 day'")
    assert run(database_url, lambda d: accept(d, new(), "k")).id == one.id


def test_a_repeated_request_is_told_the_same_lateness_as_every_page(database_url):
    run(database_url, lambda d: d.ping())
    sql(database_url, "UPDATE assignment SET due_at = now() - interval '1 min', grace_s = 3600")
    assert (
        run(database_url, lambda d: accept(d, new(), "k")).late
        and run(database_url, lambda d: accept(d, new(), "k")).late
    )
    sql(database_url, "UPDATE assignment SET due_at = now() + interval '1 day'")
    assert not run(database_url, lambda d: accept(d, new(), "k")).late


@pytest.mark.parametrize(
    ("due", "grace", "fate"),
    [("+1 hour", 0, "on time"), ("-1 hour", 7200, "late"), ("-1 hour", 60, "refused")],
)
def test_the_deadline_and_its_grace(database_url, due, grace, fate):
    run(database_url, lambda d: d.ping())
    sql(database_url, "UPDATE assignment SET due_at = now() + %s::interval, grace_s = %s", due, grace)
    one = new()
    if fate == "refused":
        with pytest.raises(SubmissionRejected, match="the deadline was"):
            run(database_url, lambda d: accept(d, one))
        assert sql(database_url, "SELECT count(*) FROM submission") == [(0,)]
    else:
        run(database_url, lambda d: accept(d, one))
        assert run(database_url, lambda d: records.read(d, one.id)).late == (fate == "late")


def test_an_extension_is_a_later_deadline_for_its_person_and_nobody_else(database_url):
    now = datetime.now(UTC)
    run(database_url, lambda d: accept(d, new("ann")))
    sql(database_url, "UPDATE assignment SET due_at = %s, grace_s = 0", now - timedelta(hours=1))
    assert run(
        database_url,
        lambda d: extend(d, "rigid-body", "ann", now + timedelta(hours=1), reason="was ill", by="prof"),
    )
    assert not run(database_url, lambda d: accept(d, new("ann"))).late
    with pytest.raises(SubmissionRejected, match="the deadline was"):
        run(database_url, lambda d: accept(d, new("ben")))


def test_what_was_sent_is_never_altered(database_url):
    run(database_url, lambda d: accept(d, new()))
    for change in ("source = 'x'", "submitted_at = now()"):
        with pytest.raises(psycopg.errors.RaiseException, match="never altered"):
            sql(database_url, f"UPDATE submission SET {change}")


def test_order_a_tenth_does_not_pass_anothers_first_and_regrades_wait(database_url):
    async def fill(database):
        for k in range(10):
            await accept(database, new("ben", seed=k))
        for name in ("cleo", "dora"):
            await accept(database, new(name))

    run(database_url, fill)
    sql(database_url,
        "UPDATE grading SET kind = 'regrade' FROM submission s JOIN person p ON p.id = s.person_id "
        "WHERE s.id = submission_id AND p.name = 'cleo'")  # fmt: skip
    sql(database_url, "DELETE FROM procrastinate_jobs")
    sql(database_url, "UPDATE grading SET requested_at = requested_at - interval '1 minute'")
    assert len(run(database_url, sweep)) == 12
    order = sql(database_url,
        "SELECT p.name FROM procrastinate_jobs j JOIN grading a ON a.id::text = j.args->>'attempt' "
                "JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id "
                "ORDER BY j.priority DESC, j.id")  # fmt: skip
    assert [name for (name,) in order] == ["ben", "dora", *["ben"] * 9, "cleo"]


def test_the_time_is_that_of_the_request(database_url):
    """Not when the database had time for it: a deadline that passes in between does not count."""
    run(database_url, lambda d: d.ping())
    sql(database_url, "UPDATE assignment SET due_at = now() - interval '2 s'")
    early = dataclasses.replace(new(), arrived=time.monotonic() - 5)
    assert not run(database_url, lambda d: accept(d, early)).late
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda d: accept(d, new()))
    ((age,),) = sql(database_url, "SELECT extract(epoch FROM now() - submitted_at) FROM submission")
    assert 5 < age < 10


def test_no_more_than_the_permitted_number_waits_for_reports_also_when_sent_at_once(database_url):
    async def send(database):
        sent = [accept(database, new(seed=k), most_open=3) for k in range(10)]
        return await asyncio.gather(*sent, return_exceptions=True)

    results = run(database_url, send)
    assert (
        sum(isinstance(r, Accepted) for r in results) == 3
        and sum(isinstance(r, TooManyOpen) for r in results) == 7
    )
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs") == [(3,)]
    assert run(database_url, lambda d: accept(d, new("ben"), most_open=3)).fresh
    first = next(r for r in results if isinstance(r, Accepted))
    run(database_url, lambda d: grade(d, first.id, {"2-energy": "✓"}))
    assert run(database_url, lambda d: accept(d, new(), most_open=3)).fresh, "one has its report"
    for action in (
        lambda d: accept(d, new(), "k", most_open=4),
        lambda d: accept(d, new(), "k", most_open=1),
    ):
        assert run(database_url, action).submitted_at, "a repeated request is no new submission"
