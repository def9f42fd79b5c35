"""Start ``polhode serve`` for tests that talk HTTP, or only its web application, in a thread."""

import os
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

import uvicorn

from service.app import create_app
from service.cli.server.demo import free_port
from service.settings import Settings


class Server:
    """``polhode serve`` as its own process on a free loopback port, with ``rigid-body`` unless
    ``environment`` names others.
    """

    def __init__(self, data: Path, *, port: int | None = None, **environment: str) -> None:
        self.data, self.port = data, port or free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.log, self.out = (data.parent / f"serve-{self.port}.{name}" for name in ("log", "out"))
        course = {} if "POLHODE_ASSIGNMENTS" in environment else {"POLHODE_COURSE": "rigid-body"}
        with self.log.open("wb") as log, self.out.open("wb") as out:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "service.cli", "serve", "--port", str(self.port)],
                env=os.environ | course | {"POLHODE_DATA": str(data)} | environment,
                stdout=out,
                stderr=log,
            )

    def wait_ready(self, path: str = "/readyz") -> "Server":
        deadline = time.monotonic() + 240
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                urllib.request.urlopen(f"{self.url}{path}", timeout=5).close()
                return self
            except OSError as error:
                if isinstance(error, urllib.error.HTTPError):
                    error.close()
                time.sleep(0.1)
        raise AssertionError(f"no server: {self.log.read_text()[-2000:]}")

    def stop(self, how: signal.Signals = signal.SIGTERM) -> int:
        if self.process.poll() is None:
            self.process.send_signal(how)
        return self.process.wait(30)


class WebApplication:
    """Pages and API in a thread of this process, on a database that is there; whoever grades is elsewhere."""

    def __init__(self, database_url: str, **settings) -> None:
        app = create_app(Settings(database_url=database_url, workers=0, **settings))
        self._server = uvicorn.Server(
            uvicorn.Config(app, port=free_port(), log_config=None, timeout_graceful_shutdown=2)
        )
        self._thread = threading.Thread(target=self._server.run)
        self.url = f"http://127.0.0.1:{self._server.config.port}"

    def __enter__(self) -> "WebApplication":
        self._thread.start()
        while not self._server.started:
            assert self._thread.is_alive(), "the application did not start"
            time.sleep(0.02)
        return self

    def __exit__(self, *error) -> None:
        self._server.should_exit = True
        self._thread.join()
