"""One worker process: takes jobs from the queue, grades them with its own warm guest, and looks after work that others lost.

Grading runs in one thread that lives as long as the process, as a guest dies with the thread that started it. The event loop
beside it gives a sign of life of the run four times in a lease.
"""

import asyncio
import contextlib
import logging
import os
import signal
import uuid
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from psycopg.errors import UndefinedTable

from service import logs
from service.grading import grader
from service.grading.grader import SweepFailed
from service.sandbox.result import Cancelled, SystemFault
from service.sandbox.select import IsolationUnavailable, choose
from service.sandbox.wire import text
from service.settings import Settings
from service.store import runs, workers
from service.store.database import Database, is_outage, patiently
from service.store.queue import QUEUE, new_app
from service.store.records import store_artefacts

log = logging.getLogger(__name__)
BEATS, LOOKS, LONGEST_LOOK_S = 4, 2, 1.0  # in a lease
ENROL_S, SWEEP_S, RETRY_SANDBOX_S = 3.0, 30.0, 5.0
GIVE_BACK_S = 3.0
PATIENCE_S = 3600.0  # a result in hand outlives an hour without database
MOST_S = 900.0  # far beyond every budget of a submission: a worker that has not come back by then ends itself


class Worker:
    """``name`` tells the host and the process; ``settings.database_url`` is set."""

    def __init__(self, settings: Settings, name: str) -> None:
        assert settings.database_url is not None
        self.name, self._settings, self._url = name, settings, settings.database_url
        self._database = Database(self._url, f"polhode worker {name}", connections=3, wait_s=settings.database_wait)
        self._beat_s, self._look_s = settings.lease / BEATS, min(LONGEST_LOOK_S, settings.lease / LOOKS)
        self._thread = ThreadPoolExecutor(1)
        self._stopping = asyncio.Event()
        self._claimed: runs.Claim | None = None
        self._progress = ("starting", 0, 0)

    async def run(self) -> None:
        """Work until told to stop by SIGTERM or SIGINT; then finish within the time to drain, or give back."""
        for how in (signal.SIGTERM, signal.SIGINT):
            asyncio.get_running_loop().add_signal_handler(how, self._stopping.set)
        if not (await self._find_tables() and await self._start_sandbox()):
            return
        caring, taking = asyncio.create_task(self._look_after()), asyncio.create_task(self._take_jobs())
        told = asyncio.create_task(self._stopping.wait())
        await asyncio.wait([told, caring, taking], return_when=asyncio.FIRST_COMPLETED)
        if not told.done():
            log.critical("a worker that has stopped to look or to take ends itself")
        caring.cancel()
        await self._drain(taking)
        await self._database.close()

    async def _find_tables(self) -> bool:
        """Wait for a server to bring the tables up to date, or for the database; False if told to stop."""
        while not self._stopping.is_set():
            try:
                await self._database.rows("SELECT 1 FROM worker")
                return True
            except Exception as error:
                if not (is_outage(error) or isinstance(getattr(error, "orig", None), UndefinedTable)):
                    raise
                await self._pause(1.0)
        return False

    async def _pause(self, seconds: float) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._stopping.wait(), seconds)

    async def _start_sandbox(self) -> bool:
        """Warm a guest and let it play the probe; report a failure and try again. Return False if the worker is stopped first."""
        while not self._stopping.is_set():
            try:
                isolation = await asyncio.to_thread(choose, self._settings.min_isolation)
                await self._call(grader.start, isolation)
                await self._call(grader.ready)
                self._isolation = isolation.name
                return True
            except (IsolationUnavailable, SystemFault) as reason:
                log.error("nothing is graded here: %s", reason)
                await self._enrol(None, str(reason))
                await self._pause(RETRY_SANDBOX_S)
        return False

    async def _take_jobs(self) -> None:
        """Take jobs one at a time; begin anew when the database was out."""
        told = False  # of this outage
        while True:
            app = new_app(self._url, f"polhode queue {self.name}", self._settings.database_wait)
            app.task(name="grade", queue=QUEUE)(self._grade)
            app.task(name="sweep", queue=QUEUE)(self._sweep)
            try:
                await self._database.ping()  # a pool that opens while the database is out waits for half a minute
                told = False
                async with app.open_async():
                    await app.run_worker_async(
                        queues=[QUEUE], name=self.name, fetch_job_polling_interval=1.0, delete_jobs="always",
                        install_signal_handlers=False, stalled_worker_timeout=3600,
                    )  # fmt: skip
            except Exception as error:
                if not told or not is_outage(error):
                    log.warning("taking jobs again after %s", type(error).__name__)
                told = True
            await asyncio.sleep(0.3)

    async def _grade(self, attempt: str) -> None:
        """The job of a grading."""
        logs.grading_id.set(attempt)
        claim = partial(runs.claim, self._database, uuid.UUID(attempt), uuid.uuid4(), self.name)
        claimed = await patiently(claim, PATIENCE_S)
        if claimed is None:
            return
        self._claimed, self._progress = claimed, ("starting", 0, 0)
        beats = asyncio.create_task(self._beat(claimed))
        try:
            report, artefacts = await self._call(
                grader.grade_one, claimed.submission, claimed.assignment, claimed.exercises, claimed.seed, self._tell
            )
            first = await patiently(partial(runs.finish, self._database, claimed, report, artefacts), PATIENCE_S)
            log.info("graded" if first else "came second")
        except Cancelled:
            log.info("stopped, as the grading has its result")
            await patiently(partial(runs.supersede, self._database, claimed), PATIENCE_S)
        except Exception as error:
            log.exception("grading failed")
            words = text(str(error) if isinstance(error, SystemFault) else f"{type(error).__name__}: {error}", 400)
            await patiently(partial(runs.release, self._database, claimed, "failed", words), PATIENCE_S)
        finally:
            beats.cancel()
            grader.stop_playing(False)
            self._claimed = None

    async def _sweep(self, attempt: str) -> None:
        """The job of a sweep that somebody looks for."""
        asked = await patiently(partial(runs.read_grading, self._database, uuid.UUID(attempt)), PATIENCE_S)
        try:
            document, chart = await self._call(grader.sweep_one, asked.submission, asked.assignment)
            artefacts = {"sweep.json": document.encode(), "sweep.svg": chart}
        except SweepFailed as reason:
            artefacts = {"sweep.refused": str(reason).encode()}
        await patiently(partial(store_artefacts, self._database, asked.grading, artefacts), PATIENCE_S)
        await patiently(partial(runs.notify, self._database, asked.submission_id), PATIENCE_S)

    def _tell(self, phase: str, scene: int, scenes: int) -> None:
        """Called in the grading thread."""
        self._progress = phase, scene, scenes

    async def _beat(self, claimed: runs.Claim) -> None:
        while True:
            await asyncio.sleep(self._beat_s)
            with _suppress_outages():
                if not await runs.heartbeat(self._database, claimed, *self._progress):
                    grader.stop_playing()

    async def _look_after(self) -> None:
        """Tell that this worker is there, and rescue what others lost."""
        lease, enrol_every, sweep_every = self._settings.lease, round(ENROL_S / self._look_s), round(SWEEP_S / self._look_s)
        for look in range(1 << 62):
            with _suppress_outages():
                if look % enrol_every == 0:
                    await self._enrol(self._isolation, None)
                if again := await workers.recover(self._database, lease):
                    log.warning("queued again: %s", ", ".join(map(str, again)))
                if look % sweep_every == 0 and (found := await workers.sweep(self._database, lease)):
                    log.warning("without a job: %s", ", ".join(map(str, found)))
            await asyncio.sleep(self._look_s)

    async def _enrol(self, isolation: str | None, refusal: str | None) -> None:
        with _suppress_outages():
            await workers.register_worker(self._database, self.name, isolation, refusal, grader.zygotes())

    async def _drain(self, taking: "asyncio.Task[None]") -> None:
        """Take no more, wait a little for the work in hand, then queue it again: it is not lost and costs nothing."""
        taking.cancel()
        with _suppress_outages():
            await workers.unregister_worker(self._database, self.name)
        await asyncio.wait([taking], timeout=self._settings.drain)  # it ends after the job that it has
        if taking.done():
            return
        if self._claimed is not None:
            with _suppress_outages():
                await asyncio.wait_for(
                    runs.release(self._database, self._claimed, "released", "the worker was stopped"), GIVE_BACK_S
                )
        os._exit(0)  # at once: Procrastinate would write down that the job is over

    async def _call(self, function: Callable[..., Any], *args: Any) -> Any:
        """Run in the grading thread. A thread that does not come back cannot be ended but with its process."""
        work = asyncio.get_running_loop().run_in_executor(self._thread, function, *args)
        await asyncio.wait([work], timeout=MOST_S)
        if not work.done():
            log.critical("%s did not come back in %g s: this worker ends", function.__name__, MOST_S)
            os._exit(1)
        return work.result()


@contextlib.contextmanager
def _suppress_outages():  # type: ignore[no-untyped-def]
    """What is done again soon anyway may fail while the database is out."""
    try:
        yield
    except Exception as error:
        if not is_outage(error):
            log.exception("a worker's housekeeping failed")


def work(settings: Settings, name: str) -> None:
    """The life of a worker process."""
    asyncio.run(Worker(settings, name).run())
    os._exit(0)  # a grading thread that is still at it would be waited for
