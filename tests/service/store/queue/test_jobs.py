"""The queue: nobody occupies all workers, what is slow waits last, and a job ends once."""

import asyncio
from uuid import UUID

import pytest
from procrastinate.exceptions import ConnectorException
from procrastinate.jobs import Status

from service.store.queue import runs, workers
from service.store.queue.jobs import FIRST, LATER, SLOW, first_gradings_wait, new_app
from service.store.queue.overview import regrade
from service.store.submissions import speed_vs_accuracy
from service.store.submissions.accepting import accept
from tests.support.database import new, run, sql
from tests.support.reports import report_of_verdicts
from tests.support.submissions import claim, submitted


def registered(url, count):
    for k in range(count):
        run(url, lambda d, k=k: workers.register_worker(d, f"w{k}", "process", None))


def take(url, *queues):
    """Take the next job, as a worker of these queues does. Return its grading, or None if there is none."""
    row = sql(url, "SELECT args->>'attempt' FROM procrastinate_fetch_job_v2(%s, NULL)", list(queues) or None)[
        0
    ][0]
    return row and str(row)


def take_all(url, *queues):
    return list(iter(lambda: take(url, *queues), None))


def done(url, grading, slow=False):
    """Store the grading's result as a worker does, and end its job as Procrastinate does."""
    claimed = claim(url, grading)
    assert run(url, lambda d: runs.finish(d, claimed, report_of_verdicts("+"), {}, slow=slow))
    sql(url, "DELETE FROM procrastinate_jobs WHERE args->>'attempt' = %s AND status = 'doing'", grading)


def send(url, *people, **more):
    """Store a submission for each; return their gradings."""
    return [str(submitted(url, person, **more)[1]) for person in people]


@pytest.mark.parametrize(("count", "most"), [(0, 1), (1, 1), (2, 1), (4, 3)])
def test_one_persons_gradings_never_occupy_all_workers(database_url, count, most):
    registered(database_url, count)
    anns = send(database_url, *["ann"] * 6)
    assert take_all(database_url) == anns[:most]
    (bens,) = send(database_url, "ben")
    assert take_all(database_url) == [bens], "the worker that is left is for others"


def test_workers_that_cannot_grade_or_are_gone_do_not_count(database_url):
    registered(database_url, 4)
    sql(database_url, "UPDATE worker SET isolation = NULL WHERE name = 'w0'")
    sql(database_url, "UPDATE worker SET seen_at = now() - interval '1 minute' WHERE name = 'w1'")
    anns = send(database_url, "ann", "ann")
    assert take_all(database_url) == anns[:1]


def test_a_persons_place_is_free_again_whichever_grading_ends_first(database_url):
    registered(database_url, 4)
    anns = send(database_url, *["ann"] * 5)
    assert take_all(database_url) == anns[:3]
    for ended, next_ in ((anns[1], anns[3]), (anns[0], anns[4])):
        done(database_url, ended)
        assert take_all(database_url) == [next_]
    done(database_url, anns[3])
    sixth = send(database_url, "ann")
    assert take_all(database_url) == sixth, "no place stays empty while somebody waits"


def test_a_persons_regrades_and_sweeps_take_the_same_places(database_url):
    registered(database_url, 2)
    (graded,) = send(database_url, "ann")
    assert take(database_url) == graded
    done(database_url, graded)
    assert run(database_url, lambda d: regrade(d, "all", "prof")) == 1
    run(database_url, lambda d: speed_vs_accuracy.request(d, UUID(graded)))
    (first,) = send(database_url, "ann")
    assert take_all(database_url) == [first], "the first grading goes before, and alone"


def test_the_student_of_a_server_without_logins_is_everybody(database_url):
    registered(database_url, 2)
    all_ = send(database_url, "local", "local", "local")
    assert take_all(database_url) == all_


def test_a_file_that_is_known_to_be_slow_waits_behind_all_others_but_before_regrades(database_url):
    (before,) = send(database_url, "ann")
    assert take(database_url) == before
    done(database_url, before, slow=True)
    assert run(database_url, lambda d: regrade(d, "all", "prof")) == 1
    (slow,) = send(database_url, "ben")
    others = send(database_url, "cleo", "cleo", source="x = 1")
    fresh = send(database_url, "dora", source="x = 2")
    order = "SELECT args->>'attempt', queue_name FROM procrastinate_jobs ORDER BY priority DESC, id"
    *ahead, last, again = sql(database_url, order)
    assert ahead == [(others[0], FIRST), (*fresh, FIRST), (others[1], FIRST)]
    assert last == (slow, SLOW) and again[1] == SLOW
    assert take_all(database_url, FIRST, LATER) == [others[0], *fresh], "one worker takes nothing slow"


def test_a_file_that_was_graded_quickly_since_is_not_slow(database_url):
    for slow in (True, False):
        (grading,) = send(database_url, "ann")
        assert take(database_url) == grading
        done(database_url, grading, slow=slow)
    send(database_url, "ben")
    assert sql(database_url, "SELECT queue_name FROM procrastinate_jobs") == [(FIRST,)]


def test_a_run_that_is_put_off_counts_as_no_failure_and_the_next_moves_up(database_url):
    first, second = send(database_url, "ann", source="while True: pass"), send(database_url, "ann")
    for _ in range(5):  # more than ``max_runs``
        taken = take(database_url)
        assert [taken] == first
        claimed = claim(database_url, taken)
        run(database_url, lambda d, c=claimed: runs.release(d, c, "postponed", "others wait"))
        assert sql(database_url, "DELETE FROM procrastinate_jobs WHERE status = 'doing' RETURNING true")
        queued = dict(sql(database_url, "SELECT args->>'attempt', queue_name FROM procrastinate_jobs"))
        assert queued == {first[0]: SLOW, second[0]: FIRST}
        assert sql(database_url, "SELECT max(priority) FROM procrastinate_jobs") == [(2000,)]
        assert take(database_url, FIRST, LATER) == second[0]
        sql(database_url, "UPDATE procrastinate_jobs SET status = 'todo' WHERE queue_name = %s", FIRST)
        sql(database_url, "UPDATE procrastinate_jobs SET priority = 3000 WHERE queue_name = %s", SLOW)
    assert claim(database_url, first[0]).may_wait
    sql(database_url, "UPDATE grading SET requested_at = now() - interval '11 minutes'")
    assert not claim(database_url, first[0]).may_wait, "and runs to its end"
    assert sql(database_url, "SELECT count(*) FROM result") == [(0,)]


def test_it_is_known_whether_somebody_waits_for_a_first_report(database_url):
    async def waits():
        async with new_app(database_url, "test").open_async() as app:
            return await first_gradings_wait(app)

    assert not asyncio.run(waits())
    (grading,) = send(database_url, "ann")
    assert asyncio.run(waits())
    take(database_url)
    done(database_url, grading)
    run(database_url, lambda d: regrade(d, "all", "prof"))
    assert not asyncio.run(waits())


def test_people_who_submit_and_whose_gradings_end_at_once_lock_nobody_out(database_url):
    """Neither order of submissions and results ends in a deadlock, and everything can be taken in the end."""
    registered(database_url, 4)
    running = send(database_url, *["ann"] * 4, *["ben"] * 4)
    claims = [claim(database_url, grading) for grading in running[:2] + running[4:6]]

    async def at_once(database):
        ends = [runs.finish(database, one, report_of_verdicts("+"), {}) for one in claims]
        sent = [accept(database, new(name)) for name in ("ann", "ben") * 4]
        put_off = runs.release(database, claims[0], "postponed", "others wait")
        return await asyncio.wait_for(asyncio.gather(*ends, *sent, put_off), 20)

    run(database_url, at_once)
    left = {
        str(id) for (id,) in sql(database_url, "SELECT id FROM grading EXCEPT SELECT grading_id FROM result")
    }
    while taken := take_all(database_url):
        for grading in taken:
            if grading in left:
                done(database_url, grading)
        left -= {*taken}
        sql(database_url, "DELETE FROM procrastinate_jobs WHERE status = 'doing'")
    assert not left


def test_persons_take_turns(database_url):
    """Ann sends five, then Ben two and Cleo one: nobody's next passes another's first, and Ann's second waits
    for no latecomer.
    """
    sent = {
        grading: name for name in (*["ann"] * 5, *["ben"] * 2, "cleo") for grading in send(database_url, name)
    }
    order = []
    while taken := take(database_url):
        order.append(sent[taken])
        if len(order) == 4:
            sent |= dict.fromkeys(send(database_url, "dora"), "dora")
        done(database_url, taken)
    assert order == ["ann", "ben", "cleo", "ann", "ben", "dora", "ann", "ann", "ann"]


TAKEN = "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)"
JOBS = "SELECT status::text FROM procrastinate_jobs"


def finish(url, job):
    """Finish a job as Procrastinate's worker does."""

    async def finished():
        app = new_app(url, "test")
        async with app.open_async():
            await app.job_manager.finish_job_by_id_async(job, Status.SUCCEEDED, delete_job=True)

    asyncio.run(finished())


def test_a_job_whose_run_failed_is_finished_and_its_grading_waits_in_another_job(database_url):
    _, grading = submitted(database_url)
    ((job,),) = sql(database_url, TAKEN)
    claimed = claim(database_url, grading)
    run(database_url, lambda database: runs.release(database, claimed, "failed", "too busy"))
    finish(database_url, job)
    assert sql(database_url, JOBS) == [("todo",)]


def test_a_job_is_finished_once_and_is_gone(database_url):
    submitted(database_url)
    ((job,),) = sql(database_url, TAKEN)
    finish(database_url, job)
    assert sql(database_url, JOBS) == []


def test_what_the_database_refuses_otherwise_is_raised(database_url):
    submitted(database_url)
    sql(database_url, "DROP FUNCTION procrastinate_finish_job_v1(bigint, procrastinate_job_status, boolean)")
    with pytest.raises(ConnectorException):
        finish(database_url, 1)
