"""A real JupyterHub as its own process on loopback, without its proxy from npm and without notebook servers:
its database, its REST API, its tokens and scopes are all there. A person's server is only written down: what
a kernel would find in its environment.
"""

import json
import os
import secrets
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

from service.cli.server.demo import free_port

# What the owner of a JupyterHub (4.0 or later) adds to jupyterhub_config.py so that kernels may hand in.
ADVISED = """\
c.JupyterHub.load_roles = [{"name": "user", "scopes": ["self", "access:services!service=polhode"]}]
c.Spawner.server_token_scopes = [
    "users:activity!user",
    "access:servers!server",
    "access:services!service=polhode",
]
"""

CONFIG = """
import asyncio, json, os, signal
from pathlib import Path
from jupyterhub.proxy import Proxy
from jupyterhub.spawner import Spawner

class NoProxy(Proxy):
    async def start(self):
        asyncio.get_running_loop().add_reader(0, self.alone)

    def alone(self):  # our input ends when whoever started us is gone, however it went
        asyncio.get_running_loop().remove_reader(0)
        os.kill(os.getpid(), signal.SIGTERM)

    async def add_route(self, routespec, target, data): pass
    async def delete_route(self, routespec): pass
    async def get_all_routes(self): return {}

class NoServer(Spawner):
    up = False

    async def start(self):
        Path(FOLDER, f"{self.user.escaped_name}.json").write_text(json.dumps(self.get_env()))
        self.up = True
        return "127.0.0.1", PORT  # the Hub itself answers when it looks whether the server is there

    async def poll(self): return None if self.up else 0
    async def stop(self, now=False): self.up = False

c.JupyterHub.proxy_class = NoProxy
c.JupyterHub.spawner_class = NoServer
c.JupyterHub.authenticator_class = "dummy"
c.JupyterHub.bind_url = c.JupyterHub.hub_bind_url = f"http://127.0.0.1:{PORT}"
c.JupyterHub.cookie_secret = os.urandom(32)
c.JupyterHub.db_url = f"sqlite:///{FOLDER}/hub.sqlite"
c.JupyterHub.log_level = "WARN"
c.JupyterHub.services = [
    {"name": "tests", "api_token": TOKEN},
    {"name": "polhode", "api_token": SERVICE_TOKEN},
]
c.JupyterHub.load_roles = [
    *c.JupyterHub.get("load_roles", []),
    {"name": "tests", "services": ["tests"], "scopes": ["admin:users", "admin:servers", "tokens"]},
    {"name": "robots", "services": ["polhode"], "scopes": ["access:services!service=polhode"]},
]
"""


class Hub:
    """JupyterHub with ``advised`` in its configuration; it ends with this process."""

    def __init__(self, folder: Path, advised: str = ADVISED) -> None:
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        self.api_url = f"{self.url}/hub/api"
        # of the service called polhode; of ours
        self.service_token, self._token = (
            secrets.token_hex(16),
            secrets.token_hex(16),
        )
        self._folder = folder.absolute()
        own = {
            "PORT": port,
            "FOLDER": str(self._folder),
            "TOKEN": self._token,
            "SERVICE_TOKEN": self.service_token,
        }
        values = [f"{name} = {value!r}" for name, value in own.items()]
        (folder / "jupyterhub_config.py").write_text("\n".join([advised, *values, CONFIG]))
        # does without; it takes 1.5 s to import
        (folder / "rfc3987_syntax.py").write_text("raise ImportError\n")
        self.start()

    def start(self) -> None:
        """Start it, also again with what it had stored; ``stop()`` ended all servers, and their tokens with
        them.
        """
        command = [sys.executable, "-m", "jupyterhub", "-f", "jupyterhub_config.py"]
        own = {name: value for name, value in os.environ.items() if not name.startswith("JUPYTERHUB_")}
        with (self._folder / "hub.log").open("ab") as log:
            self.process = subprocess.Popen(
                command, cwd=self._folder, env=own, stdin=subprocess.PIPE, stdout=log, stderr=log
            )
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                return urllib.request.urlopen(f"{self.api_url}/", timeout=5).close()
            except OSError:
                time.sleep(0.05)
        self.stop()
        raise AssertionError(f"no JupyterHub: {(self._folder / 'hub.log').read_text()[-2000:]}")

    def stop(self, how: signal.Signals = signal.SIGTERM) -> int:
        if self.process.poll() is None:
            self.process.send_signal(how)
        with self.process.stdin:
            return self.process.wait(30)

    def kernel(self, person: str) -> dict[str, str]:
        """What a kernel of the person finds in its environment,
        their server being started where it was not.
        """
        self._must("POST", f"/users/{_quoted(person)}", {201, 409})
        self._must("POST", f"/users/{_quoted(person)}/server", {201, 400})
        return json.loads((self._folder / f"{_quoted(person)}.json").read_text())

    def end_server(self, person: str) -> None:
        self._must("DELETE", f"/users/{_quoted(person)}/server", {204})

    def token_of(self, person: str, *scopes: str, **more: object) -> str:
        """The token of the person's kernels; with scopes a new one of just these, e.g. ``inherit``, or
        ``expires_in=1`` s.
        """
        if not scopes:
            return self.kernel(person)["JUPYTERHUB_API_TOKEN"]
        self._must("POST", f"/users/{_quoted(person)}", {201, 409})
        return self._must("POST", f"/users/{_quoted(person)}/tokens", {201}, {"scopes": scopes, **more})[
            "token"
        ]

    def revoke(self, token: str) -> None:
        whose = self.call("GET", "/user", token)[1]
        self._must("DELETE", f"/users/{_quoted(whose['name'])}/tokens/{whose['token_id']}", {204})

    def call(self, method: str, path: str, token: str, body: object = None) -> tuple[int, dict]:
        """Status and document of a request to the Hub's REST API."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self.api_url + path, data, {"Authorization": f"token {token}"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, json.loads(answer.read() or b"{}")
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.loads(error.read() or b"{}")

    def _must(self, method: str, path: str, fine: set[int], body: object = None) -> dict:
        status, document = self.call(method, path, self._token, body)
        assert status in fine, (method, path, status, document)
        return document


def _quoted(name: str) -> str:
    return urllib.parse.quote(name, safe="@!~")
