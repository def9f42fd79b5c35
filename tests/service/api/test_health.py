"""What the server says of itself: alive, ready, and why nothing can be graded."""

import contextlib
import json
import subprocess
import time

import pytest

from service.api.health import CACHED_S
from service.store.database import Database
from service.store.postgres.server import EmbeddedPostgres
from service.store.queue import workers
from service.store.schema import migrate
from tests.support.app import App
from tests.support.database import run, sql
from tests.support.http_client import call, post

REFUSAL = "POLHODE_MIN_ISOLATION is namespaces, but namespaces are not available"


def test_where_no_worker_has_a_sandbox_no_submission_is_taken_and_everything_says_why(new_app, database_url):
    app = new_app(database_url=database_url, identity="local")
    run(database_url, lambda database: workers.register_worker(database, "w1", None, REFUSAL))
    status, _, body = call(app, "/readyz")
    assert (status, json.loads(body)["checks"]) == (
        503,
        {"isolation": REFUSAL, "database": "ok"},
    )
    status, _, body = post(app, {"source": "x = 1"})
    problem = json.loads(body)
    assert (
        status == 503 and problem["type"] == "urn:polhode:problem:no-walls" and REFUSAL in problem["detail"]
    )
    assert call(app, "/livez")[0] == call(app, "/v1/assignments")[0] == 200


def test_missing_tables_are_an_outage_that_is_logged_once(new_app, database_url):
    app = new_app(database_url=database_url, identity="local")
    sql(database_url, "DROP TABLE token CASCADE")
    sql(database_url, "DROP TABLE submission CASCADE")
    for _ in range(3):
        status, headers, body = post(app, {"source": "x = 1"})
        problem = json.loads(body)
        assert (status, problem["type"]) == (503, "urn:polhode:problem:database-lost"), problem
        assert int(headers["retry-after"]) > 0 and "keep your work" in problem["detail"]
    assert call(app, "/v1/submissions/6f3ad1a8-7d2c-4f0f-8f5e-0a3f4e7d5c11")[0] == 503
    status, _, body = call(app, "/readyz")
    assert (status, json.loads(body)["checks"]["database"]) == (
        503,
        "lost: tables are missing: submission, token",
    )
    assert app.log.read_text().count("database unavailable") == 1 and "Traceback" not in app.log.read_text()


def test_what_was_written_into_a_lost_folder_is_not_accepted(new_app, database_url):
    """The folder is missing as soon as the submission is in it."""
    app, stored = new_app(database_url=database_url, identity="local"), "SELECT id FROM submission"
    app.state.held[Database]._find_loss = lambda: "postgres is missing" if sql(database_url, stored) else None
    status, _, body = post(app, {"source": "x = 1"})
    assert status == 503 and json.loads(body)["type"] == "urn:polhode:problem:database-lost"
    assert sql(database_url, "SELECT count(*) FROM submission") == [(1,)], "it was committed"
    assert json.loads(call(app, "/readyz")[2])["checks"]["database"] == "lost: postgres is missing"


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a small file system of its own."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounting = ["mount", "-t", "tmpfs", "-o", "size=160m", "tmpfs", str(folder)]
    if subprocess.run(mounting, capture_output=True).returncode:
        pytest.skip("needs the permission to mount a file system")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


@pytest.fixture
def full_server(small_disk):
    """An application whose database is on the small disk."""
    postgres = EmbeddedPostgres(small_disk / "data")
    postgres.start()
    try:
        migrate(postgres.url)
        app = App(database_url=postgres.url, identity="local")
        yield app, postgres.url
        app.stop()
    finally:
        postgres.stop()


@pytest.mark.slow
def test_a_server_whose_database_has_a_full_disk_is_not_ready(full_server, small_disk):
    app, url = full_server

    def ready():
        run(url, lambda database: workers.register_worker(database, "w1", "process", None))
        return seen()

    def seen():
        time.sleep(1.1 * CACHED_S)
        status, _, body = call(app, "/readyz")
        return status, json.loads(body)["checks"]["database"]

    assert ready() == (200, "ok")
    filler = small_disk / "filler"
    with contextlib.suppress(OSError), filler.open("wb", buffering=0) as stream:
        while True:
            stream.write(bytes(4096))
    assert seen() == (503, "its disk is full, so no submission is accepted: free some space")
    large = "# " + "0123456789abcdef" * 12_000
    assert post(app, {"source": large})[0] == 503
    filler.unlink()
    assert ready() == (200, "ok")
    assert post(app, {"source": "x = 1"})[0] == 202
