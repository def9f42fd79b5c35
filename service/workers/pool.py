"""A pool of worker processes on one machine, which replaces processes that end.

Workers are forked from a process that has imported everything, so they share its memory and start quickly.
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

from exercises.authoring.assignments.catalogue import assignments
from service.sandbox.guest.confinement.lockdown import die_with_parent
from service.settings import Settings
from service.workers.worker import work

log = logging.getLogger(__name__)
SHORT_LIFE_S, LONGEST_PAUSE_S = 3.0, 5.0
STOPS = (signal.SIGTERM, signal.SIGINT)
SETTLE_S = 5.0  # added to the drain time
# objects between garbage collections, which otherwise take a tenth of a grading's time on the host
MOST_YOUNG = 50_000
NICENESS = 10  # workers and guests yield to the web server and the database


class WorkerPool:
    """``settings.workers`` processes that take jobs from ``settings.database_url``."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._fork = multiprocessing.get_context("fork")
        self._stopping = False

    def run(self) -> int:
        """Keep all workers running until SIGTERM or SIGINT, then let them drain. Return the exit status."""
        for signal_number in STOPS:
            signal.signal(signal_number, self._stop)
        os.nice(NICENESS)
        assignments()  # listed once, for all workers; each loads what it grades
        gc.freeze()  # keeps imported modules in shared pages
        gc.set_threshold(MOST_YOUNG)
        workers = [_WorkerProcess(number) for number in range(self._settings.workers)]
        while not self._stopping:
            for worker in workers:
                worker.ensure_running(self._start)
            wait([worker.process.sentinel for worker in workers if worker.process], timeout=0.2)
        for worker in workers:
            if worker.process and worker.process.pid:
                os.kill(worker.process.pid, signal.SIGTERM)
        until = time.monotonic() + self._settings.drain + SETTLE_S
        for worker in workers:
            if worker.process:
                worker.process.join(max(0.0, until - time.monotonic()))
                worker.process.kill()
        return 0

    def _stop(self, signum: int, frame: object) -> None:
        self._stopping = True

    def _start(self, number: int) -> BaseProcess:
        process = self._fork.Process(
            target=_work, args=(self._settings, os.getpid(), number), name=f"worker {number}"
        )
        signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)  # until the new process has set its own handlers
        try:
            process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
        return process


class _WorkerProcess:
    """One worker of the pool. The pause before a restart grows while processes end soon after their start."""

    def __init__(self, number: int) -> None:
        self._number, self._since, self._early_ends, self._not_before = number, 0.0, 0, 0.0
        self.process: BaseProcess | None = None

    def ensure_running(self, start) -> None:  # type: ignore[no-untyped-def]
        now = time.monotonic()
        if self.process is not None and not self.process.is_alive():
            log.warning("%s exited with code %s; restarting it", self.process.name, self.process.exitcode)
            self._early_ends = self._early_ends + 1 if now - self._since < SHORT_LIFE_S else 0
            self._not_before = now + (
                min(LONGEST_PAUSE_S, 0.1 * 2**self._early_ends) if self._early_ends else 0.0
            )
            self.process.close()
            self.process = None
        if self.process is None and now >= self._not_before:
            self.process, self._since = start(self._number), now


def _work(settings: Settings, parent: int, number: int) -> None:
    die_with_parent(parent)
    for signal_number in STOPS:
        signal.signal(signal_number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
    # The first of several workers is kept for what is not known to be slow.
    work(settings, f"{socket.gethostname()}/{os.getpid()}", slow=number > 0 or settings.workers == 1)
