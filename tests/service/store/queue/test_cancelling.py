"""Cancelling: the first result stays, nothing comes back into the queue, and it costs its person nothing."""

import asyncio
import uuid

import pytest

from service.http import metrics
from service.store.queue import runs, workers
from service.store.queue.cancelling import AlreadyFinished, cancel
from service.store.queue.overview import regrade, snapshot
from service.store.submissions import records
from service.store.submissions.accepting import SubmissionRejected, accept
from tests.support.database import new, run, sql
from tests.support.reports import report_of_verdicts
from tests.support.submissions import claim, finish, graded, submitted


def jobs(url):
    return sql(url, "SELECT count(*) FROM procrastinate_jobs")[0][0]


def fall_silent(url):
    sql(
        url,
        "UPDATE run SET heartbeat_at = now() - interval '1 minute', ended_at = ended_at - interval '1"
        " minute'",
    )
    sql(url, "UPDATE procrastinate_events SET at = at - interval '1 minute'")
    sql(url, "UPDATE grading SET requested_at = requested_at - interval '1 minute'")


def forgotten(url):
    """What housekeeping queues again long after."""
    fall_silent(url)
    return run(url, workers.recover) + run(url, workers.sweep)


def test_what_waits_loses_its_job_and_gets_a_result_that_says_by_whom(database_url):
    id, grading = submitted(database_url)
    assert run(database_url, lambda d: cancel(d, grading, "prof")) == id
    stored = run(database_url, lambda d: records.read(d, id))
    assert (stored.status, stored.fault, stored.cancelled_by) == ("faulted", "cancelled by prof", "prof")
    assert jobs(database_url) == 0 and forgotten(database_url) == [] and claim(database_url, grading) is None
    ((who, action, subject, detail),) = sql(database_url, "SELECT actor, action, subject, detail FROM audit")
    assert (who, action, subject, detail["person"]) == ("prof", "cancel", str(id), "ann")
    (fault,) = run(database_url, snapshot).faults
    assert (fault.submission, fault.cancelled_by) == (id, "prof")


def test_it_is_counted_as_no_fault_of_ours(database_url):
    run(database_url, lambda d: cancel(d, submitted(database_url)[1], "prof"))
    told = run(database_url, metrics.exposition).decode()
    for status, count in (("graded", 0), ("faulted", 0), ("cancelled", 1)):
        assert f'polhode_results_total{{status="{status}"}} {count}.0\n' in told


def test_it_costs_no_submission(database_url):
    _, grading = submitted(database_url)
    sql(database_url, "UPDATE assignment SET submission_limit = 1")
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda d: accept(d, new()))
    run(database_url, lambda d: cancel(d, grading, "prof"))
    assert run(database_url, lambda d: accept(d, new())).fresh


def test_what_runs_is_told_at_its_next_beat_and_does_not_come_back(database_url):
    _, grading = submitted(database_url)
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    claimed = claim(database_url, grading)
    assert run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 9)) is True
    run(database_url, lambda d: cancel(d, grading, "prof"))
    assert run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 9)) is False
    run(database_url, lambda d: runs.supersede(d, claimed))
    run(database_url, lambda d: runs.release(d, claimed, "released", "the worker was stopped"))
    assert sql(database_url, "SELECT end_reason FROM run") == [("cancelled",)]
    # as the worker does at the end of a job
    sql(database_url, "DELETE FROM procrastinate_jobs WHERE status = 'doing'")
    assert forgotten(database_url) == [] and jobs(database_url) == 0


def test_a_worker_that_died_with_it_is_not_replaced(database_url):
    _, grading = submitted(database_url)
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    claim(database_url, grading)
    run(database_url, lambda d: cancel(d, grading, "prof"))
    assert forgotten(database_url) == [] and jobs(database_url) == 0


def test_a_lost_run_that_comes_back_is_not_opened_again(database_url):
    _, grading = submitted(database_url)
    claimed = claim(database_url, grading)
    sql(database_url, "UPDATE run SET ended_at = now(), end_reason = 'lost'")
    run(database_url, lambda d: cancel(d, grading, "prof"))
    assert run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 9)) is False
    assert not run(database_url, lambda d: runs.finish(d, claimed, report_of_verdicts("+"), {}))
    assert sql(database_url, "SELECT end_reason FROM run") == [("superseded",)]


@pytest.mark.parametrize("repetition", range(6))
def test_cancelled_while_it_finishes_the_first_result_stays(database_url, repetition):
    id, grading = submitted(database_url)
    submitted(database_url)  # whose next one moves up, from both sides
    claimed = claim(database_url, grading)

    async def both(database):
        end_reason = runs.finish(database, claimed, report_of_verdicts("+-"), {})
        asked = cancel(database, grading, "prof")
        order = (end_reason, asked) if repetition % 2 else (asked, end_reason)
        return await asyncio.wait_for(asyncio.gather(*order, return_exceptions=True), 10)

    answers = run(database_url, both)
    stored = run(database_url, lambda d: records.read(d, id))
    if stored.status == "graded":
        assert (
            any(isinstance(a, AlreadyFinished) for a in answers)
            and True in answers
            and stored.cancelled_by is None
        )
        assert sql(database_url, "SELECT end_reason FROM run") == [("finished",)]
        assert sql(database_url, "SELECT count(*) FROM audit WHERE action = 'cancel'") == [(0,)]
    else:
        assert id in answers and False in answers and stored.fault == "cancelled by prof"
        assert sql(database_url, "SELECT end_reason FROM run") == [("cancelled",)]
        assert sql(database_url, "SELECT count(*) FROM outcome") == [(0,)]


@pytest.mark.parametrize("repetition", range(4))
def test_cancelled_while_a_worker_claims_it(database_url, repetition):
    _, grading = submitted(database_url)

    async def both(database):
        return await asyncio.gather(
            runs.claim(database, grading, uuid.uuid4(), "w"), cancel(database, grading, "prof")
        )

    claimed, _ = run(database_url, both)
    if claimed is not None:
        assert run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 9)) is False
    assert forgotten(database_url) == []


def test_twice_is_once_and_a_report_is_not_cancelled(database_url):
    _, grading = submitted(database_url)

    async def two(database):
        return await asyncio.gather(
            *(cancel(database, grading, who) for who in ("a", "b")), return_exceptions=True
        )

    assert sorted(type(a).__name__ for a in run(database_url, two)) == ["AlreadyFinished", "UUID"]
    _, other = submitted(database_url, "ben")
    finish(database_url, other, "+")
    with pytest.raises(AlreadyFinished):
        run(database_url, lambda d: cancel(d, other, "prof"))
    assert run(database_url, lambda d: cancel(d, uuid.uuid4(), "prof")) is None


def test_the_persons_next_one_moves_up(database_url):
    _, first = submitted(database_url)
    _, second = submitted(database_url)
    before = dict(sql(database_url, "SELECT args->>'attempt', priority FROM procrastinate_jobs"))
    run(database_url, lambda d: cancel(d, first, "prof"))
    after = dict(sql(database_url, "SELECT args->>'attempt', priority FROM procrastinate_jobs"))
    assert after == {str(second): before[str(first)]} and before[str(second)] < before[str(first)]


def test_it_can_be_tried_again_and_what_has_a_report_cannot(database_url):
    id, grading = submitted(database_url)
    fine = graded(database_url, "ben", "+")
    run(database_url, lambda d: cancel(d, grading, "prof"))
    again = lambda d: regrade(d, [id, fine], "tutor", faults=True)  # noqa: E731
    assert run(database_url, again) == 1 and run(database_url, again) == 0  # it is being graded
    assert run(database_url, lambda d: records.read(d, id)).status == "queued"
    assert sql(database_url, "SELECT actor, subject FROM audit WHERE action = 'regrade'") == [
        ("tutor", str(id))
    ]
    ((second,),) = sql(database_url, "SELECT id FROM grading WHERE submission_id = %s AND number = 2", id)
    finish(database_url, second, "++")
    stored = run(database_url, lambda d: records.read(d, id))
    assert (stored.status, stored.points, stored.cancelled_by) == ("graded", 2, None)


def test_of_a_long_queue_the_first_two_hundred_are_shown_and_all_are_counted(database_url):
    _, grading = submitted(database_url)
    more = (
        "INSERT INTO procrastinate_jobs (queue_name, task_name, priority, args) SELECT queue_name, task_name,"
        " priority, args "
    )
    sql(database_url, more + "FROM procrastinate_jobs, generate_series(1, 249)")
    queue = run(database_url, snapshot)
    assert [place.position for place in queue.places] == list(range(1, 201)) and queue.places[
        0
    ].grading == grading
    assert queue.places[0].total == queue.waiting[0].n == 250


def test_a_run_whose_grading_has_its_result_is_not_shown_as_going(database_url):
    """Its worker came back from the dead, was overtaken and died for good: nobody ends that run."""
    _, grading = submitted(database_url)
    claim(database_url, grading, "first")
    assert [run.worker for run in run(database_url, snapshot).going] == ["first"]
    assert finish(database_url, grading, "+")
    assert run(database_url, snapshot).going == []
