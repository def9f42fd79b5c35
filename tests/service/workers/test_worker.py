"""A worker in this process: what becomes of the grading it takes, and how often it gives a sign of life."""

import asyncio
import contextlib
import os
import time

import pytest

from service.grading.grader import Grader
from service.sandbox.isolation.select import IsolationUnavailable
from service.settings import Settings
from service.store.queue import workers
from service.store.submissions import speed_vs_accuracy
from service.store.submissions.artefacts import find_artefact
from service.workers import worker
from tests.support.database import jump, run, sql
from tests.support.grader import WHY, NoSandbox
from tests.support.submissions import submitted

SLOW = "def euler_eqs(t, w, I):\n    while True: pass\n"  # its scene is stopped after 2 s
RUNS = "SELECT end_reason, phase, note FROM run WHERE grading_id = %s"
JOBS = "SELECT status::text FROM procrastinate_jobs WHERE args->>'attempt' = %s AND status = 'todo'"


class Left(BaseException):
    """The process would have ended here."""


@pytest.fixture
def waiting(database_url):
    """A grading whose job a worker has taken."""
    _, grading = submitted(database_url, source=SLOW, exercises=["2"])
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    return grading


@contextlib.asynccontextmanager
async def worker_on(url, grader=None, **settings):
    one = worker.Worker(Settings(database_url=url, **settings), "w1")
    one._grader = grader
    async with one._database:
        try:
            yield one
        finally:
            one._thread.shutdown()  # what still runs there plays in the sandbox of other tests


def grade(url, grading, grader):
    """Run the job of the grading."""

    async def graded(database):
        async with worker_on(url, grader) as worker:
            await worker._grade(str(grading))

    run(url, graded)


@pytest.mark.slow
def test_a_slow_submission_is_graded_while_its_run_tells_how_far_it_is(database_url, waiting, sandbox):
    grade(database_url, waiting, Grader(sandbox))
    ((end_reason, phase, _),) = sql(database_url, RUNS, waiting)
    assert end_reason == "finished" and phase in ("playing", "judging"), "the run was begun as 'starting'"
    assert sql(database_url, "SELECT score FROM result WHERE grading_id = %s", waiting) == [(0,)]


def test_a_grading_that_cannot_be_graded_is_given_back(database_url, waiting):
    grade(database_url, waiting, NoSandbox())
    assert sql(database_url, RUNS, waiting) == [("failed", "starting", WHY)]
    assert (
        sql(database_url, JOBS, str(waiting)) == [("todo",)]
        and sql(database_url, "SELECT 1 FROM result") == []
    )


@pytest.mark.slow
def test_a_worker_whose_grading_hangs_gives_it_back_and_ends(database_url, waiting, sandbox, monkeypatch):
    def leave(code):
        raise Left

    async def hung(database):
        async with worker_on(database_url, Grader(sandbox)) as one:
            with pytest.raises(Left):
                await one._grade(str(waiting))

    monkeypatch.setattr(os, "_exit", leave)
    monkeypatch.setattr(worker, "HOST_S", 0.3)
    monkeypatch.setattr(Grader, "longest_s", lambda self, slug: 0.0)
    run(database_url, hung)
    ((end_reason, _, note),) = sql(database_url, RUNS, waiting)
    assert end_reason == "failed" and note == "grade_and_pack did not return within 0.3 s: this worker stops"
    assert sql(database_url, JOBS, str(waiting)) == [("todo",)]


@pytest.mark.parametrize(
    ("others", "minutes", "ends"),
    [
        (["ben"], 0, [("postponed", True), ("postponed", True)]),
        (["ben"], 11, [("finished", True)]),
        ([], 0, [("finished", True)]),
    ],
    ids=["others wait", "others wait too long", "nobody waits"],
)
def test_a_slow_grading_is_put_off_while_others_wait(
    database_url, sandbox, monkeypatch, others, minutes, ends
):
    monkeypatch.setattr(worker.Pace, "slow_after", lambda pace, assignment: 0.3)
    _, slow = submitted(database_url, source="import time\ntime.sleep(3)\n", exercises=["2"])
    sql(database_url, "SELECT id FROM procrastinate_fetch_job_v2(NULL, NULL)")
    sql(database_url, "UPDATE grading SET requested_at = now() - make_interval(mins => %s)", minutes)
    for name in others:
        submitted(database_url, name)

    async def graded(database):
        async with (
            worker_on(database_url, Grader(sandbox), lease=0.8) as one,
            worker.new_app(database_url, "test").open_async() as one._app,
        ):
            for _ in ends:
                await one._grade(str(slow))

    sandbox.close()  # a guest ends with the thread that started it, here another worker's
    run(database_url, graded)
    sandbox.close()
    assert sql(database_url, "SELECT end_reason, slow FROM run ORDER BY started_at") == ends
    finished = [(None,)] * (ends[-1] == ("finished", True))
    assert sql(database_url, "SELECT fault FROM result") == finished


def test_a_heartbeat_that_outlives_its_grading_does_not_stop_the_next_one(database_url, sandbox, monkeypatch):
    heartbeat = worker.runs.heartbeat
    gradings = [
        submitted(database_url, name, source="import time\ntime.sleep(1)\n", exercises=["2"])[1]
        for name in ("ann", "ben")
    ]

    lost = []

    async def lose_a_cancellation(database, claimed, *progress):
        """Go on when first cancelled, as a wait for a connection of the pool does in Python 3.11."""
        try:
            await asyncio.sleep(0.5)
        except asyncio.CancelledError as error:
            if lost:
                raise
            lost.append(error)
        return await heartbeat(database, claimed, *progress)

    async def graded(database):
        async with worker_on(database_url, Grader(sandbox), lease=0.8) as one:
            for grading in gradings:
                await one._grade(str(grading))

    monkeypatch.setattr(worker.runs, "heartbeat", lose_a_cancellation)
    sandbox.close()  # a guest ends with the thread that started it, here another worker's
    run(database_url, graded)
    sandbox.close()
    assert sql(database_url, "SELECT end_reason FROM run") == [("finished",)] * 2


def test_a_stopped_worker_gives_back_what_it_has_in_hand_and_that_is_no_failure(
    database_url, waiting, sandbox, monkeypatch
):
    def leave(code):
        raise Left

    async def stopped(database):
        async with worker_on(database_url, Grader(sandbox), drain=0) as worker:
            grading = asyncio.create_task(worker._grade(str(waiting)))
            taking = asyncio.create_task(_stubborn(grading))
            while not worker._claimed:
                await asyncio.sleep(0.01)
            with pytest.raises(Left):
                await worker._drain(taking)
            given_back = await database.rows("SELECT end_reason FROM run")
            await grading  # a process would have ended before
            return given_back

    monkeypatch.setattr(os, "_exit", leave)
    assert [row.end_reason for row in run(database_url, stopped)] == ["released"]
    assert (
        sql(database_url, JOBS, str(waiting)) == [("todo",)]
        and sql(database_url, "SELECT 1 FROM result") == []
    )


def test_a_worker_without_a_sandbox_says_why_and_takes_nothing(database_url, monkeypatch):
    def refuse(least, allow_root):
        raise IsolationUnavailable(f"isolation level {least} is not available")

    async def started(database):
        async with worker_on(database_url, min_isolation="namespaces") as worker:
            trying = asyncio.create_task(worker._start_sandbox())
            while not (known := await database.rows("SELECT isolation, unavailable_reason FROM worker")):
                await asyncio.sleep(0.02)
            worker._stopping.set()
            return tuple(known[0]), await trying

    monkeypatch.setattr(worker, "choose", refuse)
    assert run(database_url, started) == ((None, "isolation level namespaces is not available"), False)


def test_a_sweep_that_fails_is_stored_and_not_queued_by_later_requests(database_url, waiting):
    async def swept(database):
        async with worker_on(database_url, NoSandbox()) as worker:
            await worker._sweep(str(waiting))
        return [await speed_vs_accuracy.request(database, waiting) for _ in range(3)]

    assert run(database_url, swept) == [WHY] * 3
    assert sql(database_url, "SELECT 1 FROM procrastinate_jobs WHERE task_name = 'sweep'") == []


@pytest.mark.slow
def test_a_sweep_of_a_submission_that_cannot_be_measured_is_refused_once(database_url, sandbox):
    _, grading = submitted(database_url, source="x = 1")
    sql(database_url, "DELETE FROM procrastinate_jobs")  # a sweep gives way to a grading that waits
    sandbox.close()  # a guest ends with the thread that started it, here another worker's

    async def swept(database):
        async with worker_on(database_url, Grader(sandbox)) as worker:
            await worker._sweep(str(grading))
        return await speed_vs_accuracy.request(database, grading), (
            await find_artefact(database, grading, speed_vs_accuracy.REFUSED)
        )[0]

    fault, reason = run(database_url, swept)
    sandbox.close()
    assert fault is None and b"euler_eqs is not defined" in reason
    assert sql(database_url, "SELECT 1 FROM procrastinate_jobs WHERE task_name = 'sweep'") == []


@pytest.mark.slow
def test_a_sweep_gives_way_to_a_grading_and_is_measured_later(database_url, sandbox):
    _, grading = submitted(
        database_url, source="def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I\n"
    )
    sandbox.close()
    grades = "procrastinate_jobs WHERE task_name = 'grade' AND status = 'todo'"
    assert sql(database_url, f"SELECT count(*) FROM {grades}") == [(1,)]

    async def swept(database):
        found = []
        async with (
            worker_on(database_url, Grader(sandbox)) as one,
            worker.new_app(database_url, "test").open_async() as one._app,
        ):
            for _ in range(2):
                await one._sweep(str(grading))
                found.append(await speed_vs_accuracy.ending(database, grading))
                async with database.begin() as connection:
                    await connection.execute(f"DELETE FROM {grades}")
        return found

    gave_way, measured = run(database_url, swept)
    sandbox.close()
    assert gave_way is None and measured[0] == speed_vs_accuracy.SWEPT
    assert sql(database_url, "SELECT priority FROM procrastinate_jobs WHERE task_name = 'sweep'") == [
        (-1000,)
    ]
    runs = "SELECT name FROM grading_artefact WHERE name LIKE 'sweep.run._'"
    assert sql(database_url, runs) == [("sweep.run.1",)], "the run that gave way does not count"


async def _stubborn(grading):
    """As Procrastinate, end only after the job."""
    while not grading.done():
        try:
            await asyncio.sleep(0.05)
        except asyncio.CancelledError:
            continue


@pytest.mark.parametrize(
    ("lease", "beat", "look"),
    [(2.0, 0.5, 1.0), (0.4, 0.1, 0.2), (60.0, 15.0, 1.0)],
    ids=["default", "shortest", "longest"],
)
def test_a_lease_is_several_signs_of_life_and_is_looked_after_within_it(lease, beat, look):
    async def times():
        one = worker.Worker(Settings(database_url="postgresql://nobody@127.0.0.1:1/none", lease=lease), "w")
        return one._heartbeat_s, one._round_s

    assert asyncio.run(times()) == pytest.approx((beat, look))


def test_what_no_setting_changes():
    assert (worker.REGISTER_S, worker.SWEEP_S, worker.RETRY_SANDBOX_S) == (3.0, 30.0, 5.0)
    assert worker.PATIENCE_S == 3600.0, "a result in hand outlives an hour without database"


def test_a_worker_registers_when_the_clock_has_jumped(database_url, monkeypatch):
    """Otherwise the server would say for three seconds that no worker is running."""
    monkeypatch.setattr(worker, "REGISTER_S", 3600.0)
    hours, seen = [0], "SELECT count(*) FROM worker WHERE seen_at > now() - interval '10 s'"

    async def keep_house(database):
        async with worker_on(database_url, lease=0.4) as one:
            one._isolation, one._clock = (
                "process",
                workers.ClockWatch(lambda: time.monotonic() - 3600 * hours[0]),
            )
            keeping = asyncio.create_task(one._keep_house())
            await _until(lambda: sql(database_url, seen) == [(1,)])
            await asyncio.sleep(0.3)
            jump(database_url, 1)
            hours[0] = 1
            assert sql(database_url, seen) == [(0,)]
            await _until(lambda: sql(database_url, seen) == [(1,)])
            keeping.cancel()

    run(database_url, keep_house)


async def _until(found):
    deadline = time.monotonic() + 20
    while not found():
        assert time.monotonic() < deadline
        await asyncio.sleep(0.05)
