"""Run the embedded database and the worker pool of a server, and restart them when they end."""

import logging
import os
import subprocess
import sys
import threading
import time

from service.settings import Settings
from service.store.postgres.server import EmbeddedPostgres
from service.store.schema import migrate

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
        self._lost = False  # the database's folder, until the same folder is back
        self._ready, self._stopping = threading.Event(), threading.Event()
        self._failure: Exception | None = None

    def wait_until_ready(self) -> None:
        """Return once the database answers and its tables are up to date.

        Raises DatabaseUnavailable.
        """
        self._ready.wait()
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """Stop the workers, then the database, and return once both have ended."""
        self._stopping.set()
        if self.is_alive():
            self.join()

    def find_loss(self) -> str | None:
        """Return what is wrong with the folder of the embedded database, or None. May be called from any
        thread.
        """
        return self._database.find_loss() if self._database is not None else None

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
                if self._database is not None:
                    self._keep_running(self._database)
                if self._settings.workers and (self._pool is None or self._pool.poll() is not None):
                    self._pool = self._start_pool()
                pause = POLL_S
            except Exception:
                log.exception("could not restart; trying again in at most %g s", LONGEST_PAUSE_S)
                pause = min(2 * pause, LONGEST_PAUSE_S)
                not_before = time.monotonic() + pause

    def _keep_running(self, database: EmbeddedPostgres) -> None:
        """Restart the database if it has stopped, and stop it while its folder is missing."""
        if not self._lost and (loss := database.find_loss()):
            self._lost = True
            log.critical(
                "the database is stopped and no submission is accepted, because in the folder %s %s: put the"
                " same folder back and polhode continues; otherwise stop polhode, restore a backup with"
                " polhode db restore FILE, and start polhode again",
                self._settings.data.absolute(),
                loss,
            )
            database.end()
        elif self._lost and database.unchanged():
            log.error("the folder of the database is back; starting the database")
            database.restart()
            self._lost = False
        elif not self._lost and not database.alive:
            log.error("the embedded database stopped unexpectedly; restarting it")
            database.restart()

    def _start_pool(self) -> "subprocess.Popen[bytes]":
        environment = os.environ | {
            "POLHODE_DATABASE_URL": self.url,
            "POLHODE_LOG_LEVEL": self._settings.log_level,
        }
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
