"""Fixtures that every test may use: a sandbox, an embedded database, a real server, the kit, a JupyterHub."""

import re
import shutil
import sys
import time

import pytest
from hypothesis import HealthCheck, settings

from exercises.authoring.assignments.catalogue import find
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox
from service.store.postgres.server import EmbeddedPostgres
from service.store.queue.workers import LEASE_S
from service.store.schema import migrate
from tests.support.database import connections_left, new_database, sql
from tests.support.hub import Hub
from tests.support.kit import installed
from tests.support.server import Server

# Files that take longest begin first, so that the short ones fill what is left where several processes share
# the files.
LONGEST = (
    "test_attacks",
    "test_samples",
    "test_notebooks",
    "test_submissions",
    "physics",
    "test_workers",
    "test_outage",
    "test_chaos",
    "test_machines",
    "test_sandbox",
    "test_grade",
    "test_pages",
    "test_accessible",
    "test_dashboard",
    "test_gradescope_export",
    "test_session",
)


# Files that one process runs: numba compiles for it only once, one real server is started.
TOGETHER = {
    "physics": r"^tests/reference/",
    "real server": (
        r"/(api/test_submissions|api/test_parse_submission|cli/server/test_serve|test_notebooks|test_demo)\.py$"
    ),
}

# jsonschema's optional check of IRIs compiles a grammar for three seconds in each process that imports
# nbformat.
sys.modules["rfc3987_syntax"] = None

# How many examples Hypothesis makes: some in ``make test``, more where the slow tests run too.
for profile, examples in (("some", 25), ("many", 100)):
    settings.register_profile(
        profile, max_examples=examples, deadline=None, suppress_health_check=[HealthCheck.too_slow]
    )


def pytest_configure(config):
    settings.load_profile("some" if "not slow" in config.option.markexpr else "many")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    rank = {name: k for k, name in enumerate(LONGEST)}
    items.sort(
        key=lambda item: rank.get(
            "physics" if "reference" in item.path.parts else item.path.stem, len(LONGEST)
        )
    )


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Share whole files among the processes, and the families of attacks."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file, _, test = nodeid.partition("::")
            if family := re.match(r"test_attack\[\w+-([a-z]+)_", test):
                return f"{file}::{family[1]}"
            return next((together for together, files in TOGETHER.items() if re.search(files, file)), file)

    return ByFile(config, log)


@pytest.fixture(scope="session")
def rigid_body():
    return find("rigid-body")


@pytest.fixture(scope="session")
def sandbox():
    """A sandbox at isolation level ``namespaces``, as a server has it where it can."""
    yield from _self_tested(Sandbox(choose("namespaces")))


@pytest.fixture(scope="session", params=["namespaces", "process"])
def either_sandbox(request, sandbox):
    """Each of the two isolation levels in turn."""
    if request.param == "namespaces":
        yield sandbox
        return
    yield from _self_tested(Sandbox(process_isolation()))


def _self_tested(sandbox):
    sandbox.self_test()
    yield sandbox
    sandbox.close()


@pytest.fixture(scope="module")
def new_server():
    """Start servers on any data folder; all of them are stopped at the end of the file."""
    servers = []

    def start(data, path="/readyz", port=None, **environment):
        servers.append(Server(data, port=port, **environment))
        return servers[-1].wait_ready(path)

    yield start
    for server in servers:
        server.stop()


@pytest.fixture(scope="session")
def left_connections():
    """By the address of each running test database: the process ids of the connections that tests left open
    there.
    """
    return {}


@pytest.fixture(scope="module", autouse=True)
def no_connection_stays(left_connections):
    """Fail at the end of a file whose tests leave connections open: its database allows only so many to the
    whole run.
    """
    yield
    for address, reported in left_connections.items():
        left = connections_left(address, reported)
        reported.update(left)
        assert not left, (
            f"connections that a fixture or a test of this file must close: {', '.join(left.values())}"
        )


@pytest.fixture(scope="session")
def postgres(tmp_path_factory, left_connections):
    """A running embedded PostgreSQL with the tables of this version in a template, up for longer than a lease
    lasts.
    """
    running = EmbeddedPostgres(tmp_path_factory.mktemp("postgres") / "data")
    running.start()
    # before, nothing is lost: a lease begins anew with the database
    up_for_a_lease = time.monotonic() + LEASE_S + 0.1
    # what is lost with the machine is lost with the test
    for setting in (
        "fsync",
        "full_page_writes",
        "synchronous_commit",
    ):
        sql(running.url, f"ALTER SYSTEM SET {setting} = off")
    sql(running.url, "SELECT pg_reload_conf()")
    migrate(running.url)
    # tests are of assignments that students see, but for those of drafts
    sql(running.url, "ALTER TABLE assignment ALTER COLUMN published SET DEFAULT true")
    time.sleep(max(0.0, up_for_a_lease - time.monotonic()))
    left_connections[running.url] = set()
    yield running
    left_connections.clear()
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
def real_server(tmp_path_factory):
    """``polhode serve`` as its own process with workers and an embedded database; everybody is one local
    student.
    """
    data = tmp_path_factory.mktemp("data") / "polhode"
    started = Server(data, POLHODE_LOG_LEVEL="debug", POLHODE_WORKERS="1")
    try:
        yield started.wait_ready()
    finally:
        # before its folder goes: with the number of its database in there it could not end that
        started.stop()
    shutil.rmtree(data, ignore_errors=True)


@pytest.fixture(scope="session")
def server(real_server):
    return real_server


@pytest.fixture(scope="session")
def kit(tmp_path_factory):
    """The folder that holds the students' kit as its wheel installs it, beside its cache with rigid-body."""
    return installed(tmp_path_factory.mktemp("kit"), "rigid-body")


@pytest.fixture(scope="session")
def hub(tmp_path_factory):
    """A JupyterHub whose kernels' tokens may come to us."""
    started = Hub(tmp_path_factory.mktemp("hub"))
    yield started
    started.stop()
