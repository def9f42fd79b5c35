"""Runs: the first result stays, what is lost is queued again and counted, what is released is not."""

import asyncio
import uuid

import psycopg
import pytest
from sqlalchemy import text

from ecp.report import Provenance, Report
from service.store import records, runs, workers
from service.store.queue_overview import regrade, snapshot
from service.store.submissions import SubmissionRejected, accept, add_grading
from tests.support.database import new, run, sql


def report(seed=7):
    made = Provenance(seed=seed, versions={}, isolation="process", phases_ms={"grade": 250.0})
    return Report(assignment="rigid-body", version="1", exercises=[], provenance=made)


@pytest.fixture
def attempt(database_url):
    one = new()
    run(database_url, lambda d: accept(d, one))
    return sql(database_url, "SELECT id FROM attempt")[0][0], one.id


def claim(url, attempt, worker="w1"):
    return run(url, lambda d: runs.claim(d, attempt, uuid.uuid4(), worker))


def finish(url, claimed, seed=7, **artefacts):
    return run(url, lambda d: runs.finish(d, claimed, report(seed), {k: v.encode() for k, v in artefacts.items()}))


def endings(url):
    return [e for (e,) in sql(url, "SELECT ending FROM run ORDER BY started_at")]


def fall_silent(url):
    sql(url, "UPDATE run SET beat_at = beat_at - interval '1 minute'")
    sql(url, "UPDATE procrastinate_events SET at = at - interval '1 minute'")


def take_jobs(url):
    """As a worker takes them from the queue; how many."""
    taken = 0
    while sql(url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")[0][0]:
        taken += 1
    return taken


def test_a_result_and_its_artefacts(database_url, attempt):
    claimed = claim(database_url, attempt[0])
    assert (claimed.submission_id, claimed.seed, claimed.assignment) == (attempt[1], 7, "rigid-body")
    assert run(database_url, lambda d: records.read(d, attempt[1])).status == "running"
    assert finish(database_url, claimed, a="same", b="same", c="other")
    assert finish(database_url, claimed, a="same")  # the answer to the first got lost
    stored = run(database_url, lambda d: records.read(d, attempt[1]))
    assert stored.status == "graded" and stored.report.provenance.seed == 7
    assert sql(database_url, "SELECT count(*) FROM artefact") == [(2,)] and endings(database_url) == ["finished"]
    content, digest = run(database_url, lambda d: records.find_artefact(d, attempt[0], "b"))
    assert content == b"same" and len(digest) == 64
    assert claim(database_url, attempt[0]) is None
    with pytest.raises(psycopg.errors.RaiseException, match="never altered"):
        sql(database_url, "UPDATE result SET score = 100")


def test_who_comes_second_changes_nothing(database_url, attempt):
    first, second = claim(database_url, attempt[0]), claim(database_url, attempt[0], "w2")
    assert finish(database_url, second, seed=2, a="two")
    assert not finish(database_url, first, seed=1, a="one", z="one")
    assert run(database_url, lambda d: records.read(d, attempt[1])).report.provenance.seed == 2
    assert endings(database_url) == ["superseded", "finished"] and sql(database_url, "SELECT name FROM kept") == [("a",)]


def test_a_silent_run_is_lost_and_queued_again_and_a_living_one_is_not(database_url, attempt):
    assert take_jobs(database_url) == 1
    claim(database_url, attempt[0])
    assert run(database_url, workers.recover) == []
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [attempt[0]]
    assert endings(database_url) == ["lost"] and take_jobs(database_url) == 1


def test_a_job_that_was_taken_and_never_begun_is_queued_again(database_url, attempt):
    take_jobs(database_url)
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [attempt[0]]
    assert take_jobs(database_url) == 1


def test_a_job_left_behind_by_a_finished_attempt_goes(database_url, attempt):
    take_jobs(database_url)
    finish(database_url, claim(database_url, attempt[0]))
    sql(database_url, "UPDATE run SET beat_at = beat_at - interval '1 minute', ended_at = ended_at - interval '1 minute'")
    sql(database_url, "UPDATE procrastinate_events SET at = at - interval '1 minute'")
    assert run(database_url, workers.recover) == []
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs") == [(0,)]


def test_three_lost_runs_are_a_fault_that_can_be_graded_again(database_url, attempt):
    for k in range(3):
        assert claim(database_url, attempt[0], f"host/{k}") is not None
        fall_silent(database_url)
        take_jobs(database_url)
        fall_silent(database_url)
        run(database_url, workers.recover)
    assert claim(database_url, attempt[0]) is None
    stored = run(database_url, lambda d: records.read(d, attempt[1]))
    assert stored.status == "faulted" and "begun 3 times" in stored.fault and "host/2" in stored.fault
    assert run(database_url, lambda d: regrade(d, "faults", "an instructor")) == 1
    assert run(database_url, lambda d: records.read(d, attempt[1])).status == "queued"
    ((again,),) = sql(database_url, "SELECT id FROM attempt WHERE number = 2")
    finish(database_url, claim(database_url, again))
    assert run(database_url, lambda d: records.read(d, attempt[1])).status == "graded"
    assert sql(database_url, "SELECT who, action FROM audit") == [("an instructor", "regrade")]


def test_a_run_that_comes_back_late_gives_the_result_and_is_no_loss(database_url, attempt):
    slow = claim(database_url, attempt[0])
    fall_silent(database_url)
    take_jobs(database_url)
    fall_silent(database_url)
    run(database_url, workers.recover)
    assert endings(database_url) == ["lost"] and finish(database_url, slow) and endings(database_url) == ["finished"]


def test_released_runs_do_not_count_and_failed_ones_do(database_url, attempt):
    for _ in range(5):
        claimed = claim(database_url, attempt[0])
        run(database_url, lambda d, c=claimed: runs.release(d, c, "released", "stopped"))
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs WHERE status = 'todo'") == [(1,)]
    for _ in range(3):
        claimed = claim(database_url, attempt[0])
        run(database_url, lambda d, c=claimed: runs.release(d, c, "failed", "no room left"))
    assert claim(database_url, attempt[0]) is None
    assert "no room left" in run(database_url, lambda d: records.read(d, attempt[1])).fault


def test_what_has_no_job_gets_one(database_url, attempt):
    sql(database_url, "DELETE FROM procrastinate_jobs")
    assert run(database_url, workers.sweep) == []  # it may be on its way
    sql(database_url, "UPDATE attempt SET requested_at = now() - interval '1 minute'")
    assert run(database_url, workers.sweep) == [attempt[0]] and run(database_url, workers.sweep) == []


def test_a_regrade_does_not_hide_what_there_was(database_url, attempt):
    finish(database_url, claim(database_url, attempt[0]))
    assert run(database_url, lambda d: regrade(d, "all", "x")) == 1
    assert run(database_url, lambda d: regrade(d, "all", "x")) == 0  # one is under way
    stored = run(database_url, lambda d: records.read(d, attempt[1]))
    assert stored.status == "graded" and stored.number == 1
    assert run(database_url, lambda d: records.recent(d, 5))[0].status == "graded"


def test_persons_take_turns(database_url):
    """Ann sends five, then Ben two and Cleo one: nobody's next passes another's first, and Ann's second waits for no latecomer."""

    async def fill(database, *names):
        for name in names:
            await accept(database, new(name))

    run(database_url, lambda d: fill(d, "ann", "ann", "ann", "ann", "ann", "ben", "ben", "cleo"))
    order = []
    fetch = "SELECT (args->>'attempt')::uuid FROM procrastinate_fetch_job_v2(NULL, NULL)"
    name = "SELECT p.name FROM attempt a JOIN submission s ON s.id = submission_id JOIN person p ON p.id = person_id WHERE a.id = "
    while (job := sql(database_url, fetch)[0][0]) is not None:
        order += sql(database_url, name + "%s", job)[0]
        if len(order) == 4:
            run(database_url, lambda d: fill(d, "dora"))
        finish(database_url, claim(database_url, job))
    assert order == ["ann", "ben", "cleo", "ann", "ben", "dora", "ann", "ann", "ann"]


def test_a_result_and_a_new_submission_of_the_same_person_take_turns(database_url, attempt):
    """Whichever is first, the new one has nothing before it in the end: neither may rank while the other is not committed."""
    claimed = claim(database_url, attempt[0])

    async def at_once(database):
        async with database.begin() as accepting:
            await accepting.execute(text("SELECT pg_advisory_xact_lock(hashtextextended(person_id::text, 0)) FROM submission"))
            writing = asyncio.create_task(runs.finish(database, claimed, report(), {}))
            await asyncio.sleep(0.3)
            assert not writing.done()
            await add_grading(accepting, attempt[1], "interactive", 1)  # ranked behind the one that is being finished
        return await writing

    assert run(database_url, at_once)
    assert sql(database_url, "SELECT priority FROM procrastinate_jobs ORDER BY id DESC LIMIT 1") == [(2000,)]


def place(url, attempt):
    """Which place in the queue an attempt has."""
    return int(run(url, records.positions)[str(attempt)])


def test_what_was_begun_and_lost_or_given_back_does_not_wait_again(database_url, attempt):
    async def others(database):
        for k in range(20):
            await accept(database, new(f"p{k}"))

    take_jobs(database_url)
    claimed = claim(database_url, attempt[0])
    run(database_url, others)
    fall_silent(database_url)
    run(database_url, workers.recover)
    assert place(database_url, attempt[0]) == 1
    again = claim(database_url, attempt[0], "w2")
    run(database_url, lambda d: runs.release(d, again, "released", "stopped"))
    assert place(database_url, attempt[0]) == 1
    assert finish(database_url, claimed)


def test_a_run_whose_job_is_gone_is_lost_too(database_url, attempt):
    claim(database_url, attempt[0])
    sql(database_url, "DELETE FROM procrastinate_jobs")
    assert run(database_url, workers.recover) == []
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [attempt[0]] and run(database_url, workers.recover) == []


def test_a_worker_that_was_only_cut_off_for_a_while_is_not_counted(database_url, attempt):
    claimed = claim(database_url, attempt[0])
    for _ in range(4):
        fall_silent(database_url)
        run(database_url, workers.recover)
        run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 2))
    assert endings(database_url) == [None]
    assert claim(database_url, attempt[0]) is not None  # no fault


def test_two_regrades_at_once_are_one_and_do_not_hold_up_who_submits(database_url, attempt):
    finish(database_url, claim(database_url, attempt[0]))
    counts = run(database_url, lambda d: asyncio.gather(*(regrade(d, [attempt[1]], "x") for _ in range(4))))
    assert sorted(counts) == [0, 0, 0, 1]


def test_a_regrade_that_fails_gives_no_submission_back(database_url, attempt):
    sql(database_url, "UPDATE assignment SET most_submissions = 1")
    finish(database_url, claim(database_url, attempt[0]))
    run(database_url, lambda d: regrade(d, "all", "x"))
    sql(database_url, "INSERT INTO result (attempt_id, fault) SELECT id, 'ours' FROM attempt WHERE number = 2")
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda d: accept(d, new()))
    assert run(database_url, snapshot).faults == []  # the first report is still shown
