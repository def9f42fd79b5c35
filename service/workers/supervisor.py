"""What a server keeps running beside itself: the embedded database and a crew of workers, started again when they are gone."""

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
LOOK_S, LONGEST_PAUSE_S = 0.2, 5.0


class Supervisor(threading.Thread):
    """One thread starts, watches and stops them, as a child may be told by the kernel to end with the thread that started it."""

    def __init__(self, settings: Settings) -> None:
        super().__init__(name="keeper")
        self._settings = settings
        self._database = None
        if settings.database_url is None:
            self._database = EmbeddedPostgres(settings.data, settings.postgres, settings.workers)
        self.url = settings.database_url or (self._database.url if self._database else "")
        self._crew: subprocess.Popen[bytes] | None = None
        self._ready, self._leaving = threading.Event(), threading.Event()
        self._failure: Exception | None = None

    def begin(self) -> None:
        """Return when the database answers and its tables are up to date. Raises DatabaseUnavailable."""
        self.start()
        self._ready.wait()
        if self._failure is not None:
            raise self._failure

    def stop(self) -> None:
        """Stop the workers, then the database; return when they are gone."""
        self._leaving.set()
        if self.is_alive():
            self.join()

    def run(self) -> None:
        """The thread's life."""
        try:
            if self._database is not None:
                self._database.start()
            migrate(self.url)
        except Exception as error:
            self._failure = error
            self._leaving.set()
        self._ready.set()
        try:
            self._watch()
        finally:
            self._end_crew()
            if self._database is not None:
                self._database.stop()

    def _watch(self) -> None:
        pause, not_before = LOOK_S, 0.0
        while not self._leaving.wait(LOOK_S):
            if time.monotonic() < not_before:
                continue
            try:
                if self._database is not None and not self._database.alive:
                    log.error("the database ended: it is started again")
                    self._database.restart()
                if self._settings.workers and (self._crew is None or self._crew.poll() is not None):
                    self._crew = self._start_crew()
                pause = LOOK_S
            except Exception:
                log.exception("not started again yet")
                pause = min(2 * pause, LONGEST_PAUSE_S)
                not_before = time.monotonic() + pause

    def _start_crew(self) -> "subprocess.Popen[bytes]":
        environment = os.environ | {"POLHODE_DATABASE_URL": self.url, "POLHODE_LOG_LEVEL": self._settings.log_level}
        command = [sys.executable, "-m", "service.cli", "worker", "--with-parent", str(os.getpid())]
        return subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL)

    def _end_crew(self) -> None:
        if self._crew is None or self._crew.poll() is not None:
            return
        self._crew.terminate()
        try:
            self._crew.wait(self._settings.drain + 10)
        except subprocess.TimeoutExpired:
            self._crew.kill()
            self._crew.wait()
