"""The speed vs accuracy sweep over HTTP, where the worker that runs it has no sandbox."""

import asyncio
import json
import multiprocessing
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor

from service.settings import Settings
from service.workers.worker import Worker
from tests.support.app import App
from tests.support.database import run, sql
from tests.support.grader import WHY, NoSandbox
from tests.support.submissions import graded, submitted


def test_a_sweep_that_fails_runs_once_for_many_requests(database_url):
    id = graded(database_url, "local", "+")
    app = App(database_url=database_url, identity="local")

    def get(form):
        try:
            urllib.request.urlopen(f"{app.url}/v1/submissions/{id}/sweep.{form}", timeout=70)
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.load(error)["detail"]

    async def work(database):
        """Run the sweeps that are queued, as a worker does, until the requests are answered."""
        worker = Worker(Settings(database_url=database_url), "w1")
        worker._grader = NoSandbox()
        async with worker._database:
            while not all(request.done() for request in requests):
                for row in await database.rows(
                    "SELECT args->>'attempt' AS grading FROM procrastinate_jobs WHERE task_name = 'sweep'"
                ):
                    await worker._sweep(row.grading)
                    async with database.begin() as connection:
                        await connection.execute("DELETE FROM procrastinate_jobs WHERE task_name = 'sweep'")
                await asyncio.sleep(0.05)

    with ThreadPoolExecutor(2) as pool:
        requests = [pool.submit(get, form) for form in ("json", "svg")]
        run(database_url, work)
    answers = [request.result() for request in requests] + [get("svg")]
    app.stop()
    sentence = f"polhode failed to measure speed vs accuracy: {WHY}; ask the course staff"
    assert answers == [(409, sentence)] * 3
    assert sql(database_url, "SELECT count(*) FROM grading_artefact WHERE name LIKE 'sweep.run._'") == [(1,)]
    assert sql(database_url, "SELECT 1 FROM procrastinate_jobs WHERE task_name = 'sweep'") == []


def test_the_process_that_renders_starts_while_somebody_waits_for_the_report(database_url):
    id, before = submitted(database_url, "local")[0], set(multiprocessing.active_children())
    app = App(database_url=database_url, identity="local")
    try:
        assert (
            json.load(urllib.request.urlopen(f"{app.url}/v1/submissions/{id}", timeout=10))["status"]
            == "queued"
        )
        assert set(multiprocessing.active_children()) == before, "who only asks may never look at figures"
        with urllib.request.urlopen(f"{app.url}/v1/submissions/{id}/events", timeout=10) as stream:
            assert stream.readline() == b"event: queued\n"
            (started,) = set(multiprocessing.active_children()) - before
    finally:
        app.stop()
    assert not started.is_alive()
