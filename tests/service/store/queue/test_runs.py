"""Runs: the first result stays, what is lost is queued again and counted, what is released is not."""

import asyncio
import math
import time
import uuid
from dataclasses import replace

import psycopg
import pytest

from polhode.judging.outcome import Diagnosis, Outcome, Tolerance
from polhode.judging.verdict import Verdict
from polhode.report.report import ExerciseReport, Provenance, Report
from service.store.queue import runs, workers
from service.store.queue.overview import regrade, snapshot
from service.store.submissions import artefacts, records
from service.store.submissions.accepting import SubmissionRejected, accept, add_grading
from tests.support.database import jump, new, run, sql
from tests.support.submissions import submitted


def report(seed=7):
    made = Provenance(seed=seed, versions={}, isolation="process", phases_ms={"grade": 250.0})
    return Report(assignment="rigid-body", version="1", exercises=[], provenance=made, total=0)


@pytest.fixture
def grading(database_url):
    one = new()
    run(database_url, lambda d: accept(d, one))
    return sql(database_url, "SELECT id FROM grading")[0][0], one.id


def claim(url, grading, worker="w1"):
    return run(url, lambda d: runs.claim(d, grading, uuid.uuid4(), worker))


def finish(url, claimed, seed=7, **artefacts):
    return run(
        url, lambda d: runs.finish(d, claimed, report(seed), {k: v.encode() for k, v in artefacts.items()})
    )


def endings(url):
    return [e for (e,) in sql(url, "SELECT end_reason FROM run ORDER BY started_at")]


def fall_silent(url):
    sql(url, "UPDATE run SET heartbeat_at = heartbeat_at - interval '1 minute'")
    sql(url, "UPDATE procrastinate_events SET at = at - interval '1 minute'")


def take_jobs(url):
    """As a worker takes them from the queue; how many."""
    taken = 0
    while sql(url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")[0][0]:
        taken += 1
    return taken


def test_a_result_and_its_artefacts(database_url, grading):
    claimed = claim(database_url, grading[0])
    assert (claimed.submission_id, claimed.seed, claimed.assignment) == (grading[1], 7, "rigid-body")
    assert run(database_url, lambda d: records.read(d, grading[1])).status == "running"
    assert finish(database_url, claimed, a="same", b="same", c="other")
    assert finish(database_url, claimed, a="same")  # the answer to the first got lost
    stored = run(database_url, lambda d: records.read(d, grading[1]))
    assert stored.status == "graded" and stored.report.provenance.seed == 7
    assert sql(database_url, "SELECT count(*) FROM artefact") == [(2,)] and endings(database_url) == [
        "finished"
    ]
    content, digest = run(database_url, lambda d: artefacts.find_artefact(d, grading[0], "b"))
    assert content == b"same" and len(digest) == 64
    assert claim(database_url, grading[0]) is None
    with pytest.raises(psycopg.errors.RaiseException, match="never altered"):
        sql(database_url, "UPDATE result SET score = 100")


def test_content_that_gradings_share_is_stored_once(database_url, grading):
    files, other = {"arrays.npz": "own", "sheet.png": "shared"}, submitted(database_url, "eve")
    assert finish(database_url, claim(database_url, grading[0]), **files)
    assert finish(database_url, claim(database_url, other[1]), **{**files, "arrays.npz": "other"})
    assert sorted(sql(database_url, "SELECT content FROM artefact")) == [(b"other",), (b"own",), (b"shared",)]
    for one, own in ((grading[0], b"own"), (other[1], b"other")):
        for name, content in (("arrays.npz", own), ("sheet.png", b"shared")):
            found = run(database_url, lambda d, one=one, name=name: artefacts.find_artefact(d, one, name))
            assert found is not None and found[0] == content


def test_notifications_before_the_result_are_marked_as_progress(database_url, grading):
    with psycopg.connect(database_url, autocommit=True) as listener:
        listener.execute(f"LISTEN {runs.CHANNEL}")
        claimed = claim(database_url, grading[0])
        run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 3))
        finish(database_url, claimed)
        announced = [one.payload for one in listener.notifies(timeout=0.5)]
    assert announced == [f"{grading[1]}{runs.PROGRESS}"] * 2 + [str(grading[1])]


def test_a_run_that_a_crash_of_the_database_lost_is_stored_with_its_result(database_url, grading):
    claimed = claim(database_url, grading[0])
    sql(database_url, "DELETE FROM run")  # its commit did not wait for the disk
    assert finish(database_url, claimed, a="one")
    assert sql(database_url, "SELECT id, worker, end_reason FROM run") == [(claimed.run, "w1", "finished")]
    assert sql(database_url, "SELECT run_id FROM result") == [(claimed.run,)]


def test_outcomes_are_stored_with_margins_that_are_infinite_or_missing(database_url, grading):
    margins = {"a": 2.5, "b": math.inf, "c": None}
    diagnosis = [Diagnosis(code="sign-flipped", sentence="„−“ for +", confidence=1.0)]
    outcomes = [
        Outcome(
            id=id,
            label="l",
            verdict=Verdict.PASS,
            detail="d",
            tolerance=Tolerance(reason="r"),
            margin=margin,
            diagnosis=diagnosis,
        )
        for id, margin in margins.items()
    ]
    graded = replace(report(), exercises=[ExerciseReport(number="2", title="t", outcomes=outcomes)])
    claimed = claim(database_url, grading[0])
    assert run(database_url, lambda d: runs.finish(d, claimed, graded, {}))
    rows = sql(
        database_url, "SELECT check_id, state, margin, codes, causes, points, earned FROM outcome ORDER BY 1"
    )
    assert rows == [
        (id, "pass", margin, ["sign-flipped"], ["„−“ for +"], 1, 1) for id, margin in margins.items()
    ]


def test_who_comes_second_changes_nothing(database_url, grading):
    first, second = claim(database_url, grading[0]), claim(database_url, grading[0], "w2")
    assert finish(database_url, second, seed=2, a="two")
    assert not finish(database_url, first, seed=1, a="one", z="one")
    assert run(database_url, lambda d: records.read(d, grading[1])).report.provenance.seed == 2
    assert endings(database_url) == ["superseded", "finished"] and sql(
        database_url, "SELECT name FROM grading_artefact"
    ) == [("a",)]


def test_a_silent_run_is_lost_and_queued_again_and_a_living_one_is_not(database_url, grading):
    assert take_jobs(database_url) == 1
    claim(database_url, grading[0])
    assert run(database_url, workers.recover) == []
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [grading[0]]
    assert endings(database_url) == ["lost"] and take_jobs(database_url) == 1


def test_a_job_that_was_taken_and_never_begun_is_queued_again(database_url, grading):
    take_jobs(database_url)
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [grading[0]]
    assert take_jobs(database_url) == 1


def test_a_job_left_behind_by_a_finished_grading_goes(database_url, grading):
    take_jobs(database_url)
    finish(database_url, claim(database_url, grading[0]))
    sql(
        database_url,
        "UPDATE run SET heartbeat_at = heartbeat_at - interval '1 minute', ended_at = ended_at - interval '1"
        " minute'",
    )
    sql(database_url, "UPDATE procrastinate_events SET at = at - interval '1 minute'")
    assert run(database_url, workers.recover) == []
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs") == [(0,)]


def test_three_lost_runs_are_a_fault_that_can_be_graded_again(database_url, grading):
    for k in range(3):
        assert claim(database_url, grading[0], f"host/{k}") is not None
        fall_silent(database_url)
        take_jobs(database_url)
        fall_silent(database_url)
        run(database_url, workers.recover)
    assert claim(database_url, grading[0]) is None
    stored = run(database_url, lambda d: records.read(d, grading[1]))
    assert stored.status == "faulted" and "all 3 runs" in stored.fault and "host/2" in stored.fault
    assert run(database_url, lambda d: regrade(d, "faults", "an instructor")) == 1
    assert run(database_url, lambda d: records.read(d, grading[1])).status == "queued"
    ((again,),) = sql(database_url, "SELECT id FROM grading WHERE number = 2")
    finish(database_url, claim(database_url, again))
    assert run(database_url, lambda d: records.read(d, grading[1])).status == "graded"
    assert sql(database_url, "SELECT actor, action FROM audit") == [("an instructor", "regrade")]


def test_a_run_that_comes_back_late_gives_the_result_and_is_no_loss(database_url, grading):
    slow = claim(database_url, grading[0])
    fall_silent(database_url)
    take_jobs(database_url)
    fall_silent(database_url)
    run(database_url, workers.recover)
    assert (
        endings(database_url) == ["lost"]
        and finish(database_url, slow)
        and endings(database_url) == ["finished"]
    )


def test_released_runs_do_not_count_and_a_failed_one_is_repeated_once(database_url, grading):
    for _ in range(5):
        claimed = claim(database_url, grading[0])
        run(database_url, lambda d, c=claimed: runs.release(d, c, "released", "stopped"))
    assert sql(database_url, "SELECT count(*) FROM procrastinate_jobs WHERE status = 'todo'") == [(1,)]
    for _ in range(2):
        claimed = claim(database_url, grading[0])
        run(database_url, lambda d, c=claimed: runs.release(d, c, "failed", "no room left"))
    assert claim(database_url, grading[0]) is None
    assert "no room left" in run(database_url, lambda d: records.read(d, grading[1])).fault


@pytest.mark.parametrize("hours", [1, -1])
def test_a_clock_that_jumps_loses_no_living_run_and_finds_a_dead_one(database_url, grading, hours):
    lease, jumped = 0.4, 0.0
    clock = workers.ClockWatch(lambda: time.monotonic() - 3600 * jumped)
    take_jobs(database_url)
    claimed = claim(database_url, grading[0])
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == []
    jumped = hours
    jump(database_url, hours)
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == []
    time.sleep(1.1 * lease)
    run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 2))
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == [] and endings(database_url) == [
        None
    ]
    jump(database_url, hours)  # and one whose worker died before the jump
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == [grading[0]] and endings(
        database_url
    ) == ["lost"]
    assert take_jobs(database_url) == 1


def test_a_slow_database_is_no_jump_of_its_clock(database_url, grading):
    """An answer that takes ten leases says little about the clock."""
    lease, late = 0.4, iter([0.0, 4.0, 4.0, 4.0])
    clock = workers.ClockWatch(lambda: time.monotonic() + next(late))
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == []
    take_jobs(database_url)
    claim(database_url, grading[0])
    fall_silent(database_url)
    assert run(database_url, lambda d: workers.recover(d, lease, clock)) == [grading[0]]


def test_a_grading_requested_before_the_clock_went_back_gets_its_job(database_url, grading):
    sql(database_url, "DELETE FROM procrastinate_jobs")
    jump(database_url, -1)
    assert run(database_url, workers.sweep) == [grading[0]]


def test_what_has_no_job_gets_one(database_url, grading):
    sql(database_url, "DELETE FROM procrastinate_jobs")
    assert run(database_url, workers.sweep) == []  # it may be on its way
    sql(database_url, "UPDATE grading SET requested_at = now() - interval '1 minute'")
    assert run(database_url, workers.sweep) == [grading[0]] and run(database_url, workers.sweep) == []


def test_a_regrade_does_not_hide_what_there_was(database_url, grading):
    finish(database_url, claim(database_url, grading[0]))
    assert run(database_url, lambda d: regrade(d, "all", "x")) == 1
    assert run(database_url, lambda d: regrade(d, "all", "x")) == 0  # one is under way
    stored = run(database_url, lambda d: records.read(d, grading[1]))
    assert stored.status == "graded" and stored.number == 1
    assert run(database_url, lambda d: records.recent(d, 5))[0].status == "graded"


def test_a_result_and_a_new_submission_of_the_same_person_take_turns(database_url, grading):
    """Whichever is first, the new one has nothing before it in the end: neither may rank while the other is
    not committed.
    """
    claimed = claim(database_url, grading[0])

    async def at_once(database):
        async with database.begin() as accepting:
            await accepting.execute(
                "SELECT pg_advisory_xact_lock(hashtextextended(person_id::text, 0)) FROM submission"
            )
            writing = asyncio.create_task(runs.finish(database, claimed, report(), {}))
            await asyncio.sleep(0.3)
            assert not writing.done()
            # ranked behind the one that is being finished
            await add_grading(accepting, grading[1], "interactive", 1)
        return await writing

    assert run(database_url, at_once)
    assert sql(database_url, "SELECT priority FROM procrastinate_jobs ORDER BY id DESC LIMIT 1") == [(2000,)]


def place(url, grading):
    """Which place in the queue a grading has."""
    return int(run(url, records.positions)[str(grading)])


def test_what_was_begun_and_lost_or_given_back_does_not_wait_again(database_url, grading):
    async def others(database):
        for k in range(20):
            await accept(database, new(f"p{k}"))

    take_jobs(database_url)
    claimed = claim(database_url, grading[0])
    run(database_url, others)
    fall_silent(database_url)
    run(database_url, workers.recover)
    assert place(database_url, grading[0]) == 1
    again = claim(database_url, grading[0], "w2")
    run(database_url, lambda d: runs.release(d, again, "released", "stopped"))
    assert place(database_url, grading[0]) == 1
    assert finish(database_url, claimed)


def test_a_run_whose_job_is_gone_is_lost_too(database_url, grading):
    claim(database_url, grading[0])
    sql(database_url, "DELETE FROM procrastinate_jobs")
    assert run(database_url, workers.recover) == []
    fall_silent(database_url)
    assert run(database_url, workers.recover) == [grading[0]] and run(database_url, workers.recover) == []


def test_a_worker_that_was_only_cut_off_for_a_while_is_not_counted(database_url, grading):
    claimed = claim(database_url, grading[0])
    for _ in range(4):
        fall_silent(database_url)
        run(database_url, workers.recover)
        run(database_url, lambda d: runs.heartbeat(d, claimed, "playing", 1, 2))
    assert endings(database_url) == [None]
    assert claim(database_url, grading[0]) is not None  # no fault


def test_two_regrades_at_once_are_one_and_do_not_hold_up_who_submits(database_url, grading):
    finish(database_url, claim(database_url, grading[0]))
    counts = run(database_url, lambda d: asyncio.gather(*(regrade(d, [grading[1]], "x") for _ in range(4))))
    assert sorted(counts) == [0, 0, 0, 1]


def test_a_regrade_that_fails_gives_no_submission_back(database_url, grading):
    sql(database_url, "UPDATE assignment SET submission_limit = 1")
    finish(database_url, claim(database_url, grading[0]))
    run(database_url, lambda d: regrade(d, "all", "x"))
    sql(
        database_url, "INSERT INTO result (grading_id, fault) SELECT id, 'ours' FROM grading WHERE number = 2"
    )
    with pytest.raises(SubmissionRejected):
        run(database_url, lambda d: accept(d, new()))
    assert run(database_url, snapshot).faults == []  # the first report is still shown
