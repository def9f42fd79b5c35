"""Start ``polhode serve`` for tests that talk HTTP."""

import os
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

from service.demo import free_port


class Server:
    """``polhode serve`` as its own process on a free loopback port."""

    def __init__(self, data: Path, *, port: int | None = None, **environment: str) -> None:
        self.port = port or free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.log = data.parent / f"serve-{self.port}.log"
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "service.cli", "serve", "--port", str(self.port)],
                env=os.environ | {"POLHODE_DATA": str(data)} | environment,
                stdout=log,
                stderr=log,
            )

    def wait_ready(self, path: str = "/readyz") -> "Server":
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                urllib.request.urlopen(f"{self.url}{path}", timeout=5).close()
                return self
            except OSError:
                time.sleep(0.1)
        raise AssertionError(f"no server: {self.log.read_text()[-2000:]}")

    def stop(self, how: signal.Signals = signal.SIGTERM) -> int:
        if self.process.poll() is None:
            self.process.send_signal(how)
        return self.process.wait(30)
