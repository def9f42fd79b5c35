"""The web application in the test process: the server that ``polhode serve`` runs, without a database or
workers of its own.
"""

import asyncio
import logging
import signal
import tempfile
import threading
import time
from pathlib import Path

from service import logs
from service.cli.server.http_server import http_server
from service.cli.server.serve import open_socket
from service.settings import Settings


class App:
    """A server in a thread on a free loopback port; ``settings`` are fields of Settings, ``database_url``
    among them.
    """

    def __init__(self, **settings):
        self.settings = Settings(**{"identity": "token", "port": 0} | settings)
        self._socket = open_socket(self.settings)
        self.port = self._socket.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self._server = http_server(self.settings)
        self._folder = tempfile.TemporaryDirectory(prefix="polhode-app-")
        self.log = Path(self._folder.name, "serve.log")
        self._lines = self.log.open("w")
        self._handler = logs.handler(self._lines)
        self._level = logging.root.level
        logging.root.addHandler(self._handler)
        logging.root.setLevel(
            min(self._level, logging.getLevelNamesMapping()[self.settings.log_level.upper()])
        )
        self._thread = threading.Thread(target=self._run, name="polhode app", daemon=True)
        self._thread.start()
        deadline = time.monotonic() + 60
        while not self._server.started:
            assert self._thread.is_alive() and time.monotonic() < deadline, (
                f"no application: {self.log.read_text()[-2000:]}"
            )
            time.sleep(0.005)

    @property
    def state(self):
        """The state of the running application."""
        return self._server.config.app.state

    def _run(self):
        async def main():
            self._loop = asyncio.get_running_loop()
            await self._server.serve(sockets=[self._socket])

        asyncio.run(main())

    def stop(self):
        """Stop as at SIGTERM."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._server.handle_exit, signal.SIGTERM, None)
            self._thread.join(30)
            assert not self._thread.is_alive()
        self._socket.close()
        logging.root.removeHandler(self._handler)
        logging.root.setLevel(self._level)
        self._lines.close()
        self._folder.cleanup()
