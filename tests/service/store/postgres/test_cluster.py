"""The folder of the embedded database is lost: noticed while the server runs, and never taken for a first
start.
"""

import contextlib
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import psycopg
import pytest

from service.store.postgres import backup
from service.store.postgres.os_user import DatabaseUnavailable
from service.store.postgres.server import EmbeddedPostgres, find_programs
from service.store.schema import migrate
from service.store.submissions.accepting import accept
from tests.support.database import new, run, sql


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    """A running database whose table ``kept`` is not empty, in a folder ``data`` of its own."""
    database = EmbeddedPostgres(tmp_path_factory.mktemp("cluster") / "data")
    database.start()
    sql(database.url, "CREATE TABLE kept AS SELECT 42 AS answer")
    yield database
    database.stop()


@pytest.fixture
def data(database):
    """The data folder of the stopped database."""
    database.stop()
    yield Path(database.url.split("host=")[1]).parent
    database.stop()
    database.start()


def kept(database):
    return sql(database.url, "SELECT answer FROM kept") == [(42,)]


LOSSES = {
    "postgres is missing": "",
    "postgres/global/pg_control is missing": "global/pg_control",
    "postgres/base is missing": "base",
    "postgres/pg_wal is missing": "pg_wal",
}


def test_a_running_server_notices_each_loss_and_the_return(database, tmp_path):
    folder = Path(database.url.split("host=")[1]).with_name("postgres")
    ((oid,),) = sql(database.url, "SELECT oid::int8 FROM pg_database WHERE datname = 'polhode'")
    assert database.find_loss() is None and database.unchanged()
    for sentence, path in (LOSSES | {f"postgres/base/{oid} is missing": f"base/{oid}"}).items():
        (folder / path).rename(tmp_path / "away")
        assert database.find_loss() == sentence and not database.unchanged()
        (tmp_path / "away").rename(folder / path)
        assert database.find_loss() is None and database.unchanged()
    (folder / "PG_VERSION").rename(tmp_path / "away")
    assert database.find_loss() == "postgres/PG_VERSION is missing"
    (tmp_path / "away").rename(folder / "PG_VERSION")
    # it could be a copy, whose other files follow
    assert database.find_loss() is None and not database.unchanged()
    folder.chmod(0o000)
    assert "cannot be read" in database.find_loss()
    folder.chmod(0o700)
    database.stop()
    database.start()
    folder.rename(tmp_path / "away")
    shutil.copytree(tmp_path / "away", folder, ignore=shutil.ignore_patterns("postmaster.pid"))
    assert database.find_loss() == "postgres is another folder than the one in use"
    assert not database.unchanged(), "a copy may still be growing"
    shutil.rmtree(folder)
    (tmp_path / "away").rename(folder)
    assert database.find_loss() is None and database.unchanged() and kept(database)


def test_neither_a_restart_nor_a_start_replaces_a_missing_folder(database, data, tmp_path):
    (data / "postgres").rename(tmp_path / "away")
    for start in (database.restart, database.start):
        with pytest.raises(DatabaseUnavailable, match=r"missing.*polhode db restore FILE"):
            start()
        assert not (data / "postgres").exists()
    (data / "postgres.log").rename(tmp_path / "log")  # an operator tidies up
    with pytest.raises(DatabaseUnavailable, match="existed before"):
        database.start()
    (data / "postgres.id").rename(tmp_path / "id")
    (tmp_path / "log").rename(data / "postgres.log")  # as earlier versions left it
    with pytest.raises(DatabaseUnavailable, match="existed before"):
        database.start()
    (tmp_path / "id").rename(data / "postgres.id")
    (tmp_path / "away").rename(data / "postgres")
    database.start()
    assert kept(database)


def test_the_rest_of_a_folder_is_refused(database, data, tmp_path):
    (data / "postgres" / "PG_VERSION").rename(tmp_path / "version")
    (data / "postgres.id").unlink()
    (data / "postgres.log").unlink()
    with pytest.raises(DatabaseUnavailable, match="not a complete database"):
        database.start()
    (tmp_path / "version").rename(data / "postgres" / "PG_VERSION")
    (data / "postgres" / "global" / "pg_control").rename(tmp_path / "control")
    with pytest.raises(DatabaseUnavailable, match="is damaged"):
        database.start()
    (tmp_path / "control").rename(data / "postgres" / "global" / "pg_control")


def test_an_installation_of_an_earlier_version_starts_and_is_recorded(database, data):
    (data / "postgres.id").unlink()
    database.start()
    identifier = sql(database.url, "SELECT system_identifier::text FROM pg_control_system()")
    assert kept(database) and [((data / "postgres.id").read_text().strip(),)] == identifier


def test_the_folder_of_another_database_is_refused(database, data):
    recorded = (data / "postgres.id").read_text()
    (data / "postgres.id").write_text("7000000000000000000\n")
    with pytest.raises(DatabaseUnavailable, match="another database"):
        database.start()
    (data / "postgres.id").write_text(recorded)


def test_a_folder_that_was_lost_with_its_record_leaves_one(database, data, tmp_path):
    database.start()
    data.rename(tmp_path / "away")
    assert database.find_loss() == "postgres is missing"
    database.stop()
    with pytest.raises(DatabaseUnavailable, match="existed before"):
        EmbeddedPostgres(data).start()
    shutil.rmtree(data)
    (tmp_path / "away").rename(data)


def test_a_dropped_database_is_not_created_again(database, data):
    database.start()
    with psycopg.connect(database.url.replace("/polhode?", "/postgres?"), autocommit=True) as connection:
        connection.execute("ALTER DATABASE polhode RENAME TO elsewhere")
    database.stop()
    with pytest.raises(DatabaseUnavailable, match=r"the database polhode in .* is missing"):
        database.start()
    (data / "postgres.id").rename(data / "id")  # for a moment as on a first start
    database.start()
    with psycopg.connect(database.url.replace("/polhode?", "/postgres?"), autocommit=True) as connection:
        connection.execute("DROP DATABASE polhode")
        connection.execute("ALTER DATABASE elsewhere RENAME TO polhode")


STARTS = (
    "import pathlib, sys; from service.store.postgres.server import EmbeddedPostgres as E;"
    " E(pathlib.Path(sys.argv[1])).start()"
)


@pytest.mark.slow
def test_a_first_start_that_is_killed_in_initdb_can_be_repeated(tmp_path):
    starting = subprocess.Popen([sys.executable, "-c", STARTS, str(tmp_path / "data")])
    deadline = time.monotonic() + 30
    while not [*tmp_path.glob("data/postgres.new*/PG_VERSION")]:
        assert time.monotonic() < deadline and starting.poll() is None
        time.sleep(0.005)
    starting.kill()
    starting.wait()
    assert not (tmp_path / "data" / "postgres").exists()
    database = EmbeddedPostgres(tmp_path / "data")
    database.start()
    assert sql(database.url, "SELECT 1") == [(1,)]
    database.stop()


@pytest.mark.slow
def test_a_first_start_succeeds_while_the_initdb_of_a_killed_one_still_writes(tmp_path):
    left, done = tmp_path / "data" / "postgres.new-killed", threading.Event()

    def write():
        while not done.is_set():
            left.mkdir(parents=True, exist_ok=True)
            with contextlib.suppress(OSError):
                (left / "PG_VERSION").write_text("15\n")

    writer = threading.Thread(target=write)
    writer.start()
    database = EmbeddedPostgres(tmp_path / "data")
    try:
        database.start()
        assert sql(database.url, "SELECT 1") == [(1,)]
    finally:
        done.set()
        writer.join()
        database.stop()


@pytest.mark.slow
def test_a_backup_is_restored_into_a_new_folder_and_a_failed_one_leaves_none(tmp_path):
    data = tmp_path / "data"
    before = EmbeddedPostgres(data)
    before.start()
    migrate(before.url)
    run(before.url, lambda d: accept(d, new()))
    backup.backup(before.url, find_programs(), tmp_path / "b.dump")
    before.stop()
    old = (data / "postgres.id").read_text()
    with pytest.raises(DatabaseUnavailable, match="move it away"), EmbeddedPostgres(data).new_cluster():
        pass
    (data / "postgres").rename(tmp_path / "lost")
    (tmp_path / "bad.dump").write_bytes(b"no backup")
    with pytest.raises(backup.BackupError), EmbeddedPostgres(data).new_cluster() as url:
        backup.restore(url, find_programs(), tmp_path / "bad.dump")
    assert not (data / "postgres").exists()
    with pytest.raises(DatabaseUnavailable, match="existed before"):
        EmbeddedPostgres(data).start()
    environment = os.environ | {"POLHODE_DATA": str(data)}
    command = [sys.executable, "-m", "service.cli", "db", "restore", str(tmp_path / "b.dump")]
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    after = EmbeddedPostgres(data)
    after.start()
    assert sql(after.url, "SELECT count(*) FROM submission") == [(1,)] and not any(
        backup.check(after.url).values()
    )
    assert (data / "postgres.id").read_text() != old
    after.stop()
