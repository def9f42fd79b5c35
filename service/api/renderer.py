"""Drawing beside the event loop: one process, started when somebody looks at a picture that has not been drawn yet."""

import asyncio
import functools
import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from service.grading import grader
from service.sandbox.guest.lockdown import die_with_parent
from service.store.records import SubmissionRecord

DRAW_S = 60.0


class RenderFailed(Exception):
    """The drawing process was lost or took too long; the next picture gets a new one."""


class Renderer:
    """Draws figures and charts; a process that is lost is replaced at the next picture."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._charts: dict[tuple[str, int], bytes] = {}
        self._drawing: dict[tuple[Any, ...], asyncio.Task[bytes]] = {}
        self._one_at_a_time = asyncio.Lock()

    async def figure(self, stored: SubmissionRecord, name: str, packed: bytes, form: str) -> bytes:
        """A figure of a graded submission. ArithmeticError or ValueError where its numbers cannot be drawn."""
        key = stored.grading, name, form
        return await self._once(key, grader.draw_one, stored.assignment, name, packed, stored.seed, form)

    async def chart(self, kind: str, number: int) -> bytes:
        """A chart of the reference methods, drawn once."""
        if (kind, number) not in self._charts:
            self._charts[kind, number] = await self._once((kind, number), grader.draw_chart, kind, number)
        return self._charts[kind, number]

    async def class_sweep(self, documents: Sequence[dict[str, Any]]) -> bytes:
        """The sweeps of a class over the reference methods."""
        return await self._once(("class", len(documents), str(documents)), grader.draw_class, documents)

    def stop(self) -> None:
        """End the process."""
        if self._pool is not None:
            for process in list((self._pool._processes or {}).values()):
                process.kill()
            self._pool.shutdown(wait=True, cancel_futures=True)

    async def _once(self, key: tuple[Any, ...], function: Callable[..., bytes], *args: Any) -> bytes:
        """What several ask for at the same time is drawn once, also for whoever goes away meanwhile."""
        if key not in self._drawing:
            self._drawing[key] = task = asyncio.ensure_future(self._call(function, *args))
            task.add_done_callback(lambda _: self._drawing.pop(key, None))
        return await asyncio.shield(self._drawing[key])

    async def _call(self, function: Callable[..., bytes], *args: Any) -> bytes:
        async with self._one_at_a_time:
            if self._pool is None:
                spawn = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(1, mp_context=spawn, initializer=die_with_parent, initargs=(os.getpid(),))
            try:
                work = asyncio.get_running_loop().run_in_executor(self._pool, functools.partial(function, *args))
                return await asyncio.wait_for(work, DRAW_S)
            except (BrokenProcessPool, TimeoutError) as error:
                self.stop()
                self._pool = None
                raise RenderFailed from error
