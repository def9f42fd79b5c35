"""The clock jumps an hour, forth or back, and comes back: nothing is lost, repeated for ever or valid for
ever, and deadlines are what the clock says.

test_runs.py and test_workers.py: gradings that run meanwhile.
"""

import asyncio
import time
import uuid

import pytest

from service.store.people import tokens
from service.store.queue import runs, workers
from service.store.queue.jobs import new_app
from service.store.submissions import records
from service.store.submissions.accepting import SubmissionRejected, accept
from tests.support.database import jump, new, run, sql
from tests.support.reports import report_of_verdicts
from tests.support.submissions import claim, submitted

HOURS = pytest.mark.parametrize("hours", [1, -1], ids=["forth", "back"])


def over(url, token):
    return run(url, lambda d: tokens.find(d, token)).over is not None


def given(url, make, **about):
    async def give(database):
        async with database.begin() as connection:
            return await make(connection, "ann", label="test", **about)

    return run(url, give)


@HOURS
def test_a_token_and_a_session_end_when_the_clock_says_and_never_later(database_url, hours):
    run(database_url, lambda d: accept(d, new("ann")))
    half, long = 1800.0, 2 * 3600.0
    short = [
        given(database_url, tokens.create, scopes=tokens.SCOPES, seconds=half),
        given(database_url, tokens.create_session, seconds=half),
    ]
    longer = given(database_url, tokens.create_session, seconds=long)
    revoked = given(database_url, tokens.create_session, seconds=long)
    id = run(database_url, lambda d: tokens.find(d, revoked)).id

    async def revoke(database):
        async with database.begin() as connection:
            await tokens.revoke(connection, id=id)

    run(database_url, revoke)
    jump(database_url, hours)
    assert [over(database_url, one) for one in short] == [hours > 0] * 2
    assert not over(database_url, longer) and over(database_url, revoked)
    began_meanwhile = given(database_url, tokens.create_session, seconds=half)
    jump(database_url, -hours)
    assert not any(over(database_url, one) for one in (*short, longer)) and over(database_url, revoked)
    jump(database_url, 3)
    assert all(over(database_url, one) for one in (*short, longer, revoked, began_meanwhile))


@HOURS
def test_a_notebooks_login_is_collected_at_most_once_and_not_for_ever(database_url, hours):
    device, code = run(database_url, lambda d: tokens.create_login(d, "a notebook"))
    pending, unknown = run(database_url, lambda d: tokens.create_login(d, "another"))
    assert run(database_url, lambda d: tokens.confirm_login(d, code, "ann"))
    jump(database_url, hours)
    if hours > 0:
        for one in (device, pending):
            with pytest.raises(tokens.LoginOver):
                run(database_url, lambda d, one=one: tokens.collect_login(d, one, 1.0))
        assert not run(database_url, lambda d: tokens.confirm_login(d, unknown, "ann"))
        return
    assert run(database_url, lambda d: tokens.collect_login(d, device, 1.0))[1] == "ann"
    jump(database_url, 2)
    for one in (device, pending):
        with pytest.raises(tokens.LoginOver):
            run(database_url, lambda d, one=one: tokens.collect_login(d, one, 1.0))


@HOURS
def test_a_deadline_is_what_the_clock_says_and_what_was_in_time_stays_so(database_url, hours):
    run(database_url, lambda d: d.ping())
    due = "now() + interval '30 min'" if hours > 0 else "now() - interval '30 min'"
    sql(database_url, f"UPDATE assignment SET due_at = {due}")

    def send(name):
        one = new(name)
        try:
            run(database_url, lambda d: accept(d, one))
        except SubmissionRejected:
            return None
        return one.id

    first = send("ann")
    assert (first is not None) == (hours > 0)
    jump(database_url, hours)
    second = send("ben")
    assert (second is not None) == (hours < 0)
    jump(database_url, -hours)
    third = send("cleo")
    assert (third is not None) == (hours > 0)
    for id in filter(None, (first, second, third)):
        assert not run(database_url, lambda d, id=id: records.read(d, id)).late


def test_a_grading_is_not_repeated_while_the_clock_jumps_to_and_fro(database_url):
    """Of two workers one grades and the other looks for what is lost, before and after each heartbeat."""
    lease, offset = 0.4, [0.0]
    clock = workers.ClockWatch(lambda: time.monotonic() - offset[0])
    _, grading = submitted(database_url)
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    claimed = claim(database_url, grading)

    def housekeep():
        found = run(database_url, lambda d: workers.recover(d, lease, clock))
        return found + run(database_url, lambda d: workers.sweep(d, lease))

    assert housekeep() == []
    for hours in [1, -1] * 3:
        jump(database_url, hours)
        offset[0] += 3600 * hours
        assert housekeep() == []
        assert run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 2))
        assert housekeep() == []
    assert clock.jumps == 6
    assert run(database_url, lambda d: runs.finish(d, claimed, report_of_verdicts("+"), {}))
    time.sleep(2 * lease)
    assert housekeep() == [] and sql(database_url, "SELECT 1 FROM procrastinate_jobs") == []
    assert sql(database_url, "SELECT end_reason FROM run") == [("finished",)]


@HOURS
def test_what_one_unnoticed_jump_takes_for_lost_has_one_result(database_url, hours):
    """As a worker that starts just after the jump sees it."""
    _, grading = submitted(database_url)
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    first = claim(database_url, grading)
    jump(database_url, hours)
    assert run(database_url, workers.recover) == [grading]
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    second = claim(database_url, grading, "w2")
    assert run(database_url, lambda d: runs.heartbeat(d, first, "playing", 1, 2)), "it was alive"
    assert run(database_url, lambda d: runs.finish(d, second, report_of_verdicts("+"), {}))
    assert not run(database_url, lambda d: runs.finish(d, first, report_of_verdicts("-"), {}))
    jump(database_url, 1)
    assert run(database_url, workers.recover) == run(database_url, workers.sweep) == []
    assert sql(database_url, "SELECT 1 FROM procrastinate_jobs") == []
    assert sql(database_url, "SELECT score, fault FROM result") == [(1, None)]


@HOURS
def test_a_procrastinate_worker_goes_on_taking_jobs(database_url, hours):
    """A later worker removes the rows of those whose heartbeat is an hour old, also of living ones."""
    done = []

    async def work():
        async with new_app(database_url, "test").open_async() as app:

            @app.task(name="grade")
            async def grade(attempt):
                done.append(attempt)

            def start(name):
                return asyncio.create_task(_take_for_ever(app, name))

            first = start("first")
            await _until(lambda: len(done) == 1)
            await asyncio.to_thread(jump, database_url, hours)
            second = start("second")
            await _until(lambda: len(done) == 2)
            second.cancel()
            await asyncio.gather(second, return_exceptions=True)
            await _until(lambda: len(done) == 3)
            first.cancel()
            await asyncio.gather(first, return_exceptions=True)

    async def _take_for_ever(app, name):
        while True:
            try:
                await app.run_worker_async(
                    name=name, fetch_job_polling_interval=0.2, delete_jobs="always",
                    install_signal_handlers=False, stalled_worker_timeout=3600,
                )  # fmt: skip
            except Exception:
                await asyncio.sleep(0.1)

    async def _until(reached):
        await asyncio.to_thread(submitted, database_url, uuid.uuid4().hex)
        async with asyncio.timeout(30):
            while not reached():
                await asyncio.sleep(0.05)

    asyncio.run(work())
    assert len(set(done)) == len(done) == 3
