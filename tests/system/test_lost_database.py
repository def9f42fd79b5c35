"""The folder of a running server's database goes: what students see, and how an operator gets the course
back.
"""

import json
import os
import shutil
import subprocess
import sys

import pytest

from tests.support.database import sql
from tests.support.http_client import call, post
from tests.support.server import Server
from tests.support.waiting import wait_for

pytestmark = pytest.mark.slow  # three servers with databases of their own

RIGHT = {"source": "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n", "exercises": ["2"]}


def submit(server):
    status, _, body = post(server, RIGHT)
    return status, json.loads(body)


def graded(server, id):
    return json.loads(call(server, f"/v1/submissions/{id}")[2]).get("status") == "graded"


def refuses(server, reason):
    """No submission is accepted from now on, and the server says why."""
    status, problem = submit(server)
    assert (status, problem["type"]) == (503, "urn:polhode:problem:database-lost"), (
        "nothing is accepted into deleted files"
    )
    assert "keep your work" in problem["detail"]
    status, _, body = call(server, "/readyz")
    assert (status, json.loads(body)["checks"]["database"]) == (503, f"lost: {reason}")
    status, _, page = call(server, "/", Accept="text/html")
    assert status == 503 and b"keep your work" in page and call(server, "/livez")[0] == 200


def stopped(server):
    """Whether the server has stopped its database."""
    return (
        "the database is stopped" in server.log.read_text()
        and not (server.data / "run" / ".s.PGSQL.5432").exists()
    )


def command(server, *arguments):
    return subprocess.run(
        [sys.executable, "-m", "service.cli", *arguments],
        env=os.environ | {"POLHODE_DATA": str(server.data)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_lost_folder(new_server, tmp_path):
    data = tmp_path / "data"
    server = new_server(data, POLHODE_WORKERS="1")
    id = submit(server)[1]["id"]
    wait_for(lambda: graded(server, id))
    assert command(server, "db", "backup", str(tmp_path / "b.dump")).returncode == 0

    (data / "postgres").rename(tmp_path / "away")  # as if its volume were unmounted
    refuses(server, "postgres is missing")
    wait_for(lambda: stopped(server))
    refuses(server, "postgres is missing")
    assert not (data / "postgres").exists()
    (tmp_path / "away").rename(data / "postgres")
    wait_for(lambda: call(server, "/readyz")[0] == 200)
    assert graded(server, id), "nothing is lost"
    other = submit(server)[1]["id"]
    wait_for(lambda: graded(server, other))

    shutil.rmtree(data / "postgres", ignore_errors=True)
    refuses(server, "postgres is missing")
    assert server.stop() == 0
    again = Server(data, POLHODE_WORKERS="1")
    assert again.process.wait(30) == 2
    assert "existed before" in again.log.read_text() and "Traceback" not in again.log.read_text()
    restored = command(server, "db", "restore", str(tmp_path / "b.dump"))
    assert restored.returncode == 0, restored.stderr
    server = new_server(data, POLHODE_WORKERS="1")
    assert graded(server, id) and call(server, f"/v1/submissions/{other}")[0] == 404, "as in the backup"
    url = f"postgresql://polhode@/polhode?host={data / 'run'}"
    assert sql(url, "SELECT count(*) FROM submission") == [(1,)]


def test_the_data_folder_goes_with_everything_in_it(new_server, tmp_path):
    data = tmp_path / "data"
    server = new_server(data, "/livez", POLHODE_WORKERS="0")
    data.rename(tmp_path / "away")
    refuses(server, "postgres is missing")
    assert server.stop() == 0
    again = Server(data, POLHODE_WORKERS="0")
    assert again.process.wait(30) == 2 and "existed before" in again.log.read_text()
    assert not (data / "postgres").exists()
