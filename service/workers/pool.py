"""A crew: worker processes on one machine, each replaced when it is gone, all of them ended with it.

They are forked from one process that has imported everything, so they share its memory and start at once.
"""

import gc
import logging
import multiprocessing
import os
import signal
import socket
import time
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess

from exercises.catalogue import assignments
from service.sandbox.guest.lockdown import die_with_parent
from service.settings import Settings
from service.workers.worker import work

log = logging.getLogger(__name__)
SHORT_LIFE_S, LONGEST_PAUSE_S = 3.0, 5.0
STOPS = (signal.SIGTERM, signal.SIGINT)
SETTLE_S = 5.0  # on top of the time to drain


class WorkerPool:
    """``settings.workers`` processes that take jobs from ``settings.database_url``."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._fork = multiprocessing.get_context("fork")
        self._stopping = False

    def run(self) -> int:
        """Keep the crew complete until SIGTERM or SIGINT; then let it drain."""
        for how in STOPS:
            signal.signal(how, self._stop)
        assignments()
        gc.freeze()  # what is imported stays shared
        slots = [_WorkerSlot(number) for number in range(self._settings.workers)]
        while not self._stopping:
            for slot in slots:
                slot.fill(self._start)
            wait([slot.process.sentinel for slot in slots if slot.process], timeout=0.2)
        for slot in slots:
            if slot.process and slot.process.pid:
                os.kill(slot.process.pid, signal.SIGTERM)
        until = time.monotonic() + self._settings.drain + SETTLE_S
        for slot in slots:
            if slot.process:
                slot.process.join(max(0.0, until - time.monotonic()))
                slot.process.kill()
        return 0

    def _stop(self, signum: int, frame: object) -> None:
        self._stopping = True

    def _start(self, number: int) -> BaseProcess:
        process = self._fork.Process(target=_work, args=(self._settings, os.getpid()), name=f"worker {number}")
        signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)  # until the new process has handlers of its own
        try:
            process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
        return process


class _WorkerSlot:
    """Where one worker stands; a pause before the next one grows while they die young."""

    def __init__(self, number: int) -> None:
        self._number, self._since, self._young, self._not_before = number, 0.0, 0, 0.0
        self.process: BaseProcess | None = None

    def fill(self, start) -> None:  # type: ignore[no-untyped-def]
        now = time.monotonic()
        if self.process is not None and not self.process.is_alive():
            log.warning("%s ended with %s", self.process.name, self.process.exitcode)
            self._young = self._young + 1 if now - self._since < SHORT_LIFE_S else 0
            self._not_before = now + (min(LONGEST_PAUSE_S, 0.1 * 2**self._young) if self._young else 0.0)
            self.process.close()
            self.process = None
        if self.process is None and now >= self._not_before:
            self.process, self._since = start(self._number), now


def _work(settings: Settings, crew: int) -> None:
    die_with_parent(crew)
    for how in STOPS:
        signal.signal(how, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
    work(settings, f"{socket.gethostname()}/{os.getpid()}")
