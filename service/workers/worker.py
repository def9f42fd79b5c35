"""A worker process: it takes jobs, grades them, and recovers gradings of lost workers.

Grading runs in a thread that lives as long as the process, because a guest ends with the thread that started
it. Meanwhile the event loop sends four heartbeats per lease.
"""

import asyncio
import contextlib
import logging
import os
import signal
import threading
import uuid
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from procrastinate import App

from exercises.authoring.assignments.catalogue import assignments
from service import logs
from service.grading.grader import Grader, SweepFailed
from service.sandbox.guest_process import remove_abandoned
from service.sandbox.isolation.select import IsolationUnavailable, choose, with_packages
from service.sandbox.result import Cancelled, SystemFault
from service.sandbox.sandbox import Sandbox
from service.sandbox.time_budget import TimeLimits, processor_times
from service.sandbox.untrusted_text import text
from service.settings import Settings
from service.store.database import Database, end_task, is_outage, patiently
from service.store.queue import runs, workers
from service.store.queue.jobs import FIRST, LATER, SLOW, first_gradings_wait, new_app
from service.store.schema import WrongSchema, check_schema
from service.store.submissions import speed_vs_accuracy
from service.store.submissions.artefacts import store_artefacts
from service.workers.grading_pace import Pace, Stopwatch

log = logging.getLogger(__name__)
HEARTBEATS, ROUNDS, LONGEST_ROUND_S = 4, 2, 1.0  # heartbeats and housekeeping rounds per lease
REGISTER_S, SWEEP_S, RETRY_SANDBOX_S = 3.0, 30.0, 5.0
RELEASE_S = 3.0
GIVE_WAY_S = 0.2  # how soon a measurement notices that a grading waits
PATIENCE_S = 3600.0  # a finished result is kept for an hour of database outage
# Of a job outside the sandbox: starting guests, judging, drawing. The sandbox ends every play by its own
# limits, so only an error of polhode's or an assignment's own code can take longer.
HOST_S = 60.0
QUEUES = (FIRST, LATER, SLOW)


class Worker:
    """One worker, which takes jobs from ``queues``.

    ``name`` identifies host and process; ``settings.database_url`` must be set.
    """

    def __init__(self, settings: Settings, name: str, queues: Sequence[str] = QUEUES) -> None:
        assert settings.database_url is not None
        self._queues = list(queues)
        self.name, self._settings, self._url = name, settings, settings.database_url
        self._database = Database(
            self._url, f"polhode worker {name}", connections=3, wait_s=settings.database_wait
        )
        self._heartbeat_s, self._round_s = (
            settings.lease / HEARTBEATS,
            min(LONGEST_ROUND_S, settings.lease / ROUNDS),
        )
        self._limits = TimeLimits(settings.grading_cpu, settings.grading_wall)
        self._grader: Grader | None = None
        self._thread = ThreadPoolExecutor(1)
        self._thread_id = self._thread.submit(threading.get_native_id).result()
        self._clock = workers.ClockWatch()
        self._pace = Pace()
        self._app: App | None = None
        self._stopping = asyncio.Event()
        self._claimed: runs.Claim | None = None
        self._progress = ("starting", 0, 0)

    async def run(self) -> None:
        """Work until SIGTERM or SIGINT; then finish the grading within the drain time or release it."""
        for signal_number in (signal.SIGTERM, signal.SIGINT):
            asyncio.get_running_loop().add_signal_handler(signal_number, self._stopping.set)
        async with self._database:
            await self._work()

    async def _work(self) -> None:
        if not (await self._wait_for_tables() and await self._start_sandbox()):
            return
        housekeeping, taking = asyncio.create_task(self._keep_house()), asyncio.create_task(self._take_jobs())
        stopping = asyncio.create_task(self._stopping.wait())
        await asyncio.wait([stopping, housekeeping, taking], return_when=asyncio.FIRST_COMPLETED)
        if not stopping.done():
            log.critical("housekeeping or taking jobs ended unexpectedly: this worker stops")
        await end_task(housekeeping)
        await self._drain(taking)
        self._end_guest()

    async def _wait_for_tables(self) -> bool:
        """Wait until a server has created the tables of this version. Return False if the worker is stopped
        meanwhile.
        """
        logged = False
        while not self._stopping.is_set():
            try:
                await check_schema(self._database)
                await self._database.rows("SELECT 1 FROM worker")
                return True
            except WrongSchema as reason:
                if not logged:
                    log.error("waiting, because %s", reason)
                logged = True
            except Exception as error:
                if not is_outage(error):
                    raise
            await self._pause(1.0)
        return False

    async def _pause(self, seconds: float) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._stopping.wait(), seconds)

    async def _start_sandbox(self) -> bool:
        """Start a guest and run the self-test; while this fails, record the reason and retry.

        Return False if the worker is stopped.
        """
        while not self._stopping.is_set():
            try:
                await asyncio.to_thread(remove_abandoned)
                isolation = await asyncio.to_thread(
                    choose, self._settings.min_isolation, self._settings.allow_root_guest
                )
                packages = sorted({name for known in assignments().values() for name in known.packages})
                self._grader = Grader(Sandbox(with_packages(isolation, packages), self._limits))
                await self._call(self._grader.ready, within=self._limits.wall_s)
                self._isolation = isolation.name
                return True
            except (IsolationUnavailable, SystemFault) as reason:
                log.error("the sandbox cannot start; retrying: %s", reason)
                if self._grader is not None:
                    self._grader.sandbox.close()
                await self._register(None, str(reason))
                await self._pause(RETRY_SANDBOX_S)
        return False

    async def _take_jobs(self) -> None:
        """Take jobs one at a time; reconnect after a database outage."""
        logged = False  # this outage
        while True:
            app = new_app(self._url, f"polhode queue {self.name}", self._settings.database_wait)
            self._app = app
            app.task(name="grade")(self._grade)
            app.task(name="sweep")(self._sweep)
            try:
                await self._database.ping()  # opening the pool during an outage would block for half a minute
                logged = False
                async with app.open_async():
                    await app.run_worker_async(
                        queues=self._queues, name=self.name, fetch_job_polling_interval=1.0,
                        delete_jobs="always", install_signal_handlers=False, stalled_worker_timeout=3600,
                    )  # fmt: skip
            except Exception as error:
                if not logged or not is_outage(error):
                    log.warning("fetching jobs failed (%s); reconnecting", type(error).__name__)
                logged = True
            await asyncio.sleep(0.3)

    async def _grade(self, attempt: str) -> None:
        """Run the job that grades; ``attempt`` is the id of the grading."""
        logs.grading_id.set(attempt)
        claim = partial(runs.claim, self._database, uuid.UUID(attempt), uuid.uuid4(), self.name)
        claimed = await patiently(claim, PATIENCE_S)
        if claimed is None:
            return
        self._claimed, self._progress = claimed, ("starting", 0, 0)
        assert self._grader is not None
        cancelled = self._grader.sandbox.cancelled
        watch, slow_after = Stopwatch(self._waited_s), self._pace.slow_after(claimed.assignment)
        heartbeats = asyncio.create_task(self._send_heartbeats(claimed, cancelled, watch, slow_after))
        try:
            # loads the assignment, beside the heartbeats
            longest_s = await self._call(
                self._grader.longest_s, claimed.assignment, within=self._limits.wall_s
            )
            report, artefacts = await self._call(
                self._grader.grade_and_pack,
                claimed.submission, claimed.assignment, claimed.seed, self._set_progress,
                within=longest_s,
            )  # fmt: skip
            slow = watch.seconds() > slow_after
            first = await patiently(
                partial(runs.finish, self._database, claimed, report, artefacts, slow=slow), PATIENCE_S
            )
            log.info("graded" if first else "superseded by another run")
        except Cancelled:
            log.info("stopped: the grading has a result already, or is slow and others wait")
            await patiently(partial(self._end_cancelled, claimed), PATIENCE_S)
        except Exception as error:
            log.error("grading failed: %s", error, exc_info=not isinstance(error, SystemFault))
            await patiently(
                partial(runs.release, self._database, claimed, "failed", _reason(error)), PATIENCE_S
            )
        finally:
            await end_task(heartbeats)
            cancelled.clear()
            self._claimed = None
            self._pace.note(claimed.assignment, claimed.whose, watch.seconds())

    async def _sweep(self, attempt: str) -> None:
        """Run the job that measures speed against accuracy; ``attempt`` is the id of the grading."""
        job = await patiently(partial(runs.read_grading, self._database, uuid.UUID(attempt)), PATIENCE_S)
        number = await patiently(partial(speed_vs_accuracy.begin, self._database, job.grading), PATIENCE_S)
        if number is not None:
            try:
                artefacts = await self._measure(job, number)
            except Cancelled:
                log.info("stopped: a grading waits")
                await patiently(
                    partial(speed_vs_accuracy.put_back, self._database, job.grading, number), PATIENCE_S
                )
                return
            await patiently(partial(store_artefacts, self._database, job.grading, artefacts), PATIENCE_S)
        await patiently(partial(runs.notify, self._database, job.submission_id), PATIENCE_S)

    async def _measure(self, job: runs.GradingJob, number: int) -> dict[str, bytes]:
        """Measure speed against accuracy in run ``number``. Return the artefacts of its result, or of its
        failure of any kind. Raises Cancelled as soon as a grading waits.
        """
        assert self._grader is not None
        cancelled = self._grader.sandbox.cancelled
        giving_way = asyncio.create_task(self._give_way(cancelled))
        try:
            document, chart = await self._call(
                self._grader.sweep_and_draw, job.submission, job.assignment,
                within=self._grader.longest_s(job.assignment),
            )  # fmt: skip
        except SweepFailed as reason:
            return {speed_vs_accuracy.REFUSED: str(reason).encode()}
        except Cancelled:
            raise
        except Exception as error:
            log.exception("measuring speed against accuracy failed")
            return speed_vs_accuracy.fault(number, _reason(error))
        finally:
            await end_task(giving_way)
            cancelled.clear()
        return {speed_vs_accuracy.SWEPT: document.encode(), "sweep.svg": chart}

    async def _give_way(self, cancelled: threading.Event) -> None:
        """Set ``cancelled``, which ends a measurement, once somebody waits for a first report."""
        while True:
            await asyncio.sleep(GIVE_WAY_S)
            with _suppress_outages():
                if self._app is not None and await first_gradings_wait(self._app):
                    cancelled.set()

    def _set_progress(self, phase: str, scene: int, scenes: int) -> None:
        """Called in the grading thread."""
        self._progress = phase, scene, scenes

    def _waited_s(self) -> float:
        """Return the seconds that the grading thread and the sandbox have waited for a processor."""
        assert self._grader is not None
        return processor_times(self._thread_id)[1] + self._grader.sandbox.waited_s

    async def _send_heartbeats(
        self, claimed: runs.Claim, cancelled: threading.Event, watch: Stopwatch, slow_after: float
    ) -> None:
        """Send heartbeats of the run; set ``cancelled``, which ends its play, once it is superseded, or once
        it has taken ``slow_after`` seconds of its ``watch`` and others wait for a first report.
        """
        while True:
            await asyncio.sleep(self._heartbeat_s)
            with _suppress_outages():
                goes_on = await runs.heartbeat(self._database, claimed, *self._progress)
                if goes_on and claimed.may_wait and watch.seconds() > slow_after and self._app is not None:
                    goes_on = not await first_gradings_wait(self._app)
                if not goes_on:
                    cancelled.set()

    async def _end_cancelled(self, claimed: runs.Claim) -> None:
        """End a run that was stopped: as superseded if its grading has a result, else as postponed."""
        if await runs.heartbeat(self._database, claimed, *self._progress):
            await runs.release(self._database, claimed, "postponed", "it is slow, and others were waiting")
        else:
            await runs.supersede(self._database, claimed)

    async def _keep_house(self) -> None:
        """Register this worker regularly, and recover lost gradings."""
        lease, register_every, sweep_every = (
            self._settings.lease,
            round(REGISTER_S / self._round_s),
            round(SWEEP_S / self._round_s),
        )
        for turn in range(1 << 62):
            with _suppress_outages():
                if turn % register_every == 0:
                    await self._register(self._isolation, None)
                jumps = self._clock.jumps
                if again := await workers.recover(self._database, lease, self._clock):
                    log.warning("gradings of lost runs queued again: %s", ", ".join(map(str, again)))
                if jumps != self._clock.jumps:  # the time of the last registration is that of another clock
                    await self._register(self._isolation, None)
                if turn % sweep_every == 0 and (found := await workers.sweep(self._database, lease)):
                    log.warning("gradings without a job queued again: %s", ", ".join(map(str, found)))
            await asyncio.sleep(self._round_s)

    async def _register(self, isolation: str | None, unavailable_reason: str | None) -> None:
        restarts = self._grader.sandbox.replaced if self._grader else 0
        with _suppress_outages():
            await workers.register_worker(self._database, self.name, isolation, unavailable_reason, restarts)

    async def _drain(self, taking: "asyncio.Task[None]") -> None:
        """Take no more jobs; after the drain time, queue the unfinished grading again as released."""
        taking.cancel()
        with _suppress_outages():
            await workers.unregister_worker(self._database, self.name)
        await asyncio.wait([taking], timeout=self._settings.drain)  # it ends after its present job
        if taking.done():
            return
        await self._release("released", "the worker was stopped")
        self._end_guest()
        os._exit(0)  # without cleanup: a clean exit would make Procrastinate mark the job as finished

    def _end_guest(self) -> None:
        """Kill the guest, which removes what submissions left in its folder."""
        if self._grader is not None:
            with contextlib.suppress(Exception):
                self._grader.sandbox.close()

    async def _release(self, end_reason: str, note: str) -> None:
        """Queue the unfinished grading again, unless the database does not answer: then its run is lost."""
        if self._claimed is not None:
            with _suppress_outages():
                await asyncio.wait_for(
                    runs.release(self._database, self._claimed, end_reason, note, exits=True), RELEASE_S
                )

    async def _call(self, function: Callable[..., Any], *args: Any, within: float) -> Any:
        """Run in the grading thread, which may use the sandbox for ``within`` seconds. A thread that hangs
        can only be ended with its process.
        """
        longest_s = within + HOST_S
        work = asyncio.get_running_loop().run_in_executor(self._thread, function, *args)
        await asyncio.wait([work], timeout=longest_s)
        if not work.done():
            sentence = f"{function.__name__} did not return within {longest_s:g} s: this worker stops"
            log.critical(sentence)
            await self._release("failed", sentence)
            os._exit(1)
        return work.result()


def _reason(error: Exception) -> str:
    """Return why polhode failed, as it is stored."""
    return text(str(error) if isinstance(error, SystemFault) else f"{type(error).__name__}: {error}", 400)


@contextlib.contextmanager
def _suppress_outages():  # type: ignore[no-untyped-def]
    """Suppress database outages in periodic housekeeping; the next round repeats the work."""
    try:
        yield
    except Exception as error:
        if not is_outage(error):
            log.exception("the worker's housekeeping failed")


def work(settings: Settings, name: str, *, slow: bool = True) -> None:
    """Run a worker until it is stopped, then exit the process. Unless ``slow``, it takes no grading that is
    known to be slow.
    """
    queues = [queue for queue in QUEUES if slow or queue != SLOW]
    asyncio.run(Worker(settings, name, queues).run())
    os._exit(0)  # a normal exit would wait for the grading thread
