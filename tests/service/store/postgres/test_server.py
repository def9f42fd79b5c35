"""The embedded database: a socket and no port, one owner, survives a kill, tells why it cannot start."""

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import psycopg
import pytest

from service.store.postgres import server
from service.store.postgres.os_user import DatabaseUnavailable
from service.store.postgres.server import EmbeddedPostgres


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return tmp_path_factory.mktemp("pg") / "data"


def query(database, statement):
    with psycopg.connect(database.url) as connection:
        return connection.execute(statement).fetchone()[0]


def test_start_stop_start_keeps_what_was_written(data):
    database = EmbeddedPostgres(data)
    database.start()
    with psycopg.connect(database.url) as connection:
        connection.execute("CREATE TABLE kept AS SELECT 42 AS answer")
    assert query(database, "SHOW listen_addresses") == ""
    assert stat.S_IMODE(data.stat().st_mode) == 0o700
    with pytest.raises(DatabaseUnavailable, match="another polhode"):
        EmbeddedPostgres(data).start()
    database.stop()
    database.start()
    assert query(database, "SELECT answer FROM kept") == 42
    database.stop()


OWNER = """
import os, pathlib, psycopg, sys
from service.store.postgres.server import EmbeddedPostgres
database = EmbeddedPostgres(pathlib.Path(sys.argv[1]))
database.start()
psycopg.connect(database.url, autocommit=True).execute("UPDATE kept SET answer = answer + 1")
os.kill(os.getpid(), 9)
"""


def test_a_killed_owner_loses_nothing(data):
    pid = data / "postgres" / "postmaster.pid"
    assert subprocess.run([sys.executable, "-c", OWNER, str(data)], check=False).returncode == -signal.SIGKILL
    deadline = time.monotonic() + 5
    while os.geteuid() != 0 and pid.exists() and Path(f"/proc/{pid.read_text().split(chr(10))[0]}").exists():
        assert time.monotonic() < deadline, "PostgreSQL outlived its owner"
        time.sleep(0.05)
    database = EmbeddedPostgres(data)
    database.start()
    assert query(database, "SELECT answer FROM kept") == 43
    database.stop()


@pytest.mark.slow
def test_a_long_path_gets_its_socket_elsewhere(tmp_path):
    deep = tmp_path / ("d" * 60) / ("e" * 60)
    database = EmbeddedPostgres(deep)
    database.start()
    assert query(database, "SELECT 1") == 1
    socket_folder = Path(database.url.split("host=")[1])
    database.stop()
    assert not socket_folder.exists()


def test_any_folder_name_will_do(tmp_path):
    database = EmbeddedPostgres(tmp_path / "a b, c++, a%20b, ü")
    database.start()
    assert query(database, "SELECT 1") == 1
    database.stop()


def test_another_major_version_is_refused_with_a_reason(tmp_path):
    (tmp_path / "postgres").mkdir()
    (tmp_path / "postgres" / "PG_VERSION").write_text("9\n")
    with pytest.raises(DatabaseUnavailable, match="written by PostgreSQL 9"):
        EmbeddedPostgres(tmp_path).start()


def test_programs_that_fail_are_told(tmp_path):
    fake = tmp_path / "fake" / "bin"
    fake.mkdir(parents=True)
    for name in ("postgres", "initdb"):
        (fake / name).write_text("#!/bin/sh\necho 'no room left' >&2; exit 1\n")
        (fake / name).chmod(0o755)
    with pytest.raises(DatabaseUnavailable, match="no room left"):
        EmbeddedPostgres(tmp_path / "data", programs=fake).start()


@pytest.mark.slow
def test_any_installed_server_will_do(tmp_path):
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/postgres"))
    if not found:
        pytest.skip("no PostgreSQL from the system here")
    database = EmbeddedPostgres(tmp_path / "data", programs=found[0].parent)
    database.start()
    assert query(database, "SHOW server_version_num").startswith(found[0].parts[-3])
    database.stop()


def test_it_does_not_run_as_root(data):
    if os.geteuid() != 0:
        pytest.skip("not root")
    database = EmbeddedPostgres(data)
    database.start()
    pid = int((data / "postgres" / "postmaster.pid").read_text().split("\n")[0])
    assert Path(f"/proc/{pid}").stat().st_uid != 0
    database.stop()


def test_programs_are_found():
    assert (server.find_programs() / "postgres").exists()


@pytest.mark.slow
def test_a_process_that_has_got_the_number_of_a_dead_server_is_left_alone_and_in_nobodys_way(tmp_path):
    database = EmbeddedPostgres(tmp_path / "data")
    database.start()
    database.stop()
    log = tmp_path / "data" / "postgres.log"
    innocent = subprocess.Popen(["tail", "-f", str(log)], stdout=subprocess.DEVNULL)
    try:
        lines = [
            str(innocent.pid),
            str(tmp_path / "data" / "postgres"),
            "1700000000",
            "5432",
            str(tmp_path),
            "",
            "",
            "ready",
        ]
        (tmp_path / "data" / "postgres" / "postmaster.pid").write_text("\n".join(lines))
        database.start()
        assert query(database, "SELECT 1") == 1 and innocent.poll() is None
        database.stop()
    finally:
        innocent.kill()
        innocent.wait()
