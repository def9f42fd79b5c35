"""Grading beside the web server: a pool of worker processes, never the event loop; a fault is ours and never a verdict."""

import asyncio
import logging
import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any
from uuid import UUID

from sqlalchemy.exc import DataError

from service import worker
from service.grading.report import Report
from service.sandbox.choose import WallsMissing, choose
from service.sandbox.seen import Fault
from service.sandbox.walls import Walls
from service.sandbox.wire import text
from service.store.store import Store, Stored

log = logging.getLogger(__name__)
TRIES = 2


class Grader:
    """Takes stored submissions one by one and writes their results. ``store`` is the truth; this holds only who is waiting."""

    def __init__(self, store: Store, least_tier: str, workers: int) -> None:
        self._store, self._least_tier, self._workers = store, least_tier, workers
        self.refusal = "the walls have not been tried yet"
        self._walls: Walls | None = None
        self._pool = self._new_pool()  # without walls it draws and does not grade
        self._waiting: dict[UUID, asyncio.Task[None]] = {}
        self.running: set[UUID] = set()
        self._charts: dict[tuple[str, int], bytes] = {}
        self._slots = asyncio.Semaphore(workers)

    async def start(self) -> None:
        """Choose walls, warm every worker, let it play the probe, and take up what was accepted but not graded.

        Where the walls are missing or have a hole, ``refusal`` says so and nothing is graded.
        """
        try:
            self._walls = await asyncio.to_thread(choose, self._least_tier)
            self._pool = self._new_pool()
            await asyncio.gather(*(self._call(worker.ready) for _ in range(self._workers)))
        except (WallsMissing, Fault) as reason:
            log.error("no submission is graded: %s", reason)
            self.refusal = str(reason)
            return
        self.refusal = ""
        for id in await self._store.unfinished():
            self.take(id)

    @property
    def walls(self) -> str:
        """What stands around a submission, for reports."""
        return self._walls.name if self._walls else "none"

    async def stop(self) -> None:
        """Give up what is running (it is stored and will be taken up again) and end the workers."""
        for task in self._waiting.values():
            task.cancel()
        await asyncio.gather(*self._waiting.values(), return_exceptions=True)
        for process in list((self._pool._processes or {}).values()):
            process.kill()  # their guests die with them
        self._pool.shutdown(wait=True, cancel_futures=True)

    def take(self, id: UUID) -> None:
        """Grade that submission as soon as a worker is free."""
        if id not in self._waiting:
            self._waiting[id] = task = asyncio.create_task(self._grade(id))
            task.add_done_callback(lambda _: self._waiting.pop(id, None))

    async def wait(self, id: UUID, seconds: float) -> None:
        """Return when that submission has its result, or after ``seconds``."""
        if task := self._waiting.get(id):
            await asyncio.wait([task], timeout=seconds)

    async def draw(self, stored: Stored, figure: str, packed: bytes, form: str) -> bytes:
        """Draw a figure in a worker."""
        return bytes(await self._call(worker.draw_one, stored.assignment, figure, packed, stored.seed, form))

    async def sweep(self, stored: Stored) -> tuple[str, bytes]:
        """Sweep a submission's function in a worker: JSON and a chart. Raises NotSwept; waits for a worker that does not grade."""
        async with self._slots:
            document, chart = await self._call(worker.sweep_one, stored.submission, stored.assignment)
            return str(document), bytes(chart)

    async def draw_chart(self, kind: str, number: int) -> bytes:
        """Draw a chart of the reference methods in a worker, once."""
        if (kind, number) not in self._charts:
            self._charts[kind, number] = bytes(await self._call(worker.draw_chart, kind, number))
        return self._charts[kind, number]

    async def _grade(self, id: UUID) -> None:
        async with self._slots:
            self.running.add(id)
            try:
                stored = await self._store.get(id)
                if stored is None or stored.finished:
                    return
                report, artefacts, fault = await self._attempt(stored)
                await self._finish(id, report, artefacts, fault)
            except asyncio.CancelledError:
                raise
            except Exception:
                log.exception("submission %s could not be graded and stays unfinished", id)
            finally:
                self.running.discard(id)

    async def _finish(self, id: UUID, report: Report | None, artefacts: dict[str, bytes], fault: str | None) -> None:
        try:
            await self._store.finish(id, report, fault, artefacts)
        except DataError:
            log.exception("the result of submission %s cannot be stored", id)
            await self._store.finish(id, None, "the result could not be stored", {})

    async def _attempt(self, stored: Stored) -> tuple[Report | None, dict[str, bytes], str | None]:
        fault = ""
        for _ in range(TRIES):
            try:
                document, artefacts = await self._call(
                    worker.grade_one, stored.submission, stored.assignment, stored.exercises, stored.seed
                )
                return Report.model_validate_json(document), artefacts, None
            except Exception as error:
                log.exception("grading submission %s failed", stored.id)
                fault = text(str(error) if isinstance(error, Fault) else f"{type(error).__name__}: {error}", 600)
        return None, {}, fault

    async def _call(self, function: Callable[..., Any], *args: Any) -> Any:
        """Run in the pool; a pool that lost a worker is replaced, once for all who noticed."""
        pool = self._pool
        try:
            return await asyncio.get_running_loop().run_in_executor(pool, function, *args)
        except BrokenProcessPool:
            if self._pool is pool:
                self._pool = self._new_pool()
            raise

    def _new_pool(self) -> ProcessPoolExecutor:
        spawn = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._workers, mp_context=spawn, initializer=worker.start, initargs=(self._walls,))
