"""Run the embedded database and the worker pool of a server, and restart them when they end."""

import logging
import os
import subprocess
import sys
import threading
import time

from service.settings import Settings
from service.store.database import migrate
from service.store.postgres.server import EmbeddedPostgres

log = logging.getLogger(__name__)
POLL_S, LONGEST_PAUSE_S = 0.2, 5.0


class Supervisor(threading.Thread):
    """A thread that starts, watches and stops child processes, as these may end with their thread."""

    def __init__(self, settings: Settings) -> None:
        super().__init__(name="supervisor")
        self._settings = settings
        self._database = None
        if settings.database_url is None:
            self._database = EmbeddedPostgres(settings.data, settings.postgres, settings.workers)
        self.url = settings.database_url or (self._database.url if self._database else "")
        self._pool: subprocess.Popen[bytes] | None = None
        self._ready, self._stopping = threading.Event(), threading.Event()
        self._failure: Exception | None = None

    def begin(self) -> None:
        """Start, and return once the database answers and its tables are up to date.

        Raises DatabaseUnavailable.
        """
        self.start()
        self._ready.wait()
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """Stop the workers, then the database, and return once both have ended."""
        self._stopping.set()
        if self.is_alive():
            self.join()

    def run(self) -> None:
        """Run the thread until ``stop``."""
        try:
            if self._database is not None:
                self._database.start()
            migrate(self.url)
        except Exception as error:
            self._failure = error
            self._stopping.set()
        self._ready.set()
        try:
            self._watch()
        finally:
            self._stop_pool()
            if self._database is not None:
                self._database.stop()

    def _watch(self) -> None:
        pause, not_before = POLL_S, 0.0
        while not self._stopping.wait(POLL_S):
            if time.monotonic() < not_before:
                continue
            try:
                if self._database is not None and not self._database.alive:
                    log.error("the embedded database stopped unexpectedly; restarting it")
                    self._database.restart()
                if self._settings.workers and (self._pool is None or self._pool.poll() is not None):
                    self._pool = self._start_pool()
                pause = POLL_S
            except Exception:
                log.exception("could not restart; trying again in at most %g s", LONGEST_PAUSE_S)
                pause = min(2 * pause, LONGEST_PAUSE_S)
                not_before = time.monotonic() + pause

    def _start_pool(self) -> "subprocess.Popen[bytes]":
        environment = os.environ | {"POLHODE_DATABASE_URL": self.url, "POLHODE_LOG_LEVEL": self._settings.log_level}
        command = [sys.executable, "-m", "service.cli", "worker", "--with-parent", str(os.getpid())]
        return subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL)

    def _stop_pool(self) -> None:
        if self._pool is None or self._pool.poll() is not None:
            return
        self._pool.terminate()
        try:
            self._pool.wait(self._settings.drain + 10)
        except subprocess.TimeoutExpired:
            self._pool.kill()
            self._pool.wait()
