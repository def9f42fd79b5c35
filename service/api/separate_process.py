"""A separate process for work that would block the server: one call at a time."""

import asyncio
import functools
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from service.sandbox.guest.confinement.lockdown import die_with_parent

T = TypeVar("T")


class ProcessLost(Exception):
    """The process died, or did not return in time and was killed. The next call starts a new one."""


class SeparateProcess:
    """A process that starts at the first call, with ``prepare(parent's pid)``,
    and serves one call at a time.
    """

    def __init__(self, timeout_s: float, prepare: Callable[[int], None] = die_with_parent) -> None:
        self._timeout_s, self._prepare = timeout_s, prepare
        self._pool: ProcessPoolExecutor | None = None
        self._lock = asyncio.Lock()

    async def call(self, function: Callable[..., T], *args: Any) -> T:
        """Return the function's result, or raise its exception. Raises ProcessLost."""
        async with self._lock:
            if self._pool is None:
                spawn = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(
                    1, mp_context=spawn, initializer=self._prepare, initargs=(os.getpid(),)
                )
            try:
                work = asyncio.get_running_loop().run_in_executor(
                    self._pool, functools.partial(function, *args)
                )
                return await asyncio.wait_for(work, self._timeout_s)
            except (BrokenProcessPool, TimeoutError) as error:
                self.stop()
                raise ProcessLost from error

    def stop(self) -> None:
        """Kill the process."""
        if self._pool is not None:
            for process in list((self._pool._processes or {}).values()):
                process.kill()
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None
