"""Jobs of the queue: one that was dropped while it was done is done."""

import asyncio

import pytest
from procrastinate.exceptions import ConnectorException
from procrastinate.jobs import Status

from service.store import runs
from service.store.queue import new_app
from tests.support.database import run, sql
from tests.support.submissions import claim, submitted

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
