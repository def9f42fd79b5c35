"""Sweeps: one job however many ask, every failure is stored, and a limited number of runs."""

import asyncio

import pytest

from service.store.submissions import speed_vs_accuracy
from service.store.submissions.artefacts import store_artefacts
from tests.support.database import run, sql
from tests.support.submissions import submitted

JOBS = "SELECT count(*) FROM procrastinate_jobs WHERE task_name = 'sweep'"


@pytest.fixture
def grading(database_url):
    return submitted(database_url)[1]


def request(url, grading):
    return run(url, lambda database: speed_vs_accuracy.request(database, grading))


def store(url, grading, artefacts):
    run(url, lambda database: store_artefacts(database, grading, artefacts))


def queued(url):
    """Take the queued sweeps away; return how many there were."""
    count = sql(url, JOBS)[0][0]
    sql(url, "DELETE FROM procrastinate_jobs WHERE task_name = 'sweep'")
    return count


def test_requests_at_the_same_time_queue_one_job(database_url, grading):
    async def ask(database):
        return await asyncio.gather(*(speed_vs_accuracy.request(database, grading) for _ in range(6)))

    assert run(database_url, ask) == [None] * 6 and queued(database_url) == 1


@pytest.mark.parametrize("artefact", [{"sweep.json": b"{}"}, {"sweep.refused": b"no function"}])
def test_a_request_that_comes_after_the_result_queues_nothing(database_url, grading, artefact):
    """As when a worker stores the result between the request's look and its job."""
    store(database_url, grading, artefact)
    assert request(database_url, grading) is None and queued(database_url) == 0


def test_a_failure_of_polhode_is_measured_again_only_by_another_version(database_url, grading, monkeypatch):
    assert run(database_url, lambda database: speed_vs_accuracy.begin(database, grading)) == 1
    store(database_url, grading, speed_vs_accuracy.fault(1, "OverflowError: too large"))
    assert request(database_url, grading) == "OverflowError: too large" and queued(database_url) == 0
    monkeypatch.setattr(speed_vs_accuracy.metadata, "version", lambda name: "99.0")
    assert request(database_url, grading) is None and queued(database_url) == 1


def test_lost_runs_are_repeated_up_to_a_limit_whatever_the_version(database_url, grading, monkeypatch):
    begun = [
        run(database_url, lambda database: speed_vs_accuracy.begin(database, grading))
        for _ in range(speed_vs_accuracy.MOST_RUNS + 2)
    ]
    assert begun == [1, 2, 3, None, None]
    for version in ("present", "99.0"):
        if version != "present":
            monkeypatch.setattr(speed_vs_accuracy.metadata, "version", lambda name: "99.0")
        assert "3 runs failed or were lost" in request(database_url, grading) and queued(database_url) == 0


def test_a_sweep_that_gave_way_is_queued_again_and_does_not_count(database_url, grading):
    for _ in range(speed_vs_accuracy.MOST_RUNS + 2):
        number = run(database_url, lambda database: speed_vs_accuracy.begin(database, grading))
        assert number == 1
        run(
            database_url,
            lambda database, number=number: speed_vs_accuracy.put_back(database, grading, number),
        )
        assert sql(database_url, "SELECT priority FROM procrastinate_jobs WHERE task_name = 'sweep'") == [
            (-1000,)
        ]
        assert queued(database_url) == 1


def test_how_a_sweep_ended(database_url, grading):
    def ended():
        return run(database_url, lambda database: speed_vs_accuracy.ending(database, grading))

    assert ended() is None
    store(database_url, grading, speed_vs_accuracy.fault(1, "OverflowError: too large"))
    assert ended() == (speed_vs_accuracy.FAULT, "OverflowError: too large")
    store(database_url, grading, {speed_vs_accuracy.SWEPT: b"{}"})
    assert ended() == (speed_vs_accuracy.SWEPT, "{}")
