"""Shared fixtures: a sandbox behind real walls, and one real server for the tests that talk HTTP."""

import io
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.request
import zipfile
from pathlib import Path

import pytest

from exercises.assignment import assignments
from exercises.wheel import wheel
from service.demo import free_port
from service.sandbox.choose import choose
from service.sandbox.sandbox import Sandbox
from service.sandbox.tier_b import tier_b
from service.store.migrate import migrate
from service.store.postgres import EmbeddedPostgres
from service.store.rescue import LEASE_S
from tests.hub import Hub
from tests.stored import new_database

# Long files, most of which wait: begun first, so that the many short ones fill what is left where processes share the work.
FIRST = (
    "test_http",
    "test_outage",
    "test_attacks",
    "test_workers",
    "test_notebooks",
    "test_chaos",
    "test_machines",
    "test_sandbox",
    "test_autograder",
)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    rank = {name: k for k, name in enumerate(FIRST)}
    items.sort(key=lambda item: rank.get(item.path.stem, len(FIRST)))


@pytest.fixture(scope="session")
def rigid_body():
    return assignments()["rigid-body"]


@pytest.fixture(scope="session")
def sandbox():
    """Behind tier A, as a server has it where it can."""
    sandbox = Sandbox(choose("A"))
    sandbox.rehearse()
    yield sandbox
    sandbox.close()


@pytest.fixture(scope="session", params=["A", "B"])
def either_sandbox(request, sandbox):
    """Each of the two tiers in turn."""
    if request.param == "A":
        yield sandbox
        return
    bare = Sandbox(tier_b())
    bare.rehearse()
    yield bare
    bare.close()


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


@pytest.fixture(scope="session")
def new_server():
    """Start servers on any data folder; all of them are stopped at the end."""
    servers = []

    def start(data: Path, path: str = "/readyz", port: int | None = None, **environment: str) -> Server:
        servers.append(Server(data, port=port, **environment))
        return servers[-1].wait_ready(path)

    yield start
    for server in servers:
        server.stop()


@pytest.fixture(scope="session")
def postgres(tmp_path_factory):
    """A running embedded PostgreSQL with the tables of this version in a template, up for longer than a lease lasts."""
    running = EmbeddedPostgres(tmp_path_factory.mktemp("postgres") / "data")
    running.start()
    up_for_a_lease = time.monotonic() + LEASE_S + 0.1  # before, nothing is lost: a lease begins anew with the database
    migrate(running.url)
    time.sleep(max(0.0, up_for_a_lease - time.monotonic()))
    yield running
    running.stop()


@pytest.fixture
def database_url(postgres):
    """A new database with this version's tables."""
    return new_database(postgres.url, "polhode")


@pytest.fixture(scope="module")
def url(postgres):
    """Address of a database for all tests of a file."""
    return new_database(postgres.url, "polhode")


@pytest.fixture
def empty_url(postgres):
    """A new database with nothing in it."""
    return new_database(postgres.url, "template1")


@pytest.fixture(scope="session")
def server(tmp_path_factory, new_server):
    data = tmp_path_factory.mktemp("data") / "polhode"
    started = new_server(data)
    yield started
    started.stop()  # before its folder goes: with the number of its database in there it could not end that
    shutil.rmtree(data, ignore_errors=True)


@pytest.fixture(scope="session")
def kit(tmp_path_factory):
    """The folder that holds the students' kit as its wheel installs it."""
    folder = tmp_path_factory.mktemp("kit")
    with zipfile.ZipFile(io.BytesIO(wheel())) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="session")
def hub(tmp_path_factory):
    """A JupyterHub whose kernels' tokens may come to us."""
    started = Hub(tmp_path_factory.mktemp("hub"))
    yield started
    started.stop()
